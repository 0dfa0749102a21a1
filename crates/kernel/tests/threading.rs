//! Turned threads: the axes are a function of the spindle's turns, on a simulated machine with all
//! its physics.
use crate::common::{Run, await_speed, control, line, machine, run_kernel_on, turn};
use canon::Position;
use kernel::{Kernel, Order};
use motion::{Corner, ThreadStretch};
use plan::StepKind;
use sim::SimulatedMachine;
use units::Angle;

pub(crate) const LEAD: f64 = 1.5;
pub(crate) const FROM: f64 = -5.0;
/// Of the axes of the machine in `common`, m/s² and m/s³: less than it can.
pub(crate) const ACCEL: f64 = 5e3;
const JERK: f64 = 5e5;
/// Servo period of that machine, s.
pub(crate) const PERIOD_S: f64 = 250e-6;

fn half(change: f64, n: f64) -> f64 {
    (0.75 * change * n * n / ACCEL).max((1.5 * change * n * n * n / JERK).sqrt())
}

/// A thread from Z−5 down over 15 mm at X0, out along a taper of 45° to X1.5, at a quarter of a
/// turn.
fn chain(rpm: f64) -> [StepKind; 2] {
    let n = rpm / 60.0;
    let (along, out) = ([0.0, 0.0, -LEAD], [LEAD, 0.0, -LEAD]);
    let thread = ThreadStretch {
        spindle: 0,
        start: Some(Angle::rev(0.25)),
        ends: false,
        from: [0.0, 0.0, FROM],
        to: [0.0, 0.0, FROM - 15.0],
        from_turn: 0.0,
        to_turn: 10.0,
        bend: [0.0; 3],
        entry: Corner { half: half(LEAD, n), ..Corner::default() },
        exit: Corner { beyond: out, half: half(LEAD, n), ..Corner::default() },
    };
    let taper = ThreadStretch {
        start: None,
        ends: true,
        from: thread.to,
        to: [1.5, 0.0, FROM - 16.5],
        from_turn: 10.0,
        to_turn: 11.0,
        entry: Corner { beyond: along, half: half(LEAD, n), ..Corner::default() },
        exit: Corner { half: half(LEAD, n), ..Corner::default() },
        ..thread
    };
    [StepKind::Thread(thread), StepKind::Thread(taper)]
}

pub(crate) fn steps(rpm: f64) -> Vec<StepKind> {
    let start = Position::xyz(0.0, 0.0, FROM);
    let mut steps =
        vec![line(Position::default(), start, 30.0, true), turn(0.0, rpm), await_speed()];
    steps.extend(chain(rpm));
    steps.push(StepKind::End);
    steps
}

pub(crate) fn run(rpm: f64) -> Run {
    let machine = machine(1);
    let kernel = Kernel::new(control(&machine));
    let mut machine = SimulatedMachine::new(machine).expect("it can be built");
    run_kernel_on(kernel, &mut machine, &steps(rpm), 40_000)
}

/// Kernel and machine, with the thread at S1200 before them.
fn loaded() -> (Kernel, SimulatedMachine) {
    let machine = machine(1);
    let mut kernel = Kernel::new(control(&machine));
    for (op, kind) in (0..).zip(steps(1200.0)) {
        kernel.push(&plan::Step { op, line: op + 1, kind }).expect("there is room");
    }
    (kernel, SimulatedMachine::new(machine).expect("it can be built"))
}

/// Distance of Z from the helix through the start at the start angle, µm.
pub(crate) fn off_um(z: f64, turns: f64, sense: f64) -> f64 {
    let phase = sense * (turns - 0.25) - (FROM - z) / LEAD;
    (phase - phase.round()) * LEAD * 1e3
}

#[test]
fn the_thread_is_on_the_same_helix_at_any_speed_and_either_way_round() {
    for rpm in [300.0, 1200.0, 2400.0, -1200.0] {
        let run = run(rpm);
        assert!(run.kernel.faults().is_empty(), "{rpm}: {:?}", run.kernel.faults());
        let run_in = half(LEAD, rpm.abs() / 60.0) * LEAD;
        let cut = run.samples.iter().filter(|s| {
            let z = s.axis(2).value();
            s.report.op == 3 && z < FROM - run_in - 0.5 && z > FROM - 14.0
        });
        let worst = cut
            .map(|s| off_um(s.axis(2).value(), s.spindle(0).value(), rpm.signum()).abs())
            .fold(0.0, f64::max);
        assert!(worst > 0.0 && worst < 5.0, "{rpm} rpm: {worst} µm");
        let last = run.samples.last().expect("it ran");
        let end = [0, 2].map(|i| last.command.axes[i].position.value());
        let off = [end[0] - 1.5, end[1] - (FROM - 16.5)];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{rpm} rpm: ends {off:?} mm off");
    }
}

