//! What can go wrong on a machine, as states: each alarm has a number, a sentence, a cause and a
//! remedy.
//!
//! ```text
//!   1xx  the machine      emergency stop, drives
//!   2xx  following        axis, spindle, sync error
//!   3xx  waits            speed, angle, position, tool
//!   4xx  orders           a step that this machine cannot execute, setpoints beyond limits, a control that is gone
//!   5xx  homing           switches, marks and stops that are not where they should be
//! ```
//!
//! The alarm list of the manual is made from [`FaultKind::ALL`].
mod text;

use crate::config::Subject;
use core::fmt;
use units::{AxisKind, Time};

/// A kind of alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FaultKind {
    /// The emergency stop chain is open.
    EmergencyStop,
    /// A drive is not ready.
    DriveNotReady,
    /// An encoder or the clock gave no usable number.
    FeedbackInvalid,
    /// A drive reports an alarm, and can still brake.
    DriveAlarm,
    /// An encoder says what cannot be.
    ReadingImplausible,
    /// The time of the feedback stands still, goes back or jumps.
    FeedbackStale,
    /// An axis is too far from its setpoint.
    FollowingError,
    /// A spindle under position control is too far from its setpoint.
    SpindleFollowingError,
    /// A follower is too far from its coupling in the material.
    SyncError,
    /// A cut goes on with the spindle far from its speed, or turning the wrong way.
    WrongSpinInCut,
    /// A geared spindle is too far from its gear.
    CouplingLost,
    /// A spindle turns faster than ordered, or the other way.
    SpindleRunsAway,
    /// A spindle has lost its speed.
    SpindleStalls,
    /// An axis has followed a coasting spindle as deep as it may.
    FollowsTooDeep,
    /// The encoder of a spindle that is told to turn counts nothing.
    EncoderStandsStill,
    /// The encoder of a spindle counts against the sense that is ordered.
    EncoderReversed,
    /// The encoder of a spindle counts another number of counts a turn than is configured.
    EncoderScale,
    /// The index mark of a spindle's encoder does not come.
    SpindleIndexMissing,
    /// The drive of a spindle says that it cannot bring it to its angle.
    OrientationFault,
    /// The torque of a tap is above its limit or its band.
    TapOverload,
    /// The torque of a tap is gone.
    TapCutsNothing,
    /// A spindle did not reach its speed in time.
    NotAtSpeed,
    /// A spindle did not come to the ordered angle in time.
    NotOriented,
    /// An axis did not come into position in time.
    NotInPosition,
    /// The tool was not changed in time.
    ToolNotChanged,
    /// An input that a machine sequence waits for did not come in time.
    InputsNotSeen,
    /// An input changed that must stay as it is while something moves.
    InputLost,
    /// A geared spindle did not reach the gear's speed in time.
    RatioNotHeld,
    /// A geared spindle does not turn at all.
    StillClamped,
    /// A geared spindle did not reach its phase in time.
    PhaseNotReached,
    /// A step superposes a function that the kernel has not been given.
    TableMissing,
    /// What must be known to take a tap out again could not be written down.
    RecordNotWritten,
    /// The probe touches something in a move that is no probing.
    ProbeContact,
    /// A probing move has come to its end, and the probe has not changed.
    ProbeNotReached,
    /// A probing move begins with the probe as it shall end.
    ProbeNotReady,
    /// A spindle whose turns are counted does not turn.
    TurnsNotMade,
    /// What runs the kernel has not answered a question in time.
    NotAnswered,
    /// A step orders an axis or spindle that is not configured.
    NotConfigured,
    /// A step begins where the axes are not.
    SetpointJump,
    /// A step moves an axis that does not know where it is.
    NotHomed,
    /// A setpoint is no number.
    SetpointInvalid,
    /// A setpoint is too far from the last one.
    SetpointSpeed,
    /// Setpoints ask for too much acceleration.
    SetpointAccel,
    /// Setpoints ask for too much jerk.
    SetpointJerk,
    /// A setpoint leaves the travel, or cannot stop before its end.
    SoftLimit,
    /// No step goes on with what is in motion.
    StepsRanOut,
    /// The thread in which the kernel ran has ended by itself.
    ServoThreadEnded,
    /// The process that leads the kernel shows no sign of life.
    ControlSilent,
    /// The process that leads the kernel sends what cannot be.
    ControlSenseless,
    /// What runs the kernel is being unloaded.
    ComponentUnloaded,
    /// The servo thread does not take what the control asks of it.
    RequestsNotTaken,
    /// The home switch is not where it is searched.
    HomeSwitchNotFound,
    /// The home switch stays actuated.
    HomeSwitchNotReleased,
    /// The encoder's index mark does not come.
    IndexNotFound,
    /// The index mark lies so near to the switch's edge that its neighbour may be taken for it.
    IndexAtSwitch,
    /// Nothing holds the axis.
    HardStopNotFound,
    /// The limit switch of the other end is actuated.
    WrongLimitSwitch,
    /// The axis moves against its setpoint.
    MovesAgainstOrder,
}

