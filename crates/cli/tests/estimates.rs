//! `leadscrew time` is the planner that would run it: its figure beside the run's own.
use crate::common::{leadscrew, root, said};
use serde_json::Value;
use std::fmt::Write as _;
use test_support::size;

const PLATE: &str = "programs/plate-12xM6.ngc";

fn planned(machine: &str) -> f64 {
    let output = leadscrew(&["time", PLATE, "--machine", machine, "--format", "json"]);
    let value: Value = serde_json::from_str(&said(&output)).unwrap();
    value["total_time_s"].as_f64().unwrap()
}

/// The spindle's straight ramp of 0.5 s stands in the machine's file. What the run takes longer is
/// waiting for position.
#[test]
fn a_straight_ramp_of_the_machines_file_counts_in_the_estimate() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(root().join("machines/tapping-center.toml")).unwrap();
    let slow = text.replace("ramp = \"power-curve\"", "ramp_s = 0.5\nramp = \"linear\"");
    assert_ne!(slow, text);
    let file = folder.path().join("slow.toml");
    std::fs::write(&file, slow).unwrap();
    let machine = file.to_str().unwrap();
    let out = folder.path().join("out");
    let run =
        leadscrew(&["run", PLATE, "--machine", machine, "-q", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}", said(&run));
    let certificate = std::fs::read_to_string(out.join("certificate.json")).unwrap();
    let certificate: Value = serde_json::from_str(&certificate).unwrap();
    let took = certificate["cycle_time_s"].as_f64().unwrap();
    assert!((planned(machine) / took - 1.0).abs() < 0.01, "{} s of {took} s", planned(machine));
    assert!(planned(machine) > planned("tapping-center") + 3.0);
}

fn estimate(arguments: &[&str]) -> Value {
    let output = leadscrew(&[&["time", "--format", "json"], arguments].concat());
    serde_json::from_str(&said(&output)).unwrap()
}

fn seconds(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no {key} in {value}"))
}

#[test]
fn tools_and_operations_make_up_the_whole() {
    for (program, machine) in [
        (PLATE, "tapping-center"),
        ("programs/thread-m20x1.5.ngc", "lathe"),
        ("programs/cam-shaft.nc", "cam-grinder"),
    ] {
        let whole = estimate(&[program, "--machine", machine, "--operations"]);
        let total = seconds(&whole, "total_time_s");
        let shares = ["motion", "turning", "waiting", "dwell", "tool_change"];
        let sum: f64 = shares.iter().map(|of| seconds(&whole, &format!("{of}_time_s"))).sum();
        assert!((sum - total).abs() < 1e-5, "{program}: {sum} s of {total} s");
        let moving = ["feed", "rapid", "tapping", "threading"];
        let sum: f64 = moving.iter().map(|of| seconds(&whole, &format!("{of}_time_s"))).sum();
        assert!((sum - seconds(&whole, "motion_time_s")).abs() < 1e-5, "{program}: {sum} s");
        let tools = whole["tools"].as_array().unwrap();
        let sum: f64 = tools.iter().map(|tool| seconds(tool, "total_time_s")).sum();
        assert!((sum - total).abs() < 1e-5, "{program}: {sum} s of {total} s by tool");
        let operations = whole["operations"].as_array().unwrap();
        let sum: f64 = operations.iter().map(|op| seconds(op, "time_s")).sum();
        assert!((sum - total).abs() < 1e-6 * operations.len() as f64, "{program}: {sum} s");
    }
    let thread = estimate(&["programs/thread-m20x1.5.ngc", "--machine", "lathe"]);
    // 16 passes of 23.5 mm of thread, lead 1.5, S1000 at most: a quarter of a minute
    assert!(seconds(&thread, "threading_time_s") > 16.0 * 23.5 / 1.5 / 1000.0 * 60.0);
}

