//! A blended path takes no longer than the same moves with a stop at the end of each.
use crate::common::{OPTIONS, line, machine, mm, program, rapid, tools, turn};
use canon::{OpKind, PathMode};
use plan::{Planner, Start, preflight};
use proptest::prelude::*;
use test_support::size;
use units::{CoordinateAccel, CoordinateJerk, CoordinateSpeed, Speed};

/// Axes of 200 mm/s and 1000 mm/s², with so much jerk.
fn planner(jerk: f64) -> Planner {
    let mut limits = machine();
    for axis in limits.axes.iter_mut().flatten() {
        axis.accel = CoordinateAccel::new(1000.0);
        let speed = CoordinateSpeed::linear(Speed::mm_per_min(12_000.0));
        (axis.feed_speed, axis.rapid_speed) = (speed, speed);
        (axis.feed_jerk, axis.rapid_jerk) = (CoordinateJerk::new(jerk), CoordinateJerk::new(jerk));
    }
    Planner::new(limits, tools(), OPTIONS, Start::default())
}

/// Seconds of these moves, from (0, 0, −10).
fn seconds(jerk: f64, mode: PathMode, moves: &[OpKind]) -> f64 {
    let begin = [turn(3000.0), rapid(0.0, 0.0, -10.0), OpKind::PathMode(mode)];
    let kinds = begin.into_iter().chain(moves.iter().cloned());
    let flight = preflight(planner(jerk), &program(kinds));
    assert!(!flight.is_refused(), "{:?}", flight.findings);
    flight.duration.value()
}

/// `room`: how much longer it may take, as a share.
fn assert_no_slower(moves: &[OpKind], p: f64, jerk: f64, room: f64) {
    let blend = PathMode::Blend { tolerance: Some(mm(p)), merge: None };
    let (blended, stopping) =
        (seconds(jerk, blend, moves), seconds(jerk, PathMode::ExactStop, moves));
    assert!(
        blended <= stopping * (1.0 + room),
        "P {p}, {jerk}: {blended} s, {stopping} s with stops"
    );
}

/// Drops into the work at a slow feed, as where a CAM post writes no cycles.
#[test]
fn drops_at_a_slow_feed_between_rapids() {
    let mut moves = Vec::new();
    for hole in 0..6 {
        let (x, y) = (7.0 * f64::from(hole), 12.0 * f64::from(hole % 3));
        moves.extend([rapid(x, y, -10.0), line(x, y, -14.0, 400.0), rapid(x, y, -10.0)]);
    }
    for p in [0.001, 0.01, 0.1, 0.5] {
        for jerk in [2e4, f64::INFINITY] {
            assert_no_slower(&moves, p, jerk, 0.0);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: size::of(64, 1280), ..ProptestConfig::default() })]

    /// Of 15,000 such rows 40 took longer than with stops, by 1.3 % at most: docs/planner.md.
    #[test]
    fn moves_of_all_lengths_angles_and_feeds(
        steps in prop::collection::vec((-0.3..1.6_f64, -1.0..1.0_f64, -1.0..1.0_f64, 0_u8..4, 2.0..3.9_f64), 2..24),
        p in -3.0..-1.3_f64,
        has_jerk in any::<bool>(),
    ) {
        let mut at = [0.0, 0.0, -10.0_f64];
        let mut moves = Vec::new();
        for (length, turned, up, what, feed) in steps {
            let (length, turned) = (10.0_f64.powf(length), core::f64::consts::PI * turned);
            let z = if what == 1 { up } else { 0.0 };
            let flat = (1.0 - z * z).sqrt();
            let by = [flat * turned.cos(), flat * turned.sin(), z];
            let limit = [(-90.0, 90.0), (-90.0, 90.0), (-60.0, -1.0)];
            for ((at, by), (low, high)) in at.iter_mut().zip(by).zip(limit) {
                *at = (*at + length * by).clamp(low, high);
            }
            let [x, y, z] = at;
            moves.push(if what == 3 { rapid(x, y, z) } else { line(x, y, z, 10.0_f64.powf(feed)) });
        }
        assert_no_slower(&moves, 10.0_f64.powf(p), if has_jerk { 2e4 } else { f64::INFINITY }, 0.02);
    }
}
