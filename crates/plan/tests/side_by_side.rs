//! Shape and time planned side by side are what they are one after another.
use crate::common::{OPTIONS, line, machine, mm, program, rapid, tools, turn};
use canon::{OpKind, PathMode};
use plan::{Planner, Start, Step};
use proptest::prelude::*;
use test_support::size;
use units::{CoordinateJerk, Time};

fn planner(jerk: f64) -> Planner {
    let mut limits = machine();
    for axis in limits.axes.iter_mut().flatten() {
        (axis.feed_jerk, axis.rapid_jerk) = (CoordinateJerk::new(jerk), CoordinateJerk::new(jerk));
    }
    Planner::new(limits, tools(), OPTIONS, Start::default())
}

/// All steps, and planned seconds.
fn planned(mut planner: Planner, kinds: &[OpKind]) -> (Vec<Step>, f64) {
    let mut steps = Vec::new();
    for (index, op) in (0..).zip(&program(kinds.iter().cloned())) {
        planner.push(index, op, &mut |step| steps.push(step));
    }
    planner.finish(&mut |step| steps.push(step));
    let found = planner.take_findings();
    assert!(found.iter().all(|found| !found.is_error()), "{found:?}");
    (steps, planner.duration().value())
}

fn in_a_thread(first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
    std::thread::scope(|scope| {
        scope.spawn(first);
        second();
    });
}

fn second_first(first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
    second();
    first();
}

/// A row of short lines that turns a little with each, with a rapid and a dwell now and then.
fn row(turns: &[(f64, f64)]) -> Vec<OpKind> {
    let blend = PathMode::Blend { tolerance: Some(mm(0.01)), merge: None };
    let mut kinds = vec![turn(3000.0), rapid(0.0, 0.0, -10.0), OpKind::PathMode(blend)];
    let (mut at, mut heading) = ([0.0, 0.0], 0.0_f64);
    for (number, (turned, length)) in (1..).zip(turns) {
        heading += turned;
        at = [at[0] + length * heading.cos(), at[1] + length * heading.sin()];
        kinds.push(match number % 700 {
            0 => rapid(at[0], at[1], -10.0),
            1..650 => line(at[0], at[1], -11.0, 1200.0),
            _ => line(at[0], at[1], -11.0 - 0.01 * f64::from(number % 7), 600.0),
        });
        if number % 2900 == 0 {
            kinds.push(OpKind::Dwell { time: Time::s(0.1) });
        }
    }
    kinds.push(OpKind::End);
    kinds
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: size::of(2, 60), ..ProptestConfig::default() })]

    #[test]
    fn side_by_side_the_steps_are_the_same_to_the_last_bit(
        turns in prop::collection::vec((-0.6..0.6_f64, 0.05..0.4_f64), 1000..size::of(2000, 3000)),
        jerk in prop_oneof![Just(f64::INFINITY), Just(2e4)],
    ) {
        let kinds = row(&turns);
        let expected = planned(planner(jerk), &kinds);
        for both in [in_a_thread, second_first] {
            let (steps, seconds) = planned(planner(jerk).side_by_side(both), &kinds);
            let differs = steps.iter().zip(&expected.0).position(|(a, b)| a != b);
            let counts = (steps.len(), expected.0.len());
            prop_assert!(differs.is_none() && counts.0 == counts.1, "step {differs:?} of {counts:?}");
            prop_assert_eq!(seconds, expected.1);
        }
    }
}
