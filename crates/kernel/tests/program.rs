//! Steps one after the other: moves, waits, spindle, tool, stops.
use crate::common::*;
use bus::State;
use canon::{Arc, Plane, Position};
use kernel::{EventKind, Full, Kernel, Pause, QUEUE};
use motion::{Move, Path, Phase, Profile};
use plan::{SpindleStep, Step, StepKind};
use sim::{Tool, ToolKind};
use units::{Angle, Length, Orientation, Spin, Time, TurnDirection};

const ZERO: Position = Position::xyz(0.0, 0.0, 0.0);

fn run_here(steps: &[StepKind]) -> Run {
    let machine = machine(1);
    let seen = run(&machine, &control(&machine), steps);
    assert_eq!(seen.kernel.faults(), []);
    assert_eq!(seen.kernel.report().state, State::Ended);
    seen
}

fn true_position(seen: &Run) -> [f64; 3] {
    let last = seen.samples.last().expect("there are samples");
    [last.axis(0).value(), last.axis(1).value(), last.axis(2).value()]
}

/// How long each state lasted, s.
fn lasted(seen: &Run, state: State) -> f64 {
    seen.samples.iter().filter(|s| s.report.state == state).count() as f64 * PERIOD.value()
}

#[test]
fn moves_end_where_they_should_within_the_in_position_window() {
    let there = Position::xyz(120.0, -40.0, -60.0);
    let seen = run_here(&[line(ZERO, there, 300.0, true), StepKind::End]);
    for (is, should) in true_position(&seen).into_iter().zip([120.0, -40.0, -60.0]) {
        assert!((is - should).abs() < 0.005, "{is} mm, {should} mm");
    }
}

#[test]
fn a_feed_move_is_followed_within_10_um_all_the_way() {
    let seen = run_here(&[line(ZERO, Position::xyz(80.0, 0.0, -60.0), 100.0, true), StepKind::End]);
    let off = |s: &bus::Sample, i: usize| {
        (s.axis(i) - s.command.axes[i].position).of_linear().in_um().abs()
    };
    let worst = seen.samples.iter().skip(100).map(|s| off(s, 0).max(off(s, 2))).fold(0.0, f64::max);
    assert!(worst < 10.0, "{worst} µm");
}

#[test]
fn a_circle_comes_back_to_where_it_began() {
    let at = Position::xyz(20.0, 0.0, 0.0);
    let arc =
        Arc { plane: Plane::XY, centre: [Length::ZERO, Length::ZERO], sweep: Angle::rev(1.0) };
    let path = Path::Arc { from: at, to: at, arc };
    let StepKind::Move(mut circle) =
        line(ZERO, Position::xyz(path.length(), 0.0, 0.0), 100.0, true)
    else {
        unreachable!("a line is a move")
    };
    circle.path = path;
    let seen = run_here(&[line(ZERO, at, 100.0, false), StepKind::Move(circle), StepKind::End]);
    let radius = |s: &bus::Sample| f64::hypot(s.axis(0).value(), s.axis(1).value());
    let on_circle = seen.samples.iter().filter(|s| s.report.op == 1);
    let worst = on_circle.map(|s| (radius(s) - 20.0).abs() * 1e3).fold(0.0, f64::max);
    assert!(worst < 10.0, "{worst} µm off the circle");
}

#[test]
fn a_dwell_lasts_as_long_as_it_says() {
    let seen = run_here(&[StepKind::Dwell(Time::s(0.25)), StepKind::End]);
    assert!((lasted(&seen, State::Dwell) - 0.25).abs() < 2.0 * PERIOD.value());
}

#[test]
fn moves_without_exact_stop_follow_each_other_without_a_gap() {
    let (a, b) = (Position::xyz(30.0, 0.0, 0.0), Position::xyz(60.0, 0.0, 0.0));
    let seen = run_here(&[line(ZERO, a, 100.0, false), line(a, b, 100.0, false), StepKind::End]);
    let planned = |kind: &StepKind| match kind {
        StepKind::Move(order) => order.profile.duration(),
        _ => 0.0,
    };
    let planned_s = 2.0 * planned(&line(ZERO, a, 100.0, false));
    assert!((lasted(&seen, State::Rapid) - planned_s).abs() < 2.0 * PERIOD.value());
}

