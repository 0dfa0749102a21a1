//! What goes wrong on a machine, and what the kernel makes of it.
use crate::common::*;
use bus::{Command, Feedback, Machine, State, Truth};
use canon::{Axis, Position};
use kernel::{Config, EventKind, FaultKind, Subject};
use plan::StepKind;
use sim::SimulatedMachine;
use units::{Coordinate, Length, Time};

/// A machine on which something happens from a moment on.
struct Spoiled<F> {
    machine: SimulatedMachine,
    spoil: F,
    said: Feedback,
}

impl<F: FnMut(&mut Feedback)> Machine for Spoiled<F> {
    fn period(&self) -> Time {
        self.machine.period()
    }
    fn feedback(&self) -> &Feedback {
        self.machine.feedback()
    }
    fn exchange(&mut self, command: &Command) -> &Feedback {
        self.said = *self.machine.exchange(command);
        (self.spoil)(&mut self.said);
        &self.said
    }
    fn truth(&self) -> Option<&Truth> {
        self.machine.truth()
    }
}

/// Run steps on a machine whose feedback is spoiled.
fn spoiled(
    config: &Config,
    steps: &[StepKind],
    ticks: usize,
    spoil: impl FnMut(&mut Feedback),
) -> Run {
    let machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    run_on(&mut Spoiled { said: *machine.feedback(), machine, spoil }, config, steps, ticks)
}

#[track_caller]
fn check(seen: &Run, kind: FaultKind, subject: Subject) {
    let first = seen.kernel.faults().first().expect("there is a fault");
    assert_eq!((first.kind, first.subject), (kind, subject), "{first}");
    assert_eq!(seen.kernel.report().state, State::Faulted);
    assert!(seen.events.iter().any(|e| e.kind == EventKind::FaultRaised(*first)));
}

fn there(z: f64) -> Position {
    Position::xyz(0.0, 0.0, z)
}

#[test]
fn an_emergency_stop_switches_all_outputs_off_in_the_same_tick() {
    let config = control(&machine(0));
    let seen = spoiled(&config, &tapping(&M6), 4000, |said| {
        said.emergency_stop = said.time > Time::s(0.1);
    });
    check(&seen, FaultKind::EmergencyStop, Subject::Machine);
    let last = seen.samples.last().expect("there are samples");
    assert!(last.feedback.emergency_stop);
    assert!(last.command.axes.iter().all(|a| !a.enable && a.force.value() == 0.0));
    assert!(last.command.spindles.iter().all(|s| !s.enable && s.torque.value() == 0.0));
}

#[test]
fn a_drive_that_drops_out_is_named() {
    let config = control(&machine(0));
    let seen = spoiled(&config, &tapping(&M6), 4000, |said| {
        said.axes[1].ready &= said.time < Time::s(0.1);
    });
    check(&seen, FaultKind::DriveNotReady, Subject::Axis(Axis::Y));
    let text = seen.kernel.faults()[0].to_string();
    assert_eq!(text, "alarm 102: axis Y: the drive is not ready (line 1, 0.1000 s)");
}

#[test]
fn drives_that_do_not_come_up_are_waited_for_and_then_an_alarm() {
    let config = control(&machine(0));
    let seen = spoiled(&config, &tapping(&M6), 8000, |said| said.spindles[0].ready = false);
    check(&seen, FaultKind::DriveNotReady, Subject::Spindle(0));
    assert!((seen.seconds - 1.0).abs() < 0.01, "{} s", seen.seconds);
}

#[test]
fn an_encoder_that_is_stuck_is_noticed_and_the_others_brake_under_control() {
    let config = control(&machine(0));
    let steps = [line(Position::default(), Position::xyz(100.0, 0.0, -100.0), 200.0, true)];
    let mut stuck = None;
    let seen = spoiled(&config, &steps, 4000, |said| {
        if said.time > Time::s(0.2) {
            said.axes[0].position = *stuck.get_or_insert(said.axes[0].position);
        }
    });
    check(&seen, FaultKind::ReadingImplausible, Subject::Axis(Axis::X));
    let speed = |s: &bus::Sample| s.command.axes[2].speed.value();
    assert!(speed(seen.samples.last().expect("there are samples")).abs() > 100.0);
    // Z comes to rest within the approach acceleration; outputs go off once everything stands, as
    // at any lost encoder
    let after = halted(&config, &steps, |said| {
        if said.time > Time::s(0.2) {
            said.axes[0].position = *stuck.get_or_insert(said.axes[0].position);
        }
    });
    let steps: Vec<f64> = after.windows(2).map(|w| speed(&w[1]) - speed(&w[0])).collect();
    let most = 2000.0 * PERIOD.value() * 1.001;
    assert!(
        steps.iter().all(|step| step.abs() <= most),
        "{:?}",
        steps.iter().copied().fold(0.0, f64::max)
    );
    assert!(speed(after.last().expect("there are samples")) == 0.0);
    let moves = |s: &&bus::Sample| speed(s) != 0.0;
    assert!(after.iter().filter(moves).all(|s| s.command.axes[2].enable));
    assert!(!after.last().expect("there are samples").command.axes[2].enable);
    // X has no force without its encoder, and no drive here that stops by itself: from 141 mm/s,
    // and what the loop made of a reading that stood, it slows down by its friction alone
    assert!(after[1..].iter().all(|s| s.command.axes[0].force.value() == 0.0));
    let on = after.iter().filter(|s| s.command.axes[0].enable).count();
    assert!(on as f64 * PERIOD.value() < 0.011, "{on} periods");
    let speed_of_x = |w: &[bus::Sample]| {
        let [was, is] = [0, 1].map(|i| w[i].truth.expect("simulated").axes[0].value());
        (is - was) / PERIOD.value()
    };
    let speeds: Vec<f64> = after.windows(2).map(speed_of_x).collect();
    assert!(speeds[20..].windows(2).all(|w| w[1] < w[0] + 0.5), "{:?}", &speeds[..40]);
}

