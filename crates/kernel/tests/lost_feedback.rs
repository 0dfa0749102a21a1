//! Feedback that is lost while an axis is jogged, homed or stands beside a turning spindle: the
//! axis gets no force, is seen again when its readings are back, and everything ends off.
use crate::campaign::Dice;
use crate::common::*;
use bus::{DriveReaction, Feedback, Machine, Sample};
use canon::Axis;
use kernel::{HomingMethod, HomingOrder, Kernel, ManualOrder};
use motion::{Goal, OnlineLimits, Step};
use sim::{Faulty, HomeSwitch, IndexMarks, LeftAlone, PowerOn, SimulatedMachine, Travel};
use units::{Coordinate, Stiffness, Time};

/// What goes wrong with the feedback, for how long.
#[derive(Clone, Copy, Debug)]
enum Lost {
    /// No new frames, s.
    Frames(f64),
    /// An axis' encoder gives no number, s.
    Numbers(usize, f64),
    /// It says the same from then on.
    Stuck(usize),
    /// It is off by so much from then on, mm.
    Jump(usize, f64),
}

impl Lost {
    /// What is said instead, since a while, s; `then`: what was said when it began.
    fn spoil(self, said: &mut Feedback, then: &Feedback, since_s: f64) {
        match self {
            Self::Frames(lasts) if since_s < lasts => *said = *then,
            Self::Numbers(axis, lasts) if since_s < lasts => {
                said.axes[axis].position = Coordinate::new(f64::NAN);
            }
            Self::Stuck(axis) => said.axes[axis].position = then.axes[axis].position,
            Self::Jump(axis, by) => said.axes[axis].position += Coordinate::new(by),
            Self::Frames(_) | Self::Numbers(..) => {}
        }
    }

    /// This axis gives nothing that can be used so long after it began.
    fn is_blind(self, axis: usize, since_s: f64) -> bool {
        match self {
            Self::Frames(lasts) => since_s < lasts,
            Self::Numbers(of, lasts) => of == axis && since_s < lasts,
            Self::Stuck(of) => of == axis,
            Self::Jump(..) => false,
        }
    }
}

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Doing {
    /// X and Z are jogged.
    Jog,
    /// X looks for its reference.
    Homing,
    /// The spindle turns, the axes stand.
    Turning,
}

#[derive(Clone)]
struct Bench {
    machine: Faulty<SimulatedMachine>,
    kernel: Kernel,
    samples: Vec<Sample>,
}

impl Bench {
    fn new(doing: Doing) -> Self {
        let mut config = machine(1);
        config.substep = Time::s(25e-6);
        if doing == Doing::Homing {
            config.axes.truncate(1);
            config.axes[0].1.travel = Travel {
                stops: Some((
                    Coordinate::new(-66.0),
                    Coordinate::new(6.0),
                    Stiffness::n_per_mm(80_000.0),
                )),
                limit_switches: Some((Coordinate::new(-63.0), Coordinate::new(3.0))),
                home_switch: Some(HomeSwitch {
                    from: Coordinate::new(-7.0),
                    to: Coordinate::new(100.0),
                    every: None,
                    hysteresis: Coordinate::new(0.05),
                }),
                index: Some(IndexMarks { at: Coordinate::new(1.0), every: Coordinate::new(16.0) }),
                absolute: false,
            };
            config.axes[0].1.start = Coordinate::new(-50.0);
            config.power_on = PowerOn::Known;
        }
        let mut kernel = Kernel::new(control(&config));
        if doing == Doing::Homing {
            kernel.forget_home(Axis::X);
        }
        let alone = LeftAlone {
            config: config.clone(),
            watchdog: Time::s(5e-3),
            on_silence: DriveReaction::QuickStop,
            on_power_loss: DriveReaction::QuickStop,
            bus: None,
        };
        let machine = SimulatedMachine::new(config).expect("the test's machine can be built");
        let machine = Faulty::new(machine, &[], 1).left_alone(alone);
        let mut bench = Self { machine, kernel, samples: Vec::new() };
        bench.run(0.1, None);
        bench.samples.clear();
        bench.begin(doing);
        bench
    }

