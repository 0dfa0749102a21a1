//! A tap's stroke against closed forms, lower bounds and the spindle's curve.
use crate::common::{SPINDLE, axis};
use motion::{Limiting, Limiting as L};
use plan::{AxisLimits, SpindleLimits, Stroke, StrokeRequest};
use proptest::prelude::*;
use std::f64::consts::TAU;
use test_support::size;
use units::{
    Angle, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Inertia, Lead, Power, Speed, Spin,
    Time, Torque,
};

fn request(revolutions: f64, rpm: f64, lead: f64, cut: f64) -> StrokeRequest {
    StrokeRequest {
        revolutions: Angle::rev(revolutions),
        spin: Spin::rpm(rpm),
        lead: Lead::mm_per_rev(lead),
        cut: Torque::n_m(cut),
        spindle_accel: None,
        force_ramp: None,
    }
}

/// A spindle with nothing but an acceleration, in rev/s², reached at once or within a time.
fn ideal(accel: f64, rise: f64) -> SpindleLimits {
    SpindleLimits {
        inertia: Inertia::kg_m2(0.01),
        peak_torque: Torque::n_m(0.01 * TAU * accel),
        continuous_torque: units::Torque::n_m(1e9),
        thermal_time: units::Time::s(60.0),
        peak_power: Power::w(1e12),
        friction: Torque::ZERO,
        viscous_n_m_s_per_rad: 0.0,
        max_speed: Spin::rpm(1e6),
        tapping_max: Spin::rpm(1e6),
        margin: 1.0,
        torque_rise: Time::s(rise),
    }
}

fn unlimited_axis() -> AxisLimits {
    AxisLimits {
        travel: None,
        rapid_speed: CoordinateSpeed::new(1e9),
        feed_speed: CoordinateSpeed::new(1e9),
        accel: CoordinateAccel::new(1e12),
        rapid_jerk: CoordinateJerk::new(f64::INFINITY),
        feed_jerk: CoordinateJerk::new(f64::INFINITY),
    }
}

/// Rest to rest one way with constant acceleration: 2·√(N/A) if N ≤ n²/A, else N/n + n/A.
fn lower_bound(n_rev: f64, speed: f64, accel: f64) -> f64 {
    if n_rev <= speed * speed / accel {
        2.0 * (n_rev / accel).sqrt()
    } else {
        n_rev / speed + speed / accel
    }
}

/// M8×1.25 from Z2 to Z−20 at 1000 rpm, the spindle reaching that in 0.25 s: in and out at least
/// 2·(17.6/16.667 + 0.25) = 2.612 s; a control that reverses on reaching the depth needs 2.98 s and
/// overruns.
#[test]
fn m8_at_1000_rpm_in_and_out_takes_2_6_seconds() {
    let (turns, speed, accel) = (22.0 / 1.25, 1000.0 / 60.0, 1000.0 / 60.0 / 0.25);
    let bound = 2.0 * lower_bound(turns, speed, accel);
    assert!((bound - 2.612).abs() < 1e-3);
    let at_once = request(turns, 1000.0, 1.25, 0.0).plan(&ideal(accel, 0.0), &unlimited_axis());
    assert!((2.0 * at_once.profile.duration() - bound).abs() < 1e-9);
    let smooth =
        request(turns, 1000.0, 1.25, 0.0).plan(&ideal(accel, 0.01), &axis(-300.0, 0.0, 15.0));
    let time = 2.0 * smooth.profile.duration();
    assert!(time > bound && time < bound * 1.03, "{time} s");
}

