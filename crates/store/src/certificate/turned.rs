//! A thread that was turned with a single point.
use super::{Common, Hand, Measured};
use serde::{Deserialize, Serialize};

/// A turned thread; errors are those in the material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TurnedThread {
    /// What every feature has.
    #[serde(flatten)]
    pub common: Common,
    /// Right or left.
    pub hand: Hand,
    /// Lead, without the sign of the hand.
    pub lead_mm: Measured,
    /// By how much it grows with each revolution; negative where it shrinks.
    #[serde(default)]
    pub lead_growth_mm: Measured,
    /// Turn by turn, where the lead is not the same everywhere: depth at which the turn begins, lead ordered, lead cut.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub leads_mm: Vec<[Measured; 3]>,
    /// Where the spindle stood when the thread began, as the last pass was cut.
    #[serde(default)]
    pub start_angle_deg: Measured,
    /// The axis along which it runs.
    pub axis: String,
    /// Coordinate of that axis where the material begins.
    pub from_mm: Measured,
    /// Likewise where the thread ends.
    pub to_mm: Measured,
    /// Passes cut to their end.
    pub passes: u32,
    /// Passes ordered.
    pub passes_ordered: u32,
    /// Fastest that the spindle turned.
    pub rpm_max: Measured,
    /// Largest distance from the helix, over all passes.
    pub sync_error_max_um: Measured,
    /// Its root mean square.
    pub sync_error_rms_um: Measured,
    /// Error of the lead over the thread's length.
    pub lead_error_um: Measured,
    /// Largest mean distance from the helix of a pass less the smallest.
    pub pass_spread_um: Measured,
    /// Largest distance from the ordered infeed in the last pass.
    pub infeed_error_um: Measured,
}
