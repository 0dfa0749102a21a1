//! The end of an axis' travel: a plan may use all of it, with all of the axis' acceleration, and
//! begin to brake anywhere within a period; a plan that does not brake is stopped before a period's
//! way beyond it.
use crate::common::*;
use canon::Position;
use kernel::{Config, FaultKind, Kernel};
use motion::{Bounds, Limits, Move, Path, Phase, Profile};
use plan::{Step, StepKind};
use sim::SimulatedMachine;
use units::Coordinate;

const H: f64 = PERIOD.value();
/// Limits of each axis, mm/s and mm/s²: a tenth of a millimetre a period.
const SPEED: f64 = 400.0;
const ACCEL: f64 = 5000.0;
/// The end of Z's travel, mm.
const END: f64 = -40.0;
/// Parts of a period in which a ramp begins.
const PARTS: u32 = 16;

/// The test's control with that end of travel, and this limit of jerk, mm/s³.
fn config(jerk: f64) -> Config {
    let bounds = Bounds { speed: [SPEED; 9], accel: [ACCEL; 9], jerk: [jerk; 9] };
    let mut config =
        Config { motion: Limits { feed: bounds, rapid: bounds }, ..control(&machine(0)) };
    if let Some(z) = &mut config.axes[2] {
        z.travel = Some((Coordinate::new(END), Coordinate::new(1.0)));
    }
    config
}

/// A profile that is made phase by phase.
struct Made {
    profile: Profile,
    s: f64,
    v: f64,
}

impl Made {
    fn resting(duration: f64) -> Self {
        let mut profile = Profile::EMPTY;
        assert!(profile.push(Phase { duration, s: 0.0, v: 0.0, a: 0.0, j: 0.0 }));
        Self { profile, s: 0.0, v: 0.0 }
    }

    /// To another speed with that acceleration and jerk, the time-optimal way.
    fn ramp(mut self, to: f64, jerk: f64) -> Self {
        let sense = (to - self.v).signum();
        let (change, rise) = ((to - self.v).abs(), ACCEL / jerk);
        let even = change / ACCEL - rise;
        assert!(even >= 0.0, "the ramp is too short for its jerk");
        let rises = [(rise, 0.0, jerk), (even, ACCEL, 0.0), (rise, ACCEL, -jerk)];
        let mut s_and_v = (self.s, self.v);
        for (duration, a, j) in rises.into_iter().filter(|(duration, ..)| *duration > 0.0) {
            let (s, v) = s_and_v;
            let phase = Phase { duration, s, v, a: sense * a, j: sense * j };
            let end = phase.at(duration);
            s_and_v = (end.s, end.v);
            assert!(self.profile.push(phase));
        }
        (self.s, self.v) = (s_and_v.0, to);
        self
    }

    fn cruise(mut self, duration: f64) -> Self {
        let Self { s, v, .. } = self;
        assert!(self.profile.push(Phase { duration, s, v, a: 0.0, j: 0.0 }));
        self.s += v * duration;
        self
    }

    /// As a rapid of Z down to there.
    fn to(self, end: f64) -> StepKind {
        StepKind::Move(Box::new(Move {
            path: Path::Line { from: Position::default(), to: Position::xyz(0.0, 0.0, end) },
            profile: self.profile,
            rapid: true,
            per_revolution: false,
            exact_stop: true,
            floats: false,
            programmed: None,
        }))
    }
}

/// The alarms of a move, and the lowest setpoint of Z.
fn run(config: &Config, step: StepKind) -> (Vec<kernel::Fault>, f64) {
    let mut kernel = Kernel::new(config.clone());
    for (op, kind) in (0..).zip([step, StepKind::End]) {
        kernel.push(&Step { op, line: op + 1, kind }).expect("there is room");
    }
    let mut machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    let mut lowest = f64::INFINITY;
    let mut feedback = *bus::Machine::feedback(&machine);
    for _ in 0..1600 {
        let command = kernel.tick(&feedback);
        if command.axes[2].enable {
            lowest = lowest.min(command.axes[2].position.value());
        }
        feedback = *bus::Machine::exchange(&mut machine, &command);
    }
    (kernel.faults().to_vec(), lowest)
}

/// The acceleration comes at once, within a third of a period, within one and a quarter, and within
/// ten.
const RISES: [f64; 4] = [0.0, 1.0 / 3.0, 1.25, 10.0];

#[test]
fn a_rapid_may_brake_with_all_its_acceleration_to_the_very_end_of_the_travel() {
    for periods in RISES {
        let jerk = ACCEL / (periods * H);
        for part in 0..PARTS {
            let rest = (100.0 + f64::from(part) / f64::from(PARTS)) * H;
            let ramps = Made::resting(rest).ramp(SPEED, jerk).ramp(0.0, jerk);
            let cruise = (-END - ramps.s) / SPEED;
            assert!(cruise > 0.0, "{cruise}");
            let made = Made::resting(rest).ramp(SPEED, jerk).cruise(cruise).ramp(0.0, jerk);
            let (faults, lowest) = run(&config(jerk), made.to(END));
            assert_eq!(faults, [], "acceleration within {periods} periods, {part} of {PARTS}");
            assert!((lowest - END).abs() < 1e-6, "{lowest}");
        }
    }
}

#[test]
fn a_rapid_that_does_not_brake_is_stopped_within_a_period_s_way_of_the_end() {
    let most = END - 0.01 - SPEED * H;
    // a period's way and what that makes the way to rest longer, at 500 mm/s
    let least = END + 2.0 * 500.0 * H;
    for part in 0..PARTS {
        let rest = (100.0 + f64::from(part) / f64::from(PARTS)) * H;
        let even = Made::resting(rest).ramp(SPEED, f64::INFINITY).cruise(1.0);
        // √(2 · 40 mm · 5000 mm/s²) = 632 mm/s are never reached
        let faster = Made::resting(rest).ramp(632.0, f64::INFINITY);
        for (which, made) in [("even", even), ("faster and faster", faster)] {
            let mut config = config(f64::INFINITY);
            config.motion.rapid.speed = [700.0; 9];
            let (faults, lowest) = run(&config, made.to(2.0 * END));
            let kinds: Vec<_> = faults.iter().map(|fault| fault.kind).collect();
            assert_eq!(kinds, [FaultKind::SoftLimit], "{which}, {part} of {PARTS}");
            assert!(lowest > most && lowest < least, "{which}, {part} of {PARTS}: {lowest}");
        }
    }
}
