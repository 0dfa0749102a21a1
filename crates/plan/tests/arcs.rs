//! Lines, circles and helices in all planes: sampled along the time, no axis exceeds its limits.
use crate::common;
use crate::common::{axis, machine, mm, program};
use canon::{Arc, Axis, Feed, OpKind, Plane, Position};
use motion::{Follow, Instant, Move, Shape};
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

/// What an arc becomes: stretches of one path, from rest to rest.
fn followed(
    limits: &MachineLimits,
    from: Position,
    to: Position,
    arc: Arc,
    rate: f64,
) -> Vec<Follow> {
    let start = Start { position: from, tool: 0 };
    let mut planner = Planner::new(limits.clone(), common::tools(), common::OPTIONS, start);
    let mut all = Vec::new();
    let mut emit = |step: plan::Step| match step.kind {
        StepKind::Follow(follow) => all.push(*follow),
        StepKind::Move(m) => panic!("{m:?}"),
        _ => {}
    };
    planner.push(0, &program([OpKind::Arc { to, arc, feed: feed(rate) }])[0], &mut emit);
    planner.finish(&mut emit);
    assert!(!all.is_empty(), "{:?}", planner.take_findings());
    all
}

/// The highest speed along the path; each axis is held to its limits at five places of each phase,
/// acceleration to 1.5 % and jerk to 3 %, as they change within a phase.
fn peak_within_limits(all: &[Follow], limits: &MachineLimits) -> f64 {
    let mut peak = 0.0_f64;
    for follow in all {
        for phase in &follow.phases[..usize::from(follow.count)] {
            for n in 0..=4 {
                let Instant { s, v, a } = phase.at(phase.duration * f64::from(n) / 4.0);
                let d = follow.piece.at(s);
                peak = peak.max(v);
                for (k, of) in limits.axes.iter().enumerate() {
                    let Some(of) = of else { continue };
                    let letter = Axis::ALL[k].letter();
                    let (speed, accel) = (d.q1[k] * v, d.q1[k] * a + d.q2[k] * v * v);
                    let jerk = d.q1[k] * phase.j + 3.0 * d.q2[k] * v * a + d.q3[k] * v * v * v;
                    assert!(speed.abs() <= of.feed_speed.value() * 1.001, "{letter}: {speed} mm/s");
                    assert!(accel.abs() <= of.accel.value() * 1.015, "{letter}: {accel} mm/s²");
                    assert!(jerk.abs() <= of.feed_jerk.value() * 1.03, "{letter}: {jerk} mm/s³");
                }
            }
        }
    }
    peak
}

/// A circle of 10 mm at 6000 mm/min: v²/r = 1 m/s², v³/r² = 10 m/s³: nothing holds it back.
#[test]
fn a_slow_circle_keeps_its_feed() {
    let limits = limits([10e3, 10e3, 15e3], 50_000.0, 5e5);
    let arc = Arc { plane: Plane::XY, centre: [mm(10.0), mm(0.0)], sweep: Angle::rev(1.0) };
    let at = Position::default();
    let peak = peak_within_limits(&followed(&limits, at, at, arc, 6000.0), &limits);
    assert!((peak - 100.0).abs() < 0.02, "{peak} mm/s");
}

/// A circle of 1 mm: with 10 m/s² of each axis √(10000·1) = 100 mm/s is always possible, and
/// where both axes share the bend ⁴√2 times as much; by the jerk of 500 m/s³ ∛(5e5) = 79 mm/s, and
/// ⁶√2 times as much.
#[test]
fn a_narrow_circle_is_slowed_down_by_its_curvature() {
    let arc = Arc { plane: Plane::XY, centre: [mm(1.0), mm(0.0)], sweep: Angle::rev(-2.0) };
    let both = [(f64::INFINITY, 1e4_f64.sqrt(), 0.25), (5e5, 5e5_f64.cbrt(), 1.0 / 6.0)];
    for (jerk, least, power) in both {
        let limits = limits([10e3, 10e3, 15e3], 50_000.0, jerk);
        let at = Position::default();
        let peak = peak_within_limits(&followed(&limits, at, at, arc, 50_000.0), &limits);
        let most = least * 2.0_f64.powf(power);
        assert!(peak >= least && peak <= 1.01 * most, "{peak} mm/s of {least} to {most}");
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
        let peak = peak_within_limits(&followed(&limits, from, to, arc, rate), &limits);
        prop_assert!(peak <= rate / 60.0 * (1.0 + 1e-6), "{peak} mm/s at F{rate}");
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
