//! A program is judged alike whether it is run once or by a control that stays on.

use crate::common::{complained, leadscrew, said};
use std::path::Path;

/// Features that are good, out of tolerance, and not judged.
type Count = [u64; 3];

fn by_run(program: &str, machine: &str, folder: &Path) -> Count {
    let out = folder.join("run");
    let output = leadscrew(&["run", program, "--machine", machine, "--out", out.to_str().unwrap()]);
    let certificate = std::fs::read(out.join("certificate.json"));
    let certificate = certificate.unwrap_or_else(|_| panic!("{}", complained(&output)));
    let certificate: serde_json::Value = serde_json::from_slice(&certificate).unwrap();
    ["passed", "failed", "not_judged"].map(|which| certificate["count"][which].as_u64().unwrap())
}

fn by_control(program: &str, machine: &str, folder: &Path) -> Count {
    let script = folder.join("script");
    let text = format!(
        "power on\nwait ready\nhome\nwait homed\nload {program}\nstart\nwait completed within 300 s\nfeatures\n"
    );
    std::fs::write(&script, text).unwrap();
    let output =
        leadscrew(&["control", "--machine", machine, "--script", script.to_str().unwrap()]);
    let (said, complained) = (said(&output), complained(&output));
    let last = said.lines().rfind(|line| line.contains(" good, "));
    let last = last.unwrap_or_else(|| panic!("{said}\n{complained}"));
    let numbers: Vec<u64> = last.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    numbers.try_into().unwrap_or_else(|_| panic!("{last}"))
}

fn judged_alike(program: &str, machine: &str, good: u64) {
    let folder = tempfile::TempDir::new().unwrap();
    let by_run = by_run(program, machine, folder.path());
    assert_eq!(by_run, [good, 0, 0], "{program} on {machine}, run once");
    assert_eq!(by_control(program, machine, folder.path()), by_run, "{program} on {machine}");
}

/// The profiles come from the library beside the program, which a control learns of when the
/// program is loaded.
#[test]
fn cams_of_the_library_beside_the_program() {
    judged_alike("programs/cam-shaft.nc", "cam-grinder", 4);
}

/// Where the spindle turns back by itself a thread may run as far beyond its bottom as such a
/// spindle repeats its stop.
#[test]
fn threads_behind_a_spindle_that_turns_back_by_itself() {
    judged_alike("programs/mill-8xM8.ngc", "vfd-mill", 16);
}

#[test]
fn a_turned_thread() {
    judged_alike("programs/thread-m20x1.5.ngc", "lathe", 1);
}

#[test]
fn a_polygon() {
    judged_alike("programs/hexagon-af17.nc", "polygon-lathe", 1);
}
