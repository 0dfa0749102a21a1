//! A spindle whose drive closes its own position loop: it is told an angle in every period,
//! whatever it does.
use crate::common::*;
use bus::{Command, Feedback, Machine, State};
use kernel::{Config, EncoderCheckControl, Fault, FaultKind};
use plan::{SpindleStep, StepKind};
use sim::SimulatedMachine;
use units::{Angle, Orientation, Spin, Time};

/// A machine whose spindle is, a period later, where it was told to be; what its encoder counts is
/// so many times that.
struct Drives {
    machine: SimulatedMachine,
    angle: f64,
    counts: f64,
    /// From here on the spindle falls behind.
    slips_from: f64,
    said: Feedback,
}

impl Drives {
    fn new() -> Self {
        Self::at(3.3, 1.0)
    }

    fn at(angle: f64, counts: f64) -> Self {
        let machine = SimulatedMachine::new(machine(1)).expect("it can be built");
        let said = *machine.feedback();
        let mut new = Self { machine, angle, counts, slips_from: f64::INFINITY, said };
        new.say(said);
        new
    }

    fn say(&mut self, feedback: Feedback) {
        self.said = feedback;
        self.said.spindles[0].angle = Angle::rev(self.angle * self.counts);
    }
}

impl Machine for Drives {
    fn period(&self) -> Time {
        self.machine.period()
    }

    fn feedback(&self) -> &Feedback {
        &self.said
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        let feedback = *self.machine.exchange(command);
        if command.spindles[0].enable {
            let told = command.spindles[0].angle.value();
            // behind by more and more
            self.angle = told - 0.3 * (told - self.slips_from).max(0.0).powi(2);
        }
        self.say(feedback);
        &self.said
    }
}

fn control_of(is_checked: bool) -> Config {
    let mut control = control(&machine(1));
    let spindle = control.spindles[0].as_mut().expect("one");
    spindle.closes_position = true;
    spindle.encoder_check = is_checked.then_some(EncoderCheckControl { index: false });
    control
}

fn orient(degrees: f64) -> StepKind {
    StepKind::Spindle {
        spindle: 0,
        order: SpindleStep::Orient {
            to: Orientation::shortest(Angle::deg(degrees)),
            longest: None,
        },
    }
}

/// M3, M19, a tap, M4, M5, one after the other.
fn everything() -> Vec<StepKind> {
    let mut steps =
        vec![turn(0.0, 900.0), await_speed(), turn(900.0, 0.0), await_speed(), orient(90.0)];
    let taps = tapping(&M6);
    steps.extend_from_slice(&taps[..2]);
    steps.extend([
        turn(0.0, -600.0),
        await_speed(),
        turn(-600.0, 0.0),
        await_speed(),
        StepKind::End,
    ]);
    steps
}

#[test]
fn the_angle_that_it_is_told_goes_on_with_its_speed_through_all_that_a_spindle_does() {
    let control = control_of(false);
    let seen = run_on(&mut Drives::new(), &control, &everything(), 60_000);
    assert_eq!(seen.kernel.faults(), []);
    assert!(seen.kernel.is_over());
    let h = control.period.value();
    let mut turned = [0.0_f64; 2];
    for pair in seen.samples.windows(2) {
        let [before, now] = [&pair[0].command.spindles[0], &pair[1].command.spindles[0]];
        let way = (now.angle - before.angle).value();
        // a trapezoid: within what its acceleration changes in a period, 2000 rev/s² at most here
        let mean = (before.spin + now.spin).value() / 2.0 * h;
        assert!((way - mean).abs() < 2000.0 * h * h, "{way} rev at {mean} rev a period");
        turned[usize::from(way < 0.0)] += way.abs();
    }
    // 900 rev/min up and down at 200 rev/s² is 1.125 rev; the tap turns 30 in and out; -600 is 0.5
    assert!(turned[0] > 31.1 && turned[1] > 30.5, "{turned:?}");
    assert!((seen.samples[0].command.spindles[0].angle.value() - 3.3).abs() < 1e-9);
}

