//! Everything that an operator, a program or a network client can ask of the control.
use super::state::Need;
use super::state::Need::{
    EmergencyStopArmed, EmergencyStopTriggered, FeedNotInhibited, Homed, NoAlarm, NoManualMotion,
    NoProgramUnderWay, NoSequenceHalfWay, NoTapInThread, NotRecovering, PowerOn, ProgramHeld,
    ProgramLoaded, ProgramNotStopped, ProgramUnderWay, ProgramWaitsForConfirmation,
    SequenceHalfWay, SpindleNotInhibited, Standstill, StateAcknowledged, TapInThread,
};
use crate::Refused;
use crate::job::restart;
use canon::Axis;
use core::fmt;
use std::path::PathBuf;
use units::{Angle, Coordinate, CoordinateSpeed, Spin, Time};

/// How an axis is jogged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Jog {
    /// On and on, at this speed, signed, as long as it is asked for again within [`Jog::LEASE`].
    Continuous(CoordinateSpeed),
    /// By this much from where the axis is told to be.
    Increment(Coordinate),
    /// By this much from where the handwheel has sent it so far.
    Handwheel(Coordinate),
    /// To this machine coordinate.
    To(Coordinate),
}

impl Jog {
    /// A continuous jog ends by itself after so long.
    pub const LEASE: Time = Time::s(0.2);
}

/// How a tool change that was left half way is led on, and what an operator says of the magazine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SequenceOrder {
    /// On to its end.
    GoOn,
    /// Back to where it began.
    Undo,
    /// The next step alone.
    Step,
    /// The step before alone, undone.
    StepBack,
    /// It was brought to rest by hand, with this tool in the spindle; 0 is none.
    Done(u32),
    /// This pocket of the carousel is at the spindle.
    Carousel(u32),
    /// This tool is in this pocket; tool 0: it is empty; pocket 0: the tool is not in the machine.
    Pocket(u32, u32),
}

/// A request.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Drives on or off.
    Power(bool),
    /// Press the emergency stop button (true) or release it: for tests of the chain.
    EmergencyStop(bool),
    /// Home an axis, or all in the machine's order.
    Home(Option<Axis>),
    /// Jog an axis.
    Jog(Axis, Jog),
    /// Bring every axis and spindle that is moved by hand to rest.
    JogStop,
    /// Turn a spindle by hand at this speed, as long as it is asked for again within
    /// [`Jog::LEASE`].
    TurnSpindle(usize, Spin),
    /// Bring a spindle to this angle within its turn, and hold it there.
    OrientSpindle(usize, Angle),
    /// Load a program.
    Load(PathBuf),
    /// Load a program that is written for another dialect than the machine's.
    LoadAs(PathBuf, interp::Dialect),
    /// Find where the program would be begun at a line, a hole or a tool, and say all that is
    /// restored before; the next start begins there. True: also where the program was changed since
    /// it was left half done.
    Search(restart::From, bool),
    /// Start the program that is loaded, from its beginning or from where the last search has led.
    Start,
    /// Execute blocks that are typed.
    ManualDataInput(String),
    /// Hold the feed.
    FeedHold,
    /// Go on after a hold.
    Resume,
    /// Go on after M0 or M1.
    Confirm,
    /// Give the program up.
    Stop,
    /// Back a tap out of the thread in which it was stopped.
    Retract,
    /// Take a tap out of its thread after drives, power or an encoder were gone.
    Recover,
    /// The operator has looked: no tool is in the work.
    ToolIsFree,
    /// Another workpiece is clamped, with this name, if it has one: what is cut counts for it.
    BeginWorkpiece(Option<String>),
    /// The workpiece is done.
    EndWorkpiece,
    /// The operator has compared what is in force with what the control wrote last.
    AcknowledgeState,
    /// Clear alarms; make ready for the next program.
    Reset,
    /// Hold after each block.
    SingleBlock(bool),
    /// Stop at M1.
    OptionalStop(bool),
    /// Switch the flood coolant, until the program does.
    Flood(bool),
    /// Switch the mist coolant, likewise.
    Mist(bool),
    /// Leave out blocks of this level of `/`, 1 to 9; acts on the next start.
    BlockSkip(u8, bool),
    /// Share of the programmed feed.
    FeedOverride(f64),
    /// Share of the rapids.
    RapidOverride(f64),
    /// Share of the programmed spindle speed.
    SpindleOverride(f64),
    /// Set the work offset in force so that the tool's tip is at this coordinate of the axis, mm.
    TouchOff(Axis, Coordinate),
    /// Set a work offset, 1 for G54: its zero is at this machine coordinate of the axis, mm.
    SetWorkOffset(u8, Axis, Coordinate),
    /// Set what the control believes of a tool, mm.
    EditTool(u32, ToolField, f64),
    /// A new tool is in its place: its life begins anew, and it is not worn.
    RenewTool(u32),
    /// Lead a tool change on that was left half way, or say where tools are.
    Sequence(SequenceOrder),
    /// So many holes or threads a tool may cut; none: they are only counted.
    LimitTool(u32, Option<u32>),
}

/// What of a tool is edited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolField {
    /// From the gauge line to the tip.
    Length,
    /// Cutting diameter.
    Diameter,
    /// Wear of the length, which is added to it.
    WearLength,
    /// Wear of the radius, which is added to it.
    WearRadius,
}

/// What is to be known of a request that was accepted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Accepted {
    /// In sentences; none as a rule.
    pub notes: Vec<String>,
}

/// Why a request was refused: the first of its needs that is not met, or what is wrong with the
/// request.
#[derive(Debug)]
pub enum Refusal {
    /// The control's state.
    State(Need),
    /// The request itself.
    Request(Refused),
}