/// What the machine does at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Outputs off: the drives' own safety takes over.
    Disable,
    /// Brake axes and spindles under control, synchronised ones together, then hold.
    Halt,
}

impl FaultKind {
    /// All of them, by rising number.
    pub const ALL: [Self; 58] = [
        Self::EmergencyStop,
        Self::DriveNotReady,
        Self::FeedbackInvalid,
        Self::DriveAlarm,
        Self::ReadingImplausible,
        Self::FeedbackStale,
        Self::FollowingError,
        Self::SpindleFollowingError,
        Self::SyncError,
        Self::WrongSpinInCut,
        Self::CouplingLost,
        Self::ProbeContact,
        Self::SpindleRunsAway,
        Self::SpindleStalls,
        Self::FollowsTooDeep,
        Self::EncoderStandsStill,
        Self::EncoderReversed,
        Self::EncoderScale,
        Self::SpindleIndexMissing,
        Self::OrientationFault,
        Self::TapOverload,
        Self::TapCutsNothing,
        Self::NotAtSpeed,
        Self::NotOriented,
        Self::NotInPosition,
        Self::ToolNotChanged,
        Self::RatioNotHeld,
        Self::StillClamped,
        Self::PhaseNotReached,
        Self::RecordNotWritten,
        Self::ProbeNotReached,
        Self::TurnsNotMade,
        Self::NotAnswered,
        Self::InputsNotSeen,
        Self::InputLost,
        Self::NotConfigured,
        Self::SetpointJump,
        Self::TableMissing,
        Self::ProbeNotReady,
        Self::NotHomed,
        Self::SetpointInvalid,
        Self::SetpointSpeed,
        Self::SetpointAccel,
        Self::SetpointJerk,
        Self::SoftLimit,
        Self::StepsRanOut,
        Self::ServoThreadEnded,
        Self::ControlSilent,
        Self::ControlSenseless,
        Self::ComponentUnloaded,
        Self::RequestsNotTaken,
        Self::HomeSwitchNotFound,
        Self::HomeSwitchNotReleased,
        Self::IndexNotFound,
        Self::IndexAtSwitch,
        Self::HardStopNotFound,
        Self::WrongLimitSwitch,
        Self::MovesAgainstOrder,
    ];

    /// Its number in the alarm list.
    pub const fn number(self) -> u16 {
        self.text().number
    }

    /// What has happened.
    pub const fn sentence(self) -> &'static str {
        self.text().sentence
    }

    /// What the value and the limit of such a fault are measured in.
    pub const fn unit(self) -> &'static str {
        self.text().unit
    }

    /// What the machine does at once.
    pub const fn reaction(self) -> Reaction {
        self.text().reaction
    }

    /// Why it happens.
    pub const fn cause(self) -> &'static str {
        self.text().cause
    }

    /// What to do.
    pub const fn remedy(self) -> &'static str {
        self.text().remedy
    }
}

/// An alarm that has happened.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fault {
    /// Which.
    pub kind: FaultKind,
    /// On what.
    pub subject: Subject,
    /// What was measured, in [`FaultKind::unit`]; zero where nothing is.
    pub value: f64,
    /// What was allowed, likewise.
    pub limit: f64,
    /// When.
    pub time: Time,
    /// Index of the op that was being executed.
    pub op: u32,
    /// Its program line; 0 if there was none.
    pub line: u32,
}

impl Fault {
    /// Unit of its value and limit: a rotary axis is off by degrees.
    pub fn unit(&self) -> &'static str {
        match (self.subject, self.kind.unit()) {
            (Subject::Axis(axis), unit) if axis.kind() == AxisKind::Rotary => match unit {
                "mm" => "°",
                "mm/s" => "°/s",
                "mm/s²" => "°/s²",
                "mm/s³" => "°/s³",
                unit => unit,
            },
            (_, unit) => unit,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (number, sentence, unit) = (self.kind.number(), self.kind.sentence(), self.unit());
        write!(f, "alarm {number}: {}: {sentence}", self.subject)?;
        match self.kind {
            FaultKind::EncoderReversed | FaultKind::EncoderScale => {
                let (counts, stated) = (self.value, self.limit);
                write!(
                    f,
                    ": it counts {counts:.0} a turn where the machine's file says {stated:.0}: "
                )?;
                if self.kind == FaultKind::EncoderScale {
                    write!(f, "encoder_counts_per_rev = {counts:.0}, and ")?;
                }
                write!(f, "{counts:.0} as the scale of the encoder, would fit")?;
            }
            FaultKind::EncoderStandsStill => {
                let (counts, stated) = (self.value, self.limit);
                write!(f, ": it has counted {counts:.0} in a turn, and {stated:.0} would fit")?;
            }
            FaultKind::OrientationFault => write!(f, ": its fault code is {:.0}", self.value)?,
            FaultKind::DriveNotReady if self.value > 0.0 => {
                write!(f, ": its error code is {:04X}", self.value as u16)?;
            }
            _ if unit.is_empty() => {}
            _ => write!(f, ": {:.4} {unit}, limit {:.4} {unit}", self.value, self.limit)?,
        }
        write!(f, " (line {}, {:.4} s)", self.line, self.time.value())
    }
}

