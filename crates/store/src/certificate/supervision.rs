//! What supervision by measured torque saw of a stroke of a tap.
use super::Measured;
use serde::{Deserialize, Serialize};

/// One stroke; torques of the cut by the drive's reading, each the mean of a bin of the depth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Supervision {
    /// What was diagnosed, in one sentence.
    pub says: String,
    /// No other cause is likely.
    pub sure: bool,
    /// Depth of a bin; the first one begins at the surface.
    pub bin_mm: Measured,
    /// On the way in.
    pub torque_in_n_m: Vec<Measured>,
    /// On the way out.
    pub torque_out_n_m: Vec<Measured>,
    /// Torque of the last good holes over that of the first ones.
    pub level_percent: Measured,
    /// Where it stopped the stroke.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopped: Option<SupervisionStop>,
}

/// A bound that was crossed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SupervisionStop {
    /// Mean torque since it was crossed.
    pub torque_n_m: Measured,
    /// The bound.
    pub limit_n_m: Measured,
    /// Depth of the tip.
    pub depth_mm: Measured,
    /// From the first reading beyond the bound to the alarm.
    pub alarm_after_s: Measured,
}
