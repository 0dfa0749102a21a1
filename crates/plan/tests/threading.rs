//! Turned threads: chains, their corners, and what is refused with the number that works.
mod common;
use canon::{Axis, OpKind, Position, Threading};
use common::{findings, mm, rapid, steps, turn};
use plan::{StepKind, ThreadStretch, TiedCut, WayOut};
use units::{Angle, Lead};

/// The axes of the machine in `common`: 10 m/s² across, 15 m/s² along Z, jerk 500 m/s³.
const JERK: f64 = 5e5;

fn thread(x: f64, z: f64, lead: f64) -> OpKind {
    OpKind::Threading(Threading {
        to: Position::xyz(x, 0.0, z),
        lead: Lead::mm_per_rev(lead),
        start_angle: Angle::ZERO,
        axis: Axis::Z,
        surface: mm(-10.0),
    })
}

fn stretches(kinds: impl IntoIterator<Item = OpKind>) -> Vec<ThreadStretch> {
    let stretch = |step: plan::Step| match step.kind {
        StepKind::Thread(stretch) => Some(stretch),
        _ => None,
    };
    steps(kinds).into_iter().filter_map(stretch).collect()
}

#[test]
fn stretches_one_after_another_are_one_chain_and_a_rapid_ends_it() {
    let found = stretches([
        turn(1000.0),
        rapid(0.0, 0.0, -5.0),
        thread(0.0, -25.0, 2.0),
        thread(2.0, -27.0, 8.0_f64.sqrt()),
        rapid(5.0, 0.0, -5.0),
        thread(5.0, -25.0, 2.0),
    ]);
    let [thread, taper, second] = &found[..] else { panic!("{found:?}") };
    assert_eq!((thread.start, thread.ends), (Some(Angle::ZERO), false));
    assert_eq!((taper.start, taper.ends), (None, true));
    assert_eq!((second.start, second.ends), (Some(Angle::ZERO), true));
    assert_eq!((thread.to_turn, taper.from_turn), (10.0, 10.0));
    assert!((taper.to_turn - 11.0).abs() < 1e-12);
    // Z goes on with the same lead, X begins: the corner is X's alone
    assert!(
        (thread.exit.beyond[0] - 2.0).abs() < 1e-12 && (thread.exit.beyond[2] + 2.0).abs() < 1e-12
    );
    assert_eq!(thread.exit.half, taper.entry.half);
}

#[test]
fn a_run_in_is_as_long_as_acceleration_and_jerk_need_it() {
    let rpm = 3000.0;
    let found = stretches([turn(rpm), rapid(0.0, 0.0, -5.0), thread(0.0, -45.0, 2.0)]);
    let n = rpm / 60.0 * 1.05; // the spindle may be faster than it was told by as much
    let by_accel: f64 = 0.75 * 2.0 * n * n / 15e3;
    let by_jerk = (1.5 * 2.0 * n * n * n / JERK).sqrt();
    assert!((found[0].entry.half - by_accel.max(by_jerk)).abs() < 1e-9, "{found:?}");
}

#[test]
fn a_thread_that_is_too_short_for_its_speed_is_refused_with_the_speed_that_works() {
    let at = |rpm: f64| findings([turn(rpm), rapid(0.0, 0.0, -9.0), thread(0.0, -11.0, 2.0)]);
    let refused = at(6000.0);
    let works: f64 = refused
        .split(": S")
        .nth(1)
        .and_then(|text| text.split(' ').next())
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("{refused}"));
    assert!(refused.starts_with("M0422"), "{refused}");
    assert!(!at(works).contains("M0422"), "{}", at(works));
    assert!(at(works + 1.0).contains("M0422"));
}

#[test]
fn a_lead_that_an_axis_cannot_feed_is_refused_with_the_speed_that_works() {
    // 50 m/min and 5 % for the spindle: 20 mm at S2380
    let at = |rpm: f64| findings([turn(rpm), rapid(0.0, 0.0, -5.0), thread(0.0, -295.0, 20.0)]);
    assert!(at(2500.0).contains("S2380 works"), "{}", at(2500.0));
    assert!(!at(2380.0).contains("M0423"), "{}", at(2380.0));
}

