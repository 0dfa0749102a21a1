//! Lines, circles and helices in all planes: sampled along the time, no axis exceeds its limits.
use crate::common;
use crate::common::{axis, machine, mm, program};
use canon::{Arc, Axis, Feed, OpKind, Plane, Position};
use motion::Move;
use plan::StepKind;
use plan::{AxisLimits, MachineLimits, Planner, Start};
use proptest::prelude::*;
use test_support::size;
use units::{Angle, Coordinate, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Speed};

/// The one move that an op becomes.
fn planned(limits: &MachineLimits, from: Position, kind: OpKind) -> Move {
    let start = Start { position: from, tool: 0 };
    let mut planner = Planner::new(limits.clone(), common::tools(), common::OPTIONS, start);
    let mut moves = Vec::new();
    let mut emit = |step: plan::Step| {
        if let StepKind::Move(m) = step.kind {
            moves.push(m);
        }
    };
    planner.push(0, &program([kind])[0], &mut emit);
    planner.finish(&mut emit);
    assert_eq!(moves.len(), 1, "{:?}", planner.take_findings());
    *moves[0]
}

/// Sample a move and compare speed, acceleration and (by differences) jerk of each axis with its
/// limits.
fn assert_within_limits(m: &Move, limits: &MachineLimits) {
    let n = 400;
    let dt = m.profile.duration() / f64::from(n);
    let mut before: Option<motion::Motion> = None;
    for i in 0..=n {
        let now = m.path.motion(m.profile.at(dt * f64::from(i)));
        for (k, of) in limits.axes.iter().enumerate() {
            let Some(of) = of else { continue };
            let letter = Axis::ALL[k].letter();
            let (v, a) = (now.speed[k].value().abs(), now.accel[k].value().abs());
            let speed = if m.rapid { of.rapid_speed } else { of.feed_speed };
            assert!(v <= speed.value() * (1.0 + 1e-6), "{letter}: {v} mm/s of {speed:?}");
            assert!(a <= of.accel.value() * (1.0 + 1e-6), "{letter}: {a} mm/s² of {:?}", of.accel);
            if let Some(before) = &before {
                let j = (now.accel[k] - before.accel[k]).abs().value() / dt;
                let jerk = if m.rapid { of.rapid_jerk } else { of.feed_jerk };
                assert!(j <= jerk.value() * (1.0 + 1e-6), "{letter}: {j} mm/s³ of {jerk:?}");
                // a step of the position is the mean speed, so the parts of the motion belong
                // together
                let moved = (now.position[k] - before.position[k]).value() / dt;
                let mean = (now.speed[k] + before.speed[k]).value() / 2.0;
                let bend = of.accel.value() * dt;
                assert!(
                    (moved - mean).abs() <= bend + 1e-6,
                    "{letter}: moved at {moved}, says {mean} mm/s"
                );
            }
        }
        before = Some(now);
    }
}

fn limits(accels: [f64; 3], feed: f64, jerk: f64) -> MachineLimits {
    let mut limits = machine();
    for (k, accel) in accels.into_iter().enumerate() {
        let of = AxisLimits {
            travel: None,
            feed_speed: CoordinateSpeed::linear(Speed::mm_per_min(feed * (1.0 + 0.3 * k as f64))),
            feed_jerk: CoordinateJerk::new(jerk),
            accel: CoordinateAccel::new(accel),
            ..axis(0.0, 0.0, 1.0)
        };
        limits.axes[k] = Some(of);
    }
    limits
}

fn feed(mm_per_min: f64) -> Feed {
    Feed::PerTime(Speed::mm_per_min(mm_per_min))
}

/// A circle of 10 mm at 6000 mm/min: v²/r = 1 m/s², v³/r² = 10 m/s³: nothing holds it back.
#[test]
fn a_slow_circle_keeps_its_feed() {
    let limits = limits([10e3, 10e3, 15e3], 50_000.0, 5e5);
    let arc = Arc { plane: Plane::XY, centre: [mm(10.0), mm(0.0)], sweep: Angle::rev(1.0) };
    let m = planned(
        &limits,
        Position::default(),
        OpKind::Arc { to: Position::default(), arc, feed: feed(6000.0) },
    );
    assert!((m.profile.peak() - 100.0).abs() < 1e-9);
    assert_within_limits(&m, &limits);
}

