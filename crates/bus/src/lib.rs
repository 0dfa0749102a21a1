//! What crosses the kernel's edge each servo period: the narrow waist between control and machine.
//!
//! ```text
//!             Command (setpoints, force and torque references)
//!   kernel ───────────────────────────────────────────────────► machine: simulated, or real drives
//!          ◄───────────────────────────────────────────────────
//!             Feedback (encoders, switches, inputs, drive states, the time)
//!
//!   Sample = Feedback + Command + Report (the kernel's own view) + Truth (what only a simulator can know)
//! ```
//!
//! One writer per datum: `Feedback` is the machine's, `Command` and `Report` the kernel's. Signs:
//! an axis' force is positive along the axis; a spindle turns positive clockwise seen from behind
//! (M3).
#![no_std]
mod engaged_tool;
mod panel;
mod watched;

pub use engaged_tool::{EngagedTool, EngagementEvidence, RunDownKind, STANDSTILL, SpindleSense};
pub use panel::{MDI_KEYS, OverrideDial, Panel, WHEEL_STEPS_PER_UNIT, WheelTravel};
pub use watched::{WatchedInput, WatchedInputs};

use units::{
    Angle, Coordinate, CoordinateSpeed, Force, Lead, Length, Orientation, Spin, Time, Torque,
};

/// Axes a machine may have, in the order X Y Z A B C U V W.
pub const AXES: usize = 9;
/// Spindles a machine may have.
pub const SPINDLES: usize = 2;
/// Digital signals that a machine may have, of each direction.
pub const DIGITAL: usize = 64;
/// Analogue signals that a machine may have, of each direction.
pub const ANALOGUE: usize = 16;

/// What a machine says of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AxisFeedback {
    /// Position by its encoder: the scale, where it has one.
    pub position: Coordinate,
    /// Beside a scale: the position by the motor's own encoder, from a zero of its own.
    pub motor: Option<Coordinate>,
    /// The drive is powered and has no fault.
    pub ready: bool,
    /// The home switch is actuated.
    pub home_switch: bool,
    /// The limit switches at the negative and at the positive end of the travel are actuated.
    pub limit_switches: [bool; 2],
    /// Position, by the encoder that `position` is read from, at which its index mark passed, if it
    /// did during the last period.
    pub index: Option<Coordinate>,
    /// Force of the drive as it measures it, positive along the axis; `None` where it does not.
    pub force: Option<Force>,
    /// Error code of a drive that has found a fault; 0: none, or not known.
    pub fault_code: u16,
}

/// What a machine says of one spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpindleFeedback {
    /// Angle by its encoder, unwrapped: it goes on counting over turns.
    pub angle: Angle,
    /// Angle at which the index mark passed, if it did during the last period.
    pub index: Option<Angle>,
    /// The drive is powered and has no fault.
    pub ready: bool,
    /// The drive was at its torque or power limit during the last period.
    pub saturated: bool,
    /// A drive that orients the spindle by itself: it stands at the angle of
    /// [`SpindleCommand::orient`].
    pub oriented: bool,
    /// A drive that orients the spindle by itself cannot: its fault code; 0 is none.
    pub orient_fault: i32,
    /// Torque of the drive as it measures it, with the sign of the speed that it drives to; `None`
    /// where it does not.
    pub torque: Option<Torque>,
    /// Error code of a drive that has found a fault; 0: none, or not known.
    pub fault_code: u16,
}

/// Digital and analogue signals, each kind counted from 0: inputs that programs wait for (M66),
/// outputs that they switch (M62 to M65, M67, M68).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Signals {
    /// A bit for each; set is on.
    pub digital: u64,
    /// In the machine's own unit.
    pub analogue: [f64; ANALOGUE],
}

impl Signals {
    /// A digital signal is on; one that no machine has is off.
    pub const fn is_on(&self, number: u8) -> bool {
        (number as usize) < DIGITAL && self.digital >> number & 1 == 1
    }

    /// Switch a digital signal, if a machine can have it.
    pub const fn switch(&mut self, number: u8, on: bool) {
        if (number as usize) < DIGITAL {
            self.digital = self.digital & !(1 << number) | (on as u64) << number;
        }
    }
}