/// The samples from the tick of the fault on, half a second of them.
fn halted(
    config: &Config,
    steps: &[StepKind],
    mut spoil: impl FnMut(&mut Feedback),
) -> Vec<bus::Sample> {
    let mut machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    let mut kernel = kernel::Kernel::new(config.clone());
    for kind in steps {
        kernel.push(&plan::Step { op: 0, line: 1, kind: kind.clone() }).expect("there is room");
    }
    let (mut samples, mut feedback) = (Vec::new(), *machine.feedback());
    for _ in 0..40_000 {
        let command = kernel.tick(&feedback);
        let (report, truth) = (kernel.report(), machine.truth().copied());
        if report.state == State::Faulted {
            samples.push(bus::Sample { feedback, command, report, truth });
        }
        if samples.len() == 2000 {
            break;
        }
        feedback = *machine.exchange(&command);
        spoil(&mut feedback);
    }
    samples
}

#[test]
fn a_tap_that_leaves_its_helix_stops_synchronised() {
    // the warning window is as good as a stop here: 20 µm are passed by a ramp beyond the power
    // curve
    let mut config = control(&machine(0));
    config.sync_windows.stop = Length::um(20.0);
    let order = TapOrder { ramp_s: Some(0.22), ..M6 };
    let samples = halted(&config, &tapping(&order), |_| {});
    let (first, last) = (samples[0], samples[samples.len() - 1]);
    let turned = (last.spindle(0) - first.spindle(0)).value();
    let way = (last.axis(2) - first.axis(2)).value();
    assert!(turned > 1.0, "it was turning: {turned} rev until rest");
    assert!((way + turned).abs() < 0.060, "{} µm off the helix at rest", (way + turned) * 1e3);
    assert!(last.truth.expect("simulated").spins[0].in_rpm().abs() < 1.0);
    // and the control goes on measuring how far from the helix it stands
    let (then, now) = (first.report.sync_error, last.report.sync_error);
    let (then, now) = (then.expect("it was in the material"), now.expect("it still is"));
    let moved_um = (now - then).in_um() - (way + turned) * 1e3;
    assert!(moved_um.abs() < 3.0, "{then}, {now}, {moved_um} µm from the truth");
}

#[test]
fn a_fault_in_a_tap_names_line_and_distance() {
    let mut config = control(&machine(0));
    config.sync_windows.stop = Length::um(20.0);
    let order = TapOrder { ramp_s: Some(0.22), ..M6 };
    let seen = run(&machine(0), &config, &tapping(&order));
    check(&seen, FaultKind::SyncError, Subject::Axis(Axis::Z));
    let fault = seen.kernel.faults()[0];
    assert_eq!(fault.line, 2);
    assert!(fault.value.abs() > 0.020 && fault.value.abs() < 0.022, "{fault}");
}

#[test]
fn a_step_that_begins_elsewhere_is_refused_before_anything_moves() {
    let steps = [line(there(-10.0), there(-50.0), 100.0, true)];
    let seen = run(&machine(0), &control(&machine(0)), &steps);
    check(&seen, FaultKind::SetpointJump, Subject::Axis(Axis::Z));
    assert!(seen.deepest_mm() > -0.01, "{}", seen.deepest_mm());
}

#[test]
fn an_axis_that_the_machine_lacks_is_named() {
    let mut config = control(&machine(0));
    config.axes[1] = None;
    let steps = [line(Position::default(), Position::xyz(0.0, 30.0, 0.0), 100.0, true)];
    let seen = run(&machine(0), &config, &steps);
    check(&seen, FaultKind::NotConfigured, Subject::Axis(Axis::Y));
}

#[test]
fn a_tool_that_does_not_come_is_an_alarm_after_its_wait() {
    let mut config = control(&machine(0));
    config.waits.tool_change = Time::s(0.5);
    let seen = run(&machine(0), &config, &[StepKind::ChangeTool { tool: 9, by_hand: false }]);
    check(&seen, FaultKind::ToolNotChanged, Subject::Machine);
    assert!((seen.seconds - 0.5).abs() < 0.01, "{} s", seen.seconds);
}

#[test]
fn a_spindle_that_does_not_come_to_speed_is_an_alarm_after_its_wait() {
    let mut config = control(&machine(0));
    config.waits.at_speed = Time::s(0.05);
    let seen = run(&machine(0), &config, &[turn(0.0, 6000.0), await_speed()]);
    check(&seen, FaultKind::NotAtSpeed, Subject::Spindle(0));
}

#[test]
fn an_axis_that_does_not_come_to_rest_is_an_alarm_after_its_wait() {
    let mut config = control(&machine(0));
    config.waits.in_position = Time::s(0.1);
    let steps = [line(Position::default(), there(-50.0), 100.0, true)];
    let seen = spoiled(&config, &steps, 8000, |said| {
        // a loose reading head: 20 µm at 200 Hz, too fast for the loop to follow
        let swing = (said.time.value() * core::f64::consts::TAU * 200.0).sin();
        said.axes[2].position += Coordinate::linear(Length::um(20.0) * swing);
    });
    check(&seen, FaultKind::NotInPosition, Subject::Axis(Axis::Z));
}
