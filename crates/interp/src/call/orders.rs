//! What single calls carry: the orders of cam grinding, hobbing, polygon turning, splines, and
//! entries of tables.

use crate::geometry::frame::Point;
use canon::{Oscillation, Ratio};
/// What is ordered, in the program's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CamCall {
    /// G151: profile and angle on the shaft in degrees.
    Select(u32, f64),
    /// G151 P0.
    Deselect,
    /// G150.
    Compensate,
    /// G152.
    ResetSampling,
    /// G153.
    StartSampling,
    /// G155.
    StorePhase,
    /// G154 X: what is taken off, a turn, its rate a turn, rpm.
    Grind {
        /// All told.
        stock: f64,
        /// F.
        per_turn: f64,
        /// R.
        rate: f64,
        /// S.
        rpm: f64,
    },
    /// G154 P: turns and rpm.
    SparkOut(u32, f64),
}

/// What G81 T L Q P says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HobOrder {
    /// T.
    pub teeth: u32,
    /// L.
    pub starts: i32,
    /// Q as a module, mm.
    pub module_mm: f64,
    /// P, degrees.
    pub helix_deg: f64,
    /// What (GEAR …) asks.
    pub asked: canon::GearAsked,
}

/// What G51.2 says, in the program's units.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonOrder {
    /// P, Q.
    pub ratio: Ratio,
    /// R, degrees.
    pub phase_deg: f64,
    /// What swings: program units, or revolutions of the tool.
    pub oscillations: Vec<Oscillation>,
    /// I, J: what swings by a share of the distance of the axes at the cut.
    pub by_distance: Vec<Oscillation>,
    /// D: the control chooses, and what.
    pub auto: Option<canon::Actuator>,
    /// E1: as it was measured before.
    pub compensated: bool,
}

/// A control point in X and Y, program units, and its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlPoint {
    /// X and Y.
    pub at: [f64; 2],
    /// Weight, above 0.
    pub weight: f64,
}

/// A box in machine coordinates, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeZone {
    /// Smallest X, Y, Z; infinite where the axis does not count.
    pub from: [f64; 3],
    /// Largest.
    pub to: [f64; 3],
    /// What is forbidden: its outside, else its inside.
    pub outside: bool,
}

/// What the control believes about a tool: mm and degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolEntry {
    /// Number of the tool.
    pub number: u32,
    /// Offsets of all axes.
    pub offset: Point,
    /// Diameter.
    pub diameter: f64,
    /// Front angle.
    pub front_angle: f64,
    /// Back angle.
    pub back_angle: f64,
    /// Orientation of a lathe tool, 0 to 9.
    pub orientation: u32,
}
