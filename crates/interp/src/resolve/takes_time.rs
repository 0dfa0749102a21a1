//! Operations by which the machine moves or waits, whatever came before them.
//!
//! Moves come here only where the axes stand elsewhere. M1 waits only where the operator has set
//! it.
use canon::{Await, OpKind, SpindleOrder};

pub(super) fn takes_time(kind: &OpKind) -> bool {
    match kind {
        OpKind::Dwell { time } => time.value() > 0.0,
        OpKind::Input(wait) => wait.until != Await::Nothing,
        OpKind::Pause { optional } => !optional,
        OpKind::Spindle { order, .. } => matches!(order, SpindleOrder::Orient { .. }),
        OpKind::Hole(_)
        | OpKind::Coolant { .. }
        | OpKind::SelectTool { .. }
        | OpKind::PathMode(_)
        | OpKind::Overrides { .. }
        | OpKind::Message(_)
        | OpKind::Output(_)
        | OpKind::UserCode(_)
        | OpKind::End => false,
        OpKind::Rapid { .. }
        | OpKind::Line { .. }
        | OpKind::Arc { .. }
        | OpKind::Spline { .. }
        | OpKind::Tap(_)
        | OpKind::Threading(_)
        | OpKind::Polygon(_)
        | OpKind::PolygonEnd
        | OpKind::PolygonMeasure { .. }
        | OpKind::Hob(_)
        | OpKind::HobEnd
        | OpKind::Cam(_)
        | OpKind::ChangeTool { .. }
        | OpKind::Probe(_) => true,
    }
}