#[test]
fn the_spindle_comes_to_speed_is_awaited_and_stops_again() {
    let seen = run_here(&[
        turn(0.0, 6000.0),
        await_speed(),
        turn(6000.0, 0.0),
        await_speed(),
        StepKind::End,
    ]);
    let speeds: Vec<f64> = seen
        .events
        .iter()
        .filter_map(|e| match e.kind {
            EventKind::SpindleAtSpeed { spin, .. } => Some(spin.in_rpm()),
            _ => None,
        })
        .collect();
    assert_eq!(speeds, [6000.0, 0.0]);
    let top = seen.samples.iter().map(|s| s.truth.unwrap().spins[0].in_rpm()).fold(0.0, f64::max);
    assert!((5990.0..6030.0).contains(&top), "{top} rpm");
}

#[test]
fn a_turning_spindle_that_is_oriented_stops_and_is_held_at_the_angle() {
    let orient = StepKind::Spindle {
        spindle: 0,
        order: SpindleStep::Orient { to: Orientation::shortest(Angle::deg(135.0)), longest: None },
    };
    let seen = run_here(&[turn(0.0, 3000.0), await_speed(), orient, StepKind::End]);
    let angle = seen.samples.last().unwrap().spindle(0).value();
    let off = Angle::rev(angle - 0.375 - (angle - 0.375).round());
    assert!(off.abs() < Angle::deg(0.1), "{}°", off.in_deg());
    // and it has stopped once, not run back
    let slowest =
        seen.samples.iter().map(|s| s.truth.unwrap().spins[0].in_rpm()).fold(0.0, f64::min);
    assert!(slowest > -310.0, "{slowest} rpm");
}

#[test]
fn a_held_spindle_turns_to_its_next_angle_in_the_direction_that_it_is_told() {
    let orient = |degrees: f64, direction| {
        let to = Orientation { angle: Angle::deg(degrees), direction };
        StepKind::Spindle { spindle: 0, order: SpindleStep::Orient { to, longest: None } }
    };
    let (on, back) = (TurnDirection::Forward, TurnDirection::Backward);
    for (direction, expected) in [(on, 330.0), (back, -30.0), (TurnDirection::Shortest, -30.0)] {
        let first = run_here(&[orient(90.0, TurnDirection::Shortest), StepKind::End]);
        let both = [orient(90.0, TurnDirection::Shortest), orient(60.0, direction), StepKind::End];
        let seen = run_here(&both);
        let stood = |run: &Run| Angle::rev(run.samples.last().unwrap().spindle(0).value());
        let turned = (stood(&seen) - stood(&first)).in_deg();
        assert!((turned - expected).abs() < 0.2, "{direction:?}: {turned}°");
    }
}

#[test]
fn a_turn_that_the_ramp_does_not_fit_gets_there_all_the_same() {
    let StepKind::Spindle { order, .. } = turn(1000.0, 2000.0) else {
        unreachable!("it is a spindle step")
    };
    let wrong = StepKind::Spindle { spindle: 0, order }; // the spindle stands, the ramp begins at 1000 rpm
    let seen = run_here(&[wrong, await_speed(), StepKind::End]);
    let rpm = seen.samples.last().unwrap().truth.unwrap().spins[0].in_rpm();
    assert!((rpm - 2000.0).abs() < 40.0, "{rpm} rpm");
}

#[test]
fn a_move_per_revolution_follows_the_real_spindle() {
    // 0.2 mm a revolution over 10 mm: the profile's time is revolutions
    let mut profile = Profile::EMPTY;
    assert!(profile.push(Phase { duration: 50.0, s: 0.0, v: 0.2, a: 0.0, j: 0.0 }));
    let path = Path::Line { from: ZERO, to: Position::xyz(10.0, 0.0, 0.0) };
    let feed = Move {
        path,
        profile,
        rapid: false,
        per_revolution: true,
        exact_stop: false,
        floats: false,
        programmed: None,
    };
    let seen =
        run_here(&[turn(0.0, 600.0), await_speed(), StepKind::Move(feed.into()), StepKind::End]);
    // 50 revolutions at 10 rev/s
    assert!((lasted(&seen, State::Feed) - 5.0).abs() < 0.02, "{}", lasted(&seen, State::Feed));
    let feeding: Vec<_> = seen.samples.iter().filter(|s| s.report.state == State::Feed).collect();
    let (a, b) = (feeding[2000], feeding[16_000]);
    let way = (b.axis(0) - a.axis(0)).value();
    let turns = (b.spindle(0) - a.spindle(0)).value();
    assert!((way / turns - 0.2).abs() < 1e-4, "{} mm/rev", way / turns);
}

