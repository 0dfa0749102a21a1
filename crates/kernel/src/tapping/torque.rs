//! The torque of a tap under way, handed to its supervision.
use crate::axis::AxisLoop;
use crate::drives::Finding;
use crate::event::EventKind;
use crate::execute::Context;
use crate::spindle::SpindleLoop;
use crate::supervision::Supervision;
use motion::TapPlan;
use sync::Cycle;
use units::Length;

/// Looks at this period's torque.
pub(super) fn supervise(
    cycle: &Cycle,
    supervision: &mut Supervision,
    (plan, axis, spindle): (&TapPlan, &AxisLoop, &SpindleLoop),
    context: &mut Context,
) -> Result<(), Finding> {
    if matches!(cycle, Cycle::Halted(..)) {
        supervision.interrupt();
    }
    let into = if plan.bottom >= plan.surface { 1.0 } else { -1.0 };
    let depth = (Length::mm(axis.position()) - plan.surface) * into;
    let measured = context.feedback.spindles[usize::from(plan.spindle)].torque;
    let at = (depth, spindle.reading());
    match supervision.observe(cycle.phase(), at, &spindle.control, measured) {
        Some((finding, supervised)) if !context.halted => {
            context.note(EventKind::TapSupervised(supervised));
            Err(finding)
        }
        Some(_) | None => Ok(()),
    }
}
