//! Threads judged from synthetic records whose error is known in closed form.
use crate::common::{self, Record, config, judge, judge_with, tap_tool, thread, tools};
use canon::Material;
use canon::{Op, OpKind, ToolKind, ToolLibrary};
use proptest::prelude::*;
use std::f64::consts::TAU;
use test_support::size;
use units::{Angle, Coordinate, Length};
use verify::{Config, Hand, Judge};

const SQRT3: f64 = 1.732_050_807_568_877_2;

fn close(found: Length, expected_um: f64, within_um: f64) {
    assert!(
        (found.in_um() - expected_um).abs() <= within_um,
        "expected {expected_um} µm, found {} µm",
        found.in_um()
    );
}

#[test]
fn an_ideal_helix_makes_the_taps_own_thread() {
    let feature = judge(&Record::new(2, 1.0), |_, _| 0.0);
    assert!(feature.verdict.is_pass(), "{:?}", feature.verdict);
    assert_eq!((feature.line, feature.tool), (10, Some(2)));
    let m6 = thread(&feature);
    assert_eq!((m6.size.as_str(), m6.hand), ("M6x1", Hand::Right));
    close(m6.sync_error_max, 0.0, 1e-6);
    close(m6.groove_widening, 0.0, 1e-6);
    close(m6.pitch_diameter, 5350.0, 1e-6);
    close(m6.tip_depth, 14_000.0, 1.0);
    close(m6.depth, 14_000.0 - 2500.0, 1.0);
    close(m6.margin, 0.0, 1e-5);
    close(m6.no_go_margin, 150.0, 1e-5);
    assert_eq!(m6.class.unwrap().name(), "4H");
    assert!((m6.spin_max.in_rpm() - 3000.0).abs() < 1e-9);
    assert!((m6.torque_max.unwrap().value() - 1.7).abs() < 1e-12);
    assert!((m6.axial_force_max.unwrap().value() - 40.0).abs() < 1e-12);
}

#[test]
fn a_constant_offset_is_another_start_angle_and_no_error() {
    let feature = judge(&Record::new(2, 1.0), |_, _| 0.040);
    close(thread(&feature).sync_error_max, 0.0, 1e-6);
    // 40 µm deeper on a lead of 1 mm: the helix passes the start plane 0.04 rev = 14.4° earlier
    let start = thread(&feature).start_angle.unwrap().in_deg();
    assert!((start - (90.0 - 14.4)).abs() < 1e-6, "{start}");
}

#[test]
fn a_sinusoidal_error_is_found_with_its_peak_its_rms_and_twice_it_as_widening() {
    let peak_mm = 0.008;
    let feature = judge(&Record::new(2, 1.0), |depth, _| peak_mm * (TAU * depth / 2.0).sin());
    let m6 = thread(&feature);
    close(m6.sync_error_max, 8.0, 0.05);
    close(m6.sync_error_rms, 8.0 / 2.0_f64.sqrt(), 0.05);
    close(m6.groove_widening, 16.0, 0.1);
    close(m6.pitch_diameter, 5350.0 + SQRT3 * 16.0, 0.2);
}

#[test]
fn what_differs_between_in_and_out_widens_every_groove() {
    // encoder-following without prediction: behind by v·Ts inwards, by the same outwards
    let feature = judge(&Record::new(2, 1.0), |_, out| if out { 0.012 } else { -0.012 });
    let m6 = thread(&feature);
    close(m6.sync_error_max, 12.0, 0.1);
    close(m6.groove_widening, 24.0, 1e-6);
    close(m6.lead_error, 0.0, 1e-6);
    close(m6.no_go_margin, 150.0 - SQRT3 * 24.0, 1e-3);
}

#[test]
fn a_lead_off_by_a_micrometre_per_millimetre_adds_up_over_the_engagement() {
    let feature = judge(&Record::new(2, 1.0), |depth, _| 0.001 * depth);
    let m6 = thread(&feature);
    // full thread 11.5 mm, but gauges engage 6.7·P·d^0.2 = 9.59 mm
    close(m6.lead_error, 9.59, 0.13);
    // the whole tap moves: the shallowest place sees everything from half its chamfer to the bottom
    close(m6.groove_widening, 14.0 - 1.25, 0.13);
}

