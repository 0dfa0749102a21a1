//! The state model: what the control is, and what each request needs of it.
//!
//! ```text
//!                   start                 hold                  resume
//!   READY ───────────────────► ACTIVE ───────────► FEED_HOLD ───────────► ACTIVE
//!     ▲                        │  │ ▲  single block            resume
//!     │ load, reset            │  │ └─────────────► INTERRUPTED ───────► ACTIVE
//!     │                        │  │     M0                     confirm
//!     ├── PROGRAM_COMPLETED ◄──┘  ├───────────────► PROGRAM_STOPPED ───► ACTIVE
//!     │     end                   │     M1                     confirm
//!     └── STOPPED ◄───────────────┼───────────────► OPTIONAL_STOP ─────► ACTIVE
//!           stop, alarm           │  tool, input               it comes
//!           (from any of them)    └───────────────► WAIT ──────────────► ACTIVE
//! ```
//!
//! Execution says what the program does; what the axes do is the kernel's activity. Words are those
//! of `MTConnect`.
use core::fmt;

/// What the program does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Execution {
    /// Nothing: one may be started.
    #[default]
    Ready,
    /// It runs.
    Active,
    /// It waits for something that is no operator: an input, the tool changer.
    Wait,
    /// Held by the operator.
    FeedHold,
    /// Held after a block, in single block.
    Interrupted,
    /// At M1, until it is confirmed.
    OptionalStop,
    /// At M0, until it is confirmed.
    ProgramStopped,
    /// At its end.
    ProgramCompleted,
    /// Given up: by the operator, or by an alarm.
    Stopped,
}

/// What changes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExecutionEvent {
    /// A program or a block of MDI begins.
    Start,
    /// The operator holds it.
    Hold,
    /// A block of single block is done.
    BlockDone,
    /// M0.
    Stop,
    /// M1.
    OptionalStop,
    /// It waits for something that is no operator.
    Wait,
    /// What it waited for has come; the operator resumes or confirms.
    GoOn,
    /// It has come to its end.
    End,
    /// It was given up.
    GiveUp,
    /// The operator has reset the control, or loaded a program.
    Reset,
}

impl ExecutionEvent {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Start,
        Self::Hold,
        Self::BlockDone,
        Self::Stop,
        Self::OptionalStop,
        Self::Wait,
        Self::GoOn,
        Self::End,
        Self::GiveUp,
        Self::Reset,
    ];
}

impl Execution {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Ready,
        Self::Active,
        Self::Wait,
        Self::FeedHold,
        Self::Interrupted,
        Self::OptionalStop,
        Self::ProgramStopped,
        Self::ProgramCompleted,
        Self::Stopped,
    ];

    /// The transition table; `None`: this cannot happen here.
    pub const fn after(self, event: ExecutionEvent) -> Option<Self> {
        use ExecutionEvent as On;
        Some(match (self, event) {
            // a hold acts before the control hears of it, and looks like the end of a block
            (Self::Active | Self::Wait | Self::Interrupted, On::Hold) => Self::FeedHold,
            (Self::Active, On::BlockDone) => Self::Interrupted,
            (Self::Active, On::Stop) => Self::ProgramStopped,
            (Self::Active, On::OptionalStop) => Self::OptionalStop,
            (Self::Active, On::Wait) => Self::Wait,
            (Self::Ready | Self::ProgramCompleted | Self::Stopped, On::Start)
            | (
                Self::Wait
                | Self::FeedHold
                | Self::Interrupted
                | Self::OptionalStop
                | Self::ProgramStopped,
                On::GoOn,
            ) => Self::Active,
            (Self::Active | Self::Wait, On::End) => Self::ProgramCompleted,
            (from, On::GiveUp) if from.is_under_way() => Self::Stopped,
            (from, On::Reset) if !from.is_under_way() => Self::Ready,
            _ => return None,
        })
    }

    /// A program is between its start and its end.
    pub const fn is_under_way(self) -> bool {
        matches!(
            self,
            Self::Active
                | Self::Wait
                | Self::FeedHold
                | Self::Interrupted
                | Self::OptionalStop
                | Self::ProgramStopped
        )
    }

    /// As `MTConnect` writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ready => "READY",
            Self::Active => "ACTIVE",
            Self::Wait => "WAIT",
            Self::FeedHold => "FEED_HOLD",
            Self::Interrupted => "INTERRUPTED",
            Self::OptionalStop => "OPTIONAL_STOP",
            Self::ProgramStopped => "PROGRAM_STOPPED",
            Self::ProgramCompleted => "PROGRAM_COMPLETED",
            Self::Stopped => "STOPPED",
        }
    }
}

