//! What a certificate's verdict rests on: counts, tolerances, the inputs of the run, and contact of
//! each feature.
use super::Measured;
use serde::{Deserialize, Serialize};

/// Features by their verdicts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Count {
    /// Within every tolerance.
    pub passed: usize,
    /// Out of one at least, or not cut.
    pub failed: usize,
    /// Not measured.
    pub not_judged: usize,
}

/// What a feature may be off.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tolerances {
    /// Class asked of threads.
    pub thread_class: String,
    /// Depth of a hole, each way.
    pub hole_depth_um: Measured,
    /// Place of a hole or thread.
    pub position_um: Measured,
    /// Depth of a thread, each way.
    pub thread_depth_um: Measured,
    /// How far a tap may run beyond its bottom.
    pub thread_overrun_um: Measured,
    /// A turned thread beside its helix.
    pub turned_thread_um: Measured,
    /// Contour of a cam, each way.
    pub cam_contour_um: Measured,
    /// Flatness of facets.
    pub facet_flatness_um: Measured,
    /// Size across flats, each way.
    pub across_flats_um: Measured,
    /// Thickness of hobbed teeth, each way.
    pub tooth_thickness_um: Measured,
    /// Diameter over the tips of hobbed teeth, each way.
    #[serde(default)]
    pub tip_diameter_um: Measured,
}

/// Where the set-up has the workpiece. Positions are judged from there: a frame that the program,
/// or who touched off, has moved for all operations alike is not seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clamping {
    /// Zero of the work (G54): machine coordinates X, Y, Z.
    pub zero_mm: [Measured; 3],
    /// Stock from that zero, of the program's comment or of the machine's file: its least
    /// coordinates, and its largest.
    pub stock_mm: [[Measured; 3]; 2],
}

/// SHA-256 of the bytes that a run was made from, in hexadecimal digits.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inputs {
    /// The part program.
    pub program_sha256: String,
    /// The machine's file; of a built-in machine what `leadscrew machine show` prints.
    pub machine_sha256: String,
    /// The tool table; of the built-in one its text.
    pub tools_sha256: String,
}

/// What says that a tool was in the material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// The edges were in the stock, and something resisted them where that can be known.
    pub cut: bool,
    /// Way of the edges within the stock, along the depth of the cut; null where the stock's place
    /// was not known.
    pub reach_mm: Measured,
    /// Largest torque of the cut, where it can be known.
    pub torque_max_n_m: Measured,
    /// Torque that a sharp tool would have taken.
    pub torque_expected_n_m: Measured,
    /// Largest force of the cut, where it can be known.
    pub force_max_n: Measured,
}

/// SHA-256 of some bytes, in hexadecimal digits: what `sha256sum` prints of a file.
pub fn sha256(bytes: &[u8]) -> String {
    use sha2::Digest as _;
    use std::fmt::Write as _;
    sha2::Sha256::digest(bytes).iter().fold(String::new(), |mut text, byte| {
        // writing to a String cannot fail
        let _ = write!(text, "{byte:02x}");
        text
    })
}