#[test]
fn a_go_gauge_follows_wherever_the_tap_itself_has_been() {
    // without clearance the tap's own full form stood in the groove: D2v ≥ D2 of the tap, always
    for error in [0.002, -0.004] {
        let feature = judge(&Record::new(2, 1.0), |depth, out| {
            error * depth + if out { 0.005 * (depth * 2.0).cos() } else { 0.0 }
        });
        assert!(thread(&feature).go_margin > Length::um(-0.01), "{}", thread(&feature).go_margin);
    }
}

#[test]
fn with_clearance_only_the_leading_teeth_widen_and_the_lead_error_jams_the_gauge() {
    let config = Config { flank_clearance: Length::um(30.0), ..config(tools()) };
    let feature = judge_with(config, &Record::new(2, 1.0), |depth, _| 0.001 * depth);
    let m6 = thread(&feature);
    // 12.75 µm of shift are less than the play; left is the leading stretch c/2 + P = 2.25 mm
    close(m6.groove_widening, 2.25, 0.3);
    assert!(!feature.verdict.is_pass());
    let reason = feature.verdict.reason().unwrap();
    assert!(reason.starts_with("the Go gauge of 6H does not enter"), "{reason}");
}

#[test]
fn an_offset_beyond_the_clearance_counts_only_by_what_is_beyond() {
    // e jumps by 20 µm once the tip is 10 mm deep, in and out alike: the grooves above 6.5 mm are
    // touched at the jump by following teeth alone, which have ±6 µm of play
    let config = Config { flank_clearance: Length::um(12.0), ..config(tools()) };
    let jump = |depth: f64, _| if depth > 10.0 { 0.020 } else { 0.0 };
    let feature = judge_with(config, &Record::new(2, 1.0), jump);
    let shallow = thread(&feature).profile.iter().find(|p| p.tip_depth > Length::mm(3.0)).unwrap();
    close(shallow.widening.unwrap(), 14.0, 0.01);
    close(thread(&feature).groove_widening, 20.0, 0.01);
}

#[test]
fn a_left_hand_thread_is_judged_in_its_own_sense() {
    let good = judge(&Record::new(3, -1.25), |_, _| 0.0);
    assert!(good.verdict.is_pass(), "{:?}", good.verdict);
    let m8 = thread(&good);
    assert_eq!((m8.size.as_str(), m8.hand), ("M8x1.25", Hand::Left));
    let bad = judge(&Record::new(3, -1.25), |_, out| if out { 0.020 } else { 0.0 });
    close(thread(&bad).groove_widening, 20.0, 1e-6);
}

#[test]
fn an_inch_thread_is_asked_for_2b_and_measured_in_millimetres() {
    let feature = judge(&Record::new(4, 1.27), |_, out| if out { 0.010 } else { 0.0 });
    assert!(feature.verdict.is_pass(), "{:?}", feature.verdict);
    let unc = thread(&feature);
    assert_eq!((unc.size.as_str(), unc.class_asked.name()), ("1/4-20 UNC", "2B"));
    close(unc.pitch_diameter, (0.25 - 0.649_519 * 0.05) * 25_400.0 + SQRT3 * 10.0, 0.01);
}

#[test]
fn a_groove_wider_than_its_tolerance_lets_the_no_go_gauge_in() {
    let feature = judge(&Record::new(2, 1.0), |_, out| if out { -0.090 } else { 0.0 });
    let m6 = thread(&feature);
    assert_eq!(m6.class.unwrap().name(), "7H");
    close(m6.margin, 150.0 - SQRT3 * 90.0, 1e-3);
    assert_eq!(
        feature.verdict.reason().unwrap(),
        "the No-go gauge of 6H enters: pitch diameter 5.506 mm is 6 µm over its limit, \
         the groove is 90 µm wider than the tap at 0.06 mm"
    );
}