#[test]
fn the_tool_change_waits_for_the_changer() {
    let mut machine = machine(0);
    let kind = ToolKind::Drill { diameter: Length::mm(5.0), point_angle: Angle::deg(118.0) };
    machine.magazine.push(Tool { number: 7, length: Length::mm(120.0), kind });
    let steps = [StepKind::ChangeTool { tool: 7, by_hand: false }, StepKind::End];
    let seen = run(&machine, &control(&machine), &steps);
    assert!(seen.events.iter().any(|e| e.kind == EventKind::ToolChanged { tool: 7 }));
    let took = lasted(&seen, State::ToolChange);
    assert!((took - machine.tool_change_time.value()).abs() < 0.01, "{took} s");
}

#[test]
fn coolant_is_switched_at_once_and_stays() {
    let on = StepKind::Coolant { mist: false, flood: true };
    let seen = run_here(&[on, StepKind::Dwell(Time::s(0.01)), StepKind::End]);
    assert!(seen.samples.last().unwrap().command.flood);
    assert!(!seen.samples.last().unwrap().command.mist);
}

#[test]
fn a_stop_waits_for_the_operator_and_an_optional_one_only_if_it_is_set() {
    let mut config = control(&machine(0));
    config.pause = Pause::Wait;
    let mut kernel = Kernel::new(config);
    let mut machine = sim::SimulatedMachine::new(machine(0)).expect("it can be built");
    for (op, kind) in
        [StepKind::Pause { optional: true }, StepKind::Pause { optional: false }, StepKind::End]
            .into_iter()
            .enumerate()
    {
        kernel.push(&Step { op: op as u32, line: 1, kind }).expect("there is room");
    }
    let mut feedback = *bus::Machine::feedback(&machine);
    let mut run = |kernel: &mut Kernel| {
        for _ in 0..100 {
            let command = kernel.tick(&feedback);
            feedback = *bus::Machine::exchange(&mut machine, &command);
        }
        kernel.report()
    };
    let waiting = run(&mut kernel);
    assert_eq!((waiting.state, waiting.op), (State::Paused, 1));
    kernel.resume();
    assert_eq!(run(&mut kernel).state, State::Ended);
}

#[test]
fn a_full_queue_says_so_and_takes_no_more() {
    let mut kernel = Kernel::new(control(&machine(0)));
    let step = Step { op: 0, line: 1, kind: StepKind::End };
    for _ in 0..QUEUE {
        assert!(!kernel.is_full());
        kernel.push(&step).expect("there is room");
    }
    assert!(kernel.is_full() && kernel.push(&step) == Err(Full::Steps));
}

#[test]
fn a_spindle_that_turns_before_a_tap_is_stopped_first() {
    let start = Position::xyz(0.0, 0.0, M6.from_mm);
    let seen = run_here(&[
        line(ZERO, start, 300.0, true),
        turn(0.0, 2000.0),
        await_speed(),
        StepKind::Tap(M6.plan()),
        turn(0.0, 1000.0),
        await_speed(),
        StepKind::End,
    ]);
    let tap = seen.events.iter().find_map(|e| match e.kind {
        EventKind::TapEnded(figures) => Some(figures),
        _ => None,
    });
    assert!(tap.expect("the tap ended").sync.max < Length::um(5.0));
    let at_speed = EventKind::SpindleAtSpeed { spindle: 0, spin: Spin::rpm(1000.0) };
    assert!(seen.events.iter().any(|e| e.kind == at_speed), "it turns again after the tap");
}