/// Who leads the axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The program that is loaded.
    Automatic,
    /// Blocks that are typed.
    ManualDataInput,
    /// Jog and handwheel.
    #[default]
    Manual,
}

impl Mode {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Automatic, Self::ManualDataInput, Self::Manual];

    /// As `MTConnect` writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Automatic => "AUTOMATIC",
            Self::ManualDataInput => "MANUAL_DATA_INPUT",
            Self::Manual => "MANUAL",
        }
    }
}

/// The emergency stop chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmergencyStop {
    /// Closed: the machine may be powered.
    #[default]
    Armed,
    /// Open.
    Triggered,
}

impl EmergencyStop {
    /// As `MTConnect` writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Armed => "ARMED",
            Self::Triggered => "TRIGGERED",
        }
    }
}

/// The drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Power {
    /// Without torque.
    #[default]
    Off,
    /// Under the kernel's control.
    On,
}

impl Power {
    /// As `MTConnect` writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "OFF",
            Self::On => "ON",
        }
    }
}

/// Something that a request needs; why it is refused without, and what would make it possible.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Need {
    /// The emergency stop chain is closed.
    EmergencyStopArmed,
    /// The emergency stop chain is open.
    EmergencyStopTriggered,
    /// No alarm.
    NoAlarm,
    /// The drives are on.
    PowerOn,
    /// All axes are homed; the first that is not.
    Homed(Option<char>),
    /// No program runs.
    NoProgramUnderWay,
    /// One does.
    ProgramUnderWay,
    /// No stop has given the program up; whether its tool is in the work.
    ProgramNotStopped {
        /// It stands in the work, and nothing ends the program until it is out.
        tool_in_work: bool,
    },
    /// It is held, or stopped by itself.
    ProgramHeld,
    /// It is stopped by itself, at M0 or M1.
    ProgramWaitsForConfirmation,
    /// A program is loaded.
    ProgramLoaded,
    /// No axis moves by hand and no spindle turns.
    Standstill,
    /// No axis moves by hand.
    NoManualMotion,
    /// A tap is held in its thread.
    TapInThread,
    /// No tap is held in its thread.
    NoTapInThread,
    /// No tool is being taken out by a recovery.
    NotRecovering,
    /// What is in force is what the control wrote last, or the operator has acknowledged it.
    StateAcknowledged,
    /// No door or other interlock holds the feed.
    FeedNotInhibited,
    /// None holds a spindle.
    SpindleNotInhibited,
    /// A tool change was left half way.
    SequenceHalfWay,
    /// No tool change was.
    NoSequenceHalfWay,
}

impl Need {
    /// All of them.
    pub const ALL: [Self; 21] = [
        Self::EmergencyStopArmed,
        Self::EmergencyStopTriggered,
        Self::NoAlarm,
        Self::PowerOn,
        Self::Homed(None),
        Self::NoProgramUnderWay,
        Self::ProgramUnderWay,
        Self::ProgramNotStopped { tool_in_work: false },
        Self::ProgramHeld,
        Self::ProgramWaitsForConfirmation,
        Self::ProgramLoaded,
        Self::Standstill,
        Self::NoManualMotion,
        Self::TapInThread,
        Self::NoTapInThread,
        Self::NotRecovering,
        Self::StateAcknowledged,
        Self::FeedNotInhibited,
        Self::SpindleNotInhibited,
        Self::SequenceHalfWay,
        Self::NoSequenceHalfWay,
    ];

