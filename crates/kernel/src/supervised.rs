//! What supervision by torque has seen of a tap.
use sync::supervision::depth::DepthTorque;
use sync::supervision::diagnosis::Diagnosed;
use units::{Length, Time, Torque};

/// What supervision saw of one stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Supervised {
    /// The tool.
    pub tool: u32,
    /// From the surface to the bottom.
    pub depth: Length,
    /// Cutting torque over that depth.
    pub torque: DepthTorque,
    /// What the hole was.
    pub diagnosed: Diagnosed,
    /// What the torque has left, if that has stopped the stroke.
    pub crossing: Option<Crossing>,
    /// Torque of the last good holes over that of the first ones, with this one.
    pub level: f64,
    /// Change of that with each hole, and its standard error, once there are enough.
    pub slope: Option<(f64, f64)>,
}

/// A bound that was crossed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Crossing {
    /// The bound.
    pub bound: TorqueBound,
    /// Mean torque since it was crossed.
    pub torque: Torque,
    /// The bound's value.
    pub limit: Torque,
    /// Depth of the tip below the surface.
    pub depth: Length,
    /// From the first reading beyond the bound to the alarm: what the noise takes.
    pub took: Time,
}

/// Bounds of the torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TorqueBound {
    /// What the tap bears, or the tool table states.
    Limit,
    /// The upper bound of the band.
    Upper,
    /// The lower bound of the band: the tap cuts nothing.
    Lower,
}