/// Seconds in which the run was in one of these states, by its log, and how often it was; times are
/// to a millisecond there.
fn logged(program: &str, machine: &str, states: &[&str]) -> (f64, usize) {
    let output = leadscrew(&["run", program, "--machine", machine, "--log", "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let (mut time, mut count, mut since) = (0.0, 0, None);
    for line in said(&output).lines() {
        let mut words = line.split_whitespace();
        let (Some(Ok(at)), Some(state)) = (words.next().map(str::parse::<f64>), words.nth(1))
        else {
            continue; // a heading, a summary
        };
        if words.clone().count() != 5 || words.any(|word| word.parse::<f64>().is_err()) {
            continue; // an event between two states
        }
        if let Some(from) = since.take() {
            time += at - from;
            count += 1;
        }
        since = states.contains(&state).then_some(at);
    }
    (time, count)
}

/// Cuts and rapids of the run, with the waits for position at their ends: a period a stop, and what
/// the log rounds.
#[test]
fn a_run_moves_as_long_as_was_estimated() {
    for (program, machine, period) in [
        (PLATE, "tapping-center", 250e-6),
        ("programs/scroll.ngc", "mill-5-axis", 250e-6),
        ("programs/mill-8xM8.ngc", "vfd-mill", 250e-6),
        ("programs/hexagon-af17.nc", "polygon-lathe", 250e-6),
    ] {
        let planned = estimate(&[program, "--machine", machine]);
        let planned = seconds(&planned, "feed_time_s") + seconds(&planned, "rapid_time_s");
        let (took, stretches) = logged(program, machine, &["feed", "rapid", "settle"]);
        assert!(stretches > 5, "{program}: {stretches}");
        let rounded = 1e-3 + period * stretches as f64;
        assert!(
            (took - planned).abs() < rounded,
            "{program}: {took} s of {planned} s, {stretches}"
        );
    }
}

/// `--report` leaves the page and nothing else; it says what the limits of jerk cost, and where
/// what limited.
#[test]
fn the_report_alone_shows_what_limited_the_path() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let report = format!("--report={}", page.display());
    let args = ["run", "programs/scroll.ngc", "--machine", "mill-5-axis", "-q", &report];
    assert_eq!(leadscrew(&args).status.code(), Some(0));
    let text = std::fs::read_to_string(&page).unwrap();
    for expected in ["Tool path by speed", "Tool path by what limited it", "they cost", "°/s"] {
        assert!(text.contains(expected), "{expected}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// Rows of short lines, and pockets of arcs between them, with drops and rapids.
fn long_program() -> String {
    let mut text = "G21 G90 G17 G64 P0.01\nS6000 M3\nG0 X0 Y0 Z5\nG1 Z0 F4000\n".to_owned();
    for row in 0..28 {
        for at in 0..300 {
            let x = 0.3 * f64::from(if row % 2 == 0 { at } else { 300 - at });
            let z = (x / 7.0).sin() + 0.2 * (2.1 * x + f64::from(row)).sin();
            let _ = writeln!(
                text,
                "G1 X{x:.4} Y{:.4} Z{z:.4} F{}",
                0.4 * f64::from(row),
                3000 + 100 * row
            );
        }
        if row % 7 == 3 {
            let _ = writeln!(text, "G0 Z5\nX50 Y50\nG1 Z-1 F600");
            for turn in 1..30 {
                let radius = 0.4 * f64::from(turn);
                let _ = writeln!(text, "G1 X{} F2400\nG2 I-{radius}", 50.0 + radius);
            }
            text += "G0 Z5\n";
        }
    }
    text + "G0 Z5\nM2\n"
}

/// Expected is what planning all of it says.
#[test]
fn an_estimate_from_a_sample_is_within_what_it_says_of_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.ngc");
    std::fs::write(&path, long_program()).unwrap();
    let path = path.to_str().unwrap();
    for machine in size::first_of(1, &["bench-xyz-jerk20", "bench-xyz"]) {
        let fast = estimate(&[path, "--machine", machine, "--fast"]);
        let whole = estimate(&[path, "--machine", machine]);
        let within = seconds(&fast, "within_share");
        assert!(within > 0.0 && within <= 0.02, "{within}");
        assert!(seconds(&fast, "planned_stretches") < seconds(&fast, "stretches"));
        let (fast, whole) = (seconds(&fast, "total_time_s"), seconds(&whole, "total_time_s"));
        assert!(
            (fast / whole - 1.0).abs() <= within,
            "{machine}: {fast} s of {whole} s, ±{within}"
        );
    }
    let said = said(&leadscrew(&["time", path, "--machine", "bench-xyz", "--fast"]));
    assert!(said.contains("stretches of it were planned"), "{said}");
}

#[test]
fn a_short_program_is_planned_as_a_whole_however_it_is_asked() {
    let whole = estimate(&[PLATE]);
    assert_eq!(estimate(&[PLATE, "--fast"]), whole);
    let output = leadscrew(&["time", PLATE, "--fast", "--operations"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
}