/// What a machine says, once a period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Feedback {
    /// Time since the machine was started, at the moment the encoders were read.
    pub time: Time,
    /// By axis, X first.
    pub axes: [AxisFeedback; AXES],
    /// By spindle.
    pub spindles: [SpindleFeedback; SPINDLES],
    /// The tool in the spindle; `None` while the changer is at work.
    pub tool: Option<u32>,
    /// The emergency stop chain is open.
    pub emergency_stop: bool,
    /// The probe is deflected, or its circuit is closed.
    pub probe: bool,
    /// How long before `time` the probe changed, if it did during the last period and the machine
    /// has seen when.
    pub probe_age: Option<Time>,
    /// Inputs of the machine and of its surroundings.
    pub inputs: Signals,
    /// Doors and the panel beside the machine.
    pub panel: Panel,
}

/// What the kernel wants of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AxisCommand {
    /// The drive shall be powered.
    pub enable: bool,
    /// Setpoint of position.
    pub position: Coordinate,
    /// Setpoint of speed.
    pub speed: CoordinateSpeed,
    /// Force reference: the kernel's position and speed loops plus feed-forward. Drives that close
    /// their own loops take position and speed instead.
    pub force: Force,
}

/// What the kernel wants of one spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpindleCommand {
    /// The drive shall be powered.
    pub enable: bool,
    /// Setpoint of the angle; follows the actual angle while only the speed is controlled. A drive
    /// that closes its own position loop takes it, and then it always goes on from the last one.
    pub angle: Angle,
    /// Setpoint of speed.
    pub spin: Spin,
    /// Torque reference.
    pub torque: Torque,
    /// A drive that orients the spindle by itself shall bring it to this angle within a turn, and
    /// hold it there.
    pub orient: Option<Orientation>,
    /// Its drive has said that it stands there: it may be locked.
    pub locked: bool,
}

/// What the kernel wants, once a period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Command {
    /// By axis, X first.
    pub axes: [AxisCommand; AXES],
    /// By spindle.
    pub spindles: [SpindleCommand; SPINDLES],
    /// The tool that shall be in the spindle; 0 is none.
    pub tool: u32,
    /// Flood coolant.
    pub flood: bool,
    /// Mist coolant.
    pub mist: bool,
    /// Outputs to the machine and to its surroundings.
    pub outputs: Signals,
    /// What the drives shall keep together, should they be left alone.
    pub coupled: Option<Coupled>,
}

/// An axis tied to a spindle: `place + lead·(θ − angle)`. Drives that can, brake both together on
/// this line when the control falls silent or the power fails.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Coupled {
    /// Index of the axis.
    pub axis: u8,
    /// Index of the spindle.
    pub spindle: u8,
    /// Angle of the spindle …
    pub angle: Angle,
    /// … to which this place of the axis belongs.
    pub place: Length,
    /// Travel of the axis per positive turn of the spindle.
    pub lead: Lead,
}

/// What drives do by themselves when they are left alone: the control has fallen silent, or the
/// mains have failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveReaction {
    /// Outputs off: brakes clamp, spindles coast.
    Off,
    /// Spindles coast; an axis that is tied to one goes with it.
    Coast,
    /// Each brakes by itself.
    QuickStop,
    /// Coupled ones brake together.
    CoupledStop,
}

/// What the kernel is doing; one row of `state` in the trace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum State {
    /// Nothing to do.
    #[default]
    Idle,
    /// A rapid move.
    Rapid,
    /// A cutting move.
    Feed,
    /// A programmed wait.
    Dwell,
    /// Waiting for the spindle to be at speed, oriented or at rest.
    SpindleWait,
    /// Waiting until the axes are in position.
    Settle,
    /// Changing the tool.
    ToolChange,
    /// Synchronised, going in.
    TapIn,
    /// Synchronised, at the bottom.
    TapBottom,
    /// Synchronised, coming out.
    TapOut,
    /// Coupling a spindle or an axis, or letting go of it.
    Couple,
    /// Couplings are engaged, and what was measured is being made use of.
    Measure,
    /// Waiting for the operator: a program's stop.
    Paused,
    /// Held by the operator: everything that was to stop stands, or slows down.
    Held,
    /// An axis is moved by hand: jog, handwheel, homing.
    Manual,
    /// Taking a tool out after a stop.
    Recovering,
    /// Stopped by a fault.
    Faulted,
    /// The program has ended.
    Ended,
}

