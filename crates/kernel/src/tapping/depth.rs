//! How deep an axis may follow a spindle that does not obey.
//!
//! ```text
//!   surface ──┬──
//!             │ ╲  thread, followed            A spindle without a drive coasts, and the axis goes with it: that is right
//!   bottom ───┼──╲───                          in the thread, and wrong for ever. A hole is deeper than its thread by the
//!             │   ╲ chamfer of the tap         tap's chamfer, 2 to 3 pitches (form C of DIN 2197): so far it may go.
//!   as deep ──┴────▌ the axis brakes
//!   as it may
//! ```
use super::{Outcome, TapRun, Trailing};
use crate::axis::AxisLoop;
use crate::config::Subject;
use crate::drives::Finding;
use crate::fault::FaultKind;
use motion::TapPlan;

/// A hole is deeper than its thread by so many pitches.
const BEYOND_PITCHES: f64 = 3.0;

/// The axis brakes, and stays.
pub(super) fn stay(axis: &mut AxisLoop) -> Outcome {
    axis.brake();
    Outcome::Busy
}

impl TapRun {
    /// Whether the axis, which follows a spindle that does not obey, is not too deep; it is said once, and the axis brakes
    /// from then on.
    pub(super) fn check_depth(&mut self, plan: &TapPlan, axis: &AxisLoop) -> Result<(), Finding> {
        let from = plan.start.along(plan.axis).value();
        let inward = (plan.bottom.value() - from).signum();
        let deepest = plan.bottom.value() + inward * BEYOND_PITCHES * plan.lead.value().abs();
        let at = axis.target.position;
        if self.trailing == Trailing::No || self.too_deep || (at - deepest) * inward <= 0.0 {
            return Ok(());
        }
        self.too_deep = true;
        Err((FaultKind::FollowsTooDeep, Subject::Axis(plan.axis), at, deepest))
    }
}
