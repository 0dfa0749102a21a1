//! Taps in pecks, at a preset, and as short as they can be.
use crate::common;
use crate::common::{change, hole, steps_of, tap, turn};
use canon::OpKind;
use motion::{Profile, TapPlan};
use plan::StepKind;
use plan::{AxisLimits, MachineLimits, Planner, Retract, SpindleLimits, Start, StrokeRequest};
use units::{
    Angle, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Inertia, Lead, Length, Power, Spin,
    Time, Torque,
};

fn tap_plans(limits: MachineLimits, tap: canon::Tap) -> Vec<TapPlan> {
    let start = Start { position: tap.start, tool: 2 };
    let planner = Planner::new(limits, common::tools(), common::OPTIONS, start);
    steps_of(planner, [turn(600.0), OpKind::Tap(tap)])
        .into_iter()
        .filter_map(|step| if let StepKind::Tap(plan) = step.kind { Some(*plan) } else { None })
        .collect()
}

/// Turns of the helix between two coordinates of the axis, and whether a profile has them.
fn turns(profile: &Profile, from: Length, to: Length, lead: f64) -> bool {
    (profile.end().s - (from - to).value().abs() / lead).abs() < 1e-9
}

#[test]
fn pecks_that_come_out_in_full_all_begin_at_the_start_and_at_its_angle() {
    let mut t = tap(10.0, 0.0, 2.0, -10.0, 1.0, 600.0);
    (t.peck, t.start_angle) = (Some(Length::mm(5.0)), Some(Angle::deg(90.0)));
    let plans = tap_plans(common::machine(), t);
    let start = t.start.linear[2];
    let depths: Vec<_> = plans.iter().map(|p| (start - p.bottom).value()).collect();
    assert_eq!(depths, [5.0, 10.0, 12.0]);
    for plan in &plans {
        assert_eq!((plan.start, plan.end, plan.start_angle), (t.start, start, t.start_angle));
        assert!(turns(&plan.inward, start, plan.bottom, 1.0));
        assert!(turns(&plan.outward, start, plan.bottom, 1.0));
    }
}

#[test]
fn pecks_that_break_the_chip_go_on_where_the_helix_was_left() {
    for hand in [1.0, -1.0] {
        let mut t = tap(10.0, 0.0, 2.0, -10.0, hand, 600.0);
        (t.peck, t.start_angle) = (Some(Length::mm(5.0)), Some(Angle::deg(90.0)));
        t.dwell = Time::s(0.2);
        let mut limits = common::machine();
        limits.tapping.retract = Retract::By(Length::mm(0.75));
        let start = Start { position: t.start, tool: if hand < 0.0 { 3 } else { 2 } };
        let planner = Planner::new(limits, common::tools(), common::OPTIONS, start);
        let plans: Vec<_> = steps_of(planner, [turn(600.0 * hand), OpKind::Tap(t)])
            .into_iter()
            .filter_map(|s| if let StepKind::Tap(plan) = s.kind { Some(plan) } else { None })
            .collect();
        let top = t.start.linear[2];
        let ways: Vec<_> = plans
            .iter()
            .map(|p| [p.start.linear[2], p.bottom, p.end].map(|z| (top - z).value()))
            .collect();
        assert_eq!(ways, [[0.0, 5.0, 4.25], [4.25, 10.0, 9.25], [9.25, 12.0, 0.0]]);
        for plan in &plans {
            // on the helix: a quarter turn at the start, a turn a millimetre, in the hand's sense
            let deep = (top - plan.start.linear[2]).value();
            let angle = plan.start_angle.unwrap().value();
            assert!((angle - (0.25 + hand * deep)).abs() < 1e-9, "{angle}");
            assert!(turns(&plan.inward, plan.start.linear[2], plan.bottom, 1.0));
            assert!(turns(&plan.outward, plan.bottom, plan.end, 1.0));
        }
        let dwells: Vec<_> = plans.iter().map(|p| p.dwell.value()).collect();
        assert_eq!(dwells, [0.0, 0.0, 0.2]);
    }
}

