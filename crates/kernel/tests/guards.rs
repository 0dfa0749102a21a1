//! What the kernel looks at itself in each period, each provoked: a plan with a defect, a machine
//! that lies, a spindle that does not obey. The alarm comes within a period, the refused setpoint
//! is never sent, and everything comes to rest.
use crate::common::*;
use crate::operated;
use bus::{Command, Feedback, Machine, State, Truth};
use canon::{Axis, Feed, Op, OpKind, PathMode, Position, Span};
use kernel::{Config, FaultKind, Kernel, Subject};
use motion::{Bounds, Limits, Move, Path, Phase, Profile};
use plan::{Step, StepKind};
use sim::SimulatedMachine;
use units::{Angle, Coordinate, Length, Speed, Spin, Time, Torque};

const H: f64 = PERIOD.value();
/// Limits of each axis: mm/s, mm/s², mm/s³.
const SPEED: f64 = 500.0;
const ACCEL: f64 = 5000.0;
const JERK: f64 = 200_000.0;

/// The test's control, with limits, and with an end of travel at Z-100.
fn config() -> Config {
    let bounds = Bounds { speed: [SPEED; 9], accel: [ACCEL; 9], jerk: [JERK; 9] };
    let mut config =
        Config { motion: Limits { feed: bounds, rapid: bounds }, ..control(&machine(0)) };
    if let Some(z) = &mut config.axes[2] {
        z.travel = Some((Coordinate::new(-100.0), Coordinate::new(1.0)));
    }
    config
}

/// A machine that hears or says something else from a moment on.
struct Spoiled<F, G> {
    machine: SimulatedMachine,
    hears: F,
    says: G,
    said: Feedback,
}

impl<F: FnMut(f64, &mut Command), G: FnMut(&mut Feedback)> Machine for Spoiled<F, G> {
    fn period(&self) -> Time {
        self.machine.period()
    }
    fn feedback(&self) -> &Feedback {
        self.machine.feedback()
    }
    fn exchange(&mut self, command: &Command) -> &Feedback {
        let mut command = *command;
        (self.hears)(self.machine.feedback().time.value(), &mut command);
        self.said = *self.machine.exchange(&command);
        (self.says)(&mut self.said);
        &self.said
    }
    fn truth(&self) -> Option<&Truth> {
        self.machine.truth()
    }
}

/// What was seen of a run, up to a second after its alarm.
struct Seen {
    samples: Vec<bus::Sample>,
    kernel: Kernel,
    /// The sample in which the alarm came.
    alarm: usize,
}

fn run(
    config: &Config,
    steps: &[StepKind],
    hears: impl FnMut(f64, &mut Command),
    says: impl FnMut(&mut Feedback),
) -> Seen {
    let machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    let mut machine = Spoiled { said: *machine.feedback(), machine, hears, says };
    let mut kernel = Kernel::new(config.clone());
    let mut waiting = (1..).zip(steps).peekable();
    let mut samples: Vec<bus::Sample> = Vec::new();
    let (mut alarm, mut feedback) = (None, *machine.feedback());
    for tick in 0..40_000 {
        while let Some((line, kind)) = waiting.peek() {
            let step = Step { op: *line - 1, line: *line, kind: (*kind).clone() };
            if kernel.push(&step).is_err() {
                break;
            }
            waiting.next();
        }
        let command = kernel.tick(&feedback);
        let truth = machine.truth().copied();
        samples.push(bus::Sample { feedback, command, report: kernel.report(), truth });
        if !kernel.faults().is_empty() && alarm.is_none() {
            alarm = Some(tick);
        }
        if alarm.is_some_and(|at| tick > at + 4000) {
            break;
        }
        feedback = *machine.exchange(&command);
    }
    let alarm = alarm.expect("there is an alarm");
    Seen { samples, kernel, alarm }
}

/// As it is.
fn obeys(_: f64, _: &mut Command) {}
fn says(_: &mut Feedback) {}

impl Seen {
    #[track_caller]
    fn check(&self, kind: FaultKind, subject: Subject) -> &Self {
        let first = self.kernel.faults()[0];
        assert_eq!((first.kind, first.subject), (kind, subject), "{first}");
        assert_eq!(self.kernel.report().state, State::Faulted);
        self
    }

