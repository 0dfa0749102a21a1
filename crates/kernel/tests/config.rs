//! What cannot be meant is found before the first tick, all at once.
use crate::common::{control, machine};
use kernel::{Config, Prediction, SyncMode};
use units::{Coordinate, Force, Inertia, Time};

fn problems(change: impl FnOnce(&mut Config)) -> Vec<String> {
    let mut config = control(&machine(1));
    change(&mut config);
    let mut found = Vec::new();
    config.problems(|problem| found.push(problem.to_string()));
    found
}

#[test]
fn the_tapping_centre_has_no_problems() {
    assert_eq!(problems(|_| {}), Vec::<String>::new());
}

#[test]
fn every_problem_names_its_field_its_value_and_what_would_do() {
    let found = problems(|config| {
        config.period = Time::ZERO;
        let z = config.axes[2].as_mut().unwrap();
        z.position_gain = f64::NAN;
        z.backlash = Coordinate::new(-1.0);
        z.weight = Force::n(f64::INFINITY);
        config.spindles[0].as_mut().unwrap().inertia = Inertia::ZERO;
    });
    insta::assert_snapshot!(found.join("\n"), @"
    machine: period is 0, expected a finite number above zero
    axis Z: position_gain is NaN, expected a finite number above zero
    axis Z: backlash is -1, expected a finite number, zero or more
    axis Z: weight is inf, expected a finite number
    spindle 0: inertia is 0, expected a finite number above zero
    ");
}

#[test]
fn a_loop_faster_than_the_sampling_allows_is_found() {
    let found = problems(|c| c.axes[0].as_mut().unwrap().velocity_bandwidth_hz = 400.0);
    assert_eq!(
        found,
        [
            "axis X: velocity_bandwidth_hz is 400, expected above zero and below a tenth of the servo rate"
        ]
    );
}

#[test]
fn a_wait_without_end_is_found() {
    let found = problems(|c| c.waits.at_speed = Time::s(f64::INFINITY));
    assert_eq!(found, ["machine: waits.at_speed is inf, expected a finite number above zero"]);
}

#[test]
fn a_reading_too_old_to_be_kept_is_found() {
    let found = problems(|c| {
        let prediction = Prediction::Observer;
        c.synchronisation = SyncMode::EncoderFollowing { prediction, transport: 9 };
    });
    assert_eq!(found, ["machine: transport is 9, expected 4 periods at most"]);
}
