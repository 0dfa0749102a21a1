//! The claim that clutch holders are made for: their depth does not scatter with the spindle.
#![allow(clippy::unwrap_used)] // a test may panic
use std::process::Command;

/// Columns of one cycle's row: holes, mean in mm, 1σ in µm.
fn row(table: &str, cycle: &str) -> (f64, f64, f64) {
    let line = table.lines().find(|l| l.trim_start().starts_with(cycle)).unwrap();
    let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    (numbers[0], numbers[1], numbers[2])
}

fn compare(speed: &str) -> String {
    let arguments = ["compare", "--size", "M6", "--samples", "60", "--speed", speed];
    let output = Command::new(env!("CARGO_BIN_EXE_leadscrew")).args(arguments).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    said
}

#[test]
fn a_clutch_holder_keeps_its_depth_where_the_conventional_cycle_scatters_with_the_spindle() {
    for (speed, n) in [("1500", 25.0_f64), ("2000", 2000.0 / 60.0)] {
        let table = compare(speed);
        let (holes, mean, sigma) = row(&table, "clutch");
        assert!(holes == 60.0 && mean.abs() < 0.02 && sigma < 5.0, "{table}");
        let (holes, mean, sigma) = row(&table, "conventional");
        // the relay's 5 ms alone scatter by n·5 ms; with speed and stopping time it is at most twice that
        assert!(holes == 60.0 && mean > n * 0.02, "{table}");
        assert!((130.0..=330.0).contains(&sigma) && sigma > n * 5.0 * 0.8, "{table}");
    }
}
