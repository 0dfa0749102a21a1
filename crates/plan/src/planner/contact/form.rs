//! What a tool can do to the stock.
use crate::chip::Drill;
use canon::{Tool, ToolKind};

/// What a tool can do.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    Drill(Drill),
    Tap { diameter: f64 },
    Mill { radius: f64 },
}

/// What a tool can do, as far as its table says.
pub(super) fn form(tool: &Tool, pressure: f64, stated: bool) -> Option<Form> {
    let diameter = tool.diameter.value();
    let is_described = stated && matches!(tool.kind, ToolKind::EndMill(_));
    if tool.stand_in && !is_described || tool.number == 0 || diameter <= 0.0 {
        return None;
    }
    match &tool.kind {
        ToolKind::Drill { point_angle } | ToolKind::SpotDrill { point_angle } => {
            let half = point_angle.in_rad() / 2.0;
            let cone = diameter / 2.0 / libm::tan(half);
            let cone = if cone.is_finite() { cone.max(0.0) } else { 0.0 };
            Some(Form::Drill(Drill { diameter, cone, sine: libm::sin(half), kc: pressure }))
        }
        ToolKind::Tap(_) => Some(Form::Tap { diameter }),
        ToolKind::EndMill(_) => Some(Form::Mill { radius: diameter / 2.0 }),
        ToolKind::Insert(_)
        | ToolKind::Probe(_)
        | ToolKind::PolygonCutter(_)
        | ToolKind::Hob(_)
        | ToolKind::Other => None,
    }
}
