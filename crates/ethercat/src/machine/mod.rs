//! A machine on a network: feedback of axes, spindles and signals from what its devices say, and
//! what they are told from commands.
//!
//! ```text
//!   Bus::cycle ─► MachineDrives::read ─► Feedback        counts ─► mm, °, revolutions; 60FD, terminals
//!   Bus        ◄─ MachineDrives::write ◄─ Command        where each axis shall be when its drive obeys
//! ```
//!
//! A cycle whose frame is not complete gives the feedback of the last one.
mod counts;
mod power;
mod terminals;

pub use counts::CountScale;
pub use terminals::Terminal;

use crate::bus::{Bus, Cycle, Reply};
use crate::cia402::PdsState;
use crate::drive::{DriveAxis, DriveCommand, DriveFeedback};
use crate::network::DriveMode;
use bus::{AXES, AxisFeedback, Command, Feedback, SPINDLES, Signals, SpindleFeedback};
use counts::Unwrapped;
use power::Power;
use terminals::Terminals;
use units::{Angle, Coordinate, Force, Time, Torque};

/// Bit of the status word: a limit of the drive is reached.
const AT_LIMIT: u16 = 1 << 11;

/// Bits of 60FD that are switches of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxisInputs {
    /// Home switch.
    pub home: Option<u8>,
    /// Limit switches at the negative and at the positive end.
    pub limits: [Option<u8>; 2],
}

/// An axis of the machine or a spindle, and the drive that moves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LedDrive {
    /// Index of the axis or of the spindle in commands.
    pub index: usize,
    /// Index of the drive among those of the network.
    pub drive: usize,
    /// How it is commanded.
    pub mode: DriveMode,
    /// What a count is.
    pub scale: CountScale,
    /// Switches of an axis.
    pub inputs: AxisInputs,
    /// Rated torque of the motor, of which the drive says thousandths; `None`: it is not read.
    pub torque_rated: Option<Torque>,
}

/// How long drives take to obey.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ahead {
    /// Time after which each axis is where its drive was commanded to be.
    pub axes: [Time; AXES],
    /// The same of spindles.
    pub spindles: [Time; SPINDLES],
}

/// A drive that has found a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveFault {
    /// Index of the drive among those of the network.
    pub drive: usize,
    /// Its error code, 603F; 0 where that is not exchanged.
    pub code: u16,
}

/// A drive at work.
#[derive(Clone, Copy, Debug)]
struct Led {
    of: LedDrive,
    counted: Unwrapped,
    power: Power,
}

/// Everything that a machine has on its network.
#[derive(Clone, Debug)]
pub struct MachineDrives {
    axes: Vec<Led>,
    spindles: Vec<Led>,
    terminals: Terminals,
    feedback: Feedback,
    fault: Option<DriveFault>,
}

impl Led {
    const fn new(of: LedDrive) -> Self {
        Self { of, counted: Unwrapped::new(), power: Power::Off }
    }

    /// Takes what the drive says: its place, and whether it follows.
    fn take(&mut self, said: &DriveFeedback) -> (f64, bool) {
        let place = self.of.scale.value(self.counted.take(said.position));
        (place, self.power == Power::On && said.is_enabled())
    }

    /// What the drive measures of what it gives, as the load gets it: N, of a spindle N·m.
    fn effort(&self, said: &DriveFeedback, is_spindle: bool) -> Option<f64> {
        let share = f64::from(said.torque?) / 1000.0;
        Some(self.of.scale.effort((self.of.torque_rated? * share).value(), is_spindle))
    }

    /// Commands the drive; what is no number is not sent. Returns a fault that it has just found.
    fn command(
        &mut self,
        bus: &mut Bus<'_, '_>,
        enable: bool,
        place: f64,
        speed: f64,
    ) -> Option<DriveFault> {
        let LedDrive { drive, mode, scale, .. } = self.of;
        let axis = bus.drives().get(drive)?;
        let (said, before) = (*axis.feedback(), self.power);
        let (power, resets) = before.next(enable, said.state());
        self.power = power;
        if resets {
            bus.reset_fault(drive);
        }
        let counts = match mode {
            DriveMode::Csp => scale.counts(place),
            DriveMode::Csv => scale.counts(speed),
            DriveMode::Velocity => Some(scale.motor_rpm(speed))
                .filter(|rpm| rpm.is_finite())
                .map(|rpm| rpm.round().clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as i64),
            DriveMode::Cst => None,
        };
        let last = bus.drives().get(drive)?.sent_target();
        // a position goes on at the other end of 32 bits
        let target = counts.map_or(last, |counts| counts as i32);
        bus.command(drive, DriveCommand { wanted: power.wanted(), target });
        let has_failed = power == Power::Failed && before != power;
        has_failed.then(|| DriveFault { drive, code: said.error.unwrap_or(0) })
    }
}

