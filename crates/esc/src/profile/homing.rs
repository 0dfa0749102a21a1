//! Homing that the drive does by itself, mode 6: methods 1, 2, 17, 18, 33, 34, 35 and 37.
//!
//! ```text
//!   17  to the negative limit switch, and back off it           18  likewise, positive
//!    1  as 17, then to the next index mark                       2  as 18
//!   33  to the index mark in negative direction                 34  in positive direction
//!   35, 37  here
//! ```
use units::{Angle, Spin};

/// Methods that the emulated drive has; 0 is none.
pub(crate) const METHODS: &[i64] = &[0, 1, 2, 17, 18, 33, 34, 35, 37];

/// Where the switches of an axis are, by the motor's angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingSwitches {
    /// Actuated below.
    pub negative: Angle,
    /// Actuated above.
    pub positive: Angle,
    /// Actuated between.
    pub home: [Angle; 2],
}

impl HomingSwitches {
    /// Ten turns of travel, the home switch in its middle.
    pub fn new() -> Self {
        Self {
            negative: Angle::rev(-5.0),
            positive: Angle::rev(5.0),
            home: [Angle::rev(-0.25), Angle::rev(0.25)],
        }
    }

    /// Bits 0 to 2 of 60FD: negative limit, positive limit, home.
    pub(crate) fn bits(&self, at: Angle) -> u32 {
        let home = self.home[0] <= at && at <= self.home[1];
        u32::from(at < self.negative) | u32::from(at > self.positive) << 1 | u32::from(home) << 2
    }
}

impl Default for HomingSwitches {
    fn default() -> Self {
        Self::new()
    }
}

/// How far homing is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum HomingState {
    /// It was not started since the mode was entered.
    #[default]
    NotStarted,
    /// To the limit switch.
    Approach,
    /// Off the limit switch.
    BackOff,
    /// To the index mark.
    Index,
    /// It has ended: the position is known.
    Attained,
    /// It cannot be done.
    Failed,
}

/// What homing sees in a period.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    pub(crate) method: i64,
    /// Bits of [`HomingSwitches::bits`].
    pub(crate) switches: u32,
    /// The index mark passed in this period.
    pub(crate) index: bool,
    /// Speeds towards the switch and towards the zero.
    pub(crate) speeds: [Spin; 2],
}

impl HomingState {
    /// Starts.
    pub(crate) fn start(method: i64) -> Self {
        match method {
            1 | 2 | 17 | 18 => Self::Approach,
            33 | 34 => Self::Index,
            35 | 37 => Self::Attained,
            _ => Self::Failed,
        }
    }

    pub(crate) fn is_moving(self) -> bool {
        matches!(self, Self::Approach | Self::BackOff | Self::Index)
    }

    /// Goes on for a period; returns the speed that it wants.
    pub(crate) fn next(self, sight: &Sight) -> (Self, Spin) {
        let (limit, sign) = match sight.method {
            1 | 17 | 33 => (1, -1.0),
            _ => (2, 1.0),
        };
        let on_limit = sight.switches & limit != 0;
        match self {
            Self::Approach if !on_limit => (self, sight.speeds[0] * sign),
            Self::Approach => (Self::BackOff, Spin::ZERO),
            Self::BackOff if on_limit => (self, sight.speeds[1] * -sign),
            Self::BackOff if sight.method < 3 => (Self::Index, sight.speeds[1] * -sign),
            Self::BackOff => (Self::Attained, Spin::ZERO),
            Self::Index if sight.index => (Self::Attained, Spin::ZERO),
            // off the switch away from it; without a switch, towards the index mark
            Self::Index if sight.method < 3 => (self, sight.speeds[1] * -sign),
            Self::Index => (self, sight.speeds[1] * sign),
            Self::NotStarted | Self::Attained | Self::Failed => (self, Spin::ZERO),
        }
    }
}
