//! What happened, for people: typed events in a ring of fixed size.
//!
//! ```text
//!   tick ──► [ e₇ e₈ e₉ … ] ──► the caller of next_event()
//!             └ full: the oldest goes, and is counted
//! ```
use crate::fault::Fault;
use crate::operator::Notice;
use crate::supervised::Supervised;
use crate::waiting::WaitFor;
use alloc::collections::VecDeque;
use motion::{InputWait, Output};
use sync::Figures;
use units::{Axis, Coordinate, Length, Position, Spin, Time};

/// Events kept for who has not asked yet.
pub const EVENTS: usize = 256;

/// One event.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// When.
    pub time: Time,
    /// Index of the op that was being executed.
    pub op: u32,
    /// Its program line.
    pub line: u32,
    /// What.
    pub kind: EventKind,
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[allow(clippy::large_enum_variant)] // no memory is taken in a servo period: none is boxed
pub enum EventKind {
    /// All drives are up.
    DrivesReady,
    /// An alarm.
    FaultRaised(Fault),
    /// An axis' following error has passed its warning window.
    FollowingWarning {
        /// Which axis.
        axis: Axis,
        /// How far.
        error: Coordinate,
    },
    /// A spindle has come within its at-speed window.
    SpindleAtSpeed {
        /// Which.
        spindle: u8,
        /// What it was ordered.
        spin: Spin,
    },
    /// A spindle is held at the ordered angle.
    SpindleOriented {
        /// Which.
        spindle: u8,
    },
    /// A spindle is on its gear.
    SpindlesCoupled {
        /// Which follows.
        follower: u8,
    },
    /// The axis has left the hole, and the spindle is told to run against the cut.
    ChipRemovalBegun {
        /// Which.
        spindle: u8,
        /// At what speed.
        spin: Spin,
    },
    /// That speed is reached, and the spindle is told what it shall do before the next cut.
    ChipsThrown {
        /// Which.
        spindle: u8,
        /// At what speed.
        spin: Spin,
    },
    /// It does that.
    ChipRemovalEnded {
        /// Which.
        spindle: u8,
        /// At what speed; zero is at rest.
        spin: Spin,
    },
    /// An output is switched.
    OutputSet(Output),
    /// An input is read, what was waited for has come, or the wait has run out of its time.
    InputRead {
        /// Which, and what was waited for.
        wait: InputWait,
        /// What it was; `None`: the time has run out.
        value: Option<f64>,
    },
    /// A probing move has ended.
    Probed {
        /// Where the axes were when the probe changed, or at the end.
        contact: Position,
        /// It has changed.
        changed: bool,
    },
    /// No person is there to be asked: what a person confirms was taken to be confirmed.
    ConfirmedAutomatically(WaitFor),
    /// A code of the machine's own is done.
    UserCode {
        /// Its number after M.
        number: u16,
    },
    /// The tool is in the spindle.
    ToolChanged {
        /// Its number.
        tool: u32,
    },
    /// Spindle and axis are engaged and begin to go in.
    TapStarted,
    /// The sync error in the material has passed its warning window.
    SyncWarning {
        /// How far.
        error: Length,
    },
    /// Spindle and axis are out again.
    TapEnded(TapFigures),
    /// What supervision by torque saw of a stroke: at its end, or when it stopped it.
    TapSupervised(Supervised),
    /// A tool is about to be taken out after a stop: how far from its coupling it stands, and who
    /// goes back.
    RecoveryBegun {
        /// Along the follower.
        error: Length,
        /// `None`: it is on the coupling.
        mover: Option<sync::recovery::Mover>,
    },
    /// It is back on its coupling, and comes out along it.
    OnCoupling,
    /// It is out.
    RecoveryEnded(RecoveryFigures),
    /// A tool that was screwed to nothing is off the work.
    Withdrawn {
        /// From the start to being out.
        duration: Time,
    },
    /// An axis begins to look for its reference.
    HomingBegun {
        /// Which.
        axis: Axis,
    },
    /// An axis knows where it is.
    Homed {
        /// Which.
        axis: Axis,
        /// By how much the reference was off where the axis had it before; `None`: it had none, or
        /// none was looked for.
        deviation: Option<Coordinate>,
    },
    /// Homing was given up for the operator; the axis stands and does not know where it is.
    HomingStopped {
        /// Which.
        axis: Axis,
    },
    /// A limit switch has ended a move by hand that led onto it.
    StoppedBySwitch {
        /// Which.
        axis: Axis,
    },
    /// What the operator should know of an order.
    Operator(Notice),
    /// Waiting for the operator.
    Paused,
    /// The operator went on.
    Resumed,
    /// The program is over.
    ProgramEnded,
}

/// What a tap came to, as the kernel saw it by its encoders.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TapFigures {
    /// Sync error in the material.
    pub sync: Figures,
    /// Deepest coordinate reached, less the programmed one, along the way in: positive is an
    /// overrun.
    pub depth_error: Length,
    /// Highest speed of the spindle.
    pub spin: Spin,
    /// From engaging to leaving.
    pub duration: Time,
    /// The spindle's drive was at its limit.
    pub saturated: bool,
}

/// What a recovery came to, by the encoders.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RecoveryFigures {
    /// Distance from the coupling before anything moved, along the follower.
    pub error_before: Length,
    /// Who went back onto the coupling.
    pub mover: Option<sync::recovery::Mover>,
    /// Largest distance from the coupling on the way out.
    pub helix_error_max: Length,
    /// From the start to being out.
    pub duration: Time,
}

/// The ring.
#[derive(Clone, Debug)]
pub(crate) struct Ring {
    events: VecDeque<Event>,
}

impl Ring {
    pub(crate) fn new() -> Self {
        Self { events: VecDeque::with_capacity(EVENTS) }
    }

    #[allow(clippy::large_types_passed_by_value)] // it moves into the ring
    pub(crate) fn push(&mut self, event: Event) {
        if self.events.len() == EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }

    pub(crate) fn pop(&mut self) -> Option<Event> {
        self.events.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_ring_loses_the_oldest() {
        let mut ring = Ring::new();
        for line in 0..EVENTS as u32 + 3 {
            ring.push(Event { time: Time::ZERO, op: 0, line, kind: EventKind::Paused });
        }
        assert_eq!(ring.pop().map(|e| e.line), Some(3));
    }
}
