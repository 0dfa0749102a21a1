//! Polygons that cannot be turned are refused before anything moves, by `check` and by `run`, with
//! what would work.
use crate::common::{complained, leadscrew, said};

/// T21 as in the shop, T23 larger than X can take off the bar, T91 one insert.
const TOOLS: [(u32, f64, u32); 3] = [(21, 50.0, 3), (23, 130.0, 3), (91, 50.0, 1)];

/// What turns a polygon.
#[derive(Clone, Copy)]
struct Part {
    tool: u32,
    rpm: f64,
    /// Blocks that begin it.
    gear: &'static str,
    /// Distances of the axes, pass by pass.
    passes: &'static [f64],
}

/// A hexagon of 17 mm.
const HEXAGON: Part = Part { tool: 21, rpm: 500.0, gear: "G51.2 P1 Q2", passes: &[58.5] };

impl Part {
    fn program(&self) -> String {
        let Self { tool, rpm, gear, .. } = self;
        let cut = |x: &f64| format!("G0 X{x} Z2\nG1 Z-3 F50\nG0 X150\n");
        let passes: String = self.passes.iter().map(cut).collect();
        format!(
            "G21 G90 G94 G17\nT{tool} M6\nG43 H{tool}\nG0 X150 Y0 Z5\nM3 S{rpm}\n{gear}\n{passes}G50.2\nM5\nM2\n"
        )
    }

