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
    /// Turn by turn, where the lead is not the same everywhere: depth at which the turn begins,
    /// lead ordered, lead cut.
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
    /// In a bore.
    #[serde(default)]
    pub internal: bool,
    /// Grooves side by side.
    #[serde(default)]
    pub starts: u32,
    /// The standard thread that it was taken for, by its pitch and the diameter before.
    #[serde(default)]
    pub size: Option<String>,
    /// Class asked; empty without a standard size.
    #[serde(default)]
    pub class: String,
    /// Form of the insert, and where it was taken from.
    #[serde(default)]
    pub insert: String,
    /// Diameter of the bar, or of the bore, before the first pass.
    #[serde(default)]
    pub before_mm: Measured,
    /// Share of the ordered length in which the insert's point was in the material.
    #[serde(default)]
    pub contact_percent: Measured,
    /// Deepest that the point was below bar or bore; negative: it passed it by so much.
    #[serde(default)]
    pub groove_depth_mm: Measured,
    /// What was not judged, and why.
    #[serde(default)]
    pub not_judged: Option<String>,
    /// What was measured in axial sections.
    #[serde(default)]
    pub sizes: Option<TurnedSizes>,
    /// Largest force of the cut on the insert.
    #[serde(default)]
    pub force_max_n: Measured,
    /// Largest torque of the cut on the spindle.
    #[serde(default)]
    pub torque_max_n_m: Measured,
}

/// Diameters, least and largest, with their limits, and lengths of a turned thread.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TurnedSizes {
    /// Major diameter.
    pub major_mm: [Measured; 2],
    /// Its limits.
    pub major_limits_mm: Option<[Measured; 2]>,
    /// Simple pitch diameter.
    pub pitch_mm: [Measured; 2],
    /// Virtual pitch diameter: what the Go gauge feels.
    pub virtual_pitch_mm: Measured,
    /// Limits of the pitch diameter.
    pub pitch_limits_mm: Option<[Measured; 2]>,
    /// Minor diameter.
    pub minor_mm: [Measured; 2],
    /// Its limits.
    pub minor_limits_mm: Option<[Measured; 2]>,
    /// Largest cumulative pitch error within a length of engagement.
    pub pitch_error_um: Measured,
    /// Largest distance of a flank from its straight form, along the axis.
    pub flank_error_um: Measured,
    /// Radial overlap with a mating thread's flanks, of that of the basic profile.
    pub flank_contact_percent: Measured,
    /// Length of full thread.
    pub full_length_mm: Measured,
    /// From the end of the bar, or where the thread is to begin, to it.
    pub run_in_mm: Measured,
    /// From it to where the insert last touched.
    pub run_out_mm: Measured,
}
