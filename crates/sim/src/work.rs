//! The workpiece: a slab with a surface, made of something, with holes in it.
//!
//! ```text
//!        top ───────┐ ╱ ┌──────┐     ┌─────     machine Z of the surface
//!                   │   │      │▒   ▒│
//!      full depth   │   │      │▒   ▒│          thread: helix fixed when the tap first bit
//!                   │   │      │▒   ▒│
//!        tip depth  └╲ ╱┘      │     │
//!                     V        └╲ ╱─┘
//!   thickness ───────────────────V──────
//! ```
//!
//! A hole is what tools have made at one place, so it is a list of bores, each with its diameter
//! and depth, and perhaps a thread. Depths count from the surface, positive downwards.
use units::{Angle, Lead, Length};

/// The workpiece before the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Stock {
    /// Machine Z of its surface.
    pub top: Length,
    /// From the surface to the lower side; `None` is thicker than any tool is long.
    pub thickness: Option<Length>,
    /// How far it reaches in X and Y; `None` is farther than any axis.
    pub sides: Option<Sides>,
    /// Specific cutting force kc of its material in tapping, N/mm².
    pub cutting_n_per_mm2: f64,
    /// Holes that are there already.
    pub holes: Vec<Hole>,
    /// A tap that finds no hole is taken to find one of diameter D − P, deep enough. Otherwise it
    /// finds solid material and breaks.
    pub assume_predrilled: bool,
}

/// A rectangle in machine X and Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// From here …
    pub x_from: Length,
    /// … to here in X,
    pub x_to: Length,
    /// from here …
    pub y_from: Length,
    /// … to here in Y.
    pub y_to: Length,
}

impl Stock {
    /// There is material below a place.
    pub(crate) fn is_below(&self, [x, y]: [Length; 2]) -> bool {
        self.sides.is_none_or(|s| x >= s.x_from && x <= s.x_to && y >= s.y_from && y <= s.y_to)
    }
}

/// A round hole, or a cone, coaxial with others at the same place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bore {
    /// Of its cylinder.
    pub diameter: Length,
    /// Of the deepest point reached by the tip.
    pub tip_depth: Length,
    /// From the tip to where the diameter is full.
    pub cone: Length,
}

impl Bore {
    /// Down to where the diameter is full; negative while only the point has entered.
    pub fn full_depth(&self) -> Length {
        self.tip_depth - self.cone
    }
}

/// A thread in a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Nominal diameter of the tap.
    pub diameter: Length,
    /// Signed lead of the tap, right-hand positive.
    pub lead: Lead,
    /// A point on its helix: spindle angle …
    pub phase_angle: Angle,
    /// … and machine Z of the tap's tip there.
    pub phase_tip: Length,
    /// Deepest the tip of the tap has been.
    pub tip_depth: Length,
}

/// What was made at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Centre, machine X.
    pub x: Length,
    /// Centre, machine Y.
    pub y: Length,
    /// By tool diameter, in the order they were made.
    pub bores: Vec<Bore>,
    /// The thread, if it was tapped.
    pub thread: Option<Thread>,
    /// The tap found no hole here, and one was assumed.
    pub assumed: bool,
}

impl Hole {
    /// A place where nothing has been made yet.
    pub const fn at(x: Length, y: Length) -> Self {
        Self { x, y, bores: Vec::new(), thread: None, assumed: false }
    }
}

/// A tool that comes back is out of the work where its tip stands this near to the surface, mm:
/// axes and spindles stop within micrometres of where they shall.
pub(crate) const AT_SURFACE_MM: f64 = 0.02;
/// A tool has been in the work once its tip was deeper than this, mm. More than [`AT_SURFACE_MM`],
/// so that a tool which rests at the surface is not in and out by turns.
pub(crate) const ENTERED_MM: f64 = 0.04;

/// Tools closer than this to a hole's centre are in that hole.
pub const SAME_HOLE: Length = Length::mm(0.1);