/// 32 mm at 1 mm with 6000 rpm: the cap is N/n + n/α with α at the power limit all the way; the
/// run-up alone needs at least the spindle's energy over its power: ½·J·ω²/P beyond the base speed.
#[test]
fn m6_at_6000_rpm_on_the_tapping_centre_in_and_out_takes_about_a_second() {
    let stroke = request(32.0, 6000.0, 1.0, 1.73).plan(&SPINDLE, &axis(-300.0, 0.0, 15.0));
    let time = 2.0 * stroke.profile.duration();
    assert!(time < 1.25, "{time} s");
    let up: f64 = stroke
        .profile
        .pieces()
        .iter()
        .take_while(|p| p.v < 99.999 && p.a >= 0.0)
        .map(|p| p.duration)
        .sum();
    let omega = TAU * 100.0;
    let base = 15_000.0 / 42.0;
    let least =
        0.01 * base / (0.9 * 42.0) + 0.5 * 0.01 * (omega * omega - base * base) / (0.9 * 15_000.0);
    assert!(up > least && up < least * 1.15, "run-up {up} s, at least {least} s");
    assert_eq!(stroke.limiting.speed, Limiting::ProgrammedSpeed);
    assert_eq!(stroke.limiting.ramp, Limiting::SpindlePower);
}

#[test]
fn what_bounds_a_stroke_is_named() {
    let z = axis(-300.0, 0.0, 15.0);
    let limiting = |request: StrokeRequest, spindle: &SpindleLimits, axis: &AxisLimits| {
        let l = request.plan(spindle, axis).limiting;
        (l.speed, l.ramp)
    };
    let heavy = SpindleLimits { inertia: Inertia::kg_m2(0.1), ..SPINDLE };
    assert_eq!(
        limiting(request(30.0, 2000.0, 1.0, 0.0), &heavy, &z),
        (L::ProgrammedSpeed, L::SpindleTorque)
    );
    assert_eq!(limiting(request(3.0, 6000.0, 1.0, 0.0), &heavy, &z).0, L::StrokeLength);
    assert_eq!(limiting(request(99.0, 7000.0, 1.0, 0.0), &SPINDLE, &z).0, L::TappingMaximum);
    let slow = AxisLimits { feed_speed: CoordinateSpeed::linear(Speed::mm_per_min(2000.0)), ..z };
    assert_eq!(limiting(request(30.0, 2500.0, 1.0, 0.0), &SPINDLE, &slow).0, L::FeedSpeed);
    let lazy = AxisLimits { accel: CoordinateAccel::new(100.0), ..z };
    assert_eq!(limiting(request(30.0, 2500.0, 1.0, 0.0), &SPINDLE, &lazy).1, L::FeedAcceleration);
    let soft = AxisLimits { feed_jerk: CoordinateJerk::new(2000.0), ..z };
    assert_eq!(limiting(request(30.0, 2500.0, 1.0, 0.0), &SPINDLE, &soft).1, L::FeedJerk);
    let slow_torque = SpindleLimits { torque_rise: Time::s(0.2), ..SPINDLE };
    assert_eq!(limiting(request(30.0, 2500.0, 1.0, 0.0), &slow_torque, &z).1, L::SpindleJerk);
}

/// M6 in C45 (3900 N/mm²) with a spiral flute in a 5 mm hole: 1.73 N·m.
#[test]
fn the_torque_of_an_m6_tap_in_steel_is_1_73_newton_metres() {
    let torque = plan::tapping_torque(
        units::Length::mm(6.0),
        units::Length::mm(5.0),
        canon::Flute::SpiralFlute,
        3900.0,
    );
    assert!((torque.value() - 1.73).abs() < 0.005, "{torque}");
}

/// 0.22 s to 6000 rpm asks for 454 rev/s² up to the end: 18 kW of a 15 kW drive.
#[test]
fn a_forced_ramp_is_straight_and_goes_beyond_the_curve() {
    let forced =
        StrokeRequest { force_ramp: Some(Time::s(0.22)), ..request(32.0, 6000.0, 1.0, 0.0) };
    let stroke = forced.plan(&SPINDLE, &axis(-300.0, 0.0, 15.0));
    assert_eq!(stroke.limiting.ramp, Limiting::Forced);
    assert_eq!(stroke.profile.pieces().len(), 3);
    assert!((stroke.profile.pieces()[0].duration - 0.22).abs() < 1e-12);
    let alpha = stroke.profile.pieces()[0].a;
    let power = Torque::n_m(0.01 * TAU * alpha).power_at(Spin::rpm(6000.0));
    assert!(power > Power::w(17_900.0), "{power}");
}

