//! `cargo xtask bench-listing`: how fast a long program becomes canonical calls.
//!
//! The same G1 program goes through `leadscrew canon --format linuxcnc` and through LinuxCNC's
//! `rs274 -g`, by turns in the same run, each into nowhere; the medians of five are compared. First
//! the two listings are compared in full, so that nobody wins by doing less.
#![allow(clippy::disallowed_methods)] // a bench measures: it has a clock

use crate::listing::{calls, first_difference};
use crate::rs274::Rs274;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Times each is run.
const ROUNDS: usize = 5;
/// How many times as fast as LinuxCNC's Leadscrew is to be.
const GOAL: f64 = 5.0;

/// Measures on a program of so many G1 lines. False if the goal is missed.
pub(crate) fn run(lines: usize) -> Result<bool, String> {
    let leadscrew = build()?;
    let rs274 = Rs274::new()?;
    let folder = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
    let program = folder.path().join("pass.ngc");
    fs::write(&program, finishing_pass(lines))
        .map_err(|e| format!("{}: {e}", program.display()))?;

    let ours = || {
        let mut command = Command::new(&leadscrew);
        command.args(["canon", "--format", "linuxcnc"]).arg(&program);
        command
    };
    let theirs = || rs274.command(&program);
    let (a, b) = (listing(theirs())?, listing(ours())?);
    if let Some((call, a, b)) = first_difference(&a, &b) {
        return Err(format!("the listings differ at call {call}:\n  {a}\n  {b}"));
    }
    println!("{lines} lines of G1, {} calls each, the listings are the same", a.len());

    let (mut our_times, mut their_times) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        our_times.push(time(ours())?);
        their_times.push(time(theirs())?);
    }
    let (our_time, their_time) = (median(our_times), median(their_times));
    let ratio = their_time / our_time;
    println!("leadscrew canon --format linuxcnc  {:>8.1} ms", our_time * 1e3);
    println!("rs274 -g                           {:>8.1} ms", their_time * 1e3);
    println!("ratio {ratio:.1} (goal: at least {GOAL})");
    Ok(ratio >= GOAL)
}

/// The release build of the command line.
fn build() -> Result<PathBuf, String> {
    let status =
        Command::new(env!("CARGO")).args(["build", "--release", "-p", "leadscrew"]).status();
    if !status.is_ok_and(|s| s.success()) {
        return Err("`cargo build --release -p leadscrew` failed".into());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(root.join("target"), PathBuf::from);
    Ok(target.join("release/leadscrew"))
}

/// A wavy finishing pass, as CAM systems write them.
fn finishing_pass(lines: usize) -> String {
    let mut text = String::from("G21 G90 G17 G94\nG1 F1200\n");
    for i in 0..lines {
        let t = i as f64 * 0.001;
        let (x, y, z) = (50.0 * t.cos(), 50.0 * t.sin(), -0.5 * (7.0 * t).sin());
        let _ = writeln!(text, "G1 X{x:.4} Y{y:.4} Z{z:.3}");
    }
    text + "M2\n"
}

fn listing(mut command: Command) -> Result<Vec<String>, String> {
    let output = command.stdout(Stdio::piped()).output().map_err(|e| shown(&command, &e))?;
    if !output.status.success() {
        return Err(format!("{command:?} ended with {}", output.status));
    }
    Ok(calls(&String::from_utf8_lossy(&output.stdout)))
}

fn time(mut command: Command) -> Result<f64, String> {
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let start = Instant::now();
    let status = command.status().map_err(|e| shown(&command, &e))?;
    let seconds = start.elapsed().as_secs_f64();
    if status.success() { Ok(seconds) } else { Err(format!("{command:?} ended with {status}")) }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn shown(command: &Command, error: &std::io::Error) -> String {
    format!("{}: {error}", command.get_program().to_string_lossy())
}
