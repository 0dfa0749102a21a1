//! From ops to steps: order, waiting, time.
use crate::common;
use crate::common::{
    change, hole, line, machine, mm, planner_at, rapid, steps, steps_of, steps_on, tap, turn,
};
use canon::{Feed, OpKind, PathMode, Position, ReturnAcceleration, SpindleOrder};
use motion::Shape;
use plan::{SpindleStep, Step, StepKind};
use std::f64::consts::TAU;
use units::{Angle, Lead, Length, Orientation, Time};

/// Whether a step goes on with the one before, along the same straight line and without a stop
/// between them: a law with a limit of jerk has more phases than one step holds.
fn goes_on(before: &Step, step: &Step) -> bool {
    let (StepKind::Follow(a), StepKind::Follow(b)) = (&before.kind, &step.kind) else {
        return false;
    };
    let straight = matches!(a.piece.curve, motion::Curve::Line(_));
    straight && a.piece == b.piece && before.op == step.op && !a.exact_stop
}

/// One word a step, so that a program's plan is a sentence; one word for all steps along one
/// straight line.
fn words(steps: &[Step]) -> String {
    let word = |step: &Step| match &step.kind {
        StepKind::Move(m) => {
            let kind = if m.rapid { "rapid" } else { "cut" };
            let stop = if m.exact_stop { "" } else { "~" };
            let to = m.path.to().linear;
            format!("{kind}{stop}({},{},{})", to[0].value(), to[1].value(), to[2].value())
        }
        StepKind::Follow(m) => {
            let kind = if m.piece.rapid { "rapid" } else { "cut" };
            let stop = if m.exact_stop { "" } else { "~" };
            let to = m.piece.at(m.at(m.duration()).0).q;
            format!("{kind}{stop}({},{},{})", to[0], to[1], to[2])
        }
        StepKind::Dwell(t) => format!("dwell({})", t.value()),
        StepKind::Spindle { order: SpindleStep::Turn { spin, .. }, .. } => {
            format!("turn({})", spin.in_rpm().round())
        }
        StepKind::Spindle { order: SpindleStep::Surface { .. }, .. } => "surface".into(),
        StepKind::Spindle { order: SpindleStep::AwaitSpeed, .. } => "await".into(),
        StepKind::Spindle { order: SpindleStep::Orient { .. }, .. } => "orient".into(),
        StepKind::Spindle { order: SpindleStep::Throw(throw), .. } => {
            format!("throw {:.0} then {:.0}", throw.throw.in_rpm(), throw.then.in_rpm())
        }
        StepKind::Thread(stretch) => {
            let sign = if stretch.ends { "" } else { "~" };
            format!("thread{sign}({},{},{})", stretch.to[0], stretch.to[1], stretch.to[2])
        }
        StepKind::Tap(t) => format!("tap({})", t.bottom.value()),
        StepKind::ChangeTool { tool, .. } => format!("tool({tool})"),
        StepKind::Probe { .. } => "probe".into(),
        StepKind::Coolant { .. } => "coolant".into(),
        StepKind::FeedOverride(acts) => format!("override({acts})"),
        StepKind::SpindleOverride(acts) => format!("spindle override({acts})"),
        StepKind::Output(output) => format!("output({})", output.number),
        StepKind::Input(wait) => format!("input({})", wait.number),
        StepKind::UserCode(number) => format!("M{number}"),
        StepKind::Pause { .. } => "pause".into(),
        StepKind::End => "end".into(),
        StepKind::Engage(gear) => format!("engage({}:{})", gear.ratio.follower, gear.ratio.master),
        StepKind::Release { .. } => "release".into(),
        StepKind::Superpose(order) if order.table.is_some() => "superpose".into(),
        StepKind::Superpose(_) => "fade".into(),
        StepKind::AwaitFades => "faded".into(),
        StepKind::Revolve { turns, .. } => format!("revolve({})", turns.value()),
        StepKind::Inputs(wait) => format!("inputs({:#x}, {:#x})", wait.on, wait.off),
        StepKind::Count(count) => format!("count({} of {})", count.edges, count.input),
        StepKind::Guard { on, off } => format!("guard({on:#x}, {off:#x})"),
        StepKind::Consult(what) => format!("consult({what})"),
        StepKind::WayOut(_) => "way-out".into(),
    };
    let ends = steps.chunk_by(goes_on).filter_map(<[Step]>::last);
    ends.map(word).collect::<Vec<_>>().join(" ")
}