#[test]
fn an_overrun_is_judged_more_strictly_than_a_shortfall() {
    let reach = |depth_mm| judge(&Record { depth_mm, ..Record::new(2, 1.0) }, |_, _| 0.0);
    assert!(reach(14.015).verdict.is_pass());
    assert!(reach(13.92).verdict.is_pass());
    let over = reach(14.05);
    close(thread(&over).depth_error, 50.0, 0.5);
    let reason = over.verdict.reason().unwrap();
    assert_eq!(reason, "the tap ran 50 µm beyond its bottom at 14.000 mm, 20 µm allowed");
    let short = reach(13.85);
    assert!(short.verdict.reason().unwrap().starts_with("the thread is 150 µm too shallow"));
}

#[test]
fn a_tap_may_go_as_deep_as_its_flutes_are_long_with_what_any_thread_may_overrun() {
    let reach = |depth_mm| {
        let record = Record { depth_mm, programmed_mm: 25.0, ..Record::new(2, 1.0) };
        judge(&record, |_, _| 0.0).verdict
    };
    assert!(reach(25.001).is_pass(), "{:?}", reach(25.001));
    let deeper = reach(25.1);
    assert!(deeper.reason().unwrap().contains("a tap whose thread is 25.00 mm long"), "{deeper:?}");
}

#[test]
fn a_tap_that_broke_stayed_in_or_never_came_is_no_thread() {
    let record = Record::new(2, 1.0);
    let mut judge = Judge::new(config(tools()));
    judge.op(0, &Op { span: common::span(9), kind: OpKind::ChangeTool { number: 2 } });
    for index in 1..4 {
        judge.op(index, &record.op(10 + index));
    }
    let mut broken = record.samples(1, |_, _| 0.0);
    let half = broken.len() / 2;
    for sample in &mut broken[half / 2..] {
        sample.truth.as_mut().unwrap().tool_broken = true;
    }
    let stuck = record.samples(2, |_, _| 0.0);
    let stuck = &stuck[..half / 2];
    broken.iter().chain(stuck).for_each(|sample| judge.sample(sample));
    let features = judge.finish();
    let reasons: Vec<_> = features.iter().map(|f| f.verdict.reason().unwrap_or("good")).collect();
    assert!(reasons[0].starts_with("the tool broke "), "{}", reasons[0]);
    let broke = thread(&features[0]);
    assert!(broke.tip_depth < Length::mm(13.9), "what was cut after it broke: {}", broke.tip_depth);
    assert_eq!((broke.class, broke.margin), (None, Length::ZERO));
    assert_eq!(broke.class_name(), "not gauged", "a gauge was never tried on it");
    assert!(reasons[1].starts_with("the tool was left"), "{}", reasons[1]);
    assert_eq!(reasons[2], "not cut: the program ended before it");
    assert_eq!(thread(&features[2]).class, None);
    assert_eq!(thread(&features[2]).class_name(), "not gauged");
}

#[test]
fn a_record_with_a_hole_in_it_proves_nothing() {
    let record = Record::new(2, 1.0);
    let mut judge = Judge::new(config(tools()));
    judge.op(0, &record.op(10));
    let mut samples = record.samples(0, |_, _| 0.0);
    let middle = samples.len() / 3;
    samples[middle].truth.as_mut().unwrap().spindles[0] = Angle::rev(f64::NAN);
    for sample in &samples {
        judge.sample(sample);
    }
    let features = judge.finish();
    let reason = features[0].verdict.reason().unwrap();
    assert_eq!(reason, "the record holds a position or angle that is not a number");
}

