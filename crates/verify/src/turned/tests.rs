//! Threads with errors that are known, from motion made up for them.
use super::*;
use crate::feature::{Feature, FeatureKind};
use crate::{Judge, Verdict};
use bus::Truth;
use canon::{Op, OpKind, Span, Threading, ToolLibrary};
use std::f64::consts::TAU;
use units::{Angle, Coordinate};

const PERIOD: f64 = 250e-6;
const LEAD: f64 = 1.5;

fn at(x: f64, z: f64) -> Position {
    let [x, z] = [x, z].map(Length::mm);
    Position { linear: [x, Length::ZERO, z], ..Position::default() }
}

/// A solid bar from Z0 to Z−120.
#[allow(clippy::unnecessary_wraps)] // as the configuration has it
fn bar(radius: f64) -> Option<crate::Bar> {
    let [radius, bore, face, rear] = [radius, 0.0, 0.0, -120.0].map(Length::mm);
    Some(crate::Bar { radius, bore, face, rear })
}

/// Two passes from Z5 over Z0 to Z−20, as this machine has made them: distance from the helix by
/// pass and depth.
fn judged(error: impl Fn(usize, f64) -> f64) -> TurnedThread {
    let mut judge = Judge::new(Config::new(ToolLibrary::default()));
    let (passes, n) = ([10.0, 9.5], 10.0);
    let mut time = 0.0;
    for (index, x) in passes.into_iter().enumerate() {
        let op = index as u32 * 2;
        let span = Span { line: op + 1, ..Span::default() };
        judge.op(op, &Op { span, kind: OpKind::Rapid { to: at(x, 5.0) } });
        let order = Threading {
            to: at(x, -20.0),
            lead: Lead::mm_per_rev(LEAD),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::rev(0.25),
            axis: Axis::Z,
            surface: Length::ZERO,
        };
        judge.op(op + 1, &Op { span, kind: OpKind::Threading(order) });
        // the spindle is anywhere when the pass begins, and stands at the start angle at Z5
        let whole = 7.25 + 40.0 * index as f64;
        for k in 0..(25.0 / LEAD / n / PERIOD) as usize {
            let turn = k as f64 * PERIOD * n;
            let z = 5.0 - LEAD * turn;
            let mut sample = Sample::default();
            sample.report.op = op + 1;
            sample.feedback.time = Time::s(time);
            let mut truth = Truth::default();
            truth.axes[0] = Coordinate::new(x);
            truth.axes[2] = Coordinate::new(z + error(index, -z));
            truth.spindles[0] = Angle::rev(whole + turn);
            sample.truth = Some(truth);
            judge.sample(&sample);
            time += PERIOD;
        }
    }
    let features = judge.finish();
    let [feature] = &features[..] else { panic!("{features:?}") };
    let FeatureKind::Turned(thread) = &feature.kind else { panic!("{feature:?}") };
    // without a bar the judge cannot find it good, but it can find it bad
    let expected = if thread.sync_error_max < Length::um(10.0) { "not judged" } else { "fail" };
    assert_eq!(feature.verdict.name(), expected, "{:?}", feature.verdict);
    (**thread).clone()
}

#[test]
fn a_perfect_helix_has_no_error_and_is_right_handed() {
    let thread = judged(|_, _| 0.0);
    assert!(thread.sync_error_max.in_um() < 1e-6 && thread.hand == Hand::Right, "{thread:?}");
    assert_eq!((thread.passes, thread.passes_ordered), (2, 2));
    assert!((thread.lead.value() - LEAD).abs() < 1e-12);
    assert!((thread.spin_max.value() - 10.0).abs() < 1e-6);
}

#[test]
fn a_pass_beside_the_other_is_the_passes_spread() {
    let thread = judged(|pass, _| if pass == 0 { 0.004 } else { -0.003 });
    assert!((thread.pass_spread.in_um() - 7.0).abs() < 1e-6, "{thread:?}");
    assert!((thread.sync_error_max.in_um() - 4.0).abs() < 1e-6);
}

