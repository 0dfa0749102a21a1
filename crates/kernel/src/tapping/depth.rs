//! How far an axis may follow a spindle that does not obey.
//!
//! ```text
//!   clear ────┬──▲ out of the work nothing ties it: the axis brakes
//!   surface ──┼──│
//!             │ ╲  thread, followed            A spindle without a drive coasts, and the axis goes with it: that is right
//!   bottom ───┼──╲───                          in the thread, and wrong for ever. The hole has some room below the
//!             │   ╲ room of the hole           programmed depth, at least for the tap's chamfer: so far it may go.
//!   deepest ──┴────▌ the axis brakes
//! ```
use super::{Outcome, TapRun, Trailing, clear};
use crate::axis::AxisLoop;
use crate::config::Subject;
use crate::drives::Finding;
use crate::fault::FaultKind;
use motion::TapPlan;

/// The axis brakes, and stays.
pub(super) fn stay(axis: &mut AxisLoop) -> Outcome {
    axis.brake();
    Outcome::Busy
}

impl TapRun {
    /// Whether the axis, which follows a spindle that does not obey, is not too deep; it is said
    /// once. Too deep, and clear of the work, the axis brakes from then on.
    pub(super) fn check_depth(&mut self, plan: &TapPlan, axis: &AxisLoop) -> Result<(), Finding> {
        let inward = (plan.bottom.value() - plan.start.along(plan.axis).value()).signum();
        let deepest = plan.deepest.value();
        let at = axis.target.position;
        if self.trailing == Trailing::No || self.stays {
            return Ok(());
        }
        let is_clear = (at - clear(plan).value()) * inward < 0.0;
        let is_too_deep = (at - deepest) * inward > 0.0;
        self.stays = is_clear || is_too_deep;
        if !is_too_deep {
            return Ok(());
        }
        Err((FaultKind::FollowsTooDeep, Subject::Axis(plan.axis), at, deepest))
    }
}
