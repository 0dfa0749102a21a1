//! What doors and a panel beside the machine say.
//!
//! ```text
//!   levels   feed_inhibit, spindle_inhibit ─► kernel, in the same period
//!   keys     cycle_start, hold, stop, reset ─► control: as the page asks, when one is pressed
//! ```
use crate::SPINDLES;

/// What is pressed, open or set at present.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    /// Hold after each block, while it is set.
    pub single_block: bool,
}
