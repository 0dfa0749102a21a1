//! A hobbed gear.
use super::{Common, Measured};
use serde::{Deserialize, Serialize};

/// A hobbed gear.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gear {
    /// What every feature has.
    #[serde(flatten)]
    pub common: Common,
    /// How many.
    pub teeth: u32,
    /// In the normal section.
    pub module_mm: Measured,
    /// Helix angle ordered, positive: right hand.
    pub helix_deg: Measured,
    /// Travel in which a tooth winds once around, as cut; null of straight teeth.
    pub lead_mm: Measured,
    /// The same as ordered.
    pub lead_ordered_mm: Measured,
    /// Single pitch deviation of ISO 1328-1, of the worst pair of teeth.
    pub pitch_deviation_um: Measured,
    /// Total cumulative pitch deviation.
    pub pitch_total_um: Measured,
    /// Helix slope deviation of the worst tooth.
    pub helix_deviation_um: Measured,
    /// Grade of ISO 1328-1 that all three are within.
    pub grade: Option<u8>,
    /// Where the face begins.
    pub z_from_mm: Measured,
    /// Where it ends.
    pub z_to_mm: Measured,
    /// Speed of the work.
    pub rpm: Measured,
}
