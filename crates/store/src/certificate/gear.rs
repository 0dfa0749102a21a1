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
    /// Total profile deviation of the worst tooth, along the normal of its flank.
    #[serde(default)]
    pub profile_deviation_um: Measured,
    /// Slope of that profile.
    #[serde(default)]
    pub profile_slope_um: Measured,
    /// What is left of it beside the slope.
    #[serde(default)]
    pub profile_form_um: Measured,
    /// Depth of the marks that the feed along the face leaves.
    #[serde(default)]
    pub feed_mark_um: Measured,
    /// Grade of ISO 1328-1 that pitch, helix slope and profile are within.
    pub grade: Option<u8>,
    /// Where the face begins.
    pub z_from_mm: Measured,
    /// Where it ends.
    pub z_to_mm: Measured,
    /// Speed of the work.
    pub rpm: Measured,
    /// Size of the teeth, where it is farthest from the size asked; null: the hob is not known.
    #[serde(default)]
    pub size: Option<ToothSize>,
}

/// Size of a gear's teeth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToothSize {
    /// Distance of the axes of hob and work.
    pub distance_mm: Measured,
    /// Distance at which the teeth have the size asked.
    pub distance_asked_mm: Measured,
    /// Coefficient of the profile shift.
    pub shift: Measured,
    /// Teeth that the span is taken over.
    pub spanned: u32,
    /// Base tangent length over `spanned` teeth, `W_k`.
    pub span_mm: Measured,
    /// Lower limit of the span.
    pub span_least_mm: Measured,
    /// Greatest span allowed.
    pub span_most_mm: Measured,
    /// Diameter of the measuring balls.
    pub ball_mm: Measured,
    /// Dimension over two balls.
    pub over_balls_mm: Measured,
    /// Dimension over two balls of teeth without allowances.
    pub over_balls_asked_mm: Measured,
    /// Diameter of the root circle.
    pub root_diameter_mm: Measured,
    /// Diameter over the tips, as the blank has it.
    pub tip_diameter_mm: Measured,
    /// Diameter over the tips that is asked.
    pub tip_diameter_asked_mm: Measured,
}