/// Error code of a drive that has a fault.
fn code_of(said: &DriveFeedback) -> u16 {
    let has_fault = matches!(said.state(), Some(PdsState::Fault | PdsState::FaultReactionActive));
    said.error.filter(|_| has_fault).unwrap_or(0)
}

impl MachineDrives {
    /// A machine with these axes, spindles and terminals.
    pub fn new(axes: &[LedDrive], spindles: &[LedDrive], terminals: &[Terminal]) -> Self {
        let within = |most: usize| move |led: &&LedDrive| led.index < most;
        let led = |list: &[LedDrive], most| -> Vec<Led> {
            list.iter().filter(within(most)).map(|of| Led::new(*of)).collect()
        };
        // without a tool changer no tool is ever there
        let has_changer = terminals.iter().any(|t| matches!(t, Terminal::ToolChanger { .. }));
        let tool = (!has_changer).then_some(0);
        Self {
            axes: led(axes, AXES),
            spindles: led(spindles, SPINDLES),
            terminals: Terminals::new(terminals),
            feedback: Feedback { tool, ..Feedback::default() },
            fault: None,
        }
    }

    /// What the machine says after a cycle; its time is for the caller to say.
    pub fn read(&mut self, bus: &Bus<'_, '_>, cycle: &Cycle) -> Feedback {
        if !matches!(cycle.reply, Reply::Complete { .. }) {
            return self.feedback;
        }
        for led in &mut self.axes {
            let Some(said) = bus.drives().get(led.of.drive).map(DriveAxis::feedback) else {
                continue;
            };
            let (place, ready) = led.take(said);
            let bits = said.inputs.unwrap_or(0);
            let is_set = |bit: Option<u8>| bit.is_some_and(|bit| bits >> bit & 1 == 1);
            let AxisInputs { home, limits } = led.of.inputs;
            self.feedback.axes[led.of.index] = AxisFeedback {
                position: Coordinate::new(place),
                ready,
                home_switch: is_set(home),
                limit_switches: limits.map(is_set),
                force: led.effort(said, false).map(Force::n),
                fault_code: code_of(said),
                ..AxisFeedback::default()
            };
        }
        for led in &mut self.spindles {
            let Some(said) = bus.drives().get(led.of.drive).map(DriveAxis::feedback) else {
                continue;
            };
            let (turns, ready) = led.take(said);
            self.feedback.spindles[led.of.index] = SpindleFeedback {
                angle: Angle::rev(turns),
                ready,
                saturated: ready && said.status & AT_LIMIT != 0,
                torque: led.effort(said, true).map(Torque::n_m),
                fault_code: code_of(said),
                ..SpindleFeedback::default()
            };
        }
        self.terminals.read(bus, &mut self.feedback);
        self.feedback
    }

    /// Tells the devices what the machine shall do.
    pub fn write(&mut self, bus: &mut Bus<'_, '_>, command: &Command, ahead: &Ahead) {
        for led in &mut self.axes {
            let (told, after) = (&command.axes[led.of.index], ahead.axes[led.of.index]);
            let place = told.position.value() + told.speed.value() * after.value();
            let found = led.command(bus, told.enable, place, told.speed.value());
            self.fault = self.fault.or(found);
        }
        for led in &mut self.spindles {
            let (told, after) = (&command.spindles[led.of.index], ahead.spindles[led.of.index]);
            let turns = (told.angle + told.spin * after).value();
            let found = led.command(bus, told.enable, turns, told.spin.value());
            self.fault = self.fault.or(found);
        }
        self.terminals.write(bus, &command.outputs, Some(command.tool));
    }

    /// Commands nothing: drives off, outputs off; the tool stays.
    pub fn off(&mut self, bus: &mut Bus<'_, '_>) {
        for led in self.axes.iter_mut().chain(&mut self.spindles) {
            led.command(bus, false, 0.0, 0.0);
        }
        self.terminals.write(bus, &Signals::default(), None);
    }

    /// Forgets what drives have counted: the network is started anew. No drive is switched on
    /// before its control has taken the power away.
    pub fn restart(&mut self) {
        for led in self.axes.iter_mut().chain(&mut self.spindles) {
            *led = Led { power: Power::Failed, ..Led::new(led.of) };
        }
    }

    /// Takes the first fault that a drive has found since the last call.
    pub fn take_fault(&mut self) -> Option<DriveFault> {
        self.fault.take()
    }
}