#[test]
fn a_tap_pulled_straight_out_tears_its_thread() {
    // in on the helix; then the spindle stands and the axis withdraws
    let record = Record::new(2, 1.0);
    let mut judge = Judge::new(config(tools()));
    judge.op(0, &record.op(10));
    let samples = record.samples(0, |_, _| 0.0);
    let bottom = samples.len() / 2;
    for (k, mut sample) in samples.iter().copied().enumerate() {
        if k > bottom {
            let still = samples[bottom].truth.unwrap().spindles;
            sample.truth.as_mut().unwrap().spindles = still;
        }
        judge.sample(&sample);
    }
    let features = judge.finish();
    close(thread(&features[0]).sync_error_max, 14_000.0, 50.0);
    assert!(features[0].verdict.reason().unwrap().contains("No-go gauge of 6H enters"));
    assert_eq!(thread(&features[0]).class, None);
}

#[test]
fn the_wrong_tool_is_named() {
    let reason = |tool, lead| {
        let feature = judge(&Record::new(tool, lead), |_, _| 0.0);
        feature.verdict.reason().unwrap_or("good").to_owned()
    };
    assert!(reason(9, 1.0).starts_with("T9 is not in the tool table"));
    assert!(reason(1, 1.0).starts_with("T1 is not a tap"));
    assert!(
        reason(2, -1.0).starts_with("T2 is a right-hand tap, the block turns it for a left-hand")
    );
    assert!(reason(5, 1.0).starts_with("T5: expected a thread such as"));
    let wrong_lead = reason(2, 1.25);
    assert!(wrong_lead.starts_with("the block's lead is 1.2500 mm, that of T2 is 1.0000 mm"));
    assert!(wrong_lead.contains("No-go gauge"), "and the thread is torn: {wrong_lead}");
}

#[test]
fn what_a_stand_in_taps_is_not_judged() {
    let mut tools = tools();
    let kind = canon::ToolKind::Other;
    tools.insert(canon::Tool { stand_in: true, kind, ..tap_tool(7, "M6x1", 1.0) });
    let feature = judge_with(config(tools), &Record::new(7, 1.0), |_, _| 0.0);
    assert_eq!(feature.verdict.name(), "not judged");
    assert_eq!(
        feature.verdict.reason(),
        Some("T7 is not in the tool table: what it taps is not judged; add it to the table")
    );
    assert_eq!((thread(&feature).size.as_str(), feature.contact.reach), ("thread 1.000", None));
}

#[test]
fn a_thread_is_held_to_the_start_angle_it_was_asked_for() {
    let asked = |deg| {
        let start_angle = Some(Angle::deg(deg));
        judge(&Record { start_angle, ..Record::new(2, 1.0) }, |_, _| 0.0)
    };
    assert!(asked(90.0).verdict.is_pass(), "the record starts at 1234.25 rev");
    assert!(asked(450.0).verdict.is_pass());
    let reason = asked(60.0).verdict.reason().unwrap().to_owned();
    assert_eq!(reason, "the thread starts 30.0° from the 60.0° asked, 5.0° allowed");
}

#[test]
fn a_sync_error_limit_counts_even_where_the_gauges_agree() {
    let mut config = common::config(tools());
    config.tolerances.sync_error = Some(Length::um(10.0));
    let feature =
        judge_with(config, &Record::new(2, 1.0), |depth, _| 0.0125 * (TAU * depth / 2.0).sin());
    assert_eq!(thread(&feature).class.unwrap().name(), "4H");
    assert!(feature.verdict.reason().unwrap().starts_with("the sync error reached 12.5 µm"));
}

#[test]
fn the_expected_torque_stands_beside_the_largest() {
    let config = Config { material: Some(Material::CarbonSteel), ..config(tools()) };
    let feature = judge_with(config, &Record::new(2, 1.0), |_, _| 0.0);
    let expected = thread(&feature).torque_expected.unwrap().value();
    assert!((expected - 1.73).abs() < 0.01, "{expected}");
}

#[test]
fn the_holders_deflection_moves_the_edges_and_is_no_sync_error() {
    let record = Record::new(2, 1.0);
    let mut judge = Judge::new(config(tools()));
    judge.op(0, &record.op(10));
    for mut sample in record.samples(0, |_, _| 0.0) {
        let out = sample.report.state == bus::State::TapOut;
        sample.truth.as_mut().unwrap().tool_deflection = Length::um(if out { 15.0 } else { 0.0 });
        judge.sample(&sample);
    }
    let features = judge.finish();
    close(thread(&features[0]).groove_widening, 15.0, 1e-6);
    close(thread(&features[0]).sync_error_max, 0.0, 1e-6);
}

