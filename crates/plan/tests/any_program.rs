//! Whatever a program says, the planner answers with steps that hang together or with a sentence.
use crate::common;
use crate::common::{OPTIONS, machine, mm, program, tools};
use canon::{Arc, Feed, Hole, OpKind, PathMode, Plane, Position, SpindleOrder, Tap};
use motion::Shape;
use plan::{Planner, Start, preflight};
use plan::{SpindleStep, Step, StepKind};
use proptest::prelude::*;
use test_support::size;
use units::{Angle, Lead, Orientation, Speed, Spin, Time};

/// Mostly sensible numbers, and all that f64 has besides.
fn number(span: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -span..span,
        1 => prop_oneof![Just(0.0), Just(1e300), Just(-1e300), Just(f64::NAN), Just(f64::INFINITY), Just(5e-324)],
    ]
}

fn position() -> impl Strategy<Value = Position> {
    (number(260.0), number(210.0), number(150.0))
        .prop_map(|(x, y, z)| Position::xyz(x, y, z - 150.0))
}

fn feed() -> impl Strategy<Value = Feed> {
    prop_oneof![
        number(1e4).prop_map(|x| Feed::PerTime(Speed::mm_per_min(x))),
        number(3.0).prop_map(|x| Feed::PerRevolution(Lead::mm_per_rev(x))),
        number(10.0).prop_map(|x| Feed::Duration(Time::s(x))),
    ]
}

fn tap() -> impl Strategy<Value = Tap> {
    let tap = (position(), number(40.0), number(3.0), number(7000.0), number(7000.0), number(2.0));
    (tap, any::<bool>()).prop_map(|((start, depth, lead, rpm, back, dwell), down)| Tap {
        axis: canon::Axis::Z,
        start,
        bottom: start.linear[2] - mm(if down { depth.abs() } else { depth }),
        surface: start.linear[2],
        zero: start.linear[2],
        own_zero: None,
        lead: Lead::mm_per_rev(lead),
        spin: Spin::rpm(rpm),
        return_spin: Spin::rpm(back),
        return_acceleration: canon::ReturnAcceleration::AsSet,
        dwell: Time::s(dwell),
        start_angle: None,
        peck: None,
    })
}

fn op() -> impl Strategy<Value = OpKind> {
    let arc = (position(), number(100.0), number(100.0), number(3.0), feed()).prop_map(
        |(to, a, b, sweep, feed)| {
            let arc = Arc { plane: Plane::XY, centre: [mm(a), mm(b)], sweep: Angle::rev(sweep) };
            OpKind::Arc { to, arc, feed }
        },
    );
    let hole = (position(), number(100.0)).prop_map(|(at, z)| {
        OpKind::Hole(Hole {
            axis: canon::Axis::Z,
            at,
            bottom: mm(z),
            surface: at.linear[2],
            zero: at.linear[2],
            own_zero: None,
        })
    });
    prop_oneof![
        position().prop_map(|to| OpKind::Rapid { to }),
        (position(), feed()).prop_map(|(to, feed)| OpKind::Line { to, feed }),
        arc,
        hole,
        tap().prop_map(OpKind::Tap),
        (0_u8..3, number(12_000.0)).prop_map(|(spindle, x)| OpKind::Spindle {
            spindle,
            order: SpindleOrder::Turn(Spin::rpm(x))
        }),
        Just(OpKind::Spindle {
            spindle: 0,
            order: SpindleOrder::Orient { to: Orientation::shortest(Angle::ZERO), longest: None }
        }),
        (0_u32..9).prop_map(|number| OpKind::ChangeTool { number }),
        number(5.0).prop_map(|x| OpKind::Dwell { time: Time::s(x) }),
        Just(OpKind::PathMode(PathMode::Blend { tolerance: None, merge: None })),
        Just(OpKind::Coolant { mist: false, flood: true }),
        Just(OpKind::Pause { optional: true }),
        Just(OpKind::End),
    ]
}