#[test]
fn free_ramps_go_from_any_speed_to_any_speed_and_through_rest() {
    for (from, to) in
        [(0.0, 6000.0), (6000.0, 0.0), (-3000.0, 8000.0), (9000.0, -9000.0), (500.0, 400.0)]
    {
        let ramp = SPINDLE.ramp(Spin::rpm(from), Spin::rpm(to));
        let (first, end) = (ramp.at(0.0), ramp.end());
        assert!(
            (first.v * 60.0 - from).abs() < 1e-6,
            "{from} to {to} begins at {}",
            first.v * 60.0
        );
        assert!((end.v * 60.0 - to).abs() < 1e-6, "{from} to {to} ends at {}", end.v * 60.0);
        for p in ramp.pieces() {
            for i in 0..=8 {
                let now = p.at(p.duration * f64::from(i) / 8.0);
                assert_within_curve(&SPINDLE, now, 0.0);
            }
        }
        for pair in ramp.pieces().windows(2) {
            let (end, start) = (pair[0].end(), pair[1].at(0.0));
            assert!((end.v - start.v).abs() < 1e-9 && (end.s - start.s).abs() < 1e-9);
        }
    }
    assert_eq!(SPINDLE.ramp(Spin::rpm(100.0), Spin::rpm(100.0)).duration(), 0.0);
}

/// The drive's torque for a state, against margin · min(peak, P/ω): friction and cut burden the
/// run-up, friction helps to brake.
fn assert_within_curve(spindle: &SpindleLimits, now: motion::Instant, cut: f64) {
    let omega = TAU * now.v.abs();
    let inertia = TAU * spindle.inertia.value() * now.a;
    let along = inertia * now.v.signum();
    let friction = spindle.friction.value();
    let torque = if along >= 0.0 {
        along + friction + spindle.viscous_n_m_s_per_rad * omega + cut
    } else {
        along.abs() - friction
    };
    let allowed = spindle.margin
        * spindle.peak_torque.value().min(spindle.peak_power.value() / omega.max(1e-9));
    let peak = spindle.peak_torque.value();
    assert!(torque <= allowed + 1e-9 * peak, "{torque} N·m of {allowed} at {} rpm", now.v * 60.0);
}

fn assert_sound(
    stroke: &Stroke,
    request: &StrokeRequest,
    spindle: &SpindleLimits,
    axis: &AxisLimits,
) {
    let (turns, lead) = (request.revolutions.value(), request.lead.abs().value());
    let eps = 1.0 + 1e-9;
    let top = request.spin.min(spindle.tapping_max).value();
    for p in stroke.profile.pieces() {
        assert!(lead * p.j.abs() <= axis.feed_jerk.value() * (1.0 + 1e-6), "jerk {}", p.j);
        for i in 0..=8 {
            let now = p.at(p.duration * f64::from(i) / 8.0);
            assert!(now.v >= -1e-9 * top && now.v <= top * eps, "{} rev/s of {top}", now.v);
            assert!(lead * now.v <= axis.feed_speed.value() * eps);
            assert!(lead * now.a.abs() <= axis.accel.value() * eps);
            assert_within_curve(spindle, now, request.cut.value());
        }
    }
    for pair in stroke.profile.pieces().windows(2) {
        let (end, start) = (pair[0].end(), pair[1]);
        assert!((end.s - start.s).abs() <= 1e-9 * turns && (end.v - start.v).abs() <= 1e-9 * top);
        let step = (end.a - start.a).abs() / (end.a.abs().max(start.a.abs()) + 1e-6 * top);
        assert!(
            !spindle_is_smooth(spindle, axis) || step < 1e-3,
            "a jump of acceleration from {} to {}",
            end.a,
            start.a
        );
    }
    assert_eq!(stroke.profile.end(), motion::Instant { s: turns, v: 0.0, a: 0.0 });
    let last = stroke.profile.pieces().last().expect("a stroke has pieces").end();
    assert!((last.s - turns).abs() <= 1e-12 * turns, "{} of {turns}", last.s);
}

fn spindle_is_smooth(spindle: &SpindleLimits, axis: &AxisLimits) -> bool {
    spindle.torque_rise > Time::ZERO || axis.feed_jerk.is_finite()
}

