//! Hobbed gears from the program's text to the verdict: what `check` says before motion, and what
//! `run` says of the teeth.
use crate::common::{leadscrew, said};

/// Hobs beside the shop's: left-handed, of two starts, of module 2.5, made for M4, in inches; and
/// one that no table describes.
const TOOLS: &str = "\
[[tool]]\nnumber = 23\npocket = 0\nkind = \"hob\"\nmodule_mm = 2\ndiameter_mm = 70\nhob_length_mm = 70\nlength_mm = 60\n\
[[tool]]\nnumber = 24\npocket = 0\nkind = \"hob\"\nmodule_mm = 2\nhand = \"left\"\ndiameter_mm = 70\nlength_mm = 60\n\
[[tool]]\nnumber = 25\npocket = 0\nkind = \"hob\"\nmodule_mm = 2\nstarts = 2\ndiameter_mm = 70\nlength_mm = 60\n\
[[tool]]\nnumber = 26\npocket = 0\nkind = \"hob\"\nmodule_mm = 2.5\ndiameter_mm = 70\nlength_mm = 60\n\
[[tool]]\nnumber = 27\npocket = 0\nkind = \"hob\"\nmodule_mm = 2\ncuts_with = \"M4\"\ndiameter_mm = 70\nlength_mm = 60\n\
[[tool]]\nnumber = 28\npocket = 0\nkind = \"hob\"\ndiametral_pitch = 10\npressure_angle_deg = 14.5\naddendum_in = 0.1157\ndiameter_in = 2.75\nlength_in = 2.4\n\
[[tool]]\nnumber = 29\npocket = 0\nkind = \"other\"\ndiameter_mm = 70\nlength_mm = 60\n";

/// A gear of 20 straight teeth of module 2 in 8 mm of a blank turned to 44 mm, at 52.5 mm.
#[derive(Clone, Copy)]
struct Part {
    tool: u32,
    head: &'static str,
    spindle: &'static str,
    cycle: &'static str,
    /// Between G81 T L Q P and G80.
    cuts: &'static str,
    /// After it.
    then: &'static str,
}

const STOCK: &str = "(STOCK X-22 Y-22 Z-10 X22 Y22 Z0)\nG21";
const PART: Part = Part {
    tool: 23,
    head: STOCK,
    spindle: "M3 S500",
    cycle: "G81 T20 L1 Q2",
    cuts: "G0 X52.5\nG1 Z-8 F50\nG0 X75",
    then: "",
};