    /// No setpoint of an axis has ever been farther from the one before, nor asked for more
    /// acceleration, and it comes to rest.
    #[track_caller]
    fn is_calm(&self, axis: usize, speed: f64, accel: f64) -> &Self {
        let q: Vec<f64> =
            self.samples.iter().map(|s| s.command.axes[axis].position.value()).collect();
        let on = |n: usize| self.samples[n].command.axes[axis].enable;
        for n in 2..q.len() {
            if !on(n) {
                break;
            }
            let (first, second) = (q[n] - q[n - 1], q[n] - 2.0 * q[n - 1] + q[n - 2]);
            assert!(first.abs() <= speed * H * 1.001 + 1e-9, "sample {n}: {} mm/s", first / H);
            assert!(
                second.abs() <= accel * H * H * 1.03 + 1e-9,
                "sample {n}: {} mm/s²",
                second / H / H
            );
        }
        let last = self.samples.last().expect("there are samples");
        assert!(!last.command.axes[axis].enable || last.command.axes[axis].speed.value() == 0.0);
        self
    }
}

/// A move of X whose profile is this, whatever it asks for.
fn defective(phases: &[Phase]) -> StepKind {
    let (from, to) = (Position::default(), Position::xyz(100.0, 0.0, 0.0));
    let mut profile = Profile::EMPTY;
    for phase in phases {
        assert!(profile.push(*phase));
    }
    let path = Path::Line { from, to };
    StepKind::Move(Box::new(Move {
        path,
        profile,
        rapid: true,
        per_revolution: false,
        exact_stop: true,
        floats: false,
        programmed: None,
    }))
}

/// Rest for so long, s, then something.
fn then(rest: f64, phase: Phase) -> [Phase; 2] {
    [Phase { duration: rest, s: 0.0, v: 0.0, a: 0.0, j: 0.0 }, phase]
}

#[test]
fn a_plan_that_jumps_is_refused_in_its_period_and_the_axis_stays() {
    let jump = Phase { duration: 1.0, s: 5.0, v: 0.0, a: 0.0, j: 0.0 };
    let seen = run(&config(), &[defective(&then(0.1, jump))], obeys, says);
    seen.check(FaultKind::SetpointSpeed, Subject::Axis(Axis::X)).is_calm(0, 0.0, 0.0);
    let fault = seen.kernel.faults()[0];
    assert!((fault.value - 5.0 / H).abs() < 1e-6 * fault.value, "{fault}");
}

#[test]
fn a_plan_that_begins_in_motion_is_refused_in_its_first_period() {
    let moving = Phase { duration: 1.0, s: 0.0, v: 100.0, a: 0.0, j: 0.0 };
    let seen = run(&config(), &[defective(&then(0.1, moving))], obeys, says);
    seen.check(FaultKind::SetpointAccel, Subject::Axis(Axis::X)).is_calm(0, 0.0, 0.0);
}

#[test]
fn a_plan_that_stops_dead_is_refused_and_the_axis_brakes_as_it_can() {
    let to = Phase { duration: 0.05, s: 0.0, v: 0.0, a: 4000.0, j: 0.0 };
    let stop = Phase { duration: 1.0, s: 5.0, v: 0.0, a: 0.0, j: 0.0 };
    let mut config = config();
    (config.motion.feed.jerk, config.motion.rapid.jerk) = ([f64::INFINITY; 9], [f64::INFINITY; 9]);
    let seen = run(&config, &[defective(&[to, stop])], obeys, says);
    seen.check(FaultKind::SetpointAccel, Subject::Axis(Axis::X)).is_calm(0, 200.0, 4000.0);
    // from 200 mm/s at 2000 mm/s²
    let last = seen.samples.last().expect("there are samples").axis(0).value();
    assert!((last - 15.0).abs() < 0.1, "{last}");
}

#[test]
fn a_plan_with_too_much_jerk_is_refused() {
    // acceleration that comes at ten times the jerk, and is within its limit
    let jerk = Phase { duration: 2e-3, s: 0.0, v: 0.0, a: 0.0, j: 10.0 * JERK };
    let seen = run(&config(), &[defective(&then(0.1, jerk))], obeys, says);
    seen.check(FaultKind::SetpointJerk, Subject::Axis(Axis::X)).is_calm(0, 1.0, 2000.0);
}

#[test]
fn a_plan_within_twice_the_jerk_is_none_of_the_monitors_business() {
    let jerk = Phase { duration: 5e-3, s: 0.0, v: 0.0, a: 0.0, j: 0.99 * JERK };
    let config = config();
    let mut kernel = Kernel::new(config.clone());
    let step = defective(&then(0.1, jerk));
    kernel.push(&Step { op: 0, line: 1, kind: step }).expect("there is room");
    let mut machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    let mut feedback = *machine.feedback();
    for _ in 0..415 {
        feedback = *machine.exchange(&kernel.tick(&feedback));
    }
    assert_eq!(kernel.faults(), []);
}

