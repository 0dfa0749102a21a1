//! What rigid tapping must hold on the tapping centre, run as a user runs it.
use crate::common::{complained, leadscrew, said};
use serde_json::Value;
use std::path::Path;
use test_support::size;

/// Run a program with further arguments; what it printed.
fn run(program: &str, arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.ngc");
    std::fs::write(&path, program).unwrap();
    let path = path.to_str().unwrap();
    let all = [&["run", path, "--tools", "programs/tools.toml"], arguments].concat();
    let output = leadscrew(&all);
    assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), complained(&output));
    said(&output)
}

/// The threads of a run's certificate.
fn threads(program: &str, arguments: &[&str]) -> Vec<Value> {
    let text = run(program, &[arguments, &["--format", "json"]].concat());
    let certificate: Value = serde_json::from_str(&text).unwrap();
    let features = certificate["features"].as_array().unwrap();
    features.iter().filter(|f| f["kind"] == "thread").cloned().collect()
}

/// Drill with one tool and tap with another.
fn part(drill: u32, core: &str, tap: u32, blocks: &str) -> String {
    format!(
        "G21 G17 G40 G49 G80 G90 G94 G54\nT{drill} M6\nG43 H{drill}\nS2500 M3\nG0 X0 Y0 Z12\n\
         G98 G81 X0 Y0 {core} R2 F300\nG80\nT{tap} M6\nG43 H{tap}\nG0 X0 Y0 Z12\n{blocks}\nG80\nM2\n"
    )
}

/// Seconds from the line of a state in the log to that of another one.
fn seconds(log: &str, from: &str, to: &str) -> f64 {
    let at = |state: &str| -> f64 {
        let line = log.lines().rfind(|l| l.split_whitespace().nth(2) == Some(state)).unwrap();
        line.split_whitespace().next().unwrap().parse().unwrap()
    };
    at(to) - at(from)
}

#[test]
fn an_m6_at_6000_rpm_over_30_mm_is_in_and_out_in_a_second_and_a_quarter() {
    let program = part(2, "Z-28", 3, "G95 F1\nM29 S6000\nG99 G84 X0 Y0 Z-20 R10");
    let log = run(&program, &["--log"]);
    let (inward, outward) = (seconds(&log, "tap-in", "tap-out"), seconds(&log, "tap-out", "ended"));
    assert!(inward + outward <= 1.25, "{inward} s in, {outward} s out");
    assert!(!log.contains("torque or power limit"), "{log}");
    let thread = &threads(&program, &[])[0];
    assert!(thread["sync_error_max_um"].as_f64().unwrap() <= 8.0, "{thread}");
    assert!(thread["rpm_max"].as_f64().unwrap() > 5900.0, "{thread}");
}

#[test]
fn the_depth_of_an_m8_is_met_at_any_speed_and_with_a_slow_spindle() {
    for rpm in [1000, 2000, 3000] {
        let tap = format!("G95 F1.25\nM29 S{rpm}\nG99 G84 X0 Y0 Z-20 R5");
        let program = part(10, "Z-28", 11, &tap);
        // the machine plans 0.1 s to 3000 rpm; this is three times slower
        for ramp in [&[] as &[&str], &["--force-ramp", "0.3"]] {
            let thread = &threads(&program, ramp)[0];
            let error = thread["depth_error_um"].as_f64().unwrap();
            assert!(error.abs() <= 10.0, "S{rpm} {ramp:?}: {error} µm");
        }
    }
}

/// A few holes at each speed, as the drive is and with ramps three times slower: no stroke misses
/// its bottom by 10 µm, the first one included, which is the one that teaches.
#[test]
fn a_spindle_that_is_only_told_its_speed_turns_back_within_10_micrometres() {
    let folder = tempfile::tempdir().unwrap();
    let slow = folder.path().join("slow.toml");
    let ramps = "[[spindles]]\n[spindles.drive]\nacceleration_rev_per_s2 = 22.3\ndeceleration_rev_per_s2 = 22.3\n";
    let name = "extends = \"vfd-mill\"\nname = \"slow-mill\"\ndescription = \"ramps three times slower\"\n";
    std::fs::write(&slow, format!("{name}{ramps}")).unwrap();
    // the first one teaches the second
    let holes = size::of(3, 10);
    let places = (1..holes).map(|hole| format!("\nX{}", 10 * hole)).collect::<Vec<_>>().concat();
    for rpm in [1000.0, 2000.0, 3000.0] {
        let tap = format!("S{rpm} M3\nG98 G84 X0 Y0 Z-20 R5 F{}{places}", rpm * 1.25);
        let program =
            part(10, "Z-28", 11, &tap).replace("G80\nT11", &format!("{places}\nG80\nT11"));
        for (machine, seed) in [("vfd-mill", "4"), (slow.to_str().unwrap(), "5")] {
            let taps = threads(&program, &["--machine", machine, "--seed", seed]);
            assert_eq!(taps.len(), holes);
            for tap in taps {
                let error = tap["depth_error_um"].as_f64().unwrap();
                assert!(error.abs() <= 10.0, "{machine} S{rpm}: {error} µm, line {}", tap["line"]);
            }
        }
    }
}