impl Refusal {
    /// The request is wrong, and why.
    pub(super) fn because(sentence: impl Into<String>) -> Self {
        Self::Request(Refused::because(sentence))
    }
}

impl From<Refused> for Refusal {
    fn from(refused: Refused) -> Self {
        Self::Request(refused)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(need) => need.fmt(f),
            Self::Request(refused) => refused.fmt(f),
        }
    }
}

/// What homing needs.
const HOME: &[Need] = &[
    StateAcknowledged,
    EmergencyStopArmed,
    NoAlarm,
    PowerOn,
    NoProgramUnderWay,
    NoManualMotion,
    NoTapInThread,
    NoSequenceHalfWay,
    FeedNotInhibited,
];

/// What a jog to a place needs.
const JOG_TO: &[Need] = &[
    StateAcknowledged,
    EmergencyStopArmed,
    NoAlarm,
    PowerOn,
    NoProgramUnderWay,
    NoTapInThread,
    NoSequenceHalfWay,
    FeedNotInhibited,
];

/// What a program's start needs.
const START: &[Need] = &[
    ProgramLoaded,
    StateAcknowledged,
    EmergencyStopArmed,
    NoAlarm,
    PowerOn,
    NoProgramUnderWay,
    NoManualMotion,
    NoTapInThread,
    NoSequenceHalfWay,
    FeedNotInhibited,
    SpindleNotInhibited,
    Homed(None),
];

/// What leading a tool change on needs.
const LED_ON: &[Need] = &[
    SequenceHalfWay,
    StateAcknowledged,
    EmergencyStopArmed,
    NoAlarm,
    PowerOn,
    NoProgramUnderWay,
    NoManualMotion,
    NoTapInThread,
    FeedNotInhibited,
    SpindleNotInhibited,
    Homed(None),
];

/// What blocks that are typed need: the same without a loaded program, which comes first.
const TYPED: &[Need] = START.split_at(1).1;

impl Request {
    /// What it needs, in the order in which it is asked: the one table of what is allowed when.
    pub const fn needs(&self) -> &'static [Need] {
        const NOT_STOPPED: Need = ProgramNotStopped { tool_in_work: false };
        match self {
            Self::Power(true) => &[EmergencyStopArmed, NoAlarm, NoTapInThread],
            Self::Power(false) => &[NoProgramUnderWay, NoTapInThread, Standstill],
            Self::EmergencyStop(true)
            | Self::AcknowledgeState
            | Self::JogStop
            | Self::SingleBlock(_)
            | Self::OptionalStop(_)
            | Self::Flood(false)
            | Self::Mist(false)
            | Self::FeedOverride(_)
            | Self::RapidOverride(_)
            | Self::SpindleOverride(_) => &[],
            Self::EmergencyStop(false) => &[EmergencyStopTriggered],
            Self::Flood(true) | Self::Mist(true) => &[EmergencyStopArmed, NoAlarm, PowerOn],
            Self::Home(_) => HOME,
            Self::Jog(_, Jog::To(_)) => JOG_TO,
            Self::Jog(..) => &[
                EmergencyStopArmed,
                NoAlarm,
                PowerOn,
                NoProgramUnderWay,
                NoTapInThread,
                NoSequenceHalfWay,
                FeedNotInhibited,
            ],
            // at no speed a spindle is stopped
            Self::TurnSpindle(..) => &[
                EmergencyStopArmed,
                NoAlarm,
                PowerOn,
                NoProgramUnderWay,
                NoTapInThread,
                NoSequenceHalfWay,
            ],
            Self::OrientSpindle(..) => &[
                EmergencyStopArmed,
                NoAlarm,
                PowerOn,
                NoProgramUnderWay,
                NoTapInThread,
                NoSequenceHalfWay,
                SpindleNotInhibited,
            ],
            Self::Sequence(SequenceOrder::Done(_)) => {
                &[SequenceHalfWay, NoProgramUnderWay, NoManualMotion]
            }
            Self::Sequence(SequenceOrder::Carousel(_) | SequenceOrder::Pocket(..)) => {
                &[NoProgramUnderWay]
            }
            Self::Sequence(_) => LED_ON,
            Self::Load(_)
            | Self::LoadAs(..)
            | Self::BlockSkip(..)
            | Self::SetWorkOffset(..)
            | Self::EditTool(..)
            | Self::RenewTool(_)
            | Self::LimitTool(..) => &[NoProgramUnderWay],
            Self::Search(..) => &[ProgramLoaded, NoProgramUnderWay],
            Self::Start => START,
            Self::ManualDataInput(_) => TYPED,
            Self::BeginWorkpiece(_) | Self::EndWorkpiece => {
                &[NoProgramUnderWay, NoTapInThread, NoManualMotion]
            }
            Self::FeedHold => &[NotRecovering, ProgramUnderWay, NoAlarm],
            Self::Resume => &[
                ProgramUnderWay,
                NoAlarm,
                NOT_STOPPED,
                FeedNotInhibited,
                SpindleNotInhibited,
                ProgramHeld,
            ],
            Self::Confirm => &[
                ProgramUnderWay,
                NoAlarm,
                NOT_STOPPED,
                FeedNotInhibited,
                SpindleNotInhibited,
                ProgramWaitsForConfirmation,
            ],
            Self::Stop => &[NotRecovering, ProgramUnderWay],
            Self::Retract | Self::Recover | Self::ToolIsFree => &[TapInThread],
            Self::Reset => &[EmergencyStopArmed, NoProgramUnderWay, NoTapInThread, NoManualMotion],
            Self::TouchOff(..) => &[NoProgramUnderWay, NoManualMotion, Homed(None)],
        }
    }
}