#[test]
fn a_setpoint_that_is_no_number_is_never_sent() {
    let broken = Phase { duration: 1.0, s: f64::NAN, v: 0.0, a: 0.0, j: 0.0 };
    let seen = run(&config(), &[defective(&then(0.1, broken))], obeys, says);
    seen.check(FaultKind::SetpointInvalid, Subject::Axis(Axis::X)).is_calm(0, 0.0, 0.0);
    let finite = |s: &bus::Sample| {
        let numbers = |a: &bus::AxisCommand| [a.position.value(), a.speed.value(), a.force.value()];
        s.command.axes.iter().flat_map(numbers).all(f64::is_finite)
    };
    assert!(seen.samples.iter().all(finite));
}

#[test]
fn an_axis_stops_before_the_end_of_its_travel_whatever_was_planned() {
    let steps = [line(Position::default(), Position::xyz(0.0, 0.0, -130.0), 300.0, true)];
    let seen = run(&config(), &steps, obeys, says);
    seen.check(FaultKind::SoftLimit, Subject::Axis(Axis::Z)).is_calm(2, 300.0, 5480.0); // √(300 mm/s · 10⁵ mm/s³) of the move
    let deepest = seen.samples.iter().map(|s| s.axis(2).value()).fold(0.0, f64::min);
    // 10 µm, and a tenth of a period's way; the axis itself swings over by what its loop lets it
    assert!(deepest < -99.5 && deepest > -100.1, "{deepest}");
    let told = seen.samples.iter().filter(|s| s.command.axes[2].enable);
    let told = told.map(|s| s.command.axes[2].position.value()).fold(0.0, f64::min);
    assert!(told > -100.0 - 0.01 - 300.0 * H, "{told}");
}

#[test]
fn an_axis_that_is_not_homed_has_no_travel_and_one_outside_may_come_back() {
    let mut config = config();
    if let Some(z) = &mut config.axes[2] {
        z.travel = Some((Coordinate::new(-200.0), Coordinate::new(-10.0)));
    }
    // it stands at zero, above its travel
    let steps =
        [line(Position::default(), Position::xyz(0.0, 0.0, -50.0), 100.0, true), StepKind::End];
    let mut machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    let seen = run_on(&mut machine, &config, &steps, 20_000);
    assert_eq!(seen.kernel.faults(), []);
    assert!((seen.deepest_mm() + 50.0).abs() < 0.01);
}

#[test]
fn steps_that_run_out_in_motion_are_an_alarm_and_everything_brakes() {
    let place = Span { file: 0, line: 1, start: 0, end: 0 };
    let op = |kind| Op { span: place, kind };
    let tolerance = Some(Length::mm(0.05));
    let mut ops = vec![op(OpKind::PathMode(PathMode::Blend { tolerance, merge: None }))];
    // a quarter of a circle of 50 mm in chords, at 100 mm/s
    for n in 1..=40 {
        let angle = f64::from(n) / 40.0 * core::f64::consts::FRAC_PI_2;
        let to = Position::xyz(50.0 * angle.sin(), 50.0 - 50.0 * angle.cos(), 0.0);
        ops.push(op(OpKind::Line { to, feed: Feed::PerTime(Speed::mm_per_s(100.0)) }));
    }
    let all: Vec<StepKind> = operated::planned(&ops, 20e3).into_iter().map(|s| s.kind).collect();
    let moves = all.iter().filter(|kind| matches!(kind, StepKind::Follow(_))).count();
    assert!(moves > 10, "{moves}");
    // steps that are asked for in motion, to come back some periods later, are not given
    let mut kernel = Kernel::new(config());
    let mut machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    let steps = all.iter().map(|kind| Step { op: 0, line: 1, kind: kind.clone() });
    let taken = steps.take_while(|step| kernel.push(step).is_ok()).count();
    assert!(taken > all.len() / 2, "{taken}");
    let mut feedback = *machine.feedback();
    for _ in 0..1500 {
        feedback = *machine.exchange(&kernel.tick(&feedback));
    }
    assert!(feedback.axes[0].position.value() > 5.0 && kernel.faults().is_empty());
    let reply = kernel.serve(kernel::Request::HandBack);
    assert!(matches!(reply, kernel::Reply::HandedBack(None)), "{reply:?}");
    // the second half never comes
    let seen = run(&config(), &all[..all.len() / 2], obeys, says);
    seen.check(FaultKind::StepsRanOut, Subject::Machine);
    seen.is_calm(0, 100.5, 1.05 * ACCEL).is_calm(1, 100.5, 1.05 * ACCEL);
    // from 100 mm/s, as hard as a move may brake
    let at = |n: usize| [seen.samples[n].axis(0).value(), seen.samples[n].axis(1).value()];
    let (from, to) = (at(seen.alarm), at(seen.samples.len() - 1));
    let way = (to[0] - from[0]).hypot(to[1] - from[1]);
    assert!(way > 0.5 && way < 100.0 * 100.0 / (2.0 * ACCEL) + 0.1, "{way} mm");
}