/// A drill's thrust F stretches the screw by F/k. Where the scale has made that good, the tool side
/// springs forward when the thrust ends: by F/k, and as far again, less its damping, as a spring
/// that is let go at once.
#[test]
fn where_a_scale_is_fitted_a_drill_springs_forward_no_more_than_its_screw_was_stretched() {
    let program = part(2, "Z-24", 3, "G80").replace("S2500", "S6000").replace("F300", "F900");
    let text = run(&program, &["--machine", "tapping-center-scale", "--format", "json"]);
    let certificate: Value = serde_json::from_str(&text).unwrap();
    let error = (certificate["features"][0]["depth_mm"].as_f64().unwrap() - 24.0) * 1e3;
    // ½·kc·f·D/2·sin 59° of a 5 mm drill at 0.15 mm per turn in C45, with 5 % of scatter; 80 N/µm
    let thrust_n = 0.5 * 3900.0 * 0.15 * 2.5 * 59f64.to_radians().sin();
    let stretch_um = 1.05 * thrust_n / 80.0;
    // damping ratio 0.04 of the free mode of 124 Hz
    let again = (-std::f64::consts::PI * 0.04).exp();
    assert!(
        error > 0.0 && error < stretch_um * (1.0 + again),
        "{error} µm, {stretch_um} µm of stretch"
    );
}

/// The machine with another way to peck.
fn chip_breaking(folder: &Path) -> String {
    let shown = said(&leadscrew(&["machine", "show", "tapping-center"]));
    let changed = shown.replace("retract = \"full\"", "retract = \"chip-break\"");
    assert_ne!(shown, changed);
    let path = folder.join("machine.toml");
    std::fs::write(&path, changed).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn pecks_of_both_kinds_leave_the_thread_that_one_stroke_leaves() {
    let folder = tempfile::tempdir().unwrap();
    let chip_breaking = chip_breaking(folder.path());
    let once = part(2, "Z-28", 3, "G95 F1\nM29 S3000\nG99 G84 X0 Y0 Z-20 R5 A90");
    let pecked = part(2, "Z-28", 3, "G95 F1\nM29 S3000\nG99 G84 X0 Y0 Z-20 R5 A90 Q6");
    let whole = &threads(&once, &[])[0];
    for machine in ["tapping-center", &chip_breaking] {
        let thread = &threads(&pecked, &["--machine", machine])[0];
        for (key, apart) in
            [("pitch_diameter_mm", 0.003), ("start_angle_deg", 0.5), ("depth_mm", 0.005)]
        {
            let (a, b) = (thread[key].as_f64().unwrap(), whole[key].as_f64().unwrap());
            assert!((a - b).abs() <= apart, "{machine} {key}: {a} pecked, {b} at once");
        }
        assert!(thread["sync_error_max_um"].as_f64().unwrap() <= 8.0, "{thread}");
    }
    let log = run(&pecked, &["--machine", &chip_breaking, "--log"]);
    let turned = log.lines().filter(|l| l.contains("tap-out")).count();
    assert_eq!(turned, 5, "25 mm of stroke in pecks of 6: {log}");
}

#[test]
fn presets_differ_in_time_and_none_of_them_spoils_the_thread() {
    let program = part(2, "Z-28", 3, "G95 F1\nM29 S6000\nG99 G84 X0 Y0 Z-20 R10");
    let mut before = f64::INFINITY;
    for preset in ["gentle", "standard", "fast", "max"] {
        let log = run(&program, &["--log", "--tapping-preset", preset]);
        let time = seconds(&log, "tap-in", "ended");
        assert!(time < before, "{preset} takes {time} s, the one before {before} s");
        before = time;
        let thread = &threads(&program, &["--tapping-preset", preset])[0];
        assert!(thread["sync_error_max_um"].as_f64().unwrap() <= 15.0, "{preset}: {thread}");
    }
}