    fn begin(&mut self, doing: Doing) {
        let limits = OnlineLimits { speed: 100.0, accel: 2000.0, jerk: 50_000.0 };
        let order = ManualOrder {
            goal: Goal::Speed(100.0),
            limits,
            ends: (-500.0, 500.0),
            lease: Some(Time::s(10.0)),
        };
        match doing {
            Doing::Jog => {
                self.kernel.move_manually(Axis::X, order).unwrap();
                let down = ManualOrder { goal: Goal::Speed(-60.0), ..order };
                self.kernel.move_manually(Axis::Z, down).unwrap();
            }
            Doing::Homing => {
                let order = HomingOrder {
                    method: HomingMethod::SwitchAndIndex,
                    positive: true,
                    off_switch: false,
                    fast: 50.0,
                    slow: 20.0,
                    accel: 2000.0,
                    jerk: 200_000.0,
                    reference: 1.0,
                    search: 74.0,
                    index_spacing: 16.0,
                    pull_off: 1.0,
                    force_share: 0.1,
                };
                self.kernel.home(Axis::X, &order).unwrap();
            }
            Doing::Turning => {
                for kind in
                    [turn(0.0, 6000.0), await_speed(), motion::StepKind::Dwell(Time::s(9.0))]
                {
                    self.kernel.push(&Step { op: 0, line: 1, kind }).unwrap();
                }
            }
        }
    }

    /// So long; with what is lost from the beginning.
    fn run(&mut self, seconds: f64, lost: Option<Lost>) {
        let then = *self.machine.feedback();
        let end = then.time + Time::s(seconds);
        while self.machine.feedback().time < end {
            let mut feedback = *self.machine.feedback();
            let since_s = (feedback.time - then.time).value();
            if let Some(lost) = lost {
                lost.spoil(&mut feedback, &then, since_s);
            }
            let command = self.kernel.tick(&feedback);
            let truth = self.machine.truth().copied();
            self.samples.push(Sample { feedback, command, report: self.kernel.report(), truth });
            self.machine.exchange(&command);
        }
    }
}

/// What is wrong with how it ended.
fn wrong(doing: Doing, at_s: f64, lost: Lost) -> Vec<String> {
    let mut bench = Bench::new(doing);
    bench.run(at_s, None);
    let before = bench.samples.split_off(bench.samples.len() - 8);
    bench.samples.clear();
    bench.run(1.5, Some(lost));
    let is_alarm = |s: &Sample| s.report.state == bus::State::Faulted;
    let Some(alarm) = bench.samples.iter().position(is_alarm) else { return Vec::new() };
    let axes = if doing == Doing::Homing { 1 } else { 3 };
    let place = |s: &Sample, axis: usize| s.truth.unwrap().axes[axis].value();
    let stop = &bench.samples[alarm..];
    let mut wrong = Vec::new();
    for axis in 0..axes {
        let all: Vec<&Sample> = before.iter().chain(&bench.samples).collect();
        let first = all.len() - stop.len();
        let speed =
            (place(all[first], axis) - place(all[first - 7], axis)).abs() / (7.0 * PERIOD.value());
        let most = if speed < 0.5 { 0.2 } else { speed * 0.015 + speed * speed / 4000.0 + 0.5 };
        let went = stop.iter().map(|s| (place(s, axis) - place(&stop[0], axis)).abs());
        let went = went.fold(0.0, f64::max);
        if went > most {
            wrong
                .push(format!("axis {axis} went {went:.3} mm from {speed:.1} mm/s, not {most:.3}"));
        }
        let weight = if axis == 2 { 150.0 * 9.81 } else { 0.0 };
        let unseen = stop.iter().enumerate().filter(|(k, s)| {
            lost.is_blind(axis, (alarm + k) as f64 * PERIOD.value()) && s.command.axes[axis].enable
        });
        let most = unseen.map(|(_, s)| s.command.axes[axis].force.value().abs());
        let most = most.fold(0.0, f64::max);
        // an axis that stands is not seen to be stuck, and its loop holds it where it is
        let stands = matches!(lost, Lost::Stuck(_)) && speed < 0.5;
        if most > weight + 1.0 && !stands {
            wrong.push(format!("axis {axis} gets {most:.0} N without feedback"));
        }
    }
    let last = stop[stop.len() - 1];
    if last.command.axes.iter().any(|axis| axis.enable)
        || last.command.spindles.iter().any(|spindle| spindle.enable)
    {
        wrong.push("outputs are on in the end".into());
    }
    if last.truth.unwrap().spins[0].value().abs() > 0.1 {
        wrong.push(format!("the spindle turns in the end: {:?}", last.truth.unwrap().spins[0]));
    }
    wrong
}

