//! Bodies beside the tool's edges and the workpiece that can meet one another: what the spindle
//! holds where it holds no tool, and what holds the work.
//!
//! ```text
//!      ┌──────┐ spindle                 ▒▒▒▒▒▒┐ chuck
//!      │      │                         ▒▒▒▒▒▒├──────────────┬──┬───┐
//!      └──────┘ nose                    ▒▒▒▒▒▒├─ bar ────────┤  │ tailstock
//!         ╱╲    tool                    ▒▒▒▒▒▒┘              └──┴───┘
//! ```
//!
//! What a machine's file does not state is not judged. Coordinates are those of a tool's tip in the
//! machine's frame, as of [`Stock`](crate::Stock).
use units::Length;

/// What a machine has beside tools and stock, as far as its file says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bodies {
    /// Diameter of the spindle's nose.
    pub nose: Option<Length>,
    /// Radius of a grinder's wheel, whose axis is parallel to the work's.
    pub wheel: Option<Length>,
    /// Tools are clamped by hand, and programs need not name them.
    pub tools_by_hand: bool,
    /// The chuck with its jaws.
    pub chuck: Option<Cylinder>,
    /// The tailstock with its centre.
    pub tailstock: Option<Cylinder>,
    /// The turret of a lathe, whose tools stand side by side.
    pub turret: Option<Turret>,
}

/// A turret of a lathe that turns about an axis parallel to the work's, on the side of X+.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turret {
    /// Its stations, at equal angles.
    pub stations: u32,
    /// From its axis to the tips of its tools.
    pub radius: Length,
}

/// A round body about the axis of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Largest distance from the axis of the work.
    pub radius: Length,
    /// Z of its end towards the chuck's side.
    pub from: Length,
    /// Z of its other end.
    pub to: Length,
}

impl Cylinder {
    /// How deep a point is in it, by the shortest way out: across, or past an end; mm. `r` is the
    /// distance from the axis.
    pub(crate) fn depth(&self, r: f64, z: f64) -> f64 {
        let across = self.radius.value() - r;
        across.min(z - self.from.value()).min(self.to.value() - z)
    }
}