#[test]
fn a_thread_with_a_spindle_at_rest_is_refused_and_a_short_run_in_is_said() {
    let still = findings([rapid(0.0, 0.0, -5.0), thread(0.0, -25.0, 2.0)]);
    assert!(still.contains("M0421"), "{still}");
    let near = findings([turn(3000.0), rapid(0.0, 0.0, -9.9), thread(0.0, -45.0, 2.0)]);
    assert!(near.starts_with("M0426 Warning"), "{near}");
    let far = findings([turn(3000.0), rapid(0.0, 0.0, -5.0), thread(0.0, -45.0, 2.0)]);
    assert_eq!(far, "");
}

fn ways_out(kinds: impl IntoIterator<Item = OpKind>) -> Vec<WayOut> {
    let way_out = |step: plan::Step| match step.kind {
        StepKind::WayOut(way_out) => way_out,
        _ => None,
    };
    steps(kinds).into_iter().filter_map(way_out).collect()
}

#[test]
fn a_pass_is_left_to_where_the_tool_stood_before_it_was_fed_in() {
    for (rpm, lead) in [(1000.0, -2.0), (-1000.0, 2.0)] {
        let found = ways_out([
            turn(rpm),
            rapid(30.0, 0.0, -1.0),
            rapid(11.0, 0.0, -5.0),
            rapid(9.5, 0.0, -5.0),
            thread(9.5, -25.0, 2.0),
        ]);
        let [way_out] = &found[..] else { panic!("{found:?}") };
        assert_eq!((way_out.cut, way_out.infeed), (TiedCut::Thread, Axis::X));
        assert_eq!((way_out.clear, way_out.outward), (mm(11.0), 1.0));
        let pass = way_out.pass.expect("a thread is cut in passes");
        assert_eq!(
            (pass.axis, pass.start, pass.end, pass.from),
            (Axis::Z, mm(-5.0), mm(-25.0), mm(-5.0))
        );
        assert_eq!(pass.lead, Lead::mm_per_rev(lead));
        assert!(way_out.inside(mm(9.5)) == mm(1.5) && way_out.inside(mm(12.0)) == mm(-1.0));
    }
}

#[test]
fn a_thread_in_a_bore_is_left_towards_its_middle() {
    let found = ways_out([
        turn(1000.0),
        rapid(8.0, 0.0, -5.0),
        rapid(9.5, 0.0, -5.0),
        thread(9.5, -25.0, 2.0),
    ]);
    assert_eq!((found[0].clear, found[0].outward), (mm(8.0), -1.0));
}

#[test]
fn a_chain_that_goes_out_farther_than_it_came_in_is_left_as_far() {
    let found = ways_out([
        turn(1000.0),
        rapid(11.0, 0.0, -5.0),
        rapid(9.5, 0.0, -5.0),
        thread(9.5, -25.0, 2.0),
        thread(12.0, -27.5, 12.5_f64.sqrt()),
    ]);
    assert_eq!(found[0].clear, mm(12.0));
}

#[test]
fn a_chain_that_feeds_in_by_itself_is_left_to_where_it_began() {
    let found = ways_out([
        turn(1000.0),
        rapid(30.0, 0.0, -1.0),
        rapid(11.0, 0.0, -5.0),
        thread(9.0, -7.0, 8.0_f64.sqrt()),
        thread(9.0, -25.0, 2.0),
    ]);
    assert_eq!(found[0].clear, mm(11.0));
    let pass = found[0].pass.expect("a thread is cut in passes");
    // the straight part begins a turn later, and the whole chain where it was
    assert_eq!((pass.start, pass.from), (mm(-7.0), mm(-5.0)));
    assert!((pass.angle - Angle::rev(1.0)).abs().value() < 1e-12, "{pass:?}");
}