fn lost(dice: &mut Dice) -> Lost {
    let lasts = 0.25e-3 * 400.0_f64.powf(dice.unit());
    let axis = (dice.unit() * 2.0) as usize * 2;
    match (dice.unit() * 4.0) as u32 {
        0 => Lost::Frames(lasts),
        1 => Lost::Numbers(axis, lasts),
        2 => Lost::Stuck(axis),
        _ => Lost::Jump(axis, (dice.unit() - 0.5) * 2.0),
    }
}

#[test]
fn whatever_is_lost_in_a_jog_in_homing_or_beside_a_spindle_nothing_runs_away() {
    let cases =
        if std::env::var("LEADSCREW_TESTS").is_ok_and(|size| size == "full") { 600 } else { 45 };
    let mut failed = Vec::new();
    for number in 0..cases {
        let mut dice = Dice((number as u64) << 32);
        let doing = [Doing::Jog, Doing::Homing, Doing::Turning][number as usize % 3];
        let mut lost = lost(&mut dice);
        if doing == Doing::Homing {
            lost = match lost {
                Lost::Numbers(_, lasts) => Lost::Numbers(0, lasts),
                Lost::Stuck(_) => Lost::Stuck(0),
                Lost::Jump(_, by) => Lost::Jump(0, by),
                frames @ Lost::Frames(_) => frames,
            };
        }
        let at_s = 0.05 + 1.5 * dice.unit();
        let found = wrong(doing, at_s, lost);
        failed.extend(
            found.iter().map(|w| format!("{number}: {doing:?}, {lost:?} at {at_s:.4}: {w}")),
        );
    }
    assert!(failed.is_empty(), "{} of {cases}:\n{}", failed.len(), failed.join("\n"));
}

#[test]
fn an_axis_that_is_seen_again_after_five_milliseconds_is_braked_from_where_it_is() {
    let mut bench = Bench::new(Doing::Jog);
    bench.run(0.5, None);
    bench.samples.clear();
    bench.run(1.0, Some(Lost::Numbers(0, 0.005)));
    // 103 switches everything off where nothing is tied: the drives stop by themselves
    assert_eq!(bench.kernel.faults()[0].kind, kernel::FaultKind::FeedbackInvalid);
    let x = |s: &Sample| s.truth.unwrap().axes[0].value();
    let way = x(&bench.samples[bench.samples.len() - 1]) - x(&bench.samples[0]);
    assert!(way > 0.2 && way < 2.0, "{way} mm");
    let mut bench = Bench::new(Doing::Jog);
    bench.run(0.5, None);
    bench.samples.clear();
    // a jump is bridged for some periods; then the axis is braked by its loop, at 2000 mm/s²
    bench.run(1.0, Some(Lost::Jump(0, 0.4)));
    assert_eq!(bench.kernel.faults()[0].kind, kernel::FaultKind::ReadingImplausible);
    let free = bench.samples.iter().filter(|s| {
        let x = s.command.axes[0];
        s.report.state == bus::State::Faulted && x.enable && x.force.value() == 0.0
    });
    assert!((3..8).contains(&free.count()));
    let way = x(&bench.samples[bench.samples.len() - 1]) - x(&bench.samples[0]);
    assert!(way > 2.0 && way < 100.0 * 100.0 / 4000.0 + 1.0, "{way} mm");
}