#[test]
fn the_spindle_starts_before_the_rapids_and_its_speed_is_awaited_before_the_first_cut() {
    let steps = steps([
        turn(1000.0),
        rapid(10.0, 0.0, 0.0),
        line(20.0, 0.0, 0.0, 600.0),
        line(30.0, 0.0, 0.0, 600.0),
    ]);
    assert_eq!(words(&steps), "turn(1000) rapid(10,0,0) await cut~(20,0,0) cut(30,0,0)");
}

#[test]
fn a_tap_finds_the_spindle_at_rest_and_the_order_in_force_waits_for_the_next_cut() {
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.0, 600.0);
    let steps = steps_of(
        planner_at(t.start, 2),
        [
            turn(600.0),
            OpKind::Tap(t),
            rapid(10.0, 0.0, -148.0),
            OpKind::Tap(tap(10.0, 0.0, 2.0, -20.0, 1.0, 600.0)),
            rapid(20.0, 0.0, -148.0),
            line(20.0, 0.0, -150.0, 600.0),
            OpKind::End,
        ],
    );
    assert_eq!(
        words(&steps),
        "tap(-170) rapid(10,0,-148) tap(-170) turn(600) rapid(20,0,-148) await cut(20,0,-150) turn(0) end"
    );
}

#[test]
fn a_spindle_that_turns_is_stopped_and_awaited_before_a_tap() {
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.0, 600.0);
    let steps = steps_of(
        planner_at(t.start, 2),
        [turn(600.0), OpKind::Dwell { time: Time::s(1.0) }, OpKind::Tap(t)],
    );
    assert_eq!(words(&steps), "turn(600) dwell(1) await turn(0) await tap(-170)");
}

#[test]
fn a_spindle_that_is_oriented_stays_so_until_it_is_told_to_turn_again() {
    let orient = || OpKind::Spindle {
        spindle: 0,
        order: SpindleOrder::Orient { to: Orientation::shortest(Angle::deg(90.0)), longest: None },
    };
    let dwell = || OpKind::Dwell { time: Time::s(1.0) };
    let ops = [turn(600.0), dwell(), orient(), dwell(), rapid(5.0, 0.0, 0.0), turn(500.0), dwell()];
    assert_eq!(
        words(&steps(ops)),
        "turn(600) dwell(1) await turn(0) await orient dwell(1) rapid(5,0,0) turn(500) dwell(1)"
    );
}

#[test]
fn a_tool_change_lifts_z_and_the_first_cut_brings_it_back() {
    let steps = steps([
        rapid(0.0, 0.0, -100.0),
        turn(1000.0),
        line(5.0, 0.0, -100.0, 600.0),
        change(1),
        rapid(50.0, 20.0, -100.0),
        line(60.0, 20.0, -100.0, 600.0),
    ]);
    assert_eq!(
        words(&steps),
        "rapid(0,0,-100) turn(1000) await cut(5,0,-100) turn(0) rapid(5,0,0) await tool(1) \
         rapid(50,20,0) rapid(50,20,-100) cut(60,20,-100)"
    );
}

#[test]
fn tools_are_changed_where_the_machine_has_it_and_the_way_there_and_back_is_at_the_top() {
    let mut limits = machine();
    limits.tool_change.x = Some(Length::mm(-200.0));
    limits.tool_change.y = Some(Length::mm(30.0));
    let ops = [
        rapid(0.0, 0.0, -100.0),
        change(1),
        // X and Y alone: straight there, at the top
        rapid(50.0, 20.0, -100.0),
        line(60.0, 20.0, -100.0, 600.0),
        change(2),
        // Z alone: back over the work first
        rapid(60.0, 20.0, -90.0),
        change(1),
        line(70.0, 20.0, -90.0, 600.0),
    ];
    assert_eq!(
        words(&steps_on(limits, ops)),
        "rapid(0,0,-100) rapid(0,0,0) rapid(-200,30,0) tool(1) rapid(50,20,0) rapid(50,20,-100) cut(60,20,-100) \
         rapid(60,20,0) rapid(-200,30,0) tool(2) rapid(60,20,0) rapid(60,20,-90) \
         rapid(60,20,0) rapid(-200,30,0) tool(1) rapid(60,20,0) rapid(60,20,-90) cut(70,20,-90)"
    );
}

#[test]
fn under_g64_collinear_cuts_are_one_that_waits_until_in_position_at_its_end() {
    let blend = OpKind::PathMode(PathMode::Blend { tolerance: None, merge: None });
    let steps = steps([
        blend,
        turn(1000.0),
        line(1.0, 0.0, 0.0, 600.0),
        line(2.0, 0.0, 0.0, 600.0),
        rapid(3.0, 0.0, 0.0),
    ]);
    assert_eq!(words(&steps), "turn(1000) await cut(2,0,0) rapid(3,0,0)");
}