fn any_spindle() -> impl Strategy<Value = SpindleLimits> {
    let friction = (0.0..1.0, 0.0..0.004);
    (
        0.001..0.1,
        10.0..100.0,
        1e3..3e4,
        friction,
        500.0..12_000.0,
        0.5..1.0,
        prop_oneof![Just(0.0), 0.001..0.03],
    )
        .prop_map(|(j, torque, power, (c0, c1), rpm, margin, rise)| SpindleLimits {
            inertia: Inertia::kg_m2(j),
            peak_torque: Torque::n_m(torque),
            continuous_torque: units::Torque::n_m(1e9),
            thermal_time: units::Time::s(60.0),
            peak_power: Power::w(power),
            friction: Torque::n_m(c0),
            viscous_n_m_s_per_rad: c1,
            max_speed: Spin::rpm(rpm),
            tapping_max: Spin::rpm(rpm * 0.8),
            margin,
            torque_rise: Time::s(rise),
        })
}

fn any_axis() -> impl Strategy<Value = AxisLimits> {
    (1e3..6e4, 0.5..20.0, prop_oneof![Just(f64::INFINITY), 1e4..1e6]).prop_map(
        |(speed, accel, jerk)| AxisLimits {
            feed_speed: CoordinateSpeed::linear(Speed::mm_per_min(speed)),
            feed_jerk: CoordinateJerk::new(jerk),
            ..axis(-300.0, 0.0, accel)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(256, 2560), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn torque_power_and_the_feed_axis_are_never_asked_for_more_than_they_have(
        spindle in any_spindle(), axis in any_axis(),
        turns in 0.01..200.0, rpm in 50.0..9000.0, lead in 0.2..4.0, cut in 0.0..4.0,
    ) {
        let request = request(turns, rpm, lead, cut);
        let stroke = request.plan(&spindle, &axis);
        assert_sound(&stroke, &request, &spindle, &axis);
        // an ideal spindle with the same torque, and the feed's limits, cannot be beaten
        let accel = (spindle.peak_torque.value() + spindle.friction.value()) / (TAU * spindle.inertia.value());
        let bound = lower_bound(turns, rpm / 60.0, accel.min(axis.accel.value() / lead));
        assert!(stroke.profile.duration() >= bound * (1.0 - 1e-9));
    }

    #[test]
    fn with_constant_acceleration_the_stroke_is_the_closed_form(
        turns in 0.01..100.0, rpm in 50.0..9000.0, accel in 20.0..2000.0,
    ) {
        let expected = lower_bound(turns, rpm / 60.0, accel);
        let stroke = request(turns, rpm, 1.0, 0.0).plan(&ideal(accel, 0.0), &unlimited_axis());
        assert!((stroke.profile.duration() / expected - 1.0).abs() < 1e-9, "{expected}");
    }

    #[test]
    fn against_a_fine_integration_of_the_curve_the_run_up_loses_little(
        spindle in any_spindle(), share in 0.1..0.8,
    ) {
        let spindle = SpindleLimits { torque_rise: Time::ZERO, ..spindle };
        let top = spindle.reachable(Torque::ZERO).value() * share;
        let ours = spindle.ramp(Spin::ZERO, Spin::rev_per_s(top)).duration();
        let exact = run_up_time(&spindle, top);
        assert!(ours >= exact * (1.0 - 1e-6), "{ours} s is faster than the curve's {exact} s");
        assert!(ours <= exact * 1.05, "{ours} s; the curve allows {exact} s");
    }
}

/// ∫ dn/α(n) along the curve, by the midpoint rule.
fn run_up_time(spindle: &SpindleLimits, top: f64) -> f64 {
    let steps = 20_000;
    let dn = top / f64::from(steps);
    (0..steps)
        .map(|i| {
            let omega = TAU * dn * (f64::from(i) + 0.5);
            let torque = spindle.margin
                * spindle.peak_torque.value().min(spindle.peak_power.value() / omega);
            let net = torque - spindle.friction.value() - spindle.viscous_n_m_s_per_rad * omega;
            dn * TAU * spindle.inertia.value() / net
        })
        .sum()
}