/// A thread from Z−5 that begins with 1.5 mm and grows by 0.1 mm in each of 12 turns, over 25.2 mm,
/// at a quarter of a turn.
fn growing(rpm: f64) -> StepKind {
    let n = rpm / 60.0;
    StepKind::Thread(ThreadStretch {
        spindle: 0,
        start: Some(Angle::rev(0.25)),
        ends: true,
        from: [0.0, 0.0, FROM],
        to: [0.0, 0.0, FROM - 25.2],
        from_turn: 0.0,
        to_turn: 12.0,
        bend: [0.0, 0.0, -0.1],
        entry: Corner { half: half(LEAD, n) * 1.5, ..Corner::default() },
        exit: Corner { half: half(LEAD + 1.2, n) * 1.5, ..Corner::default() },
    })
}

#[test]
fn a_lead_that_grows_is_on_its_parabola_over_the_turns_at_any_speed_and_either_way_round() {
    for rpm in [300.0, 1200.0, -1200.0] {
        let start = Position::xyz(0.0, 0.0, FROM);
        let steps = [
            line(Position::default(), start, 30.0, true),
            turn(0.0, rpm),
            await_speed(),
            growing(rpm),
            StepKind::End,
        ];
        let machine = machine(1);
        let kernel = Kernel::new(control(&machine));
        let mut machine = SimulatedMachine::new(machine).expect("it can be built");
        let run = run_kernel_on(kernel, &mut machine, &steps, 40_000);
        assert!(run.kernel.faults().is_empty(), "{rpm}: {:?}", run.kernel.faults());
        let (mut worst, mut seen) = (0.0_f64, 0);
        for sample in run.samples.iter().filter(|s| s.report.op == 3) {
            let z = FROM - sample.axis(2).value();
            if (2.5..20.0).contains(&z) {
                // z = 1.5·n + 0.1·n²/2, solved for n
                let wanted = ((1.5_f64 * 1.5 + 2.0 * 0.1 * z).sqrt() - 1.5) / 0.1;
                let turn = rpm.signum() * (sample.spindle(0).value() - 0.25) - wanted;
                worst = worst.max((turn - turn.round()).abs() * (1.5 + 0.1 * wanted) * 1e3);
                seen += 1;
            }
        }
        assert!(
            seen > 100 && worst > 0.0 && worst < 5.0,
            "{rpm} rpm: {worst} µm in {seen} samples"
        );
        let end = run.samples.last().expect("it ran").command.axes[2].position.value();
        assert!((end - (FROM - 25.2)).abs() < 1e-9, "{rpm} rpm: ends at {end}");
    }
}

#[test]
fn emitted_setpoints_keep_the_acceleration_that_the_corners_were_made_for() {
    let rpm = 2400.0;
    let run = run(rpm);
    let h = 250e-6;
    let threading: Vec<_> = run.samples.iter().filter(|s| matches!(s.report.op, 3 | 4)).collect();
    for axis in [0, 2] {
        let q: Vec<f64> = threading.iter().map(|s| s.command.axes[axis].position.value()).collect();
        let accel = q.windows(3).map(|w| ((w[2] - 2.0 * w[1] + w[0]) / (h * h)).abs());
        let most = accel.fold(0.0, f64::max);
        // the spindle's own unevenness comes on top: 2 %
        assert!(most > 0.5 * ACCEL && most < 1.02 * ACCEL, "axis {axis}: {most} mm/s²");
    }
}

#[test]
fn an_alarm_in_the_thread_brings_spindle_and_axes_to_rest_together_on_the_helix() {
    let (mut kernel, mut machine) = loaded();
    let mut feedback = *bus::Machine::feedback(&machine);
    let (mut said, mut worst) = (false, 0.0_f64);
    for _ in 0..40_000 {
        let command = kernel.tick(&feedback);
        feedback = *bus::Machine::exchange(&mut machine, &command);
        let truth = bus::Machine::truth(&machine).expect("it is simulated");
        let z = truth.axes[2].value();
        if !said && z < FROM - 8.0 {
            kernel.report_alarm(kernel::Subject::Machine);
            said = true;
        }
        if said {
            worst = worst.max(off_um(z, truth.spindles[0].value(), 1.0).abs());
            if kernel.is_standing() && truth.spins[0].in_rpm().abs() < 0.1 {
                break;
            }
        }
    }
    assert!(said && !kernel.faults().is_empty() && kernel.is_standing());
    let z = bus::Machine::truth(&machine).expect("it is simulated").axes[2].value();
    assert!(z < FROM - 8.0 && z > FROM - 15.0, "{z}");
    assert!(worst > 0.0 && worst < 10.0, "{worst} µm");
}

#[test]
fn a_hold_waits_for_the_end_of_the_thread() {
    let (mut kernel, mut machine) = loaded();
    let mut feedback = *bus::Machine::feedback(&machine);
    let (mut ordered, mut end) = (false, 0.0);
    for _ in 0..40_000 {
        let command = kernel.tick(&feedback);
        feedback = *bus::Machine::exchange(&mut machine, &command);
        if !ordered && feedback.axes[2].position.value() < FROM - 3.0 {
            kernel.order(Order::FeedHold);
            ordered = true;
        }
        end = command.axes[2].position.value();
        if kernel.report().state == bus::State::Held {
            break;
        }
    }
    assert!(ordered && kernel.report().state == bus::State::Held);
    assert!((end - (FROM - 16.5)).abs() < 1e-9, "{end}");
}
