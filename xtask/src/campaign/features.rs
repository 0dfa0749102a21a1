//! What is cut when it is stopped.

/// What is cut: a program, the options that it takes, and from when to when its tool is tied to a
/// spindle, machine time in s.
pub(super) struct Feature {
    pub(super) name: &'static str,
    pub(super) program: &'static str,
    pub(super) options: &'static [&'static str],
    /// Of the machine simulator alone.
    pub(super) machine: &'static [&'static str],
    pub(super) window: (f64, f64),
}

const TAP: &str = "G21 G90 G54 G17\nT11 M6\nS1000 M3\nG0 X0 Y0\nG43 H11 Z20\nG99 G84 X0 Y0 Z-18 R5 F1250\nG80\nG0 Z50\nM2\n";
const LEFT: &str = "G21 G90 G54 G17\nT41 M6\nS1000 M4\nG0 X0 Y0\nG43 H41 Z20\nG99 G74 X0 Y0 Z-20 R5 F1250\nG80\nG0 Z50\nM2\n";
const PECK: &str = "G21 G90 G54 G17\nT3 M6\nS3000 M3\nG0 X0 Y0\nG43 H3 Z20\nG99 G84 X0 Y0 Z-12 R5 Q3 F3000\nG80\nG0 Z50\nM2\n";
const SOFT: &str = "G21 G90 G54 G17\nT6 M6\nS2000 M3\nG0 X0 Y0\nG43 H6 Z20\nG99 G84 X0 Y0 Z-6 R5 F1000\nG80\nG0 Z50\nM2\n";

/// A machine that breaks chips instead of going out with each peck.
pub(super) const CHIP_BREAK: &str = "extends = \"tapping-center\"\nname = \"tapping-center\"\n\n[tapping.peck]\nretract = \"chip-break\"\n";

pub(super) const FEATURES: [Feature; 12] = [
    Feature {
        name: "tap M8, S1000",
        program: TAP,
        options: &[],
        machine: &[],
        window: (1.75, 4.0),
    },
    Feature {
        name: "left-hand tap M8, S1000",
        program: LEFT,
        options: &[],
        machine: &[],
        window: (1.75, 4.2),
    },
    Feature {
        name: "tap M8, S1000, encoder without turns",
        program: TAP,
        options: &[],
        machine: &["--single-turn"],
        window: (1.75, 4.0),
    },
    Feature {
        name: "peck tap M6, S3000",
        program: PECK,
        options: &[],
        machine: &[],
        window: (1.7, 3.4),
    },
    Feature {
        name: "chip-break peck M6, S3000",
        program: PECK,
        options: &["--machine", "chip-break.toml"],
        machine: &[],
        window: (1.7, 2.9),
    },
    Feature {
        name: "soft holder M3, S2000",
        program: SOFT,
        options: &[],
        machine: &[],
        window: (1.7, 2.5),
    },
    Feature {
        name: "speed-commanded spindle M8, S1000",
        program: TAP,
        options: &["--machine", "vfd-mill"],
        machine: &[],
        window: (8.6, 11.0),
    },
    Feature {
        name: "turned thread M20",
        program: include_str!("../../../programs/thread-m20x1.5.ngc"),
        options: &["--machine", "lathe"],
        machine: &[],
        window: (2.8, 5.0),
    },
    Feature {
        name: "hobbing m2 z40",
        program: include_str!("../../../programs/gear-m2-z40.nc"),
        options: &["--machine", "gear-hobber"],
        machine: &[],
        window: (20.0, 40.0),
    },
    Feature {
        name: "polygon AF17",
        program: include_str!("../../../programs/hexagon-af17.nc"),
        options: &["--machine", "polygon-lathe"],
        machine: &[],
        window: (8.0, 13.0),
    },
    Feature {
        name: "cam grinding, 60 rpm",
        program: include_str!("../../../programs/cam-shaft.nc"),
        options: &["--machine", "cam-grinder"],
        machine: &[],
        window: (7.7, 12.9), // cylinder 1: down to size and sparked out
    },
    Feature {
        name: "clutch tap M6, S1000",
        program: "G21 G90 G54 G17\nT13 M6\nS1000 M3\nG0 X0 Y0\nG43 H13 Z20\nG99 G84 X0 Y0 Z-15 R8 F1000\nG80\nG0 Z50\nM2\n",
        options: &[],
        machine: &[],
        window: (1.7, 3.4),
    },
];

/// All of them, and a left-hand tap.
pub(super) fn tools() -> String {
    include_str!("../../../programs/tools.toml").to_owned()
        + "\n[[tool]]\nnumber = 41\npocket = 41\nkind = \"tap\"\ndescription = \"M8 left hand, rigid collet\"\ndiameter_mm = 8.0\nlength_mm = 115.0\nthread = \"M8x1.25-LH\"\nchamfer_pitches = 2.5\nthread_length_mm = 30.0\nflute = \"spiral-flute\"\noversize_um = 45.0\nholder = { kind = \"rigid\", stiffness_n_per_um = 20.0 }\n"
}
