//! The phase plane: the tap's height over the spindle's angle, and below it how far it is off its
//! line.
//!
//! ```text
//!   z │╲             on scale of the thread the way in and the way out are one line;
//!     │  ╲           the residual below, a thousand times enlarged, shows the difference
//!     │    ╲
//!   e │~~~~~~
//!     └──────── θ
//! ```
use super::figure::{ThreadView, figure};
use crate::svg::{Chart, Range, Stroke, fixed};
use units::Length;

/// The tap's height and its residual over the spindle's angle.
pub(crate) fn phase_plane(view: &ThreadView) -> String {
    let heading = "z over spindle angle";
    let caption = "Above: the tap's height over the turns of the spindle; in and out must lie on the dotted \
        line, one lead per turn, with no hook at the bottom. Below: the distance of the axis from that line, \
        enlarged; plus is deeper. A step at the turning point is friction or backlash, a slope a wrong lead, a bulge at \
        the ends a drive at its limit.";
    figure(heading, &(height(view) + &residual(view)), caption)
}

fn height(view: &ThreadView) -> String {
    let (trace, measure) = (view.trace, view.measure);
    let unit = measure.symbol();
    let clearance = trace.clearance();
    let to_z =
        |(turns, stroke): (f64, f64)| (turns, measure.number(clearance - Length::mm(stroke)));
    let [inward, outward] =
        trace.stroke.each_ref().map(|s| s.points().into_iter().map(to_z).collect::<Vec<_>>());
    let turns = (trace.whole() / trace.tap.lead.abs()).value();
    let ideal =
        [(0.0, measure.number(clearance)), (turns, measure.number(clearance - trace.whole()))];
    let all = || inward.iter().chain(&outward).chain(&ideal);
    let x = Range::of("spindle angle from the start, turns / rev", all().map(|p| p.0)).padded(0.03);
    let y = Range::of(&format!("z over the surface / {unit}"), all().map(|p| p.1)).padded(0.06);
    let description = format!(
        "The tap goes from {} {unit} over the surface to {} {unit} below it in {} turns, and back.",
        measure.length(clearance),
        measure.length(trace.whole() - clearance),
        fixed(turns, 2)
    );
    let mut chart =
        Chart::new("Height of the tap over the spindle angle", &description, x, y, 250.0);
    let surface = if view.thread.is_some() { "surface" } else { "programmed surface" };
    chart.level(Stroke::Capability, 0.0, surface);
    chart.line(Stroke::In, &inward, Some("in"));
    chart.line(Stroke::Out, &outward, Some("out"));
    chart.line(Stroke::Ideal, &ideal, Some("ideal: one lead per turn"));
    chart.finish(&format!("{}-z", view.id))
}

fn residual(view: &ThreadView) -> String {
    let trace = view.trace;
    let measure = view.measure;
    let small = measure.small_symbol();
    let least = measure.small_number(Length::um(1.0));
    let to_error = |(turns, e): (f64, f64)| (turns, measure.small_number(Length::um(e)));
    let [inward, outward] =
        trace.error.each_ref().map(|s| s.points().into_iter().map(to_error).collect::<Vec<_>>());
    let all = || inward.iter().chain(&outward);
    let turns = trace.whole() / trace.tap.lead.abs();
    let ends = [0.0, turns.value()];
    let x = Range::of("spindle angle from the start, turns / rev", all().map(|p| p.0).chain(ends))
        .padded(0.03);
    let errors = all().map(|p| p.1).chain([-least, least]);
    let y = Range::of(&format!("off the line / {small}"), errors).padded(0.08);
    let largest = all().map(|p| p.1.abs()).fold(0.0, f64::max);
    let description = format!(
        "The axis is off the line by {} {small} at most, in air and material.",
        fixed(largest, measure.small_decimals(1))
    );
    let mut chart = Chart::new("Distance of the axis from the line", &description, x, y, 180.0);
    chart.band("air", f64::NEG_INFINITY, (trace.clearance() / trace.tap.lead.abs()).value());
    chart.zero(false);
    chart.line(Stroke::In, &inward, None);
    chart.line(Stroke::Out, &outward, None);
    let above = if view.thread.is_some() {
        "not yet in the material"
    } else {
        "above the programmed surface"
    };
    chart.legend("air", above);
    chart.finish(&format!("{}-r", view.id))
}