    /// Its name, for programs.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::EmergencyStopArmed => "emergency_stop_armed",
            Self::EmergencyStopTriggered => "emergency_stop_triggered",
            Self::NoAlarm => "no_alarm",
            Self::PowerOn => "power_on",
            Self::Homed(_) => "homed",
            Self::NoProgramUnderWay => "no_program_under_way",
            Self::ProgramUnderWay => "program_under_way",
            Self::ProgramNotStopped { .. } => "program_not_stopped",
            Self::ProgramHeld => "program_held",
            Self::ProgramWaitsForConfirmation => "program_waits_for_confirmation",
            Self::ProgramLoaded => "program_loaded",
            Self::Standstill => "standstill",
            Self::NoManualMotion => "no_manual_motion",
            Self::TapInThread => "tap_in_thread",
            Self::NoTapInThread => "no_tap_in_thread",
            Self::NotRecovering => "not_recovering",
            Self::StateAcknowledged => "state_acknowledged",
            Self::FeedNotInhibited => "feed_not_inhibited",
            Self::SpindleNotInhibited => "spindle_not_inhibited",
            Self::SequenceHalfWay => "sequence_half_way",
            Self::NoSequenceHalfWay => "no_sequence_half_way",
        }
    }

    /// Why what needs it is refused without, and what would make it possible, where the reason does
    /// not say it.
    pub fn reason(&self) -> (String, Option<String>) {
        let sentence = self.to_string();
        match sentence.split_once(": ") {
            Some((reason, remedy)) => (reason.to_owned(), Some(remedy.to_owned())),
            None => (sentence, None),
        }
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::EmergencyStopArmed => "the emergency stop is triggered: release it, then reset",
            Self::EmergencyStopTriggered => "the emergency stop is not triggered",
            Self::NoAlarm => "an alarm has stopped the machine: mend its cause, then reset",
            Self::PowerOn => "the drives are not on: power on, and wait until they are ready",
            Self::Homed(Some(axis)) => return write!(f, "{axis} is not homed: home it first"),
            Self::Homed(None) => "not every axis is homed: home first",
            Self::NoProgramUnderWay => "a program is under way: wait for its end, or stop it",
            Self::ProgramUnderWay => "no program is under way: start one first",
            Self::ProgramNotStopped { tool_in_work: true } => {
                "the program was stopped and cannot go on: retract its tool, then start it again, or from a line"
            }
            Self::ProgramNotStopped { tool_in_work: false } => {
                "the program is being stopped and cannot go on: wait until everything stands, then start it again, or from a line"
            }
            Self::ProgramHeld => "the program is not held: hold it first",
            Self::ProgramWaitsForConfirmation => "nothing waits for a confirmation",
            Self::ProgramLoaded => "no program is loaded: load one first",
            Self::Standstill => "an axis moves or a spindle turns: stop it first",
            Self::NoManualMotion => "an axis is moved by hand: wait until it stands, or stop it",
            Self::TapInThread => "no tap stands in a thread",
            Self::NoTapInThread => "a tap stands in its thread: retract it, or recover it, first",
            Self::NotRecovering => "a tool is being taken out: the emergency stop alone stops that",
            Self::StateAcknowledged => "the state in force is not what the control wrote last: compare each value, then acknowledge the state",
            Self::FeedNotInhibited => "a door or another interlock holds the feed: close it first",
            Self::SpindleNotInhibited => "a door or another interlock holds a spindle: close it first",
            Self::SequenceHalfWay => "no tool change is half way",
            Self::NoSequenceHalfWay => "a tool change is half way: go on, undo it, or bring it to rest by hand (sequence), first",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_begins_only_where_none_is_under_way_and_every_one_can_be_given_up() {
        for state in Execution::ALL {
            let begins = state.after(ExecutionEvent::Start).is_some();
            assert_eq!(begins, !state.is_under_way(), "{state:?}");
            let given_up = state.after(ExecutionEvent::GiveUp);
            assert_eq!(given_up.is_some(), state.is_under_way(), "{state:?}");
        }
    }

    #[test]
    fn from_every_state_every_other_one_can_be_reached() {
        for from in Execution::ALL {
            let mut reached = vec![from];
            let mut at = 0;
            while let Some(state) = reached.get(at).copied() {
                at += 1;
                for next in ExecutionEvent::ALL.iter().filter_map(|event| state.after(*event)) {
                    if !reached.contains(&next) {
                        reached.push(next);
                    }
                }
            }
            assert_eq!(reached.len(), Execution::ALL.len(), "from {from:?}: {reached:?}");
        }
    }
}
