//! What is refused before motion: one sentence each, with the number that would work.
use crate::common;
use crate::common::{change, findings, findings_of, hole, line, mm, planner_at, rapid, tap, turn};
use canon::{Arc, Feed, OpKind, Plane, Position, SpindleOrder};
use insta::assert_snapshot;
use units::{Angle, CoordinateSpeed, Lead, Length, Speed, Spin, Time};

/// Findings about a tap that stands ready over its hole.
fn tap_findings(tool: u32, tap: canon::Tap) -> String {
    findings_of(planner_at(tap.start, tool), [OpKind::Tap(tap)])
}

/// Drill with one tool, tap with another.
fn drilled_and_tapped(drill: u32, drill_z: f64, tool: u32, tap: canon::Tap) -> String {
    let start = tap.start.linear;
    findings([
        change(drill),
        turn(2000.0),
        rapid(start[0].value(), start[1].value(), -128.0),
        hole(start[0].value(), start[1].value(), drill_z),
        line(start[0].value(), start[1].value(), -130.0 + drill_z, 300.0),
        rapid(start[0].value(), start[1].value(), -128.0),
        change(tool),
        rapid(start[0].value(), start[1].value(), start[2].value()),
        OpKind::Tap(tap),
    ])
}

#[test]
fn a_sound_hole_and_tap_pass_without_a_word() {
    assert_eq!(drilled_and_tapped(1, -25.0, 2, tap(10.0, 10.0, 2.0, -20.0, 1.0, 3000.0)), "");
}

#[test]
fn a_deep_hole_without_pecks_is_remarked_upon_in_the_programs_unit() {
    let found = |depth: f64, bears: Option<f64>, pecks: &[f64]| {
        let mut tools = common::tools();
        let mut drill = tools.get(1).unwrap().clone();
        drill.body.depth_without_pecks = bears.map(mm);
        tools.insert(drill);
        let feeds = pecks.iter().chain([&depth]).map(|z| line(10.0, 10.0, -130.0 - z, 300.0));
        let begin = [change(1), turn(2000.0), rapid(10.0, 10.0, -128.0), hole(10.0, 10.0, -depth)];
        let start = plan::Start { position: Position::default(), tool: 0 };
        let planner = plan::Planner::new(common::machine(), tools, common::OPTIONS, start);
        findings_of(planner, begin.into_iter().chain(feeds))
    };
    // 4·D is 20 mm
    assert!(found(20.5, None, &[]).contains("a hole of 20.5 mm is drilled in one stroke"));
    assert_eq!(found(19.5, None, &[]), "");
    assert_eq!(found(30.0, None, &[8.0, 16.0, 24.0]), "");
    assert_eq!(found(30.0, Some(40.0), &[]), "");
    assert!(found(19.5, Some(15.0), &[]).contains("down to 15 mm"));
}

