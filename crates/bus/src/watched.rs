//! Inputs that must not be believed while nothing drives them: what stops the machine, and what
//! drives say of themselves: that they are ready, and their torque.
use crate::{AXES, SPINDLES};
use core::fmt;
use units::Axis;

/// An input of this kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatchedInput {
    /// The emergency stop chain is closed.
    EmergencyStop,
    /// No axis of a program moves.
    FeedInhibit,
    /// The feed is held.
    Hold,
    /// The program is given up.
    Stop,
    /// This spindle does not turn.
    SpindleInhibit(u8),
    /// The drive of this axis is ready.
    AxisReady(u8),
    /// The drive of this spindle is ready.
    SpindleReady(u8),
    /// The force that the drive of this axis measures.
    AxisForce(u8),
    /// The torque that the drive of this spindle measures.
    SpindleTorque(u8),
}

const SPINDLES_U8: u8 = SPINDLES as u8;
const AXES_U8: u8 = AXES as u8;
const FIRST_INHIBIT: u8 = 4;
const FIRST_SPINDLE: u8 = FIRST_INHIBIT + SPINDLES_U8;
const FIRST_AXIS: u8 = FIRST_SPINDLE + SPINDLES_U8;
const FIRST_FORCE: u8 = FIRST_AXIS + AXES_U8;
const FIRST_TORQUE: u8 = FIRST_FORCE + AXES_U8;
const END: u8 = FIRST_TORQUE + SPINDLES_U8;

impl WatchedInput {
    const fn bit(self) -> u8 {
        match self {
            Self::EmergencyStop => 0,
            Self::FeedInhibit => 1,
            Self::Hold => 2,
            Self::Stop => 3,
            Self::SpindleInhibit(number) => FIRST_INHIBIT + number % SPINDLES_U8,
            Self::SpindleReady(number) => FIRST_SPINDLE + number % SPINDLES_U8,
            Self::AxisReady(axis) => FIRST_AXIS + axis % AXES_U8,
            Self::AxisForce(axis) => FIRST_FORCE + axis % AXES_U8,
            Self::SpindleTorque(number) => FIRST_TORQUE + number % SPINDLES_U8,
        }
    }

    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..END).map(|bit| match bit {
            0 => Self::EmergencyStop,
            1 => Self::FeedInhibit,
            2 => Self::Hold,
            3 => Self::Stop,
            FIRST_TORQUE.. => Self::SpindleTorque(bit - FIRST_TORQUE),
            FIRST_FORCE.. => Self::AxisForce(bit - FIRST_FORCE),
            FIRST_AXIS.. => Self::AxisReady(bit - FIRST_AXIS),
            FIRST_SPINDLE.. => Self::SpindleReady(bit - FIRST_SPINDLE),
            _ => Self::SpindleInhibit(bit - FIRST_INHIBIT),
        })
    }
}

fn letter(axis: u8) -> char {
    Axis::ALL[usize::from(axis % AXES_U8)].letter().to_ascii_lowercase()
}

/// As a pin of HAL is named.
impl fmt::Display for WatchedInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::EmergencyStop => f.write_str("estop-ok"),
            Self::FeedInhibit => f.write_str("feed-inhibit"),
            Self::Hold => f.write_str("hold"),
            Self::Stop => f.write_str("stop"),
            Self::SpindleInhibit(number) => write!(f, "spindle.{number}.inhibit"),
            Self::SpindleReady(number) => write!(f, "spindle.{number}.ready"),
            Self::SpindleTorque(number) => write!(f, "spindle.{number}.torque-fb"),
            Self::AxisReady(axis) => write!(f, "{}.ready", letter(axis)),
            Self::AxisForce(axis) => write!(f, "{}.torque-fb", letter(axis)),
        }
    }
}

/// A set of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WatchedInputs(u64);

impl WatchedInputs {
    /// Each of them.
    pub const ALL: Self = Self((1 << END) - 1);

    /// The set of this mask; bits that stand for nothing are left out.
    pub const fn of_bits(bits: u64) -> Self {
        Self(bits & Self::ALL.0)
    }

    /// A bit for each.
    pub const fn bits(self) -> u64 {
        self.0
    }

    /// The set with this one in it.
    #[must_use]
    pub const fn with(self, input: WatchedInput) -> Self {
        Self(self.0 | 1 << input.bit())
    }

    /// True where it is in the set.
    pub const fn has(self, input: WatchedInput) -> bool {
        self.0 >> input.bit() & 1 == 1
    }

    /// Those that are in this set and not in another one.
    pub fn without(self, other: Self) -> impl Iterator<Item = WatchedInput> {
        WatchedInput::all().filter(move |input| self.has(*input) && !other.has(*input))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn each_input_has_a_name_and_a_place_of_its_own() {
        let names: std::collections::BTreeSet<_> =
            WatchedInput::all().map(|input| input.to_string()).collect();
        assert_eq!(names.len(), usize::from(END));
        assert!(names.contains("estop-ok") && names.contains("w.ready"));
        assert!(names.contains("spindle.1.inhibit") && names.contains("spindle.0.ready"));
        for input in WatchedInput::all() {
            let one = WatchedInputs::default().with(input);
            assert_eq!(one.without(WatchedInputs::default()).count(), 1);
            assert!(WatchedInputs::ALL.has(input) && one.has(input));
            assert_eq!(one.without(WatchedInputs::ALL).count(), 0);
        }
    }
}