/// The alarm list of the manual, in Markdown: a row of a table for each kind, by number
/// (`docs/alarms.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlarmList;

impl fmt::Display for AlarmList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "# Alarms\n\n\
             What can stop a running machine. `Disable`: all outputs go off, the drives' own safety takes\n\
             over. `Halt`: axes and spindles brake under control, coupled ones together, and are held.\n\n\
             While a tap is in its thread 102, 103 and 106 brake coupled too, as far as what is left\n\
             allows; outputs go off when everything stands.\n\n\
             A drive without a usable reading (103, 105, 106) gets no force but what bears its weight, and\n\
             is off after 10 ms; if it reads again before, it is taken over as it moves and braked. Feed and\n\
             spindle of a thread are carried on their model until they read again, for 1 s at most\n\
             ([recovery](recovery.md#faults-of-feedback)).\n\n\
             601, *the state in force is not what the control wrote last*, is raised by the control at its\n\
             start and stops nothing: no program, no blocks and no homing are started until it is\n\
             acknowledged ([what outlives the control](state.md)).\n\n\
             What is wrong with a *program* is found before anything moves; `leadscrew check` says it with\n\
             its code. This page is written from `crates/kernel/src/fault/text.rs`.\n\n",
        )?;
        f.write_str("| number | alarm | reaction | cause | remedy |\n|---|---|---|---|---|\n")?;
        for kind in FaultKind::ALL {
            let reaction = match kind.reaction() {
                Reaction::Disable => "Disable",
                Reaction::Halt => "Halt",
            };
            let (number, sentence) = (kind.number(), kind.sentence());
            let (cause, remedy) = (kind.cause(), kind.remedy());
            writeln!(f, "| {number} | {sentence} | {reaction} | {cause} | {remedy} |")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_alarm_has_its_own_number_and_says_what_to_do() {
        for (i, kind) in FaultKind::ALL.iter().enumerate() {
            assert!(FaultKind::ALL[..i].iter().all(|k| k.number() < kind.number()), "{kind:?}");
            for text in [kind.sentence(), kind.cause(), kind.remedy()] {
                assert!(text.len() > 10, "{kind:?}: {text}");
            }
        }
    }

    #[test]
    fn an_alarm_of_an_axis_reads_in_the_unit_of_that_axis() {
        let said = |kind, axis| {
            let (subject, time) = (Subject::Axis(axis), Time::s(1.5));
            let fault = Fault { kind, subject, value: 110.5, limit: 110.0, time, op: 0, line: 3 };
            std::string::ToString::to_string(&fault)
        };
        for (kind, linear, rotary) in [
            (FaultKind::SoftLimit, "mm", "°"),
            (FaultKind::FollowingError, "mm", "°"),
            (FaultKind::SetpointSpeed, "mm/s", "°/s"),
            (FaultKind::SetpointAccel, "mm/s²", "°/s²"),
            (FaultKind::SetpointJerk, "mm/s³", "°/s³"),
        ] {
            for axis in units::Axis::ALL {
                let is_rotary = matches!(axis.letter(), 'A'..='C');
                let unit = if is_rotary { rotary } else { linear };
                let expected = std::format!(": 110.5000 {unit}, limit 110.0000 {unit} (line 3");
                let text = said(kind, axis);
                assert!(text.contains(&expected), "{text}");
            }
        }
    }

    #[test]
    fn the_alarm_list_names_them_all() {
        let list = std::string::ToString::to_string(&AlarmList);
        for kind in FaultKind::ALL {
            assert!(list.contains(kind.sentence()) && list.contains(kind.remedy()), "{list}");
        }
        let row = "| 101 | the emergency stop chain is open | Disable | ";
        assert!(list.contains(row), "{list}");
        assert!(
            !FaultKind::ALL
                .iter()
                .any(|k| [k.sentence(), k.cause(), k.remedy()].concat().contains('|'))
        );
    }

    #[test]
    fn the_manuals_page_of_alarms_is_this_list() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/alarms.md");
        let list = std::string::ToString::to_string(&AlarmList);
        if std::env::var_os("UPDATE_ALARMS").is_some() {
            std::fs::write(page, &list).unwrap();
        }
        let written = std::fs::read_to_string(page).unwrap_or_default();
        assert!(written == list, "UPDATE_ALARMS=1 cargo test -p kernel writes docs/alarms.md anew");
    }
}
