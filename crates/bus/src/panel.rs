//! What doors and a panel beside the machine say.
//!
//! ```text
//!   levels   feed_inhibit, spindle_inhibit ─► kernel, in the same period
//!   keys     cycle_start, hold, stop, reset,
//!            power_on, power_off, home, flood,
//!            mist, mdi                       ─► control: as the page asks, when one is pressed
//!   switches single_block, optional_stop,
//!            block_skip                     ─► control: as they are set
//!   dials, wheel, jog keys                  ─► control: as they are turned or held
//! ```
use crate::{AXES, SPINDLES};
use units::{Coordinate, CoordinateSpeed};

/// A dial of an override.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OverrideDial {
    /// Percent that it has been turned by since the panel was there.
    pub turned: f32,
    /// Percent at which it is set; `None`: only its turns count.
    pub at: Option<f32>,
}

/// What a handwheel has asked an axis to move by since the panel was there, in steps of 1e-4 mm or
/// degrees; it goes on from its largest value at its smallest one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelTravel(i32);

impl WheelTravel {
    /// Steps of it.
    pub const fn of_steps(steps: i32) -> Self {
        Self(steps)
    }

    /// The way from an earlier reading to this one.
    pub fn since(self, before: Self) -> Coordinate {
        Coordinate::new(f64::from(self.0.wrapping_sub(before.0)) / WHEEL_STEPS_PER_UNIT)
    }
}

/// Keys of blocks that a panel may have: [`Panel::mdi`].
pub const MDI_KEYS: usize = 32;
/// Steps of a [`WheelTravel`] in a mm or a degree.
pub const WHEEL_STEPS_PER_UNIT: f64 = 1e4;

/// What is pressed, open or set at present.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[allow(clippy::struct_excessive_bools)] // keys and levels, any of them with any other
pub struct Panel {
    /// No axis moves but for homing and for taking a tool out.
    pub feed_inhibit: bool,
    /// These spindles do not turn.
    pub spindle_inhibit: [bool; SPINDLES],
    /// Start the program that is loaded, or go on with the one that is held.
    pub cycle_start: bool,
    /// Hold the feed.
    pub hold: bool,
    /// Give the program up.
    pub stop: bool,
    /// Clear alarms.
    pub reset: bool,
    /// Power the drives.
    pub power_on: bool,
    /// Take the power from the drives.
    pub power_off: bool,
    /// Home all axes.
    pub home: bool,
    /// Switch the flood coolant off and on.
    pub flood: [bool; 2],
    /// The same of the mist coolant.
    pub mist: [bool; 2],
    /// Keys of blocks that the machine file has, a bit each.
    pub mdi: u32,
    /// Hold after each block, while it is set.
    pub single_block: bool,
    /// Stop at M1, while it is set.
    pub optional_stop: bool,
    /// Leave out blocks behind `/`, while it is set.
    pub block_skip: bool,
    /// Dials of the overrides of feed, rapid and spindle.
    pub overrides: [OverrideDial; 3],
    /// Handwheel, by bus index of the axis.
    pub wheel: [WheelTravel; AXES],
    /// Jog keys that are held, by bus index: −1, 1, or 0 for none.
    pub jog: [i8; AXES],
    /// Speed at which jog keys jog.
    pub jog_speed: CoordinateSpeed,
}

impl Panel {
    /// Nothing is pressed, open or turned.
    pub const NONE: Self = Self {
        feed_inhibit: false,
        spindle_inhibit: [false; SPINDLES],
        cycle_start: false,
        hold: false,
        stop: false,
        reset: false,
        power_on: false,
        power_off: false,
        home: false,
        flood: [false; 2],
        mist: [false; 2],
        mdi: 0,
        single_block: false,
        optional_stop: false,
        block_skip: false,
        overrides: [OverrideDial { turned: 0.0, at: None }; 3],
        wheel: [WheelTravel::of_steps(0); AXES],
        jog: [0; AXES],
        jog_speed: CoordinateSpeed::ZERO,
    };
}