#[test]
fn a_screw_of_another_lead_leaves_its_error_over_the_length() {
    let thread = judged(|_, depth| -1e-4 * depth);
    // judged from the surface to a revolution before the end: 18.5 mm; in −Z the thread is longer
    assert!((thread.lead_error.in_um() - -1.85).abs() < 0.01, "{thread:?}");
}

#[test]
fn a_wave_is_found_with_its_peak_and_its_rms_and_the_run_out_is_not_judged() {
    let wave = |_: usize, depth: f64| {
        if depth > 18.6 { -0.3 } else { 0.008 * (TAU * depth / 3.0).sin() }
    };
    let thread = judged(wave);
    assert!((thread.sync_error_max.in_um() - 8.0).abs() < 0.05, "{thread:?}");
    assert!((thread.sync_error_rms.in_um() - 8.0 / 2.0_f64.sqrt()).abs() < 0.1);
}

/// A pass from Z5 over Z0: 2 mm for 10 turns up to Z−15, then growing by 0.1 mm in each of 20 turns
/// to 4 mm at Z−75, on with that for 5 turns to Z−95; X goes 1 mm out on 100 of Z. `error` by turn
/// and depth.
fn growing(sense: f64, error: impl Fn(f64) -> f64) -> (TurnedThread, Verdict) {
    let bar = bar(12.0);
    let mut judge = Judge::new(Config { bar, ..Config::new(ToolLibrary::default()) });
    let taper = |z: f64| at(9.0 + (5.0 - z) / 100.0, z);
    let slant = 0.01_f64.hypot(1.0);
    judge.op(0, &Op { span: Span::default(), kind: OpKind::Rapid { to: taper(5.0) } });
    for (op, (z, lead, growth)) in
        (1..).zip([(-15.0, 2.0, 0.0), (-75.0, 2.0, 0.1), (-95.0, 4.0, 0.0)])
    {
        let order = Threading {
            to: taper(z),
            lead: Lead::mm_per_rev(lead * slant),
            growth: LeadGrowth::mm_per_rev2(growth * slant),
            start_angle: Angle::rev(0.25),
            axis: Axis::Z,
            surface: Length::mm(if z == -15.0 { 0.0 } else { z + 60.0 }),
        };
        judge.op(op, &Op { span: Span::default(), kind: OpKind::Threading(order) });
    }
    let n = 10.0;
    for k in 0..(35.0 / n / PERIOD) as usize {
        let turn = k as f64 * PERIOD * n;
        let (op, z) = if turn < 10.0 {
            (1, 5.0 - 2.0 * turn)
        } else if turn < 30.0 {
            let grown = turn - 10.0;
            (2, -15.0 - 2.0 * grown - 0.05 * grown * grown)
        } else {
            (3, -75.0 - 4.0 * (turn - 30.0))
        };
        let mut sample = Sample::default();
        sample.report.op = op;
        sample.feedback.time = Time::s(k as f64 * PERIOD);
        let mut truth = Truth::default();
        truth.axes[0] = taper(z).along(Axis::X);
        truth.axes[2] = Coordinate::new(z + error(turn));
        truth.spindles[0] = Angle::rev(0.25 + sense * (7.0 + turn));
        sample.truth = Some(truth);
        judge.sample(&sample);
    }
    let feature = judge.finish().remove(0);
    let FeatureKind::Turned(thread) = feature.kind else { panic!("{feature:?}") };
    (*thread, feature.verdict)
}

