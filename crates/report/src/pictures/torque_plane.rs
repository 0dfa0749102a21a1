//! The torque–speed plane: where the spindle's drive worked, under its curve.
//!
//! ```text
//!        M │ ╭───────╮
//!    brake │╱  drive  ╲      first and third quadrant drive, second and fourth brake
//!   ───────┼──────────── n
//!    drive │╲  brake  ╱
//!          │ ╰───────╯
//! ```
use super::figure::{ThreadView, figure};
use crate::svg::{Chart, Range, Stroke, fixed};

/// Operating points of one tap under the drive's curve.
pub(crate) fn torque_plane(view: &ThreadView) -> String {
    let points = view.trace.plane.points();
    let fastest = points.iter().map(|p| p.0.abs()).fold(0.0, f64::max).max(100.0) * 1.12;
    let right = view.run.limits.torque_up_to(units::Spin::rpm(fastest * 1.3));
    let right: Vec<_> = right.iter().map(|&(n, m)| (n.in_rpm(), m.value())).collect();
    let mut upper: Vec<_> = right.iter().rev().map(|&(n, m)| (-n, m)).collect();
    upper.extend(&right);
    let lower: Vec<_> = upper.iter().map(|&(n, m)| (n, -m)).collect();
    let torques = points.iter().chain(&right).map(|p| p.1.abs()).fold(1.0, f64::max);
    let outwards = if view.trace.tap.lead.value() < 0.0 { "plus" } else { "minus" };
    let x = Range::of(&format!("spindle speed / rpm ({outwards}: outwards)"), [-fastest, fastest]);
    let y = Range::of("torque of the drive / N·m", [-torques, torques]).padded(0.08);
    let used = largest_share(view, &points);
    let description = match used {
        Some(share) => format!(
            "The drive used up to {} % of what it can give at its speed.",
            fixed(share * 100.0, 0)
        ),
        None => "Operating points of the drive; its curve is not known.".into(),
    };
    let mut chart =
        Chart::new("Operating points under the torque curve", &description, x, y, 330.0);
    chart.zero(true);
    chart.line(Stroke::Capability, &upper, Some("what the drive can give"));
    chart.line(Stroke::Capability, &lower, None);
    chart.dots(&points, "operating points, every extreme kept");
    let caption = format!(
        "{description} The plan is good if the points run along the curve without lying on it: that is the fastest \
         this spindle can reverse. Points on the curve are a drive at its limit."
    );
    figure("Torque over speed", &chart.finish(&format!("{}-p", view.id)), &caption)
}

/// Largest share of the available torque that was used.
fn largest_share(view: &ThreadView, points: &[(f64, f64)]) -> Option<f64> {
    let shares = points.iter().filter_map(|&(rpm, torque)| {
        let can = view.run.limits.torque_at(units::Spin::rpm(rpm))?;
        Some(torque.abs() / can.value())
    });
    shares.filter(|s| s.is_finite()).reduce(f64::max)
}