/// A point 0.02 mm beside the line, P 0.1 mm: LinuxCNC's Q is P where none is stated, which leaves
/// all of P to the blend.
#[test]
fn a_q_below_p_merges_what_is_within_it_and_one_as_large_as_p_does_not() {
    let merges = |q: f64| {
        let (tolerance, merge) = (Some(common::mm(0.1)), Some(common::mm(q)));
        let blend = OpKind::PathMode(PathMode::Blend { tolerance, merge });
        let cuts = [line(10.0, 0.02, 0.0, 600.0), line(20.0, 0.0, 0.0, 600.0)];
        let steps = steps([blend, turn(1000.0)].into_iter().chain(cuts));
        // a merged line leads through no place beside it
        !words(&steps).contains(",0.0")
    };
    let merged = [0.0, 0.015, 0.025, 0.05, 0.1, 0.2].map(merges);
    assert_eq!(merged, [false, false, true, true, false, false]);
}

#[test]
fn steps_carry_the_index_and_line_of_their_op_and_a_step_of_no_length_is_none() {
    let steps =
        steps([rapid(0.0, 0.0, 0.0), rapid(1.0, 0.0, 0.0), OpKind::Dwell { time: Time::s(0.5) }]);
    let places: Vec<_> = steps.iter().map(|s| (s.op, s.line)).collect();
    assert_eq!(places, [(1, 2), (2, 3)]);
}

/// 100 mm at 6000 mm/min is 1 s; the ramps of 100 mm/s at 10 m/s², 500 m/s³ add v/a +
/// a/j = 0.01 + 0.02 s (reached: v·j = 5e7 < a² = 1e8, so 2·√(v/j) = 0.02828 s).
#[test]
fn the_time_of_a_cut_is_its_closed_form() {
    let mut planner = planner_at(Position::default(), 0);
    for (i, op) in (0..).zip(&common::program([line(100.0, 0.0, 0.0, 6000.0)])) {
        planner.push(i, op, &mut |_| {});
    }
    let expected = 1.0 + 2.0 * (100.0_f64 / 5e5).sqrt();
    assert!((planner.duration().value() - expected).abs() < 1e-12, "{}", planner.duration());
}

/// 50 revolutions at 0.2 mm each: at 1000 rpm 3 s and a little for the ramps.
#[test]
fn a_feed_per_revolution_is_planned_over_revolutions() {
    let feed = Feed::PerRevolution(Lead::mm_per_rev(0.2));
    let steps = steps([turn(1000.0), OpKind::Line { to: Position::xyz(10.0, 0.0, 0.0), feed }]);
    let StepKind::Move(m) = &steps.last().unwrap().kind else { panic!("{}", words(&steps)) };
    assert!(m.per_revolution);
    assert!((m.profile.peak() - 0.2).abs() < 1e-12);
    assert!(
        m.profile.duration() > 50.0 && m.profile.duration() < 50.2,
        "{} rev",
        m.profile.duration()
    );
}

#[test]
fn an_inverse_time_move_lasts_as_long_as_programmed_unless_the_axes_are_slower() {
    for (seconds, lasts) in [(2.0, 2.0), (0.11, 0.11)] {
        let feed = Feed::Duration(Time::s(seconds));
        let steps = steps([turn(1.0), OpKind::Line { to: Position::xyz(10.0, 0.0, 0.0), feed }]);
        let StepKind::Move(m) = &steps.last().unwrap().kind else { panic!("{}", words(&steps)) };
        assert!((m.profile.duration() - lasts).abs() < 1e-9, "{} s", m.profile.duration());
    }
    let feed = Feed::Duration(Time::s(1e-6));
    let steps = steps([turn(1.0), OpKind::Line { to: Position::xyz(10.0, 0.0, 0.0), feed }]);
    let StepKind::Move(m) = &steps.last().unwrap().kind else { panic!("{}", words(&steps)) };
    assert!(m.profile.duration() > 0.05, "{} s", m.profile.duration());
}

#[test]
fn drilling_and_tapping_a_hole_end_to_end() {
    let steps = steps([
        change(1),
        turn(2000.0),
        rapid(10.0, 10.0, -128.0),
        hole(10.0, 10.0, -25.0),
        line(10.0, 10.0, -155.0, 300.0),
        rapid(10.0, 10.0, -128.0),
        change(2),
        turn(1000.0),
        rapid(10.0, 10.0, -148.0),
        OpKind::Tap(tap(10.0, 10.0, 2.0, -20.0, 1.0, 1000.0)),
        OpKind::End,
    ]);
    assert_eq!(
        words(&steps),
        "tool(1) turn(2000) rapid(10,10,-128) await cut(10,10,-155) rapid(10,10,-128) \
         turn(0) rapid(10,10,0) await tool(2) rapid(10,10,-148) tap(-170) end"
    );
}

