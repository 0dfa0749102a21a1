//! The operator's spindle override: within its limits, locked where the program or a synchronised
//! cut needs the programmed speed, and no alarm of a cut that is made at the speed the operator has
//! chosen.
use crate::common::{await_speed, control, line, machine, run_ordered, turn};
use canon::Position;
use kernel::{EventKind, Kernel, Notice, Order, Overrides};
use plan::StepKind;
use sim::SimulatedMachine;
use units::Spin;

/// Real speeds of the spindle, rpm, at these times, s: M3 S1000, then a cut of ten seconds; with
/// orders at ticks.
fn speeds(
    limits: Overrides,
    orders: &[(usize, Order)],
    first: &[StepKind],
    at: &[f64],
) -> (Vec<f64>, Vec<Notice>) {
    let machine = machine(1);
    let mut told = control(&machine);
    told.overrides = limits;
    let to = Position::xyz(20.0, 0.0, 0.0);
    let mut steps = vec![turn(0.0, 1000.0), await_speed()];
    steps.extend_from_slice(first);
    steps.push(line(Position::default(), to, 5.0, true));
    let mut machine = SimulatedMachine::new(machine).unwrap();
    let seen = run_ordered(Kernel::new(told), &mut machine, &steps, 16_000, orders);
    assert_eq!(seen.kernel.faults(), []);
    let found = at.iter().map(|at| {
        let sample = seen.samples.iter().find(|s| s.feedback.time.value() >= *at).unwrap();
        sample.truth.unwrap().spins[0].in_rpm()
    });
    let notices = seen.events.iter().filter_map(|event| match event.kind {
        EventKind::Operator(notice) => Some(notice),
        _ => None,
    });
    (found.collect(), notices.collect())
}

#[track_caller]
fn near(found: &[f64], expected: &[f64]) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 0.01 * expected, "{found} rpm, expected {expected}");
    }
}

#[test]
fn the_spindle_turns_at_the_operators_share_within_the_machines_limits() {
    let orders = [
        (4000, Order::SpindleOverride(0.8)),
        (6000, Order::SpindleOverride(1.1)),
        (8000, Order::SpindleOverride(0.1)),
        (10_000, Order::SpindleOverride(1.0)),
    ];
    let at = [0.9, 1.45, 1.95, 2.45, 2.95];
    let (found, notices) = speeds(Overrides::USUAL, &orders, &[], &at);
    near(&found, &[1000.0, 800.0, 1100.0, 500.0, 1000.0]);
    assert_eq!(notices, [Notice::OverrideOutOfRange { least: 50, most: 120 }]);
    let narrow = Overrides { spindle: (0.9, 1.0), ..Overrides::USUAL };
    let (found, notices) = speeds(narrow, &orders, &[], &at);
    near(&found, &[1000.0, 900.0, 1000.0, 900.0, 1000.0]);
    assert_eq!(notices.len(), 3);
}

#[test]
fn a_program_that_locks_the_override_is_cut_at_its_speed_and_the_operator_is_told() {
    let orders = [(0, Order::SpindleOverride(0.5)), (5000, Order::SpindleOverride(0.7))];
    let lock = [StepKind::SpindleOverride(false)];
    let (found, notices) = speeds(Overrides::USUAL, &orders, &lock, &[1.2, 1.6, 2.0]);
    near(&found, &[1000.0, 1000.0, 1000.0]);
    assert_eq!(notices, [Notice::OverrideLocked]);
}

#[test]
fn what_needs_the_programmed_speed_waits_until_the_spindle_has_it() {
    let machine = machine(1);
    let steps = [
        turn(0.0, 1000.0),
        await_speed(),
        StepKind::SpindleOverride(false),
        line(Position::default(), Position::xyz(2.0, 0.0, 0.0), 5.0, true),
    ];
    let told = control(&machine);
    let mut machine = SimulatedMachine::new(machine).unwrap();
    let half = [(0, Order::SpindleOverride(0.5))];
    let seen = run_ordered(Kernel::new(told), &mut machine, &steps, 16_000, &half);
    assert_eq!(seen.kernel.faults(), []);
    let first = seen.samples.iter().find(|s| s.report.op == 3).unwrap();
    let turns = first.truth.unwrap().spins[0];
    assert!((turns - Spin::rpm(1000.0)).abs() < Spin::rpm(25.0), "{turns}");
}
