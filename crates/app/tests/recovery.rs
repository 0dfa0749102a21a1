//! Controls that are killed in a tap, irons whose power fails, and the way out: over processes, as a user has it.
#![allow(clippy::unwrap_used)] // a test may panic
#[allow(dead_code)] // each test binary uses its own part
mod common;
#[path = "common/iron.rs"]
mod iron;
use common::{complained, said};
use iron::{Iron, number, one_tap};
use serde_json::Value;

/// Machine time at which the tap of [`one_tap`] begins to go in, and at which it is out, s.
fn stroke(hand: &str, tool: u32) -> (f64, f64) {
    let iron = Iron::start(&[]);
    let output = iron.run(&one_tap(hand, tool), &["--log"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), complained(&output));
    let log = said(&output) + &complained(&output);
    let time = |word: &str| -> f64 {
        let line =
            log.lines().find(|l| l.contains(word)).unwrap_or_else(|| panic!("{word}: {log}"));
        line.split_whitespace().find_map(|w| w.parse().ok()).unwrap()
    };
    (time("tap-in"), time("tap-out") + 1.0)
}

/// Kill the control at this machine time, recover, and hold it to what is promised; the answer.
fn killed(hand: &str, tool: u32, at: f64, options: &[&str]) -> Value {
    let at = format!("{at:.6}");
    let mut all = vec!["--kill-control-at", &at];
    all.extend(options);
    recovered(&Iron::start(&all), hand, tool, &at)
}

/// What is promised of whatever stopped the control.
fn recovered(iron: &Iron, hand: &str, tool: u32, at: &str) -> Value {
    let output = iron.run(&one_tap(hand, tool), &[]);
    assert_ne!(output.status.code(), Some(0), "nothing stopped it at {at}");
    let stopped = iron.status();
    let answer = iron.recover(&[]);
    let after = iron.status();
    assert_eq!(after["tool_broken"], false, "{at} s: {stopped:#} {answer:#} {after:#}");
    assert_eq!(after["tap_in_thread"], false, "{at} s: {stopped:#} {answer:#} {after:#}");
    match answer["outcome"].as_str().unwrap() {
        "recovered" => {
            let by_encoders = number(&answer, "helix_error_max_um");
            let by_truth = number(&after, "off_helix_while_coupled_max_um");
            assert!(by_encoders <= 20.0 && by_truth <= 20.0, "{at} s: {answer:#} {after:#}");
        }
        "nothing-to-do" => assert_eq!(stopped["tap_in_thread"], false, "{at} s: {answer:#}"),
        other => panic!("{other} at {at} s: {stopped:#} {answer:#}"),
    }
    answer
}

/// So many instants within the tap, from a seed: one in each of as many equal parts.
fn instants(count: u32, (from, to): (f64, f64), mut seed: u64) -> Vec<f64> {
    let part = (to - from) / f64::from(count);
    let mut draw = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed % 1000) as f64 / 1000.0
    };
    (0..count).map(|at| from + part * (f64::from(at) + draw())).collect()
}

#[test]
fn a_control_that_is_killed_in_a_right_hand_tap_is_recovered_at_any_instant() {
    let span = stroke("G84", 11);
    let mut recovered = 0;
    for at in instants(5, span, 0x5eed) {
        let answer = killed("G84", 11, at, &[]);
        recovered += u32::from(answer["outcome"] == "recovered");
    }
    assert!(recovered >= 3, "only {recovered} were in the work");
}

#[test]
fn a_control_that_is_killed_in_a_left_hand_tap_is_recovered_at_any_instant() {
    let span = stroke("G74", 41);
    for at in instants(3, span, 0xbeef) {
        let answer = killed("G74", 41, at, &[]);
        assert!(answer["hand"] == "left", "{answer:#}");
    }
}