#[test]
fn in_and_out_are_alike_at_one_speed_and_a_left_hand_tap_turns_the_other_way() {
    for (lead, tool, sense) in [(1.0, 2, 1.0), (-1.0, 3, -1.0)] {
        let t = tap(0.0, 0.0, 2.0, -20.0, lead, 3000.0);
        let steps = steps_of(planner_at(t.start, tool), [OpKind::Tap(t)]);
        let [Step { kind: StepKind::Tap(plan), .. }] = &steps[..] else {
            panic!("{}", words(&steps))
        };
        assert_eq!(plan.inward, plan.outward);
        assert_eq!(plan.inward.end().s, 22.0);
        assert_eq!(plan.lead, Lead::mm_per_rev(-lead), "into -Z");
        assert_eq!(
            (plan.spin.in_rpm().round(), plan.return_spin.in_rpm().round()),
            (3000.0 * sense, -3000.0 * sense)
        );
    }
}

#[test]
fn a_faster_return_takes_less_time() {
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.0, 1500.0);
    let t = canon::Tap { return_spin: units::Spin::rpm(3000.0), ..t };
    let steps = steps_of(planner_at(t.start, 2), [OpKind::Tap(t)]);
    let [Step { kind: StepKind::Tap(plan), .. }] = &steps[..] else { panic!("{}", words(&steps)) };
    assert!(plan.outward.duration() < 0.7 * plan.inward.duration());
}

/// Out with its own acceleration A under the jerk j: N/n + n/A + A/j, while the way in stays what
/// it was.
#[test]
fn the_way_out_has_an_acceleration_of_its_own() {
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.0, 1500.0);
    let out = |asked: ReturnAcceleration| {
        let t = canon::Tap { return_acceleration: asked, ..t };
        let steps = steps_of(planner_at(t.start, 2), [OpKind::Tap(t)]);
        let [Step { kind: StepKind::Tap(plan), .. }] = &steps[..] else {
            panic!("{}", words(&steps))
        };
        (plan.inward.duration(), plan.outward.duration())
    };
    let spindle = common::SPINDLE;
    let level = spindle.margin * spindle.peak_torque.value() / (TAU * spindle.inertia.value());
    let jerk = (level / spindle.torque_rise.value()).min(5e5);
    let closed_form = |accel: f64| 22.0 / 25.0 + 25.0 / accel + accel / jerk;
    let usual = out(ReturnAcceleration::AsSet);
    for accel in [60.0, 100.0, 300.0] {
        let found = out(ReturnAcceleration::Limit(units::SpinAccel::rev_per_s2(accel)));
        assert_eq!(found.0, usual.0, "the way in");
        assert!((found.1 - closed_form(accel)).abs() < 1e-9, "{accel}: {found:?}");
    }
    // a share of what torque gives from rest against friction and the cut (M6 in C45: 1.726 N·m)
    let cut = plan::tapping_torque(mm(6.0), mm(5.0), canon::Flute::SpiralFlute, 3900.0).value();
    let highest = level - (spindle.friction.value() + cut) / (TAU * spindle.inertia.value());
    let half = out(ReturnAcceleration::Share(0.5));
    assert!((half.1 - closed_form(highest / 2.0)).abs() < 1e-9, "{half:?}");
}

#[test]
fn a_tool_that_is_in_the_spindle_is_not_changed() {
    let steps = steps([change(1), rapid(1.0, 0.0, -5.0), change(1), rapid(2.0, 0.0, -5.0)]);
    assert_eq!(words(&steps), "tool(1) rapid(1,0,-5) rapid(2,0,-5)");
}

/// Turn to 1000 rpm takes longer than the short rapid; the cut waits for it, and the estimate with
/// it.
#[test]
fn waiting_for_the_spindle_counts_in_the_planned_time() {
    let ramp = common::SPINDLE.ramp(units::Spin::ZERO, units::Spin::rpm(9000.0)).duration();
    let far = steps([turn(9000.0), rapid(1.0, 0.0, 0.0), line(2.0, 0.0, 0.0, 600.0)]);
    let (StepKind::Move(way), StepKind::Move(cut)) = (&far[1].kind, &far[3].kind) else {
        panic!("{}", words(&far))
    };
    assert!(way.profile.duration() < ramp);
    let ops = common::program([turn(9000.0), rapid(1.0, 0.0, 0.0), line(2.0, 0.0, 0.0, 600.0)]);
    let planned = plan::preflight(planner_at(Position::default(), 0), &ops).duration;
    assert!((planned.value() - ramp - cut.profile.duration()).abs() < 1e-12, "{planned}");
}
