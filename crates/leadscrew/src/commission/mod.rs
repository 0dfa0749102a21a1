//! Commissioning: from a machine whose file is guessed to one that is known.
//!
//! ```text
//!   file as it is ─► axes ─► spindle ─► values ± 95 %, pictures ─► the file with them ─► proof
//! ```
mod axes;
mod axis_model;
mod least_squares;
mod motion;
mod proof;
mod result;
mod spindle;
mod strokes;
mod write;

pub use axes::StrokeCounts;
pub use least_squares::Estimate;
pub use motion::{Bench, MOST_TORQUE_SHARE, Window};
pub use proof::{AirTaps, Circle, Proof};
pub use result::{AxisExcursion, MeasuredValue, StepResult};
pub use write::commissioned;

/// Measures the linear axes.
///
/// # Errors
/// The machine cannot be run.
pub fn axes(bench: &Bench, effort: StrokeCounts) -> Result<StepResult, control::Refused> {
    axes::measure(bench, effort)
}

/// Measures the first spindle.
///
/// # Errors
/// The machine cannot be run.
pub fn spindle(bench: &Bench) -> Result<StepResult, control::Refused> {
    spindle::measure(bench)
}