fn planner() -> Planner {
    Planner::new(machine(), tools(), OPTIONS, Start::default())
}

/// Each step begins where the one before has ended, in place and in spindle speed; all numbers are
/// finite.
fn assert_hangs_together(steps: &[Step]) {
    let (mut at, mut spin, mut awaited, mut op) = (Position::default(), Spin::ZERO, true, 0);
    let near =
        |a: Position, b: Position| (0..3).all(|i| (a.linear[i] - b.linear[i]).abs() < mm(1e-6));
    for step in steps {
        assert!(step.op >= op, "steps out of order");
        op = step.op;
        match &step.kind {
            StepKind::Move(m) => {
                assert!(near(*m.path.from(), at), "begins at {:?}, not at {at:?}", m.path.from());
                assert!(m.profile.duration() > 0.0 && m.profile.duration().is_finite());
                assert_eq!(m.profile.end().s, m.path.length());
                assert!(m.rapid || awaited, "a cut before the spindle is at speed");
                at = *m.path.to();
            }
            StepKind::Follow(m) => {
                let place = |s: f64| {
                    let q = m.piece.at(s).q;
                    Position::xyz(q[0], q[1], q[2])
                };
                assert!(near(place(m.phases[0].s), at), "goes on from elsewhere");
                assert!(m.duration() > 0.0 && m.duration().is_finite());
                assert!(m.piece.rapid || awaited, "a cut before the spindle is at speed");
                at = place(m.at(m.duration()).0);
            }
            StepKind::Thread(stretch) => {
                let at_turn = |turn: f64| {
                    let q = stretch.at(turn).q;
                    Position::xyz(q[0], q[1], q[2])
                };
                if stretch.start.is_some() {
                    assert!(near(at_turn(stretch.begins()), at), "a thread from elsewhere");
                }
                assert!(
                    spin != Spin::ZERO && awaited,
                    "a thread with a spindle that is not at speed"
                );
                at = at_turn(stretch.is_over_at());
            }
            StepKind::Tap(t) => {
                assert!(
                    near(t.start, at) && spin == Spin::ZERO && awaited,
                    "a tap from elsewhere or from speed"
                );
                let turns = (t.bottom - t.start.linear[2]) / t.lead;
                assert!(
                    (t.inward.end().s - turns.value().abs()).abs() < 1e-9
                        && t.spin / t.return_spin < 0.0
                );
                assert!(turns / t.spin > Time::ZERO, "the tap does not turn inwards");
                assert_eq!(t.outward.end().s, t.inward.end().s);
            }
            StepKind::Spindle { order: SpindleStep::Turn { spin: to, ramp }, .. } => {
                assert!(awaited, "a ramp from a speed that was not reached");
                assert!(
                    (ramp.at(0.0).v - spin.value()).abs() < 1e-9
                        && (ramp.end().v - to.value()).abs() < 1e-9
                );
                (spin, awaited) = (*to, false);
            }
            StepKind::Spindle { order: SpindleStep::Surface { .. }, .. } => {
                panic!("this machine's spindle turns the tool")
            }
            StepKind::Spindle { order: SpindleStep::AwaitSpeed, .. } => awaited = true,
            StepKind::Spindle { order: SpindleStep::Orient { .. }, .. } => {
                assert_eq!(spin, Spin::ZERO);
            }
            StepKind::Spindle { order: SpindleStep::Throw(throw), .. } => {
                assert!(awaited, "a ramp begins before the last one is over");
                (spin, awaited) = (throw.then, false);
            }
            StepKind::ChangeTool { .. } => {
                assert_eq!((spin, awaited, at.linear[2]), (Spin::ZERO, true, mm(0.0)));
            }
            StepKind::Engage(gear) => {
                assert!(gear.follower != gear.master && awaited && spin != Spin::ZERO);
            }
            StepKind::WayOut(_)
            | StepKind::Release { .. }
            | StepKind::Superpose(_)
            | StepKind::AwaitFades
            | StepKind::Revolve { .. }
            | StepKind::Consult(_)
            | StepKind::Probe { .. }
            | StepKind::Dwell(_)
            | StepKind::Coolant { .. }
            | StepKind::FeedOverride(_)
            | StepKind::SpindleOverride(_)
            | StepKind::Output(_)
            | StepKind::Input(_)
            | StepKind::Inputs(_)
            | StepKind::Count(_)
            | StepKind::Guard { .. }
            | StepKind::UserCode(_)
            | StepKind::Pause { .. }
            | StepKind::End => {}
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(256, 2560), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_program_is_planned_or_refused(kinds in prop::collection::vec(op(), 1..40)) {
        let ops = program(kinds);
        let flight = preflight(planner(), &ops);
        let mut steps = Vec::new();
        let mut planner = planner();
        for (i, op) in (0..).zip(&ops) {
            planner.push(i, op, &mut |step| steps.push(step));
        }
        planner.finish(&mut |step| steps.push(step));
        assert_eq!(planner.duration(), flight.duration);
        assert!(flight.duration.is_finite());
        for finding in &flight.findings {
            assert!(finding.span.line > 0 && !finding.message.is_empty());
        }
        if !flight.is_refused() {
            assert_hangs_together(&steps);
        }
    }

    #[test]
    fn any_program_has_a_sample_whose_times_are_finite(kinds in prop::collection::vec(op(), 1..40)) {
        let blended = OpKind::PathMode(PathMode::Blend { tolerance: Some(mm(0.05)), merge: None });
        let mut planner = planner().sampling();
        for (i, op) in (0..).zip(&program([vec![blended], kinds].concat())) {
            planner.push(i, op, &mut |_| ());
        }
        planner.finish(&mut |_| ());
        let sample = planner.take_sample().unwrap();
        assert!(sample.rough.is_finite() && sample.rough >= Time::ZERO);
        for stretch in &sample.kept {
            let time = stretch.plan(&machine()).total();
            assert!(time.is_finite() && time >= Time::ZERO);
        }
    }

    #[test]
    fn a_program_of_sound_moves_hangs_together(
        places in prop::collection::vec((-250.0..250.0, -200.0..200.0, -300.0..0.0, 0..6), 1..60),
    ) {
        let mut kinds = vec![common::turn(1000.0)];
        for (x, y, z, what) in places {
            let to = Position::xyz(x, y, z);
            match what {
                0 => kinds.push(common::turn(x * 16.0 + 6000.0)),
                1 => kinds.extend([
                    common::change(2),
                    OpKind::Rapid { to: Position::xyz(x, y, z / 2.0 - 50.0) },
                    OpKind::Tap(Tap {
                        start: Position::xyz(x, y, z / 2.0 - 50.0),
                        surface: mm(z / 2.0 - 52.0),
                        zero: mm(z / 2.0 - 52.0),
                        own_zero: None,
                        bottom: mm(z / 2.0 - 60.0),
                        ..common::tap(0.0, 0.0, 2.0, -8.0, 1.0, 3000.0)
                    }),
                    common::turn(500.0),
                ]),
                2 => kinds.push(OpKind::Line { to, feed: Feed::PerRevolution(Lead::mm_per_rev(0.1)) }),
                3 => kinds.push(OpKind::Line { to, feed: Feed::PerTime(Speed::mm_per_min(900.0)) }),
                4 => kinds.push(OpKind::Coolant { mist: true, flood: false }),
                _ => kinds.push(OpKind::Rapid { to }),
            }
        }
        let ops = program(kinds);
        let mut steps = Vec::new();
        let mut planner = planner();
        for (i, op) in (0..).zip(&ops) {
            planner.push(i, op, &mut |step| steps.push(step));
        }
        planner.finish(&mut |step| steps.push(step));
        assert!(!planner.take_findings().iter().any(diag::Diagnostic::is_error));
        assert_hangs_together(&steps);
    }
}
