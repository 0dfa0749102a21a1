//! The tools in the magazine, as far as their mechanics go.
//!
//! A tool's tip stands at `Z axis − length`. Directions and hands: spindles turn positive
//! clockwise, so a right-hand tap (positive lead) goes towards −Z while the spindle turns positive.
use units::{Angle, Lead, Length, Stiffness};

/// A tool in the magazine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool {
    /// T number, by which a `Command` asks for it.
    pub number: u32,
    /// From the gauge line of the spindle to the tip.
    pub length: Length,
    /// What it does to the work.
    pub kind: ToolKind,
}

impl Tool {
    /// Cutting diameter; zero for what does not cut here.
    pub fn diameter(&self) -> Length {
        match &self.kind {
            ToolKind::Drill { diameter, .. } | ToolKind::Mill { diameter } => *diameter,
            ToolKind::Tap(tap) => tap.diameter,
            ToolKind::Insert(_)
            | ToolKind::PolygonCutter(_)
            | ToolKind::Probe(_)
            | ToolKind::Other => Length::ZERO,
        }
    }
}

/// What a tool does to the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolKind {
    /// Makes or deepens a hole; a spot drill is a drill with a blunt point that is not driven deep.
    Drill {
        /// Of its cylinder.
        diameter: Length,
        /// Full angle of its point.
        point_angle: Angle,
    },
    /// Cuts an internal thread.
    Tap(Tap),
    /// Turns a bar with a single point.
    Insert(crate::Insert),
    /// Turns a polygon from the second spindle, without a force.
    PolygonCutter(crate::PolygonCutter),
    /// Switches when it touches the work.
    Probe(crate::TouchProbe),
    /// An end mill: takes away what it meets, without a force.
    Mill {
        /// Of its circle.
        diameter: Length,
    },
    /// Does nothing that is simulated.
    Other,
}

/// A tap in its holder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Nominal diameter D.
    pub diameter: Length,
    /// Lead of its helix; negative for a left-hand tap.
    pub lead: Lead,
    /// Length of its chamfer, in pitches.
    pub chamfer_pitches: f64,
    /// Torque of its flute form over the formula's: 1.15 spiral flute (steel), 1.05
    /// (aluminium), 0.95 spiral point, 1.35 straight.
    pub flute_factor: f64,
    /// Longest thread it can cut: beyond it the shank meets the hole's edge, and the tap breaks.
    pub thread_length: Length,
    /// Whole axial play of the tap in the thread it has cut.
    pub flank_play: Length,
    /// Axial stiffness of flanks against thread, fully engaged.
    pub flank_stiffness: Stiffness,
    /// What holds it.
    pub holder: Holder,
    /// What lets go of it, in a clutch holder; the holder's stiffness is then that of the spring
    /// which brings it home, and its travel is not looked at.
    pub clutch: Option<Clutch>,
}

/// What makes a tap holder a clutch: see the crate's `clutch` module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clutch {
    /// D: pulled out so far, the tap's splines leave the arbor's.
    pub spline_length: Length,
    /// β: from the reversal until the pawl drives.
    pub pawl_backlash: Angle,
    /// Travel towards the spindle from home, on the same spring.
    pub compression: Length,
}

/// Room beyond the splines until a clutch holder is at its end (estimate).
pub const CLUTCH_RUN_OUT: Length = Length::mm(1.0);

/// A tap holder: a spring between spindle and tap, and a stop at the end of its travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Holder {
    /// Axial stiffness within the travel.
    pub stiffness: Stiffness,
    /// Travel to each side; none for a rigid holder, which is a spring all the way.
    pub travel: Option<Length>,
}

/// Stiffness of a holder at the end of its travel: the collet and the stop, as a rigid holder has
/// (machines' figures for collet chucks: 10–30 N/µm).
pub const HOLDER_STOP: Stiffness = Stiffness::n_per_mm(20_000.0);
