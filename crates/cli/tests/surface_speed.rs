//! Constant surface speed (G96) from the command line, on a lathe and elsewhere.
use crate::common;

use crate::common::{complained, said};
use std::fs;

/// What a command says of a program with these words: exit code and text.
fn leadscrew(command: &[&str], program: &str, options: &[&str]) -> (Option<i32>, String) {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("part.nc");
    fs::write(&path, program).unwrap();
    let path = path.display().to_string();
    let output = common::leadscrew(&[command, &[path.as_str()], options].concat());
    (output.status.code(), format!("{}{}", said(&output), complained(&output)))
}

const FANUC: [&str; 4] = ["--machine", "lathe", "--dialect", "fanuc-lathe-a"];
const LINUXCNC: [&str; 2] = ["--machine", "lathe"];

/// The spindle's speed in the line of a log in which something begins in a line of the program.
fn rpm(log: &str, line: u32, state: &str) -> f64 {
    let found = log.lines().find_map(|text| {
        let words: Vec<_> = text.split_whitespace().collect();
        let here = words.get(1) == Some(&line.to_string().as_str()) && words.get(2) == Some(&state);
        here.then(|| words.last().unwrap().parse().unwrap())
    });
    found.unwrap_or_else(|| panic!("no {state} in line {line}:\n{log}"))
}

/// 100 m/min: 1326.3 rpm on a diameter of 24 mm, 3183 on 10 mm, which the limit of 2500 does not
/// let it have.
#[test]
fn a_face_is_turned_at_the_speed_of_its_diameter_in_both_dialects() {
    let fanuc = "%\nO1\nG21 G18 G99\nG50 S2500\nT3131\nG96 S100 M3\nG0 X24. Z12.\nZ-1.\nG1 X10. F0.1\nG0 Z12.\nM30\n%\n";
    let linuxcnc = "G21 G18 G7 G95 G90\nT31 M6 G43\nG96 D2500 S100 M3\n(here)\n(as)\n(there)\nG0 X24 Z12\nZ-1\nG1 X10 F0.1\nG0 Z12\nM2\n";
    for (program, options) in [(fanuc, &FANUC[..]), (linuxcnc, &LINUXCNC[..])] {
        let (code, log) = leadscrew(&["run"], program, &[options, &["--log"]].concat());
        assert_eq!(code, Some(0), "{log}");
        assert!((rpm(&log, 9, "feed") - 1326.3).abs() < 3.0, "{log}");
        assert!((rpm(&log, 9, "settle") - 2500.0).abs() < 5.0, "{log}");
    }
}

/// Feet per minute: 328.084 ft/min are 100 m/min.
#[test]
fn with_inches_the_surface_speed_is_in_feet_per_minute() {
    let program = "G20 G18 G7 G95 G90\nT31 M6 G43\nG96 D2500 S328.084 M3\nG0 X0.944882 Z0.5\nG1 X0.9 F0.004\nM2\n";
    let (code, log) = leadscrew(&["run"], program, &[&LINUXCNC[..], &["--log"]].concat());
    assert_eq!(code, Some(0), "{log}");
    assert!((rpm(&log, 5, "feed") - 1326.3).abs() < 3.0, "{log}");
}

/// Passes at 1640 rpm to 1766 rpm: their helices agree as those of G97 do.
#[test]
fn a_thread_with_it_is_cut_within_its_tolerance_as_with_g97() {
    let thread = |speed: &str| {
        format!(
            "%\nO1\nG21 G18 G99\nG50 S2500\nT3232\n{speed} M3\nG0 X26. Z12.\nG76 P010060 Q100 R0.02\n\
             G76 X18.03 Z-20. P985 Q300 F1.5\nG0 X30.\nM30\n%\n"
        )
    };
    for (speed, warned) in [("G96 S100", true), ("G96 S40", true), ("G97 S1600", false)] {
        let (code, text) = leadscrew(&["run"], &thread(speed), &FANUC);
        assert_eq!(code, Some(0), "{text}");
        assert!(text.contains("Go gauge: 68 of 140 µm left"), "{speed}: {text}");
        assert_eq!(text.contains("warning[M0356]"), warned, "{speed}: {text}");
    }
}

#[test]
fn without_a_limit_it_is_said_and_where_the_spindle_turns_the_tool_it_is_refused() {
    let program = "G21 G90\nG96 S100 M3\nG1 X10 F100\nM2\n";
    let (_, text) = leadscrew(&["check"], program, &LINUXCNC);
    assert!(text.contains("warning[M0319]: G96 without a limit"), "{text}");
    for machine in ["tapping-center", "gear-hobber", "cam-grinder"] {
        let (code, text) = leadscrew(&["check"], program, &["--machine", machine]);
        assert_eq!(code, Some(2), "{text}");
        let refused =
            "error[M0310]: constant surface speed (G96) is for a spindle that turns the work";
        assert!(text.contains(refused), "{machine}: {text}");
    }
}