/// A circle of 1 mm: with 10 m/s² the speed is at most √(0.8·10000·1) = 89 mm/s, by the jerk of 500
/// m/s³ at most ∛(0.4·5e5) = 58 mm/s.
#[test]
fn a_narrow_circle_is_slowed_down_by_its_curvature() {
    let arc = Arc { plane: Plane::XY, centre: [mm(1.0), mm(0.0)], sweep: Angle::rev(-2.0) };
    for (jerk, speed) in [(f64::INFINITY, 8000.0_f64.sqrt()), (5e5, 2e5_f64.cbrt())] {
        let limits = limits([10e3, 10e3, 15e3], 50_000.0, jerk);
        let to = Position::default();
        let m = planned(&limits, to, OpKind::Arc { to, arc, feed: feed(50_000.0) });
        assert!((m.profile.peak() - speed).abs() < 1e-6, "{} mm/s", m.profile.peak());
        assert_within_limits(&m, &limits);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(256, 2560), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_axis_exceeds_its_limits_on_any_arc_or_helix(
        plane in prop_oneof![Just(Plane::XY), Just(Plane::ZX), Just(Plane::YZ)],
        radius in 0.05..300.0, start in 0.0..1.0, sweep in prop_oneof![-5.0..-0.01, 0.01..5.0], rise in -50.0..50.0,
        rate in 50.0..60_000.0, accel in (500.0..2e4, 500.0..2e4, 500.0..2e4),
        jerk in prop_oneof![Just(f64::INFINITY), 1e4..1e6],
    ) {
        let limits = limits([accel.0, accel.1, accel.2], 30_000.0, jerk);
        let [first, second, normal] = plane.axes();
        let on_circle = |turn: f64| {
            let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
            Position::default().with(first, Coordinate::linear(mm(radius * cos))).with(second, Coordinate::linear(mm(radius * sin)))
        };
        let (from, to) = (on_circle(start), on_circle(start + sweep).with(normal, Coordinate::linear(mm(rise))));
        let arc = Arc { plane, centre: [mm(0.0); 2], sweep: Angle::rev(sweep) };
        let m = planned(&limits, from, OpKind::Arc { to, arc, feed: feed(rate) });
        assert!(m.profile.peak() <= rate / 60.0 * (1.0 + 1e-9));
        assert_within_limits(&m, &limits);
    }

    #[test]
    fn no_axis_exceeds_its_limits_on_any_line_and_one_of_them_is_used_up(
        to in (-300.0..300.0, -300.0..300.0, -300.0..300.0), accel in (500.0..2e4, 500.0..2e4, 500.0..2e4),
        jerk in prop_oneof![Just(f64::INFINITY), 1e4..1e6],
    ) {
        let limits = limits([accel.0, accel.1, accel.2], 30_000.0, jerk);
        let to = Position::xyz(to.0, to.1, to.2);
        for kind in [OpKind::Rapid { to }, OpKind::Line { to, feed: feed(1e5) }] {
            let m = planned(&limits, Position::default(), kind);
            assert_within_limits(&m, &limits);
            let start = m.path.motion(m.profile.pieces()[0].at(0.0));
            let level = m.path.motion(m.profile.pieces()[0].end());
            let used = |k: usize| {
                let of = limits.axes[k].unwrap();
                let j = if m.rapid { of.rapid_jerk } else { of.feed_jerk };
                let rise = (level.accel[k] - start.accel[k]).abs().value() / m.profile.pieces()[0].duration;
                (level.accel[k].abs() / of.accel).max(rise / j.value())
            };
            let most = (0..3).map(used).fold(0.0, f64::max);
            assert!(most > 1.0 - 1e-6, "only {most} of any axis is used");
        }
    }
}
