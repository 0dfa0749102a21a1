//! The way out of work in which a tool is tied to a spindle, but not screwed to it: turned threads,
//! cams, polygons, gears.
//!
//! ```text
//!     X ▲      ● clear                 after a stop in which spindle and axes ran apart, the law of the coupling leads
//!       │      ↑ 1 infeed axis         through the work: the infeed axis takes the tool off it first, and only then
//!       │ ═════╪═══════◄── groove      the axis along a thread goes back to where the pass began
//!       │ ◄────┘ 2 along the thread
//!       └──────────────────► Z
//! ```
//!
//! Where the tool is clear is where it stood before it was fed in: that of a thread's pass, of a
//! wheel before its cam, of a polygon's cutter when it was geared up.
use units::{Angle, Axis, Lead, LeadGrowth, Length, Spin};

/// What is being cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TiedCut {
    /// A pass over a thread.
    Thread,
    /// A cam.
    Cam,
    /// A polygon.
    Polygon,
    /// A gear.
    Gear,
    /// A thread, by a tap in a floating or clutch holder: no axis is tied to its spindle, and the
    /// thread holds it.
    FloatingTap,
}

/// See the module's header.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WayOut {
    /// What is being cut.
    pub cut: TiedCut,
    /// The spindle that leads.
    pub spindle: u8,
    /// The axis that takes the tool off the work.
    pub infeed: Axis,
    /// Its coordinate where the tool is clear of the work.
    pub clear: Length,
    /// +1 where that is on its positive side, else −1.
    pub outward: f64,
    /// The pass over a thread.
    pub pass: Option<Pass>,
}

/// One pass over a thread: `position = start + lead·(θ − angle) + growth·(θ − angle)²/2`, θ within
/// a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pass {
    /// The axis along the thread.
    pub axis: Axis,
    /// Where its straight part begins …
    pub start: Length,
    /// … with the spindle at this angle, …
    pub angle: Angle,
    /// … and where it ends.
    pub end: Length,
    /// Where the whole pass begins.
    pub from: Length,
    /// Where the material begins.
    pub surface: Length,
    /// Travel per positive turn of the spindle.
    pub lead: Lead,
    /// By how much that grows with each of them.
    pub growth: LeadGrowth,
    /// Speed of the spindle.
    pub spin: Spin,
}

impl WayOut {
    /// Nothing but the infeed axis is needed to take the tool off the work: it is held by nothing
    /// on the side from which it came.
    pub const fn is_straight(&self) -> bool {
        match self.cut {
            TiedCut::Thread | TiedCut::Cam | TiedCut::Polygon | TiedCut::Gear => true,
            TiedCut::FloatingTap => false,
        }
    }

    /// How far a place of the infeed axis is inside of where the tool is clear.
    pub fn inside(&self, place: Length) -> Length {
        (self.clear - place) * self.outward
    }
}