impl State {
    /// Its name in traces and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Rapid => "rapid",
            Self::Feed => "feed",
            Self::Dwell => "dwell",
            Self::SpindleWait => "spindle-wait",
            Self::Settle => "settle",
            Self::ToolChange => "tool-change",
            Self::TapIn => "tap-in",
            Self::TapBottom => "tap-bottom",
            Self::TapOut => "tap-out",
            Self::Couple => "couple",
            Self::Measure => "measure",
            Self::Paused => "paused",
            Self::Held => "held",
            Self::Manual => "manual",
            Self::Recovering => "recovering",
            Self::Faulted => "faulted",
            Self::Ended => "ended",
        }
    }
}

/// The kernel's own view of the period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Report {
    /// What it is doing.
    pub state: State,
    /// Index of the op it works on, counted from 0 in the order of the program's ops.
    pub op: u32,
    /// Program line of that op.
    pub line: u32,
    /// Distance of the follower from its coupling, while one is engaged and the tool is in the
    /// material: the kernel's own monitor, from encoders.
    pub sync_error: Option<Length>,
}

/// What broke a tool: what was put on it, and what it withstands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ToolBreak {
    /// Torque and pull stressed its core together.
    Stress {
        /// Torque of the cut.
        torque: Torque,
        /// Axial force of the cut, without its sign.
        force: Force,
        /// What it withstands of torque alone.
        most_torque: Torque,
        /// What it withstands of force alone.
        most_force: Force,
    },
    /// It was moved across its axis in the work.
    Sideways {
        /// How far from where it went in.
        by: Length,
        /// What it withstands.
        most: Length,
    },
}

/// What only a simulated machine can know, for the judge and for people.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Truth {
    /// Where the tool side (table, ram, nose) of each axis really is.
    pub axes: [Coordinate; AXES],
    /// Force of the drive on each axis.
    pub axis_forces: [Force; AXES],
    /// Where each spindle's nose really is.
    pub spindles: [Angle; SPINDLES],
    /// Real speed of each spindle.
    pub spins: [Spin; SPINDLES],
    /// Torque of each spindle's drive.
    pub spindle_torques: [Torque; SPINDLES],
    /// Axial offset of the tool's edges from where the axis holds them: the holder's deflection.
    /// The cutting edges stand at `axis + tool_deflection` along the tool axis; on a grinder the
    /// wheel does, along its infeed axis, pressed back by the work and worn off.
    pub tool_deflection: Length,
    /// How far the tool's edges stand ahead of the spindle's nose; zero unless a clutch holder has
    /// let go.
    pub tool_turn: Angle,
    /// Torque of the cut on the spindle.
    pub cutting_torque: Torque,
    /// Axial force of the cut on the tool; of an insert that turns, the force along the cut.
    pub cutting_force: Force,
    /// The tool has broken.
    pub tool_broken: bool,
    /// What broke it, where that is known.
    pub broken_by: Option<ToolBreak>,
}

/// One servo period, recorded: what the judge and the trace are made from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// What the machine said at the period's start.
    pub feedback: Feedback,
    /// What the kernel answered.
    pub command: Command,
    /// The kernel's own view.
    pub report: Report,
    /// The world at the same moment as `feedback`, where it can be known.
    pub truth: Option<Truth>,
}

impl Sample {
    /// Where an axis really is: by the simulator if there is one, else by its encoder.
    #[inline]
    pub fn axis(&self, index: usize) -> Coordinate {
        self.truth.as_ref().map_or(self.feedback.axes[index].position, |t| t.axes[index])
    }

    /// Where a spindle really is, likewise.
    pub fn spindle(&self, index: usize) -> Angle {
        self.truth.as_ref().map_or(self.feedback.spindles[index].angle, |t| t.spindles[index])
    }
}

/// Anything that obeys a `Command` for one servo period and then says where it is.
pub trait Machine {
    /// Length of the servo period.
    fn period(&self) -> Time;
    /// What it says now, before any command.
    fn feedback(&self) -> &Feedback;
    /// Obey for one period; answer with what the encoders say at its end.
    fn exchange(&mut self, command: &Command) -> &Feedback;
    /// The world at the moment of the last feedback, where it can be known.
    fn truth(&self) -> Option<&Truth> {
        None
    }
}