#[test]
fn a_lead_that_grows_is_measured_turn_by_turn_over_the_whole_chain() {
    for (sense, hand) in [(1.0, Hand::Right), (-1.0, Hand::Left)] {
        let (thread, verdict) = growing(sense, |_| 0.0);
        assert!(verdict.is_pass() && thread.hand == hand, "{verdict:?}, {thread:?}");
        assert!(thread.sync_error_max.in_um() < 1e-6, "{thread:?}");
        assert!((thread.lead.value() - 2.0).abs() < 1e-9);
        assert!((thread.growth.value() - 0.1).abs() < 1e-9);
        assert!((thread.start_angle.in_deg() - 90.0).abs() < 1e-6, "{}", thread.start_angle);
        assert_eq!((thread.surface, thread.end), (Length::ZERO, Length::mm(-95.0)));
        // from Z0, 2.5 turns in, to a turn before the end
        assert_eq!(thread.leads.len(), 31);
        for (k, turn) in thread.leads.iter().enumerate() {
            // the mean lead of a turn that begins so long after the lead began to grow
            let grown =
                |turn: f64| 0.05 * turn.clamp(0.0, 20.0).powi(2) + 2.0 * (turn - 20.0).max(0.0);
            let began = k as f64 - 7.5;
            let wanted = 2.0 + grown(began + 1.0) - grown(began);
            assert!((turn.cut.value() - wanted).abs() < 0.01, "turn {k}: {turn:?}, {wanted}");
            assert!((turn.cut - turn.ordered).abs().value() < 1e-9, "turn {k}: {turn:?}");
        }
        assert_eq!(thread.lead_in_words(), "lead 2 mm growing 0.1 mm a turn");
    }
}

#[test]
fn a_turn_that_is_too_long_and_a_start_that_is_late_are_found() {
    // from turn 15 on 6 µm farther; 0.01 turns late in all the constant part
    let (thread, _) = growing(1.0, |turn| if turn >= 15.0 { -0.006 } else { 0.0 });
    let worst = thread.worst_turn().expect("there are turns");
    assert!(((worst.cut - worst.ordered).value() - 0.006).abs() < 1e-6, "{worst:?}");
    assert!((thread.sync_error_max.in_um() - 6.0).abs() < 1e-3);
    let at = |turn: f64| {
        let grown = (turn - 10.0).clamp(0.0, 20.0);
        5.0 - 2.0 * turn - 0.05 * grown * grown - 2.0 * (turn - 30.0).max(0.0)
    };
    let (thread, verdict) = growing(1.0, |turn| at(turn - 0.01) - at(turn));
    assert!((thread.start_angle.in_deg() - 93.6).abs() < 1e-3, "{}", thread.start_angle.in_deg());
    assert!(!verdict.is_pass() && thread.lead_error.in_um() > 20.0, "{}", thread.lead_error);
}

#[test]
fn a_thread_of_one_lead_where_a_growing_one_is_ordered_fails() {
    let (thread, verdict) =
        growing(1.0, |turn| if turn > 10.0 { 0.05 * (turn - 10.0).min(20.0).powi(2) } else { 0.0 });
    assert!(!verdict.is_pass() && thread.sync_error_max > Length::mm(0.5), "{thread:?}");
}

/// A pass from Z0 to Z−12, where the axis stands when it begins and comes within `ramp` turns to
/// `speed` times the thread's; half of the ramp lies before the start angle, as it does here.
fn from_rest(ramp: f64, speed: f64, bar: Option<crate::Bar>) -> (TurnedThread, Verdict) {
    let mut judge = Judge::new(Config { bar, ..Config::new(ToolLibrary::default()) });
    judge.op(0, &Op { span: Span::default(), kind: OpKind::Rapid { to: at(10.0, 0.0) } });
    let order = Threading {
        to: at(10.0, -12.0),
        lead: Lead::mm_per_rev(1.0),
        growth: LeadGrowth::ZERO,
        start_angle: Angle::ZERO,
        axis: Axis::Z,
        surface: Length::ZERO,
    };
    judge.op(1, &Op { span: Span::default(), kind: OpKind::Threading(order) });
    for k in 0..(14.0 / 25.0 / PERIOD) as usize {
        let turn = k as f64 * PERIOD * 25.0;
        let way = if turn < ramp { turn * turn / (2.0 * ramp) } else { turn - ramp / 2.0 } * speed;
        let mut sample = Sample::default();
        sample.report.op = 1;
        sample.feedback.time = Time::s(k as f64 * PERIOD);
        let mut truth = Truth::default();
        (truth.axes[0], truth.axes[2]) = (Coordinate::new(10.0), Coordinate::new(-way.min(12.0)));
        truth.spindles[0] = Angle::rev(4.0 - ramp / 2.0 + turn);
        sample.truth = Some(truth);
        judge.sample(&sample);
    }
    let feature = judge.finish().remove(0);
    let FeatureKind::Turned(thread) = feature.kind else { panic!("{feature:?}") };
    (*thread, feature.verdict)
}

