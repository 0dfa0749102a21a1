//! What can go wrong on a machine, as states: each alarm has a number, a sentence, a cause and a remedy.
//!
//! ```text
//!   1xx  the machine      emergency stop, drives
//!   2xx  following        axis, spindle, sync error
//!   3xx  waits            speed, angle, position, tool
//!   4xx  orders           a step that this machine cannot execute
//!   5xx  homing           switches, marks and stops that are not where they should be
//! ```
//!
//! The alarm list of the manual is made from [`FaultKind::ALL`].
use crate::config::Subject;
use core::fmt;
use units::Axis;
use units::Time;

/// A kind of alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FaultKind {
    /// The emergency stop chain is open.
    EmergencyStop,
    /// A drive is not ready.
    DriveNotReady,
    /// An encoder or the clock gave no usable number.
    FeedbackInvalid,
    /// A drive reports an alarm, and can still brake.
    DriveAlarm,
    /// An encoder in a tap says what cannot be.
    ReadingImplausible,
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
    /// A spindle did not reach its speed in time.
    NotAtSpeed,
    /// A spindle did not come to the ordered angle in time.
    NotOriented,
    /// An axis did not come into position in time.
    NotInPosition,
    /// The tool was not changed in time.
    ToolNotChanged,
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
    /// A step orders an axis or spindle that is not configured.
    NotConfigured,
    /// A step begins where the axes are not.
    SetpointJump,
    /// A step moves an axis that does not know where it is.
    NotHomed,
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

/// Number, sentence, unit of the value, reaction, cause, remedy.
struct Text {
    number: u16,
    sentence: &'static str,
    unit: &'static str,
    reaction: Reaction,
    cause: &'static str,
    remedy: &'static str,
}

