//! A spindle whose drive is told a speed and orients it by itself: M19 is handed to the drive, and
//! its answer is waited for.
use crate::common::*;
use bus::{Command, Feedback, Machine, Truth};
use kernel::{Config, FaultKind, OwnRamps, Prediction, SyncMode};
use plan::{SpindleStep, StepKind};
use sim::{PlainDrive, SimulatedMachine};
use units::{Angle, Orientation, Spin, SpinAccel, Time, TurnDirection};

const RAMP: SpinAccel = SpinAccel::rev_per_s2(67.0);
const DELAY: Time = Time::s(0.02);

fn mill() -> (SimulatedMachine, Config) {
    let model = machine(1);
    let mut control = control(&model);
    control.synchronisation =
        SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport: 1 };
    let spindle = control.spindles[0].as_mut().expect("one");
    let repeats = (Time::s(0.7e-3), 0.002);
    spindle.own_ramps = Some(OwnRamps {
        delay: DELAY,
        accel: RAMP,
        decel: RAMP,
        uncertainty: 0.25,
        repeats,
        creep: 0.1,
    });
    spindle.orients = true;
    let drive = PlainDrive {
        delay: DELAY,
        delay_scatter: Time::ZERO,
        accel: RAMP,
        decel: RAMP,
        ramp_scatter: 0.0,
        speed_scatter: 0.0,
        orients: Some((Spin::rpm(100.0), SpinAccel::rev_per_s2(10.0))),
    };
    (SimulatedMachine::new(model).expect("it can be built").with_plain_drive(drive), control)
}

/// A drive whose answer is another one.
struct Answers<F> {
    machine: SimulatedMachine,
    answer: F,
    said: Feedback,
}

impl<F: Fn(&Command, &mut Feedback)> Machine for Answers<F> {
    fn period(&self) -> Time {
        self.machine.period()
    }

    fn feedback(&self) -> &Feedback {
        self.machine.feedback()
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        self.said = *self.machine.exchange(command);
        (self.answer)(command, &mut self.said);
        &self.said
    }

    fn truth(&self) -> Option<&Truth> {
        self.machine.truth()
    }
}

/// M3 S1000, then M19 at each of these angles, then M3 again, on a drive that answers so.
fn oriented_on(angles: &[f64], answer: impl Fn(&Command, &mut Feedback)) -> Run {
    let to = |degrees: &f64| Orientation::shortest(Angle::deg(*degrees));
    let all: Vec<_> = angles.iter().map(to).collect();
    oriented_to(&all, None, answer)
}

/// The same by these ways, each within this time.
fn oriented_to(
    all: &[Orientation],
    longest: Option<Time>,
    answer: impl Fn(&Command, &mut Feedback),
) -> Run {
    let (machine, control) = mill();
    let mut steps = vec![turn(0.0, 1000.0), await_speed(), turn(1000.0, 0.0), await_speed()];
    for to in all {
        let order = SpindleStep::Orient { to: *to, longest };
        steps.push(StepKind::Spindle { spindle: 0, order });
        steps.push(StepKind::Dwell(Time::s(0.05)));
    }
    steps.extend([turn(0.0, 500.0), await_speed(), StepKind::End]);
    run_on(&mut Answers { said: *machine.feedback(), machine, answer }, &control, &steps, 60_000)
}

/// Whole turns left out, from −0.5 to 0.5.
fn within_turn(rev: f64) -> f64 {
    rev - rev.round()
}

#[test]
fn the_drive_is_asked_when_the_spindle_stands_and_let_go_when_it_shall_turn() {
    let seen = oriented_on(&[90.0, 270.0, 270.0], |_, _| {});
    assert_eq!(seen.kernel.faults(), []);
    let mut locked = Vec::new();
    for pair in seen.samples.windows(2) {
        let [before, now] = [&pair[0].command.spindles[0], &pair[1].command.spindles[0]];
        assert!(now.orient.is_some() || !now.locked);
        let angles = before.orient.zip(now.orient);
        assert!(angles.is_none_or(|(before, now)| before == now), "it is not asked anew");
        if now.orient.is_some() && before.orient.is_none() {
            assert!(
                now.spin == Spin::ZERO
                    && pair[1].truth.expect("it is simulated").spins[0].abs() < Spin::rpm(3.0)
            );
        }
        if now.locked && !before.locked {
            let angle = now.orient.expect("it is told").angle.in_deg();
            let stands = within_turn(pair[1].spindle(0).value() - angle / 360.0) * 360.0;
            assert!(stands.abs() < 0.1, "{stands} degrees off {angle}");
            locked.push(angle);
        }
    }
    assert_eq!(locked, [90.0, 270.0]);
    let last = seen.samples.last().expect("one");
    assert!(last.command.spindles[0].orient.is_none() && !last.command.spindles[0].locked);
}

