//! A spindle drive that is asked for more than its torque of continuous duty, and a magazine that
//! has no such pocket.
use crate::common;
use crate::common::{OPTIONS, change, findings_of, machine, tools, turn};
use canon::{OpKind, SpindleOrder, ToolLibrary};
use plan::{MachineLimits, Planner, Start};
use plan::{SpindleStep, Step, StepKind};
use std::f64::consts::TAU;
use units::{Time, Torque};

/// A start to 6000 rpm and a stop, each second, for five minutes.
fn starts_and_stops() -> Vec<OpKind> {
    let stop = OpKind::Spindle { spindle: 0, order: SpindleOrder::Stop };
    let wait = || OpKind::Dwell { time: Time::s(0.5) };
    (0..300).flat_map(|_| [turn(6000.0), wait(), stop.clone(), wait()]).collect()
}

fn on(limits: MachineLimits) -> Planner {
    Planner::new(limits, tools(), OPTIONS, Start::default())
}

/// The machine whose drive can give so much for ever, N·m.
fn with_continuous(torque: f64) -> MachineLimits {
    let mut limits = machine();
    limits.spindles[0].continuous_torque = Torque::n_m(torque);
    limits.spindles[0].thermal_time = Time::s(30.0);
    limits
}

/// Root of the mean square of the inertia's torque over a second of the program.
fn root_mean_square() -> f64 {
    let steps: Vec<Step> = common::steps_on(machine(), starts_and_stops());
    let inertia = machine().spindles[0].inertia.value();
    let mut heat = 0.0;
    for step in steps {
        if let StepKind::Spindle { order: SpindleStep::Turn { ramp, .. }, .. } = step.kind {
            for k in 0..1000 {
                let at = ramp.at((f64::from(k) + 0.5) * ramp.duration() / 1000.0);
                heat += (inertia * TAU * at.a).powi(2) * ramp.duration() / 1000.0;
            }
        }
    }
    (heat / 300.0).sqrt()
}

#[test]
fn a_drive_is_overloaded_from_the_root_of_the_mean_square_of_its_torque_on() {
    let exact = root_mean_square();
    assert!((3.0..30.0).contains(&exact), "{exact} N·m");
    // friction adds a little on the way up and takes it away on the way down
    let cool = findings_of(on(with_continuous(1.2 * exact)), starts_and_stops());
    assert!(!cool.contains("M0318"), "{cool}");
    let hot = findings_of(on(with_continuous(0.9 * exact)), starts_and_stops());
    assert!(hot.contains("M0318") && hot.contains("over 30 s"), "{hot}");
    // and checked without a law of time it is the same
    let checked = findings_of(on(with_continuous(0.9 * exact)).only_judging(), starts_and_stops());
    assert_eq!(hot, checked);
}

#[test]
fn a_single_start_at_full_torque_overloads_nothing() {
    let text = findings_of(on(with_continuous(5.0)), [turn(6000.0)]);
    assert!(!text.contains("M0318"), "{text}");
}

#[test]
fn a_tool_in_a_pocket_that_the_magazine_lacks_is_said_with_those_it_has() {
    let mut limits = machine();
    limits.tool_change.pockets = 4;
    let with = |pocket| {
        let mut table = ToolLibrary::default();
        for tool in tools().iter() {
            table.insert(canon::Tool { pocket, ..tool.clone() });
        }
        let planner = Planner::new(limits.clone(), table, OPTIONS, Start::default());
        findings_of(planner, [change(1)])
    };
    assert!(with(5).contains("M0317") && with(5).contains("pockets 1 to 4"), "{}", with(5));
    for pocket in [0, 1, 4] {
        assert!(!with(pocket).contains("M0317"), "{}", with(pocket));
    }
}