#[test]
fn it_is_oriented_by_the_angle_that_it_is_told() {
    let control = control_of(false);
    let steps = &everything()[..5];
    let seen = run_on(&mut Drives::new(), &control, steps, 20_000);
    let stands = seen.samples.last().expect("one").command.spindles[0].angle.value();
    assert!((stands - stands.floor() - 0.25).abs() < 1e-9, "{stands} rev");
}

#[test]
fn a_tap_is_on_its_helix_and_at_its_depth_by_what_drives_are_told() {
    let control = control_of(false);
    let seen = run_on(&mut Drives::new(), &control, &tapping(&M6), 60_000);
    assert_eq!(seen.kernel.faults(), []);
    let (mut lines, mut deepest) = (Vec::new(), f64::MAX);
    for sample in seen.synchronised() {
        let told = &sample.command;
        let (z, turned) = (told.axes[2].position.value(), told.spindles[0].angle.value());
        lines.push(z + M6.lead_mm * turned);
        deepest = deepest.min(z);
    }
    let middle = f64::midpoint(
        lines.iter().copied().fold(f64::MAX, f64::min),
        lines.iter().copied().fold(f64::MIN, f64::max),
    );
    let off = lines.iter().fold(0.0_f64, |most, line| most.max((line - middle).abs()));
    assert!(off < 1e-6, "{off} mm");
    assert!((deepest - M6.to_mm).abs() < 1e-3, "{deepest} mm");
}

#[test]
fn one_that_does_not_follow_stops_the_machine_also_while_it_only_turns() {
    let control = control_of(false);
    let mut drives = Drives::new();
    drives.slips_from = 3.5;
    let dwell = StepKind::Dwell(Time::s(1.0));
    let steps = [turn(0.0, 300.0), await_speed(), dwell, StepKind::End];
    let seen = run_on(&mut drives, &control, &steps, 20_000);
    let fault = seen.kernel.faults()[0];
    assert_eq!(fault.kind, FaultKind::SpindleFollowingError);
    let window = control.spindles[0].expect("one").windows.following_stop.value();
    assert!(fault.value >= window && fault.value < 1.2 * window, "{fault}");
}

/// A tap with an encoder that counts so many times what the drive turns: the first fault, and
/// whether the axis has gone in.
fn counted(counts: f64) -> (Option<Fault>, bool) {
    let control = control_of(true);
    let mut drives = Drives::at(0.0, counts);
    let seen = run_on(&mut drives, &control, &tapping(&M6), 60_000);
    let goes_in = seen.samples.iter().any(|sample| sample.report.state == State::TapIn);
    (seen.kernel.faults().first().copied(), goes_in)
}

/// The drive keeps its angle: a scale that is off by a hundredth is seen, which a drive that is
/// told a speed may slip.
#[test]
fn its_encoder_is_checked_as_well_and_more_sharply() {
    let (none, goes_in) = counted(1.0);
    assert!(none.is_none() && goes_in, "{none:?}");
    for (counts, kind) in [
        (-1.0, FaultKind::EncoderReversed),
        (0.0, FaultKind::EncoderStandsStill),
        (0.25, FaultKind::EncoderScale),
        (1.01, FaultKind::EncoderScale),
    ] {
        let (fault, goes_in) = counted(counts);
        let fault = fault.expect("one");
        assert!(fault.kind == kind && !goes_in, "{counts}: {fault}");
        let stated = fault.limit;
        assert!((fault.value - counts * stated).abs() < stated / 500.0 + 4.0, "{counts}: {fault}");
    }
}

#[test]
fn spun_by_hand_and_stopped_it_is_told_no_other_angle_than_it_has() {
    let control = control_of(false);
    let mut kernel = kernel::Kernel::new(control.clone());
    let mut drives = Drives::new();
    let mut told = Vec::new();
    for tick in 0..8000 {
        if tick == 100 {
            kernel.turn_manually(0, Spin::rpm(300.0), Time::s(1.0)).expect("it stands");
        }
        let command = kernel.tick(drives.feedback());
        told.push(command.spindles[0].angle.value());
        drives.exchange(&command);
    }
    assert_eq!(kernel.faults(), []);
    let most = told.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    assert!(most <= 5.0 * control.period.value() + 1e-9, "{most} rev in a period");
    assert!(told[7999] == told[7900] && told[7999] > 4.0, "{}", told[7999]);
}
