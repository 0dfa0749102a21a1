//! What is waited for, since when, and how long it may take: for a status line, and for who has to
//! do something.
use core::fmt;
use motion::{Await, InputWait};
use units::Time;

/// A wait under way.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Waiting {
    /// For what.
    pub what: WaitFor,
    /// Time at which it began.
    pub since: Time,
    /// How long it has lasted.
    pub age: Time,
    /// How long it may last; `None`: as long as it takes.
    pub limit: Option<Time>,
}

/// What is waited for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum WaitFor {
    /// The drives come up.
    Drives,
    /// A spindle reaches its speed, or comes to rest.
    SpindleSpeed(u8),
    /// A spindle comes to an angle.
    SpindleAngle(u8),
    /// A spindle is made ready for a tap.
    SpindleForTap(u8),
    /// A geared spindle reaches its gear.
    Gear(u8),
    /// All axes are in position.
    InPosition,
    /// The sync record is on the disk.
    SyncRecord,
    /// The changer puts a tool in.
    Tool(u32),
    /// A tool is put in by hand, and confirmed.
    ToolByHand(u32),
    /// An input.
    Input(InputWait),
    /// Digital inputs come to what a step of a machine sequence needs.
    Inputs {
        /// A bit for each that must be on.
        on: u64,
        /// A bit for each that must be off.
        off: u64,
    },
    /// Edges of a digital input.
    Edges(u8),
    /// The operator goes on after M0 (or M1, which is optional).
    Operator {
        /// M1.
        optional: bool,
    },
    /// What was measured is made use of.
    Measurement,
    /// A spindle makes its turns.
    SpindleTurns(u8),
    /// What is superposed fades.
    Fade,
    /// A door or another interlock that holds the feed is closed.
    FeedInterlock,
    /// The same, of a spindle, and the spindle has its speed again.
    SpindleInterlock,
}

impl WaitFor {
    /// It ends by an order of the operator, and by nothing else.
    pub const fn is_for_operator(self) -> bool {
        matches!(self, Self::Operator { .. } | Self::ToolByHand(_))
    }
}

impl fmt::Display for WaitFor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drives => f.write_str("drives ready"),
            Self::SpindleSpeed(index) => write!(f, "spindle {index} at speed"),
            Self::SpindleAngle(index) => write!(f, "spindle {index} at its angle"),
            Self::SpindleForTap(index) => write!(f, "spindle {index} ready to tap"),
            Self::Gear(index) => write!(f, "spindle {index} on its gear"),
            Self::InPosition => f.write_str("axes in position"),
            Self::SyncRecord => f.write_str("sync record on the disk"),
            Self::Tool(0) => f.write_str("spindle empty"),
            Self::Tool(number) => write!(f, "tool {number}"),
            Self::ToolByHand(0) => f.write_str("spindle emptied by hand"),
            Self::ToolByHand(number) => write!(f, "tool {number} by hand"),
            Self::Input(wait) => {
                let kind = if wait.digital { "input" } else { "analogue input" };
                let until = match wait.until {
                    Await::Nothing => "read",
                    Await::Rise => "rise",
                    Await::Fall => "fall",
                    Await::On => "high",
                    Await::Off => "low",
                };
                write!(f, "{kind} {} {until}", wait.number)
            }
            Self::Inputs { on, off } => {
                f.write_str("inputs")?;
                for number in 0..64_u8 {
                    let bit = 1_u64 << number;
                    if (on | off) & bit != 0 {
                        let state = if on & bit != 0 { "high" } else { "low" };
                        write!(f, " {number} {state}")?;
                    }
                }
                Ok(())
            }
            Self::Edges(input) => write!(f, "edges of input {input}"),
            Self::Operator { optional } => {
                write!(f, "operator: M{}", u8::from(*optional))
            }
            Self::Measurement => f.write_str("measurement"),
            Self::SpindleTurns(index) => write!(f, "turns of spindle {index}"),
            Self::Fade => f.write_str("superposition faded"),
            Self::FeedInterlock => f.write_str("feed no longer inhibited"),
            Self::SpindleInterlock => f.write_str("spindle no longer inhibited, and at its speed"),
        }
    }
}

impl fmt::Display for Waiting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {:.1} s", self.what, self.age.value())?;
        match self.limit {
            Some(limit) => write!(f, " of {} s", limit.value()),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn a_status_line_says_what_how_long_and_how_long_at_most() {
        let wait = InputWait { number: 3, digital: true, until: Await::On, longest: Time::s(10.0) };
        let since = Time::s(4.0);
        let limit = Some(wait.longest);
        let waiting = Waiting { what: WaitFor::Input(wait), since, age: Time::s(2.1), limit };
        assert_eq!(waiting.to_string(), "input 3 high, 2.1 s of 10 s");
        let waiting =
            Waiting { what: WaitFor::Operator { optional: false }, limit: None, ..waiting };
        assert_eq!(waiting.to_string(), "operator: M0, 2.1 s");
        assert_eq!(WaitFor::ToolByHand(12).to_string(), "tool 12 by hand");
        assert_eq!(WaitFor::SpindleSpeed(0).to_string(), "spindle 0 at speed");
    }
}