#[test]
fn without_a_bar_the_way_to_the_threads_speed_is_left_out_and_said() {
    // v²/2a of 25 mm/s at 420 mm/s² are 744 µm, in 1.488 turns
    let (thread, verdict) = from_rest(1.488, 1.0, None);
    assert!(thread.sync_error_max < Length::um(1.0), "{}", thread.sync_error_max.in_um());
    assert!((0.744..0.9).contains(&thread.run_in.value()), "{}", thread.run_in.value());
    assert_eq!(verdict.name(), "not judged", "{verdict:?}");
    let reason = verdict.reason().unwrap_or_default();
    assert!(reason.contains("mm, in which Z comes to its speed, are left out"), "{reason}");
    // a bar says where the thread begins
    let (thread, verdict) = from_rest(1.488, 1.0, bar(10.5));
    assert_eq!((verdict.name(), thread.run_in), ("fail", Length::ZERO));
    assert!(thread.sync_error_max > Length::um(400.0), "{}", thread.sync_error_max.in_um());
}

#[test]
fn without_a_bar_a_wrong_lead_behind_the_run_in_fails() {
    for speed in [0.99, 1.01, 0.8] {
        let (thread, verdict) = from_rest(1.488, speed, None);
        assert_eq!(verdict.name(), "fail", "{speed}: {verdict:?}");
        assert!(thread.sync_error_max > Length::um(50.0), "{speed}: {}", thread.sync_error_max);
    }
    let (thread, verdict) = from_rest(0.0, 1.0, None);
    assert_eq!((verdict.name(), thread.run_in), ("not judged", Length::ZERO), "at speed at once");
}

#[test]
fn a_hold_in_the_first_pass_already_is_known_to_take_the_tool_off_the_work() {
    let mut judge = Judge::new(Config::new(ToolLibrary::default()));
    let order = Threading {
        to: at(10.0, -20.0),
        lead: Lead::mm_per_rev(LEAD),
        growth: LeadGrowth::ZERO,
        start_angle: Angle::ZERO,
        axis: Axis::Z,
        surface: Length::ZERO,
    };
    let rapid = |x, z| OpKind::Rapid { to: at(x, z) };
    let ops = [rapid(30.0, 5.0), rapid(12.0, 5.0), rapid(10.0, 5.0)];
    let ops = ops.into_iter().chain([OpKind::Threading(order)]);
    for (index, kind) in (0..).zip(ops) {
        judge.op(index, &Op { span: Span::default(), kind });
    }
    let thread = |turn: f64| 5.0 - LEAD * turn;
    let mut time = 0.0;
    let mut see = |x: f64, z: f64, turn: f64| {
        let mut sample = Sample::default();
        sample.report.op = 3;
        sample.feedback.time = Time::s(time);
        let mut truth = Truth::default();
        (truth.axes[0], truth.axes[2]) = (Coordinate::new(x), Coordinate::new(z));
        truth.spindles[0] = Angle::rev(turn);
        sample.truth = Some(truth);
        judge.sample(&sample);
        time += PERIOD;
    };
    let step = PERIOD * 10.0;
    let turns = |from: f64, to: f64| {
        (0..((to - from) / step) as u32).map(move |k| from + f64::from(k) * step)
    };
    turns(0.0, 10.0).for_each(|turn| see(10.0, thread(turn), turn));
    // out within a turn, still on the thread; back in another three, and the pass again from turn
    // 20 on
    turns(10.0, 11.0).for_each(|turn| see(10.0 + 2.0 * (turn - 10.0), thread(turn), turn));
    turns(11.0, 14.0).for_each(|turn| {
        see(12.0, thread(11.0) + (5.0 - thread(11.0)) * (turn - 11.0) / 3.0, turn);
    });
    turns(14.0, 20.0).for_each(|turn| see(10.0, 5.0, turn));
    turns(20.0, 36.0).for_each(|turn| see(10.0, thread(turn - 20.0), turn));
    let feature = judge.finish().remove(0);
    assert_eq!(feature.verdict.name(), "not judged", "{:?}", feature.verdict.reason());
    let FeatureKind::Turned(found) = feature.kind else { panic!("{:?}", feature.kind) };
    assert_eq!((found.passes, found.passes_ordered), (1, 1));
}

