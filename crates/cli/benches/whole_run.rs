//! How fast whole runs are: interpreting, planning, ticking, simulating, judging and recording of a
//! shipped program, as `leadscrew run --timings` states it. Prints the median of some runs, without
//! and with report files.
//!
//! ```text
//!   cargo bench -p cli
//! ```
#![allow(clippy::unwrap_used)] // a bench may panic
use std::{path::Path, process::Command};

const RUNS: usize = 7;
const PROGRAMS: [&str; 3] =
    ["programs/plate-12xM6.ngc", "programs/m3-and-m10.ngc", "programs/bolt-circle.ngc"];

fn main() {
    println!("{:<28} {:>16} {:>22}", "program", "times real time", "with report and trace");
    for program in PROGRAMS {
        println!("{program:<28} {:>16.0} {:>22.0}", median(program, false), median(program, true));
    }
}

/// Simulated time over time: median of some runs.
fn median(program: &str, report_files: bool) -> f64 {
    let mut ratios: Vec<_> = (0..RUNS).map(|_| ratio(program, report_files)).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[RUNS / 2]
}

fn ratio(program: &str, report_files: bool) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
    run.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."));
    run.args(["run", program, "-q", "--timings"]);
    if report_files {
        run.arg("--out").arg(folder.path().join("out"));
    }
    let output = run.output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    let before = text.split(" times real time").next().unwrap();
    before.rsplit(' ').next().unwrap().parse().unwrap_or_else(|_| panic!("{text}"))
}