#[test]
fn time_that_stands_still_is_an_alarm_in_the_third_period() {
    let steps = [line(Position::default(), Position::xyz(100.0, 0.0, 0.0), 200.0, true)];
    let mut frozen: Option<Feedback> = None;
    let seen = run(&config(), &steps, obeys, |said| {
        if said.time.value() > 0.2 {
            *said = *frozen.get_or_insert(*said);
        }
    });
    seen.check(FaultKind::FeedbackStale, Subject::Machine);
    let first = frozen.expect("it has stood").time.value();
    assert!((seen.alarm as f64 * H - first - 3.0 * H).abs() < 1e-9);
    assert!(seen.samples[seen.alarm].command.axes.iter().all(|axis| !axis.enable));
}

#[test]
fn two_lost_frames_are_lived_through_in_a_fast_move() {
    let steps =
        [line(Position::default(), Position::xyz(100.0, 0.0, 0.0), 200.0, true), StepKind::End];
    let machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    let mut before = *machine.feedback();
    let says = move |said: &mut Feedback| {
        let lost = said.time.value() > 0.2 && (said.time.value() / H).round() as u32 % 50 < 2;
        *said = if lost { before } else { *said };
        before = *said;
    };
    let mut machine = Spoiled { said: *machine.feedback(), machine, hears: obeys, says };
    let seen = run_on(&mut machine, &config(), &steps, 20_000);
    assert_eq!(seen.kernel.faults(), []);
    assert!((seen.samples.last().expect("there are samples").axis(0).value() - 100.0).abs() < 0.01);
}

#[test]
fn an_encoder_that_jumps_by_half_a_millimetre_is_noticed_in_its_period_in_a_plain_move() {
    let steps = [line(Position::default(), Position::xyz(0.0, 0.0, -50.0), 20.0, true)];
    let seen = run(&config(), &steps, obeys, |said| {
        if said.time.value() > 1.0 {
            said.axes[2].position += Coordinate::new(0.5);
        }
    });
    seen.check(FaultKind::ReadingImplausible, Subject::Axis(Axis::Z));
    let fault = seen.kernel.faults()[0];
    assert!((fault.time.value() - 1.0).abs() < 1.5 * H, "{fault}");
    // the loop has not taken it back: Z is where it was, and what braking takes from 20 mm/s
    let z = |s: &bus::Sample| s.axis(2).value();
    let way = z(seen.samples.last().expect("there are samples")) - z(&seen.samples[seen.alarm]);
    assert!(way < 0.0 && way > -0.2, "{way} mm");
}

#[test]
fn an_encoder_that_is_stuck_lets_the_axis_go_no_farther_than_it_brakes() {
    let steps = [line(Position::default(), Position::xyz(0.0, 0.0, -90.0), 15.0, true)];
    let mut stuck = None;
    let seen = run(&config(), &steps, obeys, |said| {
        if said.time.value() > 1.0 {
            said.axes[2].position = *stuck.get_or_insert(said.axes[2].position);
        }
    });
    seen.check(FaultKind::ReadingImplausible, Subject::Axis(Axis::Z));
    // seen after 14 µm; the loop has made 25 mm/s of 15 by then, and nothing but friction brakes
    // what is too much of it
    let z = seen.samples.last().expect("there are samples").axis(2) - stuck.expect("it was");
    assert!(z.value() < 0.0 && z.value() > -1.5, "{z:?}");
    assert!(!seen.samples.last().expect("there are samples").command.axes[2].enable);
}

#[test]
fn an_axis_that_does_not_move_is_not_pushed_on_after_its_alarm() {
    let steps = [line(Position::default(), Position::xyz(90.0, 0.0, 0.0), 15.0, true)];
    // a drive that obeys by a twentieth: friction holds the axis, slowly enough for the encoder to
    // be believed
    let seen = run(
        &config(),
        &steps,
        |now, told| {
            if now > 1.0 {
                told.axes[0].force = told.axes[0].force * 0.0;
            }
        },
        says,
    );
    seen.check(FaultKind::FollowingError, Subject::Axis(Axis::X));
    let last = seen.samples.last().expect("there are samples");
    assert!(!last.command.axes[0].enable, "it pushes with {:?}", last.command.axes[0].force);
    assert!(last.command.axes.iter().all(|axis| axis.force.value() == 0.0));
    // until everything has come to rest the drives stay on
    let on = seen.samples[seen.alarm..].iter().filter(|sample| sample.command.axes[2].enable);
    assert!(on.count() as f64 * H > 0.04);
}