    /// What `check` says, and that `run` says the same.
    fn refusal(&self) -> String {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        let tools = TOOLS.map(|(number, radius, inserts)| {
            format!(
                "[[tool]]\nnumber = {number}\nkind = \"polygon-cutter\"\ntip_radius_mm = {radius:.1}\ninserts = {inserts}\nnose_radius_mm = 0.8\nlength_mm = 60.0\n"
            )
        });
        std::fs::write(at("tools.toml"), tools.concat()).unwrap();
        std::fs::write(at("part.nc"), self.program()).unwrap();
        let (part, tools, out) = (at("part.nc"), at("tools.toml"), at("out"));
        let common = [&part, "--machine", "polygon-lathe", "--tools", &tools];
        let checked = leadscrew(&[&["check"], &common[..]].concat());
        let run = leadscrew(&[&["run"], &common[..], &["--out", &out]].concat());
        assert_eq!((checked.status.code(), run.status.code()), (Some(2), Some(2)));
        assert!(!folder.path().join("out").exists(), "it has run");
        let (checked, run) = (said(&checked), complained(&run));
        let findings = |text: &str| {
            text.lines().filter(|l| l.starts_with("error")).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(findings(&checked), findings(&run));
        findings(&checked).join("\n")
    }
}

#[track_caller]
fn refused(part: Part, words: &[&str]) {
    let said = part.refusal();
    for word in words {
        assert!(said.contains(word), "{word:?} is not in {said}");
    }
}

#[test]
fn opposite_rotation() {
    refused(Part { gear: "G51.2 P1 Q-2", ..HEXAGON }, &["against each other", "1:2, works"]);
    refused(Part { gear: "G51.2 P1 Q-2 D0", ..HEXAGON }, &["against each other", "1:2, works"]);
}

#[test]
fn a_wrong_ratio() {
    refused(Part { gear: "G51.2 P1 Q1", ..HEXAGON }, &["the tool must turn faster, 1:2 works"]);
    refused(Part { gear: "G51.2 P1 Q1.5", ..HEXAGON }, &["whole numbers", "found Q1.5"]);
    // 2.94 is neither whole over eight turns nor within a hundredth of what is
    let odd = Part { gear: "G51.2 P100 Q294", ..HEXAGON };
    refused(odd, &["441 different facets", "1:3 works"]);
}

#[test]
fn a_cutter_too_big() {
    // X goes to 150 mm from the work's axis: less the bar's 25 and 2 of clearance
    let big = Part { tool: 23, passes: &[138.5], ..HEXAGON };
    refused(big, &["the cutter is too big", "Ø246.000 works"]);
    refused(Part { gear: "G51.2 P1 Q2 D0", ..big }, &["the cutter is too big", "Ø246.000 works"]);
}

#[test]
fn corners_beyond_the_stock() {
    // 46/cos 30° = 53.116 mm across corners, from a bar of 50
    let words = ["53.116 mm across corners", "Ø53.116 works, or 43.301 mm across flats"];
    refused(Part { passes: &[73.0], ..HEXAGON }, &words);
    refused(Part { passes: &[74.0, 73.0], ..HEXAGON }, &words);
    refused(Part { gear: "G51.2 P1 Q2 D0", passes: &[73.0], ..HEXAGON }, &words);
}

#[test]
fn a_speed_above_a_limit() {
    refused(Part { rpm: 3500.0, ..HEXAGON }, &["7000 rpm of the tool spindle", "S3000 works"]);
    // a tenth of a millimetre at 50 Hz has 0.1·(2π·50)³ = 3100 m/s³, 270 are for swings:
    // 500·(270/3100)^⅓ = 221.6 rpm
    let swing = Part { gear: "G51.3 L6 Y0.1\nG51.2 P1 Q2", ..HEXAGON };
    refused(swing, &["jerk of Y", "3100.6 m/s³", "270.0 m/s³", "S221 works"]);
}

#[test]
fn an_amplitude_beyond_travel() {
    let swing = Part { rpm: 1.0, gear: "G51.3 L6 Y70\nG51.2 P1 Q2", ..HEXAGON };
    refused(swing, &["Y swings from -70.000 to 70.000 mm", "an amplitude of 60.000 mm works"]);
    let swing = Part { rpm: 1.0, gear: "G51.3 L6 X100\nG51.2 P1 Q2", ..HEXAGON };
    refused(swing, &["an amplitude of 91.500 mm works"]);
}

#[test]
fn facets_that_nothing_makes_flat_enough_at_that_speed() {
    // a triangle needs 21° of the tool's phase, and its torque rises within 6 ms
    let triangle = Part { tool: 91, gear: "G51.2 P1 Q3 D4", ..HEXAGON };
    let said = triangle.refusal();
    assert!(said.contains("20 µm are allowed: jerk of tool phase binds"), "{said}");
    let works = said.split("; S").nth(1).unwrap().split(' ').next().unwrap();
    let rpm: f64 = works.parse().unwrap();
    assert!((300.0..500.0).contains(&rpm), "{said}");
}

#[test]
fn the_helper_refuses_them_too() {
    let refused = |words: &[&str]| {
        let output = leadscrew(&[&["polygon", "--across-flats", "17"], words].concat());
        assert_eq!(output.status.code(), Some(2));
        complained(&output)
    };
    // X travels to 150 mm from the work's axis: less the bar's 25 and 2 of clearance
    let big = refused(&["--tip-radius", "230"]);
    assert!(big.contains("the cutter is too big") && big.contains("Ø246.000 works"), "{big}");
    assert!(refused(&["--ratio", "1:-2"]).contains("the same sense, 1:2, works"));
    assert!(refused(&["--stock", "19"]).contains("Ø19.630 works"));
    assert!(refused(&["--speed", "3500"]).contains("--speed 3000 works"));
    assert!(refused(&["--internal"]).contains("broach"));
    assert!(refused(&["--sides", "5"]).contains("6 sides work, or --ratio 2:5 with one insert"));
}

#[test]
fn the_helper_says_up_to_which_speed_a_facet_is_as_flat_as_allowed() {
    let words = ["--sides", "3", "--ratio", "1:3", "--across-flats", "17", "--actuator", "phase"];
    let text = said(&leadscrew(&[&["polygon"], &words[..]].concat()));
    let line = text.lines().find(|line| line.starts_with("20.00 µm")).unwrap();
    let rpm: f64 = line.rsplit(' ').nth(1).unwrap().parse().unwrap();
    assert!(line.contains("allowed of a facet") && (300.0..500.0).contains(&rpm), "{line}");
    // what is a page of harmonics is left to the control
    assert!(text.contains("G51.2 P1 Q3 R0 D4") && !text.contains("G51.3"), "{text}");
}