/// Passes a remark of `check` that has the first text; the verdict, and a text that `run` prints.
type Expected = (Option<&'static str>, &'static str, &'static str);

impl Part {
    fn program(&self) -> String {
        let Self { tool, head, spindle, cycle, cuts, then } = self;
        let safe = if head.contains("G20") { "G0 X4 Y0 Z0.2" } else { "G0 X75 Y0 Z5" };
        format!(
            "{head} G90 G94 G17\nT{tool} M6\nG43 H{tool}\n{safe}\n{spindle}\n{cycle}\n{cuts}\nG80\n{then}M5\nM2\n"
        )
    }

    #[track_caller]
    fn is(&self, name: &str, (before, verdict, after): Expected) {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        std::fs::write(at("tools.toml"), TOOLS).unwrap();
        std::fs::write(at("part.nc"), self.program()).unwrap();
        let (part, tools, out) = (at("part.nc"), at("tools.toml"), at("out"));
        let common = [&part, "--machine", "gear-hobber", "--tools", &tools];
        let checked = said(&leadscrew(&[&["check"], &common[..]].concat()));
        match before {
            Some(text) => assert!(checked.contains(text), "{name}: {text}: {checked}"),
            None => assert!(checked.contains("0 errors, 0 remarks"), "{name}: {checked}"),
        }
        let run = said(&leadscrew(&[&["run"], &common[..], &["--out", &out]].concat()));
        let last = run.lines().find(|line| line.starts_with(verdict));
        assert!(last.is_some() && run.contains(after), "{name}: {verdict}, {after}: {run}");
    }
}

#[test]
fn what_run_finds_wrong_with_teeth_check_has_said_before_motion_with_the_number_that_works() {
    let cuts = |cuts| Part { cuts, ..PART };
    let cycle = |cycle| Part { cycle, ..PART };
    let attacks: [(&str, Part, Expected); 12] = [
        ("as it should be", PART, (None, "PASS", "span over teeth")),
        ("0.2 too deep", cuts("G0 X52.3\nG1 Z-8 F50\nG0 X75"), (Some("M0434"), "FAIL", "too thin")),
        (
            "0.2 too shallow",
            cuts("G0 X52.7\nG1 Z-8 F50\nG0 X75"),
            (
                Some(
                    "T23 (a hob) goes 0.2 mm too shallow for 20 teeth of module 2, whose teeth become 0.146 mm too thick: X52.5 works",
                ),
                "FAIL",
                "too thick",
            ),
        ),
        (
            "in the air",
            cuts("G0 X58\nG1 Z-8 F50\nG0 X75"),
            (
                Some(
                    "passes the blank, which it touches from X57 of G54, 1 mm off it: nothing is cut here, X52.5 works",
                ),
                "FAIL",
                "not cut: the hob never touched the blank",
            ),
        ),
        (
            "above the blank",
            cuts("G0 X52.5\nG1 Z1 F50\nG0 X75"),
            (Some("stays beside the blank, whose face is at Z0 of G54"), "FAIL", "never touched"),
        ),
        ("a tooth less", cycle("G81 T19 L1 Q2"), (Some("X51.5 works"), "FAIL", "too thick")),
        (
            "two starts ordered",
            cycle("G81 T20 L2 Q2"),
            (Some("has 1 right-hand start(s), and L2 is ordered: L1 works"), "FAIL", "10 teeth"),
        ),
        (
            "against the hob's hand",
            Part { tool: 24, ..PART },
            (Some("has 1 left-hand start(s), and L1 is ordered: L-1 works"), "FAIL", "no teeth"),
        ),
        (
            "another module",
            Part { tool: 26, ..PART },
            (Some("has module 2.5, and module 2 is ordered: Q2.5 works"), "FAIL", "base pitch"),
        ),
        (
            "M4",
            Part { spindle: "M4 S500", ..PART },
            (Some("backs of its teeth ahead (M4): M3 works"), "FAIL", "M3 works"),
        ),
        (
            "a blank that was not turned",
            Part { head: "(STOCK X-25 Y-25 Z-10 X25 Y25 Z0)\nG21", ..PART },
            (
                Some(
                    "the blank is 50 mm in diameter, and the tips of 20 teeth of module 2 are at 44 mm",
                ),
                "FAIL",
                "tip diameter 50.000",
            ),
        ),
        (
            "a tool of no description",
            Part { tool: 29, ..PART },
            (None, "NOT JUDGED", "not described as a hob"),
        ),
    ];
    for (name, part, expected) in attacks {
        part.is(name, expected);
    }
}

#[test]
fn good_gears_of_every_kind_are_good_before_and_after_motion() {
    const SHIFTED: &str =
        "(STOCK X-23.2 Y-23.2 Z-10 X23.2 Y23.2 Z0)\n(GEAR SHIFT 0.6 WIDTH 7 GRADE 6)\nG21";
    // 30 teeth of diametral pitch 10: tips at 3.2 in, 1.5 + 1.375 − 0.1157 in
    const INCHES: &str = "G20\n(STOCK X-1.6 Y-1.6 Z-0.4 X1.6 Y1.6 Z0)\n(GEAR ANGLE 14.5)\nG20";
    let good: [(&str, Part); 7] = [
        ("a left-hand hob", Part { tool: 24, cycle: "G81 T20 L-1 Q2", ..PART }),
        ("two starts", Part { tool: 25, cycle: "G81 T20 L2 Q2", ..PART }),
        ("a hob for M4", Part { tool: 27, spindle: "M4 S500", ..PART }),
        ("fed upwards", Part { cuts: "G0 X75 Z-9\nG1 X52.5 F200\nG1 Z2 F50\nG0 X75", ..PART }),
        ("a shift", Part { head: SHIFTED, cuts: "G0 X53.7\nG1 Z-8 F50\nG0 X75", ..PART }),
        (
            "roughed and finished in one cycle",
            Part {
                cuts: "G0 X53.5\nG1 Z-9 F100\nG0 X75\nG0 Z5\nG0 X52.5\nG1 Z-9 F50\nG0 X75",
                ..PART
            },
        ),
        (
            "inches",
            Part {
                tool: 28,
                head: INCHES,
                cycle: "G81 T30 L1 Q10",
                cuts: "G0 X2.7593\nG1 Z-0.35 F1.5\nG0 X4",
                ..PART
            },
        ),
    ];
    for (name, part) in good {
        part.is(name, (None, "PASS", "1/1"));
    }
}

#[test]
fn teeth_that_are_cut_in_two_cycles_are_one_gear_and_other_teeth_over_them_destroy_it() {
    const AGAIN: &str = "G0 Z5\nG81 T20 L1 Q2\nG0 X52.5\nG1 Z-8 F50\nG0 X75\nG80\n";
    const OTHER: &str = "G0 Z5\nG81 T20 L1 Q2 P10\nG0 X52.5\nG1 Z-8 F50\nG0 X75\nG80\n";
    let rough = Part { cuts: "G0 X53.2\nG1 Z-8 F80\nG0 X75", then: AGAIN, ..PART };
    rough.is("roughed, then finished", (None, "PASS", "1/1"));
    let over = Part { then: OTHER, ..PART };
    over.is("another helix over it", (Some("M0434"), "FAIL", "good when cut, destroyed in line"));
}

#[test]
fn an_inch_programs_remark_is_in_inches() {
    let part = Part {
        tool: 28,
        head: "G20\n(STOCK X-1.6 Y-1.6 Z-0.4 X1.6 Y1.6 Z0)\n(GEAR ANGLE 14.5)\nG20",
        cycle: "G81 T30 L1 Q10",
        cuts: "G0 X2.7493\nG1 Z-0.35 F1.5\nG0 X4",
        ..PART
    };
    part.is("0.01 in too deep", (Some("goes 0.01 in too deep for 30 teeth of module 2.54, whose teeth become 0.0052 in too thin: X2.7593 works"), "FAIL", "too thin"));
}