#[test]
fn a_tap_that_a_clutch_lets_slip_is_judged_by_its_own_angle_not_by_the_spindles() {
    let record = Record::new(2, 1.0);
    let mut judge = Judge::new(config(tools()));
    judge.op(0, &record.op(10));
    for mut sample in record.samples(0, |_, _| 0.0) {
        let out = sample.report.state == bus::State::TapOut;
        let slip = units::Angle::rev(if out { 7.3 } else { 0.0 });
        let truth = sample.truth.as_mut().unwrap();
        truth.spindles[0] += slip;
        truth.tool_turn = -slip;
        judge.sample(&sample);
    }
    let features = judge.finish();
    close(thread(&features[0]).groove_widening, 0.0, 1e-6);
    close(thread(&features[0]).lead_error, 0.0, 1e-6);
}

#[test]
fn without_a_simulator_the_encoders_are_believed() {
    let record = Record::new(2, 1.0);
    let mut judge = Judge::new(config(tools()));
    judge.op(0, &record.op(10));
    for mut sample in record.samples(0, |_, out| if out { 0.010 } else { 0.0 }) {
        let truth = sample.truth.take().unwrap();
        for (axis, position) in sample.feedback.axes.iter_mut().zip(truth.axes) {
            axis.position = position;
        }
        sample.feedback.spindles[0].angle = truth.spindles[0];
        judge.sample(&sample);
    }
    let features = judge.finish();
    let m6 = thread(&features[0]);
    close(m6.groove_widening, 10.0, 1e-6);
    assert_eq!((m6.torque_max, m6.axial_force_max), (None, None));
    assert!((m6.spin_max.in_rpm() - 3000.0).abs() < 15.0, "{}", m6.spin_max.in_rpm());
}

/// Ops of a program that drills with T1, then taps with T2 in the same place.
fn drill_then_tap(drilled_mm: f64, at_mm: [f64; 2]) -> Vec<verify::Feature> {
    let record = Record::new(2, 1.0);
    let change =
        |line, number| Op { span: common::span(line), kind: OpKind::ChangeTool { number } };
    let mut ops = vec![change(1, 1)];
    ops.extend(common::hole_ops(2, at_mm, drilled_mm));
    ops.extend([change(3, 2), record.op(4)]);
    let mut judge = Judge::new(config(tools()));
    for (index, op) in ops.iter().enumerate() {
        judge.op(index as u32, op);
    }
    let tapping = record.samples(5, |_, _| 0.0);
    common::drilling(1, 1, at_mm, drilled_mm).iter().chain(&tapping).for_each(|s| judge.sample(s));
    judge.finish()
}

#[test]
fn the_drilled_hole_gives_the_minor_diameter_and_how_deep_a_tap_may_go() {
    let good = drill_then_tap(17.0, [30.0, 20.0]);
    assert_eq!(
        good.iter().map(|f| (f.kind_name(), f.line)).collect::<Vec<_>>(),
        [("hole", 2), ("thread", 4)]
    );
    assert!(good.iter().all(|f| f.verdict.is_pass()), "{:?}", good[1].verdict);
    assert_eq!(thread(&good[1]).hole, verify::KnownHole::Seen);
    close(thread(&good[1]).minor_diameter, 5000.0, 1e-9);

    // 15 mm to the drill's tip are 13.50 mm of full diameter; the tap wants 14
    let shallow = drill_then_tap(15.0, [30.0, 20.0]);
    let reason = shallow[1].verdict.reason().unwrap();
    assert_eq!(reason, "the tap went 0.50 mm deeper than the hole's full diameter");

    let elsewhere = drill_then_tap(15.0, [60.0, 20.0]);
    assert_eq!(thread(&elsewhere[1]).hole, verify::KnownHole::Assumed);
    let reason = elsewhere[1].verdict.reason().unwrap();
    assert!(reason.starts_with("no hole was drilled here before it was tapped"), "{reason}");
    assert_eq!(elsewhere[1].verdict.name(), "not judged");
}