impl FaultKind {
    /// All of them, by rising number.
    pub const ALL: [Self; 32] = [
        Self::EmergencyStop,
        Self::DriveNotReady,
        Self::FeedbackInvalid,
        Self::DriveAlarm,
        Self::ReadingImplausible,
        Self::FollowingError,
        Self::SpindleFollowingError,
        Self::SyncError,
        Self::WrongSpinInCut,
        Self::CouplingLost,
        Self::ProbeContact,
        Self::NotAtSpeed,
        Self::NotOriented,
        Self::NotInPosition,
        Self::ToolNotChanged,
        Self::RatioNotHeld,
        Self::StillClamped,
        Self::PhaseNotReached,
        Self::RecordNotWritten,
        Self::ProbeNotReached,
        Self::NotConfigured,
        Self::SetpointJump,
        Self::TableMissing,
        Self::ProbeNotReady,
        Self::NotHomed,
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

    #[allow(clippy::too_many_lines)] // a table: an entry for each alarm
    const fn text(self) -> Text {
        match self {
            Self::EmergencyStop => Text {
                number: 101,
                sentence: "the emergency stop chain is open",
                unit: "",
                reaction: Reaction::Disable,
                cause: "An emergency stop button, a door switch or an over-travel switch.",
                remedy: "Remove the danger, release the button, start the control again.",
            },
            Self::DriveNotReady => Text {
                number: 102,
                sentence: "the drive is not ready",
                unit: "",
                reaction: Reaction::Disable,
                cause: "The drive has no power, or a fault of its own.",
                remedy: "Read the drive's own alarm; restore its power.",
            },
            Self::FeedbackInvalid => Text {
                number: 103,
                sentence: "the encoder gives no usable reading",
                unit: "",
                reaction: Reaction::Disable,
                cause: "A broken encoder line, or a fault of the field bus.",
                remedy: "Check encoder, cable and bus.",
            },
            Self::DriveAlarm => Text {
                number: 104,
                sentence: "a drive reports an alarm and asks for a stop",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The drive is too hot, its bus is low, or it has another complaint with which it can still brake.",
                remedy: "A tap in its hole comes out with a retract. Then read the drive's own alarm.",
            },
            Self::ReadingImplausible => Text {
                number: 105,
                sentence: "the encoder's reading jumps, stands still or is missing in a synchronised cut",
                unit: "",
                reaction: Reaction::Halt,
                cause: "A slipped or stuck encoder, a broken encoder line, or a fault of the field bus.",
                remedy: "Check encoder, cable and bus, start the control again so that the encoders are read anew, then recover the tool.",
            },
            Self::FollowingError => Text {
                number: 201,
                sentence: "following error too large",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "Collision, a jammed guideway, a drive at its force limit, or wrong loop data.",
                remedy: "Look for an obstacle; compare force and acceleration with the machine file.",
            },
            Self::SpindleFollowingError => Text {
                number: 202,
                sentence: "following error of the spindle's angle too large",
                unit: "rev",
                reaction: Reaction::Halt,
                cause: "The drive is at its torque or power limit, or the tool is stuck.",
                remedy: "Use a longer ramp or a lower speed; check tool and bore.",
            },
            Self::SyncError => Text {
                number: 203,
                sentence: "the feed axis left the thread's helix in the material",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "The spindle or the axis could not follow: drive limit, friction, a stuck tap.",
                remedy: "Do not move the axis alone: the tap is in its thread. Drive it out synchronised.",
            },
            Self::WrongSpinInCut => Text {
                number: 204,
                sentence: "the spindle cuts at the wrong speed or in the wrong sense",
                unit: "rev/s",
                reaction: Reaction::Halt,
                cause: "The load has pulled the spindle away from its speed, or it was reversed during the cut.",
                remedy: "Withdraw the tool; check its edges, feed and depth of cut against the drive's torque.",
            },
            Self::CouplingLost => Text {
                number: 205,
                sentence: "the geared spindle has lost its phase",
                unit: "rev",
                reaction: Reaction::Halt,
                cause: "Too much torque of the cut, a spindle drive at its limit, or a slipping encoder.",
                remedy: "The tool has left the work, if the machine file has control.phase_loss; else retreat from it. Reduce infeed or speed; check the encoders of both spindles.",
            },
            Self::ProbeContact => Text {
                number: 206,
                sentence: "the probe touches something in a move that is no probing",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The work or a clamp stands where the program has nothing, or the program rapids to where it should probe.",
                remedy: "Jog the probe off the way it came; check the work offset and the way of the probe.",
            },
            Self::ProbeNotReached => Text {
                number: 309,
                sentence: "the probe has not changed on the whole way of a probing move",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The work is not where the program looks for it, or the probe gives no signal.",
                remedy: "Check work offset, length of the probe and its battery; probe further, or with G38.3 or G38.5, which go on without contact.",
            },
            Self::ProbeNotReady => Text {
                number: 404,
                sentence: "a probing move begins with the probe as it shall end",
                unit: "",
                reaction: Reaction::Halt,
                cause: "G38.2 or G38.3 with the probe in contact already, or G38.4 or G38.5 without contact.",
                remedy: "Move off the work first, by G38.4 or G0; check the probe's signal.",
            },
            Self::NotAtSpeed => Text {
                number: 301,
                sentence: "the spindle did not reach its speed in time",
                unit: "rev/s",
                reaction: Reaction::Halt,
                cause: "Too high a load, a slipping belt, or a speed that the drive cannot reach.",
                remedy: "Check the load; lower S or lengthen control.waits.at_speed_s.",
            },
            Self::NotOriented => Text {
                number: 302,
                sentence: "the spindle did not come to its angle in time",
                unit: "rev",
                reaction: Reaction::Halt,
                cause: "The spindle is held fast, or its position loop is not stable.",
                remedy: "Turn the spindle by hand; check its loop data; lengthen control.waits.oriented_s.",
            },
            Self::NotInPosition => Text {
                number: 303,
                sentence: "the axis did not come into position in time",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "A constant force, friction, or too narrow a window.",
                remedy: "Check for contact; widen the axis' in_position_um.",
            },
            Self::ToolNotChanged => Text {
                number: 304,
                sentence: "the tool was not changed in time",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The changer is jammed, or the tool is not in the magazine.",
                remedy: "Free the changer; load the tool; lengthen control.waits.tool_change_s.",
            },
            Self::RatioNotHeld => Text {
                number: 305,
                sentence: "the geared spindle does not reach the speed of its gear: the ratio cannot be held",
                unit: "rev/s",
                reaction: Reaction::Halt,
                cause: "The ratio asks for more speed than the spindle has, or the drive is too weak.",
                remedy: "Reduce the master's speed; compare the spindle with the machine file.",
            },
            Self::StillClamped => Text {
                number: 306,
                sentence: "the geared spindle does not turn: it is still clamped",
                unit: "rev/s",
                reaction: Reaction::Halt,
                cause: "A clamp, a brake or a lock pin holds the spindle.",
                remedy: "Release the clamp before the gear is engaged.",
            },
            Self::PhaseNotReached => Text {
                number: 307,
                sentence: "the geared spindle has not reached its phase in time",
                unit: "rev",
                reaction: Reaction::Halt,
                cause: "A load on the spindle, loops that differ too much, or a window that is too narrow.",
                remedy: "Engage outside the work; compare window and loop data with the machine file.",
            },
            Self::RecordNotWritten => Text {
                number: 308,
                sentence: "the sync record is not on the disk, so the tool does not go in",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The disk with the state folder is full, read-only or too slow.",
                remedy: "Free the disk or name another folder with --state; then start again, from this hole.",
            },
            Self::NotConfigured => Text {
                number: 401,
                sentence: "ordered, but not configured on this machine",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The program was planned for another machine.",
                remedy: "Plan the program with the machine file that the control runs.",
            },
            Self::SetpointJump => Text {
                number: 402,
                sentence: "a step begins away from where the axis stands",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "The program was planned from another position.",
                remedy: "Plan the program again from where the axes stand.",
            },
            Self::TableMissing => Text {
                number: 403,
                sentence: "a step superposes a function that the control has not been given",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The table of a cam or an oscillation was not loaded before the step.",
                remedy: "Start the program again; report it if it comes back.",
            },
            Self::NotHomed => Text {
                number: 405,
                sentence: "a step moves an axis that is not homed",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The program was started before the axis had found its reference.",
                remedy: "Home the axis, then start the program again.",
            },
            Self::HomeSwitchNotFound => Text {
                number: 501,
                sentence: "the home switch was not found over the whole way",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "The switch or its cable is broken, its cam is gone, or homing goes the wrong way.",
                remedy: "Actuate the switch by hand and look at the input; check homing.direction and the travel in the machine file.",
            },
            Self::HomeSwitchNotReleased => Text {
                number: 502,
                sentence: "the home switch stays actuated while the axis backs off",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "The switch sticks, its cable is broken, it is connected the other way round, or it is another axis' switch.",
                remedy: "Actuate the switch by hand and look at the input; check the wiring.",
            },
            Self::IndexNotFound => Text {
                number: 503,
                sentence: "the encoder's index mark did not come",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "A broken line of the encoder, a dirty scale, or a wrong distance between marks in the machine file.",
                remedy: "Check encoder and cable; compare the screw's lead, or homing.index_every_mm, with the machine.",
            },
            Self::IndexAtSwitch => Text {
                number: 504,
                sentence: "the index mark lies too near to the edge of the home switch: the next homing may take its neighbour",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "The cam of the switch has been moved, or motor and screw have been coupled anew.",
                remedy: "Move the cam by half the distance between two marks, then set homing.reference anew.",
            },
            Self::HardStopNotFound => Text {
                number: 505,
                sentence: "no hard stop holds the axis over the whole way",
                unit: "mm",
                reaction: Reaction::Halt,
                cause: "The stop is gone, or homing goes the wrong way.",
                remedy: "Check the stop; check homing.direction and the travel in the machine file.",
            },
            Self::WrongLimitSwitch => Text {
                number: 506,
                sentence: "the limit switch of the other end is actuated",
                unit: "",
                reaction: Reaction::Halt,
                cause: "The two limit switches are connected the wrong way round, or motor and encoder both are.",
                remedy: "Actuate each limit switch by hand and look at the inputs.",
            },
            Self::MovesAgainstOrder => Text {
                number: 507,
                sentence: "the axis moves against its setpoint: its encoder counts the wrong way, or its motor turns the wrong way",
                unit: "mm",
                reaction: Reaction::Disable,
                cause: "The encoder's lines or the motor's phases are connected the wrong way round, or the drive's data are another motor's.",
                remedy: "Change the encoder's sense in the drive, then home again.",
            },
        }
    }
}

/// An alarm that has happened.
#[derive(Clone, Copy, Debug, PartialEq)]
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
            (Subject::Axis(Axis::A | Axis::B | Axis::C), "mm") => "°",
            (Subject::Machine | Subject::Axis(_) | Subject::Spindle(_), unit) => unit,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (number, sentence, unit) = (self.kind.number(), self.kind.sentence(), self.unit());
        write!(f, "alarm {number}: {}: {sentence}", self.subject)?;
        if !unit.is_empty() {
            write!(f, ": {:.4} {unit}, limit {:.4} {unit}", self.value, self.limit)?;
        }
        write!(f, " (line {}, {:.4} s)", self.line, self.time.value())
    }
}

/// The alarm list of the manual, in Markdown: a row of a table for each kind, by number (`docs/alarms.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlarmList;

impl fmt::Display for AlarmList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("# Alarms\n\n")?;
        f.write_str("What can stop a running machine. `Disable`: all outputs go off, the drives' own safety takes over. ")?;
        f.write_str("`Halt`: axes and spindles brake under control, coupled ones together, and are held.\n\n")?;
        f.write_str("While a tap is in its thread 102 and 103 brake coupled too, as far as what is left allows; outputs go off when everything stands.\n\n")?;
        f.write_str("What is wrong with a *program* is found before anything moves; `leadscrew check` says it with its code.\n\n")?;
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