#[test]
fn rounding_across_the_way_in_takes_no_tool_off_the_work() {
    // Y of the place before and of the pass differ by the rounding of a conversion; the axis stands
    // a micrometre off
    let place = |x: f64, y: f64| {
        let [x, y] = [x, y].map(Length::mm);
        Position { linear: [x, y, Length::ZERO], ..Position::default() }
    };
    let (stood, from) = (place(12.0, -60.0), place(10.0, -60.0 + 7e-4));
    let off = |x: f64, y: f64| move |i: usize| [x, y, 0.0][i];
    assert!(!is_clear(2, &stood, &from, off(0.0, -0.001)));
    assert!(!is_clear(2, &stood, &from, off(1.5, 0.0)));
    assert!(is_clear(2, &stood, &from, off(1.99, 0.001)));
    assert!(!is_clear(2, &from, &from, off(0.0, 0.0)), "not fed in at all");
}

#[test]
fn only_the_last_rapid_across_the_thread_fed_the_tool_in() {
    let place = |x: f64, y: f64, z: f64| Position {
        linear: [x, y, z].map(Length::mm),
        ..Position::default()
    };
    let mut came = CameFrom::default();
    let way = [
        place(150.0, 60.0, 350.0),
        place(12.0, 0.0, 8.0),
        place(10.0, 1e-6, 8.0),
        place(10.0, 1e-6, 5.0),
    ];
    way.windows(2).for_each(|pair| came.rapid(&pair[0], &pair[1]));
    let stood = came.before(&way[3], Axis::Z);
    assert_eq!(stood.linear, [12.0, 1e-6, 5.0].map(Length::mm));
    assert_eq!(side_fed_in_from(&stood, &way[3], [Length::ZERO; 2]), Some(Side::External));
}

#[test]
fn a_pass_that_ends_early_fails() {
    let mut judge = Judge::new(Config::new(ToolLibrary::default()));
    let order = Threading {
        to: at(9.0, -20.0),
        lead: Lead::mm_per_rev(LEAD),
        growth: LeadGrowth::ZERO,
        start_angle: Angle::ZERO,
        axis: Axis::Z,
        surface: Length::ZERO,
    };
    judge.op(0, &Op { span: Span::default(), kind: OpKind::Threading(order) });
    let feature = judge.finish().remove(0);
    let reason = feature.verdict.reason().unwrap_or_default();
    assert_eq!(reason, "0 of 1 passes were cut to their end");
}

#[test]
fn a_thread_beside_another_is_a_thread_of_its_own() {
    let mut judge = Judge::new(Config::new(ToolLibrary::default()));
    let thread = |from: f64, to: f64, lead: f64| {
        let order = Threading {
            to: at(9.0, to),
            lead: Lead::mm_per_rev(lead),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::ZERO,
            axis: Axis::Z,
            surface: Length::mm(from),
        };
        [
            OpKind::Rapid { to: at(12.0, from) },
            OpKind::Rapid { to: at(9.0, from) },
            OpKind::Threading(order),
        ]
    };
    // two passes of one, 0.3 mm apart by the slide; another lead; another place
    let threads = [
        thread(5.0, -20.0, 1.5),
        thread(4.7, -20.3, 1.5),
        thread(5.0, -20.0, 2.0),
        thread(-30.0, -50.0, 2.0),
    ];
    for (index, kind) in (0..).zip(threads.into_iter().flatten()) {
        judge.op(index, &Op { span: Span::default(), kind });
    }
    let ordered = |feature: &Feature| match &feature.kind {
        FeatureKind::Turned(thread) => (thread.passes_ordered, thread.lead.value()),
        other => panic!("{other:?}"),
    };
    let found: Vec<_> = judge.finish().iter().map(ordered).collect();
    assert_eq!(found, [(2, 1.5), (1, 2.0), (1, 2.0)]);
}