fn oversize_m6(oversize_um: f64) -> ToolLibrary {
    let mut tool = common::tap_tool(2, "M6x1", 1.0);
    if let ToolKind::Tap(tap) = &mut tool.kind {
        tap.oversize = Length::um(oversize_um);
    }
    ToolLibrary::new([tool])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(24, 480)))]

    #[test]
    fn an_exact_helix_always_passes(
        start_rev in -1e5..1e5, rpm in 100.0..8000.0, depth_mm in 4.0..24.0, oversize_um in 0.0..149.0,
    ) {
        let record = Record { start_rev, rpm, depth_mm, programmed_mm: depth_mm, ..Record::new(2, 1.0) };
        let feature = judge_with(config(oversize_m6(oversize_um)), &record, |_, _| 0.0);
        prop_assert!(feature.verdict.is_pass(), "{:?}", feature.verdict);
        prop_assert!(thread(&feature).groove_widening.in_um() < 1e-3);
    }

    #[test]
    fn an_offset_between_in_and_out_is_recovered_within_a_micrometre(
        offset_um in -200.0..200.0_f64, rpm in 100.0..8000.0, clearance_um in 0.0..40.0,
    ) {
        let config = Config { flank_clearance: Length::um(clearance_um), ..config(tools()) };
        let record = Record { rpm, ..Record::new(2, 1.0) };
        let shift = offset_um * 1e-3;
        let feature = judge_with(config, &record, |_, out| if out { shift } else { 0.0 });
        let widening_um = thread(&feature).groove_widening.in_um();
        prop_assert!((widening_um - offset_um.abs()).abs() < 1.0, "{widening_um} for {offset_um}");
    }

    #[test]
    fn no_error_narrows_the_groove(a in -0.05..0.05_f64, b in -0.01..0.01_f64, c in 0.1..9.0_f64, clearance_um in 0.0..40.0) {
        let config = Config { flank_clearance: Length::um(clearance_um), ..config(tools()) };
        let feature = judge_with(config, &Record::new(2, 1.0), |depth, out| {
            a * (c * depth).sin() + b * depth * if out { -1.0_f64 } else { 1.0 }
        });
        let m6 = thread(&feature);
        prop_assert!(m6.groove_widening >= Length::ZERO);
        prop_assert!(m6.pitch_diameter >= Length::mm(5.350));
        prop_assert!(m6.profile.iter().filter_map(|p| p.widening).all(|w| w >= Length::ZERO));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(200, 2000)))]

    #[test]
    fn no_record_however_mad_makes_the_judge_panic(
        numbers in proptest::collection::vec((prop::num::f64::ANY, prop::num::f64::ANY, 0..6_u32), 1..40),
        bottom in prop::num::f64::ANY, lead in prop::num::f64::ANY, tool in 0..7_u32,
    ) {
        let record = Record { lead_mm: lead, programmed_mm: bottom, ..Record::new(tool, 1.0) };
        let mut judge = Judge::new(config(tools()));
        for (index, op) in common::hole_ops(7, [0.0, 0.0], bottom).iter().enumerate() {
            judge.op(index as u32, op);
        }
        judge.op(3, &record.op(8));
        for (z, theta, op) in numbers {
            let mut sample = bus::Sample::default();
            sample.feedback.axes[2].position = Coordinate::new(z);
            sample.feedback.spindles[0].angle = Angle::rev(theta);
            sample.feedback.tool = Some(tool);
            sample.report.op = op;
            judge.sample(&sample);
        }
        let features = judge.finish();
        let tolerances = verify::Tolerances::default();
        prop_assert_eq!(verify::Summary::of(&features, &tolerances).threads.total(), 1);
    }
}