#[test]
fn a_drive_that_never_says_so_is_an_alarm_after_the_time_that_it_is_given() {
    let seen = oriented_on(&[90.0], |_, feedback| feedback.spindles[0].oriented = false);
    let fault = seen.kernel.faults()[0];
    assert_eq!(fault.kind, FaultKind::NotOriented);
    let text = fault.to_string();
    assert!(
        text.starts_with(
            "alarm 302: spindle 0: the spindle did not come to its angle in time: 3.00"
        ),
        "{text}"
    );
    assert!(text.contains(" s, limit 3.0000 s"), "{text}");
    assert!(seen.samples.last().expect("one").command.spindles[0].orient.is_none());
}

#[test]
fn a_program_that_says_how_long_it_waits_is_taken_at_its_word() {
    let to = [Orientation::shortest(Angle::deg(90.0))];
    let never = |_: &Command, feedback: &mut Feedback| feedback.spindles[0].oriented = false;
    let seen = oriented_to(&to, Some(Time::s(1.5)), never);
    let text = seen.kernel.faults()[0].to_string();
    assert!(text.contains("alarm 302") && text.contains(" s, limit 1.5000 s"), "{text}");
}

/// How far the spindle turned from where its drive was asked to where it stood, rev, for each.
fn turned_by_the_drive(all: &[Orientation]) -> Vec<f64> {
    let seen = oriented_to(all, None, |_, _| {});
    assert_eq!(seen.kernel.faults(), []);
    let (mut from, mut found) = (0.0, Vec::new());
    for pair in seen.samples.windows(2) {
        let [before, now] = [&pair[0].command.spindles[0], &pair[1].command.spindles[0]];
        if now.orient.is_some() && before.orient.is_none() {
            from = pair[1].spindle(0).value();
        }
        if now.locked && !before.locked {
            found.push(pair[1].spindle(0).value() - from);
        }
    }
    found
}

#[test]
fn the_drive_turns_it_in_the_direction_that_it_is_told() {
    let to = |degrees: f64, direction| Orientation { angle: Angle::deg(degrees), direction };
    let (on, back) = (TurnDirection::Forward, TurnDirection::Backward);
    let turned = turned_by_the_drive(&[to(0.0, on), to(90.0, on), to(120.0, back), to(60.0, on)]);
    for (found, expected) in turned[1..].iter().zip([0.25, 30.0 / 360.0 - 1.0, 300.0 / 360.0]) {
        assert!((found - expected).abs() < 2e-3, "{turned:?}");
    }
    assert_eq!(turned.len(), 4);
}

#[test]
fn a_drive_that_says_that_it_cannot_is_an_alarm_with_its_code() {
    let seen = oriented_on(&[90.0], |command, feedback| {
        feedback.spindles[0].orient_fault =
            if command.spindles[0].orient.is_some() { 7 } else { 0 };
    });
    let fault = seen.kernel.faults()[0];
    assert_eq!(fault.kind, FaultKind::OrientationFault);
    let text = fault.to_string();
    assert!(text.contains("cannot bring the spindle to its angle: its fault code is 7"), "{text}");
}

/// An answer that stands from before is about another angle, and a fault code from before about
/// another order.
#[test]
fn what_the_drive_says_before_it_can_have_obeyed_is_not_about_this_angle() {
    let since = std::cell::Cell::new(0.0);
    let seen = oriented_on(&[90.0], |command, feedback| {
        let asked = command.spindles[0].orient.is_some();
        since.set(if asked { since.get() + 250e-6 } else { 0.0 });
        if since.get() < DELAY.value() {
            (feedback.spindles[0].oriented, feedback.spindles[0].orient_fault) = (true, 3);
        }
    });
    assert_eq!(seen.kernel.faults(), []);
    let now = seen.samples.iter().find(|sample| sample.command.spindles[0].locked).expect("one");
    let off = within_turn(now.spindle(0).value() - 0.25) * 360.0;
    assert!(off.abs() < 0.1, "{off} degrees");
}

#[test]
fn turned_to_an_angle_by_hand_it_is_given_as_long() {
    let (machine, control) = mill();
    let mut machine = Answers {
        said: *machine.feedback(),
        machine,
        answer: |_: &Command, feedback: &mut Feedback| feedback.spindles[0].oriented = false,
    };
    let mut kernel = kernel::Kernel::new(control);
    let mut feedback = *machine.feedback();
    for tick in 0..20_000 {
        if tick == 2000 {
            kernel.orient_manually(0, Angle::deg(45.0)).expect("it stands");
        }
        let command = kernel.tick(&feedback);
        feedback = *machine.exchange(&command);
    }
    assert_eq!(kernel.faults().first().map(|fault| fault.kind), Some(FaultKind::NotOriented));
}