/// Turn on at 3000 rpm and wait.
fn turning() -> [StepKind; 3] {
    [turn(0.0, 3000.0), await_speed(), StepKind::Dwell(Time::s(5.0))]
}

#[test]
fn a_spindle_that_runs_away_is_switched_off() {
    let seen = run(
        &config(),
        &turning(),
        |now, told| {
            if now > 1.0 {
                told.spindles[0].torque = Torque::n_m(42.0);
            }
        },
        says,
    );
    seen.check(FaultKind::SpindleRunsAway, Subject::Spindle(0));
    // beyond 3000 rpm by a quarter, and 2 % of 10,000 rpm
    let fault = seen.kernel.faults()[0];
    assert!((Spin::rev_per_s(fault.value).in_rpm() - 3950.0).abs() < 20.0, "{fault}");
    assert!(!seen.samples[seen.alarm].command.spindles[0].enable);
}

#[test]
fn a_spindle_that_should_stand_and_turns_is_switched_off() {
    let steps = [StepKind::Dwell(Time::s(5.0))];
    let seen = run(
        &config(),
        &steps,
        |now, told| {
            if now > 0.1 {
                told.spindles[0].torque = Torque::n_m(-5.0);
            }
        },
        says,
    );
    seen.check(FaultKind::SpindleRunsAway, Subject::Spindle(0));
    let fault = seen.kernel.faults()[0];
    assert!((Spin::rev_per_s(fault.value).in_rpm() + 200.0).abs() < 10.0, "{fault}");
}

#[test]
fn a_spindle_that_stalls_is_an_alarm_and_everything_stops() {
    let seen = run(
        &config(),
        &turning(),
        |now, told| {
            if now > 1.0 {
                told.spindles[0].torque = Torque::n_m(-20.0);
            }
        },
        says,
    );
    seen.check(FaultKind::SpindleStalls, Subject::Spindle(0));
    let fault = seen.kernel.faults()[0];
    // below 3000 rpm by a quarter, and 2 % of 10,000 rpm
    assert!((Spin::rev_per_s(fault.value).in_rpm() - 2050.0).abs() < 20.0, "{fault}");
}

#[test]
fn an_axis_follows_a_spindle_without_a_drive_no_deeper_than_there_is_room_for_its_tap() {
    let mut config = config();
    if let Some(z) = &mut config.axes[2] {
        z.travel = None;
    }
    (config.motion.feed.jerk, config.motion.rapid.jerk) = ([f64::INFINITY; 9], [f64::INFINITY; 9]);
    let order = TapOrder { from_mm: -60.0, surface_mm: -62.0, to_mm: -80.0, rpm: 3000.0, ..M6 };
    let mut gone = false;
    let (hears, says) = {
        let gone = std::rc::Rc::new(std::cell::Cell::new(false));
        let heard = gone.clone();
        (
            move |_: f64, told: &mut Command| {
                if heard.get() {
                    told.spindles[0].torque = Torque::ZERO;
                }
            },
            move |said: &mut Feedback| {
                if said.axes[2].position < Coordinate::new(-76.0) {
                    gone.set(true);
                }
                said.spindles[0].ready &= !gone.get();
            },
        )
    };
    let seen = run(&config, &tapping(&order), hears, says);
    gone |= seen.kernel.faults().iter().any(|fault| fault.kind == FaultKind::FollowsTooDeep);
    assert!(gone, "{:?}", seen.kernel.faults());
    seen.check(FaultKind::DriveNotReady, Subject::Spindle(0));
    // its room of 3 mm, and what the axis needs to brake from 50 mm/s at 2000 mm/s²
    let deepest = seen.samples.iter().map(|s| s.axis(2).value()).fold(0.0, f64::min);
    assert!(deepest < -83.0 && deepest > -83.0 - 50.0 * 50.0 / 4000.0 - 0.1, "{deepest}");
    // the spindle turns on
    let turned = |n: usize| seen.samples[n].spindle(0);
    assert!(turned(seen.samples.len() - 1) - turned(seen.alarm) > Angle::rev(5.0));
}