#[test]
fn a_tap_may_follow_a_spindle_without_a_drive_as_deep_as_its_hole_is_and_its_flutes_reach() {
    let room = |drilled: Option<f64>, depth: f64, peck: Option<f64>| {
        let mut t = tap(10.0, 0.0, 2.0, -depth, 1.0, 600.0);
        t.peck = peck.map(Length::mm);
        let drill = drilled.map(|z| [change(1), turn(800.0), hole(10.0, 0.0, -z)]);
        let to = common::rapid(10.0, 0.0, t.start.linear[2].value());
        let taps = [change(2), turn(600.0), to, OpKind::Tap(t)];
        let deepest = common::steps(drill.into_iter().flatten().chain(taps))
            .into_iter()
            .filter_map(|step| match step.kind {
                StepKind::Tap(plan) => Some((t.bottom - plan.deepest).value()),
                _ => None,
            });
        deepest.collect::<Vec<_>>()
    };
    let near = |found: Vec<f64>, expected: &[f64]| {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?}");
    };
    // the point of a drill of 5 mm and 118° is 2.5/tan 59° = 1.502 mm high
    near(room(Some(30.0), 12.0, None), &[30.0 - 1.502 - 12.0]);
    near(room(Some(45.0), 12.0, None), &[32.0 - 12.0]);
    // not drilled here: three pitches, as a tap's chamfer takes; and never beyond its flutes
    near(room(None, 12.0, None), &[3.0]);
    near(room(None, 30.5, None), &[1.5]);
    // a peck has the room of the whole hole
    near(room(Some(30.0), 12.0, Some(7.0)), &[16.498, 16.498]);
}

#[test]
fn a_tap_with_less_dynamics_takes_longer_and_a_hard_return_is_shorter_than_its_way_in() {
    let t = tap(10.0, 0.0, 2.0, -18.0, 1.0, 3000.0);
    let planned = |inward: f64, outward: f64| {
        let mut limits = common::machine();
        limits.tapping.inward.margin = inward;
        limits.tapping.outward.margin = outward;
        let plan = tap_plans(limits, t)[0];
        [plan.inward.duration(), plan.outward.duration()]
    };
    let [gentle, standard, mixed] =
        [(0.5, 0.5), (0.9, 0.9), (0.5, 0.9)].map(|(i, o)| planned(i, o));
    assert!(gentle[0] > standard[0] && gentle[1] > standard[1]);
    assert_eq!(mixed, [gentle[0], standard[1]]);
}

#[test]
fn a_short_stroke_is_within_3_percent_of_the_time_that_no_tap_can_beat() {
    // 20 mm deep at 1.25 mm: N = 16 rev; 500 rev/s² up and down. In and out, rest to rest:
    // 4·√(N/A).
    let bound = 4.0 * (16.0_f64 / 500.0).sqrt();
    assert!((bound - 0.7155).abs() < 1e-4);
    let spindle = SpindleLimits {
        inertia: Inertia::kg_m2(0.01),
        // 500 rev/s² = 1000·π rad/s²
        peak_torque: Torque::n_m(0.01 * 1000.0 * core::f64::consts::PI),
        continuous_torque: units::Torque::n_m(1e9),
        thermal_time: units::Time::s(60.0),
        peak_power: Power::w(1e9),
        friction: Torque::ZERO,
        viscous_n_m_s_per_rad: 0.0,
        margin: 1.0,
        torque_rise: Time::ZERO,
        tapping_max: Spin::rpm(1e5),
        max_speed: Spin::rpm(1e5),
    };
    let axis = AxisLimits {
        feed_speed: CoordinateSpeed::new(1e5),
        accel: CoordinateAccel::new(1e6),
        feed_jerk: CoordinateJerk::new(f64::INFINITY),
        ..common::machine().axes[2].unwrap()
    };
    let request = StrokeRequest {
        revolutions: Angle::rev(16.0),
        spin: Spin::rpm(1e5),
        lead: Lead::mm_per_rev(1.25),
        cut: Torque::ZERO,
        spindle_accel: None,
        force_ramp: None,
    };
    let both = 2.0 * request.plan(&spindle, &axis).profile.duration();
    assert!(both >= bound * (1.0 - 1e-9) && both <= bound * 1.03, "{both} s, bound {bound} s");
}
