//! `leadscrew time` is the planner that would run it: its figure beside the run's own.
#![allow(clippy::unwrap_used)] // a test may panic
#[allow(dead_code)] // each test binary uses its own part
mod common;
use common::{leadscrew, root, said};
use serde_json::Value;

const PLATE: &str = "programs/plate-12xM6.ngc";

fn planned(machine: &str) -> f64 {
    let output = leadscrew(&["time", PLATE, "--machine", machine, "--format", "json"]);
    let value: Value = serde_json::from_str(&said(&output)).unwrap();
    value["total_time_s"].as_f64().unwrap()
}

/// The spindle's straight ramp of 0.5 s stands in the machine's file. What the run takes longer is waiting for position.
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
