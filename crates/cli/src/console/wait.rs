//! What a line can wait for.
use control::operation::{Control, Execution, Status};

/// Something that becomes so.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Condition {
    /// The drives are up.
    Ready,
    /// The program does this, by its name in the standard.
    Execution(&'static str),
    /// The program is paused: at M0, at M1.
    Paused,
    /// Every axis is homed.
    Homed,
    /// No program is under way, nothing moves, no spindle turns.
    Standstill,
    /// The axes do this, by the activity's name.
    Activity(String),
    /// A line of the program is executed.
    Line(u32),
    /// A tool that is tied to a spindle is in the work; or none is.
    ToolInWork(bool),
    /// An alarm has stopped the machine.
    Alarm,
    /// So many features are good, and no other one is there.
    Features(usize),
}

/// Names of conditions, for people.
const KNOWN: &str = "ready, homed, standstill, active, held, interrupted, paused, completed, stopped, waiting, \
                     activity NAME, line N, tool in work, tool out, alarm, features N good";

impl Condition {
    /// From its words.
    pub(crate) fn read(words: &[&str]) -> Result<Self, String> {
        Ok(match words {
            ["ready"] => Self::Ready,
            ["homed"] => Self::Homed,
            ["standstill"] => Self::Standstill,
            ["active"] => Self::Execution(Execution::Active.name()),
            ["held"] => Self::Execution(Execution::FeedHold.name()),
            ["interrupted"] => Self::Execution(Execution::Interrupted.name()),
            ["paused"] => Self::Paused,
            ["completed"] => Self::Execution(Execution::ProgramCompleted.name()),
            ["stopped"] => Self::Execution(Execution::Stopped.name()),
            ["waiting"] => Self::Execution(Execution::Wait.name()),
            ["alarm"] => Self::Alarm,
            ["activity", name] => Self::Activity((*name).to_owned()),
            ["line", number] => Self::Line(
                number.parse().map_err(|_| format!("expected a line, found \"{number}\""))?,
            ),
            ["tool", "in", "work"] => Self::ToolInWork(true),
            ["tool", "out"] => Self::ToolInWork(false),
            ["features", number, "good"] => Self::Features(
                number.parse().map_err(|_| format!("expected a number, found \"{number}\""))?,
            ),
            _ => {
                return Err(format!(
                    "nothing becomes \"{}\": expected one of {KNOWN}, or a time",
                    words.join(" ")
                ));
            }
        })
    }

    /// Whether it is so.
    pub(crate) fn holds(&self, control: &Control) -> bool {
        let (execution, ..) = control.states();
        match self {
            Self::Execution(name) => execution.name() == *name,
            Self::Paused => {
                matches!(execution, Execution::ProgramStopped | Execution::OptionalStop)
            }
            Self::Ready => control.is_ready(),
            Self::Standstill => control.is_at_standstill(),
            Self::Activity(name) => control.activity().name() == name,
            Self::Line(line) => control.line() == *line,
            Self::ToolInWork(wanted) => control.is_tool_in_work() == *wanted,
            Self::Alarm => control.has_alarm(),
            Self::Homed => control.is_homed_all(),
            Self::Features(number) => {
                let Status { features, .. } = control.status();
                features.good == *number && features.failed + features.not_judged == 0
            }
        }
    }

    /// It becomes so or not, and time changes nothing of it: it is asked once.
    pub(crate) const fn is_answered_at_once(&self) -> bool {
        matches!(self, Self::Features(_))
    }
}
