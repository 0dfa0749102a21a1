//! The use of a mill.
use super::{Common, Measured};
use serde::{Deserialize, Serialize};

/// What a mill has done while it was in the spindle: the largest of each, with its line and its
/// place in G54.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Milling {
    /// What every feature has.
    #[serde(flatten)]
    pub common: Common,
    /// T number.
    pub tool: Option<u32>,
    /// Such as "flat mill".
    pub form: String,
    /// Diameter of the mill.
    pub diameter_mm: Measured,
    /// Where the stock is known from: "machine file", "comment", "size" (of a comment,
    /// its place assumed), "extent" (assumed); null: nowhere.
    pub stock: Option<String>,
    /// Side of a cell of the grid.
    pub cell_mm: Measured,
    /// What was removed, to the error of the grid.
    pub removed_mm3: Measured,
    /// Axial depth.
    pub depth_mm: At,
    /// Radial width.
    pub width_mm: At,
    /// Angle of engagement.
    pub engagement_deg: At,
    /// Removal rate.
    pub removal_mm3_per_s: At,
    /// Feed a tooth.
    pub feed_per_tooth_mm: At,
    /// Thickness of the chip.
    pub chip_mm: At,
    /// Tangential force, estimated.
    pub force_n: At,
    /// Deflection of the tip by it.
    pub deflection_mm: At,
    /// Fastest speed of the spindle in the cut.
    pub rpm_max: Measured,
    /// Rapids through the stock: how many, and the first ones with the height that stood in their
    /// way.
    pub rapids: usize,
    /// The first ones of them.
    pub rapids_mm: Vec<At>,
}

/// A value and where it was; all null where it is not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct At {
    /// How large.
    pub value: Measured,
    /// Program line.
    pub line: Option<u32>,
    /// X, Y and Z of the tip in G54.
    pub at_mm: Option<[Measured; 3]>,
}