#[test]
fn a_coordinate_beyond_the_travel() {
    assert_snapshot!(findings([rapid(312.4, 0.0, 0.0), rapid(0.0, -200.5, 1.0)]), @r"
    M0301 Error line 1: X would go to 312.4 mm (machine coordinate), 62.4 mm beyond its travel of -250 to 250 mm: X250 is the nearest that works
        help: shift the work offset or the work
    M0301 Error line 2: Y would go to -200.5 mm (machine coordinate), 0.5 mm beyond its travel of -200 to 200 mm: Y-200 is the nearest that works
        help: shift the work offset or the work
    M0301 Error line 2: Z would go to 1 mm (machine coordinate), 1 mm beyond its travel of -300 to 0 mm: Z0 is the nearest that works
        help: shift the work offset, raise or lower the work, or take a tool of another length
    ");
}

#[test]
fn an_arc_that_bulges_beyond_the_travel_though_its_ends_are_inside() {
    let arc = Arc { plane: Plane::XY, centre: [mm(240.0), mm(0.0)], sweep: Angle::rev(0.5) };
    let feed = Feed::PerTime(Speed::mm_per_min(500.0));
    let ops = [turn(500.0), OpKind::Arc { to: Position::xyz(240.0, 20.0, 0.0), arc, feed }];
    assert_snapshot!(findings_of(planner_at(Position::xyz(240.0, -20.0, 0.0), 0), ops), @r"
    M0301 Error line 2: X would go to 260 mm (machine coordinate), 10 mm beyond its travel of -250 to 250 mm: X250 is the nearest that works
        help: shift the work offset or the work
    ");
}

#[test]
fn numbers_that_are_none() {
    let nan = OpKind::Line {
        to: Position::xyz(f64::NAN, 0.0, 0.0),
        feed: Feed::PerTime(Speed::mm_per_min(100.0)),
    };
    let never = OpKind::Line { to: Position::xyz(1.0, 0.0, 0.0), feed: Feed::PerTime(Speed::ZERO) };
    let dwell = OpKind::Dwell { time: Time::s(-1.0) };
    assert_snapshot!(findings([turn(500.0), nan, rapid(1e300, 0.0, 0.0), never, dwell]), @r"
    M0302 Error line 2: expected a coordinate within ±1000000 mm, found X NaN
    M0302 Error line 3: expected a coordinate within ±1000000 mm, found X 1e300
    M0303 Error line 4: expected a feed above zero (F), found 0
    M0312 Error line 5: expected a dwell of zero seconds or more, found -1
    ");
}

#[test]
fn an_axis_that_the_machine_lacks() {
    let mut to = Position::default();
    to.rotary[0] = Angle::deg(90.0);
    assert_snapshot!(findings([OpKind::Rapid { to }]), @"M0305 Error line 1: the machine has no A axis, and the program moves it");
}

/// The move with the missing axis is left out, and Z with it: nothing may be planned across that
/// gap.
#[test]
fn an_axis_that_the_machine_lacks_within_a_blended_path_ends_planning() {
    let mode = canon::PathMode::Blend { tolerance: Some(mm(0.1)), merge: None };
    let beside = |mut to: Position| {
        to.parallel[2] = mm(0.25);
        OpKind::Rapid { to }
    };
    let ops = [
        OpKind::PathMode(mode),
        rapid(4.3469, 11.094, 0.0),
        rapid(4.8884, 11.2387, 0.0),
        beside(Position::xyz(4.8884, 11.2387, -0.25)),
        beside(Position::xyz(6.0683, 11.6625, -0.25)),
        beside(Position::xyz(7.0, 12.0, -0.25)),
    ];
    assert_snapshot!(findings(ops), @"M0305 Error line 4: the machine has no W axis, and the program moves it");
}

#[test]
fn a_spindle_that_stands_still_while_cutting() {
    let per_revolution = Feed::PerRevolution(Lead::mm_per_rev(0.1));
    let ops = [
        line(1.0, 0.0, 0.0, 100.0),
        line(2.0, 0.0, 0.0, 100.0),
        OpKind::Line { to: Position::xyz(3.0, 0.0, 0.0), feed: per_revolution },
    ];
    assert_snapshot!(findings(ops), @r"
    M0307 Warning line 1: cutting feed with the spindle at rest
        help: order M3 or M4 with an S above zero before the first cut
    M0306 Error line 3: a feed per revolution (G95) with the spindle at rest would never move: order M3 or M4 with an S above zero first
    ");
}

#[test]
fn a_spindle_order_it_cannot_obey() {
    let css = SpindleOrder::ConstantSurfaceSpeed { speed: Speed::mm_per_s(2000.0), limit: None };
    let ops = [
        turn(12_000.0),
        OpKind::Spindle { spindle: 0, order: css },
        OpKind::Spindle { spindle: 3, order: SpindleOrder::Stop },
    ];
    assert_snapshot!(findings(ops), @r"
    M0308 Error line 1: S12000 is above the spindle's highest speed: S10000 works
    M0310 Error line 2: constant surface speed (G96) is for a spindle that turns the work, and this one turns the tool: give rpm with G97 S
        help: on a lathe, lathe = true in the machine's file says that its first spindle turns the work
    M0313 Error line 3: the machine has 1 spindle(s), found an order for spindle 3, counted from 0
    ");
}

#[test]
fn a_feed_above_the_axes_is_said_once() {
    assert_snapshot!(findings([turn(500.0), line(9.0, 0.0, 0.0, 9e4), line(0.0, 0.0, 0.0, 9e4)]), @r"
    M0304 Warning line 2: a feed of 90000 mm/min is faster than the axes can along this path: it runs at 50000
        help: said once; later moves may be slowed down likewise
    ");
}

/// Of rotary axes alone the feed is in degrees.
#[test]
fn a_feed_above_a_rotary_axis_is_said_in_degrees() {
    let mut limits = common::machine();
    limits.axes[5] = Some(common::axis(-36_000.0, 36_000.0, 1.5)); // C, in degrees
    let to =
        Position { rotary: [Angle::ZERO, Angle::ZERO, Angle::deg(90.0)], ..Position::default() };
    let feed = Feed::Duration(Time::s(0.01)); // 9000 degrees a second
    let start = plan::Start { position: Position::default(), tool: 0 };
    let tools = canon::ToolLibrary::new([]);
    let planner = plan::Planner::new(limits, tools, common::OPTIONS, start);
    let found = findings_of(planner, [turn(500.0), OpKind::Line { to, feed }]);
    assert_snapshot!(found, @r"
    M0304 Warning line 2: a feed of 540000 degrees a minute is faster than the axes can along this path: it runs at 50000
        help: said once; later moves may be slowed down likewise
    ");
}

#[test]
fn a_tool_that_the_table_lacks() {
    assert_snapshot!(findings([change(77)]), @r"
    M0309 Error line 1: T77 is not in the tool table
        help: add it to the table, or let missing tools be stood in for
    ");
}

#[test]
fn a_lead_times_speed_that_the_axis_cannot_follow() {
    let mut slow = common::machine();
    let z = slow.axes[2].as_mut().unwrap();
    z.feed_speed = CoordinateSpeed::linear(Speed::mm_per_min(5000.0));
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.25, 5500.0);
    let start = plan::Start { position: t.start, tool: 5 };
    let planner = plan::Planner::new(slow, common::tools(), common::OPTIONS, start);
    assert_snapshot!(findings_of(planner, [OpKind::Tap(t)]), @"M0320 Error line 1: S5500 is too fast for this tap: Z feeds at 5000 mm/min at most, and 1.25 mm per revolution need 6875; S4000 works (with G94: F5000)");
}

#[test]
fn a_speed_above_the_tapping_maximum() {
    assert_snapshot!(tap_findings(2, tap(0.0, 0.0, 2.0, -20.0, 1.0, 6500.0)), @"M0321 Error line 1: S6500 is too fast for this tap: the spindle taps at 6000 rpm at most; S6000 works (with G94: F6000)");
}

#[test]
fn a_tap_that_is_too_heavy_for_the_spindle() {
    let mut weak = common::machine();
    weak.spindles[0].peak_torque = units::Torque::n_m(3.0);
    weak.spindles[0].peak_power = units::Power::w(500.0);
    let planner = |tool, t: canon::Tap| {
        let start = plan::Start { position: t.start, tool };
        plan::Planner::new(weak.clone(), common::tools(), common::OPTIONS, start)
    };
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.25, 3000.0);
    assert_snapshot!(findings_of(planner(5, t), [OpKind::Tap(t)]), @r"
    M0331 Error line 1: M8x1.25 needs 3.625 N·m here, and the spindle has 2.4 N·m for cutting
        help: drill a wider hole within the tolerance, or take a smaller tap or a stronger spindle
    ");
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.0, 3000.0);
    assert_snapshot!(findings_of(planner(2, t), [OpKind::Tap(t)]), @"M0331 Error line 1: S3000 is too fast for this tap: against 1.726 N·m of cut the spindle does not reach it; S1882 works (with G94: F1882)");
}

#[test]
fn a_return_faster_than_possible_is_slowed_down() {
    let fast_return =
        canon::Tap { return_spin: Spin::rpm(9000.0), ..tap(0.0, 0.0, 2.0, -20.0, 1.0, 4500.0) };
    assert_snapshot!(tap_findings(2, fast_return), @r"
    M0324 Note line 1: no hole was drilled here by this program: it is taken to be there, deep enough and of the right size
    M0332 Warning line 1: the return at S9000 is faster than spindle and axis can tap: it runs at S6000
    ");
}

#[test]
fn a_return_acceleration_beyond_the_drives_is_refused_and_one_that_no_ramp_obeys_too() {
    use canon::ReturnAcceleration::Limit;
    let asked = |accel: f64| canon::Tap {
        return_acceleration: Limit(units::SpinAccel::rev_per_s2(accel)),
        ..tap(0.0, 0.0, 2.0, -20.0, 1.0, 3000.0)
    };
    // (0.9·42 − 0.3 − 1.726) N·m / (2π·0.01 kg·m²) = 569.3 rev/s²
    assert_snapshot!(tap_findings(2, asked(900.0)), @"M0344 Error line 1: a return acceleration of 900 rev/s² is more than spindle and Z give from rest, 569.356 rev/s²: I569 works");
    assert!(!tap_findings(2, asked(569.0)).contains("M0344"));
    let t = asked(100.0);
    let forced = plan::Options { force_ramp: Some(units::Time::s(0.3)), ..common::OPTIONS };
    let start = plan::Start { position: t.start, tool: 2 };
    let planner = plan::Planner::new(common::machine(), common::tools(), forced, start);
    assert_snapshot!(findings_of(planner, [OpKind::Tap(t)]), @"M0345 Error line 1: a return acceleration (I) cannot be obeyed here, because the run-up of every tap is set to a time: leave I out");
}

#[test]
fn deeper_than_the_flutes() {
    assert_snapshot!(tap_findings(2, tap(0.0, 0.0, 2.0, -40.0, 1.0, 600.0)), @"M0322 Error line 1: T2 M6x1 can cut 32 mm deep before its flutes end, found 40 mm: Z-32 is the deepest that works");
}

#[test]
fn deeper_than_the_hole() {
    assert_snapshot!(drilled_and_tapped(1, -20.0, 2, tap(10.0, 10.0, 2.0, -20.0, 1.0, 3000.0)), @"M0323 Error line 9: the tap goes 20 mm deep, but the hole has its full diameter only down to 18.498 mm: Z-18.497 is the deepest that works");
    // 118° on 5 mm: a point of 2.5/tan 59° = 1.502 mm, deeper than the hole
    assert_snapshot!(drilled_and_tapped(1, -1.0, 2, tap(10.0, 10.0, 2.0, -20.0, 1.0, 3000.0)), @"M0323 Error line 9: the tap goes 20 mm deep, but the hole has its full diameter nowhere: drill it 21.502 mm deep, of which 1.502 mm is the drill's point");
}

#[test]
fn beside_its_hole() {
    let tap = tap(10.4, 10.3, 2.0, -20.0, 1.0, 3000.0);
    let [x, y, z] = tap.start.linear.map(units::Length::value);
    let found = findings([
        change(1),
        turn(2000.0),
        rapid(10.0, 10.0, -128.0),
        hole(10.0, 10.0, -30.0),
        line(10.0, 10.0, -160.0, 300.0),
        rapid(10.0, 10.0, -128.0),
        change(2),
        rapid(x, y, z),
        OpKind::Tap(tap),
    ]);
    assert_snapshot!(found, @r"
    M0335 Error line 9: the tap would meet the hole of 5 mm drilled here 0.5 mm off its centre
        help: tap at the place that was drilled
    ");
}

#[test]
fn in_a_hole_that_the_taps_own_core_does_not_enter() {
    assert_snapshot!(drilled_and_tapped(1, -30.0, 5, tap(10.0, 10.0, 2.0, -20.0, 1.25, 3000.0)), @r"
    M0325 Error line 9: expected a hole of 6.647 to 6.912 mm for M8x1.25, found 5 mm
        help: the tap's own core does not go into this hole
    ");
}

#[test]
fn in_a_hole_of_the_wrong_diameter() {
    assert_snapshot!(drilled_and_tapped(6, -25.0, 2, tap(10.0, 10.0, 2.0, -20.0, 1.0, 3000.0)), @r"
    M0325 Warning line 9: expected a hole of 4.917 to 5.153 mm for M6x1, found 5.6 mm
        help: the thread will be too shallow for 6H
    ");
    assert_snapshot!(drilled_and_tapped(4, -25.0, 2, tap(10.0, 10.0, 2.0, -20.0, 1.0, 3000.0)), @r"
    M0325 Error line 9: expected a hole of 4.917 to 5.153 mm for M6x1, found 6.8 mm
        help: no thread is left to cut in this hole
    ");
    assert_snapshot!(drilled_and_tapped(7, -25.0, 5, tap(10.0, 10.0, 2.0, -20.0, 1.25, 3000.0)), @r"
    M0325 Warning line 9: expected a hole of 6.647 to 6.912 mm for M8x1.25, found 6.5 mm
        help: the tap cuts too much and may break
    ");
}

#[test]
fn with_the_wrong_tool_hand_or_lead() {
    assert_snapshot!(tap_findings(0, tap(0.0, 0.0, 2.0, -20.0, 1.0, 600.0)), @"M0329 Error line 1: there is no tool in the spindle to tap with");
    assert_snapshot!(tap_findings(1, tap(0.0, 0.0, 2.0, -20.0, 1.0, 600.0)), @"M0328 Error line 1: expected a tap in the spindle, found T1 (a drill)");
    assert_snapshot!(tap_findings(3, tap(0.0, 0.0, 2.0, -20.0, 1.0, 600.0)), @r"
    M0327 Error line 1: expected a tap of the other hand: T3 M6x1 LH is left-hand
        help: use G74, or M4 before G33.1
    ");
    assert_snapshot!(tap_findings(2, tap(0.0, 0.0, 2.0, -20.0, 1.25, 600.0)), @"M0326 Error line 1: expected the tap's lead of 1 mm per revolution (M6x1), found 1.25: F600 with G94 and S600, F1 with G95, K1 with G33.1");
}

#[test]
fn with_another_axis_moving() {
    let t = tap(5.0, 0.0, 2.0, -20.0, 1.0, 600.0);
    let elsewhere = Position::xyz(0.0, 0.0, t.start.linear[2].value());
    assert_snapshot!(findings_of(planner_at(elsewhere, 2), [OpKind::Tap(t)]), @"M0330 Error line 1: expected only Z to move in a tap, found X moving by 5 mm: move there in a block before");
}

#[test]
fn a_tap_of_no_depth_lead_or_speed() {
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.0, 600.0);
    let none = [
        canon::Tap { bottom: t.start.linear[2], ..t },
        canon::Tap { lead: Lead::ZERO, ..t },
        canon::Tap { spin: Spin::ZERO, ..t },
        canon::Tap { bottom: Length::mm(f64::NAN), ..t },
    ];
    assert_snapshot!(findings_of(planner_at(t.start, 2), none.map(OpKind::Tap)), @r"
    M0333 Error line 1: a tap needs a depth, a lead and a speed above zero, found a stroke of 0 mm, 1 mm per revolution, S600
    M0333 Error line 2: a tap needs a depth, a lead and a speed above zero, found a stroke of -22 mm, 0 mm per revolution, S600
    M0333 Error line 3: a tap needs a depth, a lead and a speed above zero, found a stroke of -22 mm, 1 mm per revolution, S0
    M0333 Error line 4: a tap needs a depth, a lead and a speed above zero, found a stroke of NaN mm, 1 mm per revolution, S600
    ");
}

#[test]
fn all_moves_beyond_one_end_of_the_travel_are_one_finding_with_the_worst() {
    let text = findings((0..100).map(|i| rapid(300.0 + f64::from(i % 50), 0.0, 0.0)));
    assert_eq!(text.matches("M0301").count(), 1, "{text}");
    assert!(
        text.contains("line 1: X would go to 349 mm (machine coordinate), 99 mm beyond its travel"),
        "{text}"
    );
    assert!(
        text.contains(", in line 50, the worst of 100 such moves: X250 is the nearest that works"),
        "{text}"
    );
}

#[test]
fn many_findings_of_a_kind_are_counted_after_the_fortieth() {
    let text = findings((0..100).map(|_| line(10.0, 0.0, 0.0, 0.0)));
    assert_eq!(text.matches("M0303 Error").count(), 40);
    assert!(text.contains("60 more findings of the kind M0303"), "{text}");
}

/// A machine whose spindle coasts when its control dies.
fn coasting(tool: u32, t: canon::Tap) -> plan::Planner {
    let mut machine = common::machine();
    machine.tapping.coasts = plan::Coasts { on_link_loss: true, on_power_loss: false };
    let start = plan::Start { position: t.start, tool };
    plan::Planner::new(machine, common::tools(), common::OPTIONS, start)
}

#[test]
fn a_tap_that_would_coast_into_the_ground_is_warned_of_with_the_speed_that_survives() {
    let t = tap(0.0, 0.0, 2.0, -20.0, 1.0, 3000.0);
    assert_snapshot!(findings_of(coasting(2, t), [OpKind::Tap(t)]), @r#"
    M0338 Warning line 1: if the control dies in this tap its spindle coasts: from S3000 it goes up to 45.7 mm deeper than programmed, its flutes reach 12 mm more, and the tap breaks; S1480 survives that
        help: [drives] on_link_loss = "coupled-stop" or "quick-stop" brakes instead, at every speed
    M0324 Note line 1: no hole was drilled here by this program: it is taken to be there, deep enough and of the right size
    "#);
    assert!(!tap_findings(2, t).contains("M0338"), "a spindle that brakes does not coast");
    // up to the speed that is said nothing is said, and from the next one on something is
    let said = findings_of(coasting(2, t), [OpKind::Tap(t)]);
    let works: f64 = said
        .split("; S")
        .nth(1)
        .and_then(|rest| rest.split(' ').next()?.parse().ok())
        .expect("a speed is said");
    for (rpm, warned) in [(works, false), (works + 10.0, true), (100.0, false)] {
        let t = tap(0.0, 0.0, 2.0, -20.0, 1.0, rpm);
        let found = findings_of(coasting(2, t), [OpKind::Tap(t)]);
        assert_eq!(found.contains("M0338"), warned, "S{rpm}: {found}");
    }
}
