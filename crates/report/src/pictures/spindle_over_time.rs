//! Spindle speed and torque over the time of one tap, against what the drive can give at each
//! speed.
use super::figure::{ThreadView, figure};
use crate::svg::{Chart, Range, Stroke, fixed};
use units::{Spin, Torque};

/// Speed above, torque below, over one time.
pub(crate) fn spindle_over_time(view: &ThreadView) -> String {
    let saturated = view.trace.saturated_for.value() * 1e3;
    let verdict = if saturated > 0.0 {
        format!("The drive was at its limit for {} ms (filled).", fixed(saturated, 1))
    } else {
        "The drive never reached its limit.".into()
    };
    let caption = format!(
        "{verdict} Look for torque that touches the dashed line: there the spindle leaves its plan \
         and the thread suffers. The dashed line comes nearer where the speed is high, because power is torque \
         times speed."
    );
    figure("Spindle speed and torque over time", &(speed(view) + &torque(view)), &caption)
}

fn time(view: &ThreadView) -> Range {
    let points = view.trace.torque.points();
    Range::of("time from the start of the tap / s", points.into_iter().map(|p| p.0)).padded(0.02)
}

fn saturation(chart: &mut Chart, view: &ThreadView) {
    for &(from, to) in &view.trace.saturated {
        chart.band("hot", from, to);
    }
}

fn speed(view: &ThreadView) -> String {
    let points = view.trace.speed.points();
    let largest = points.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
    let y = Range::of("spindle speed / rpm", points.iter().map(|p| p.1).chain([0.0])).padded(0.08);
    let description = format!(
        "The spindle reaches {} rpm, stops at the bottom, and turns back.",
        fixed(largest, 0)
    );
    let mut chart = Chart::new("Spindle speed over time", &description, time(view), y, 190.0);
    saturation(&mut chart, view);
    chart.zero(false);
    chart.line(Stroke::Main, &points, None);
    chart.finish(&format!("{}-n", view.id))
}

fn torque(view: &ThreadView) -> String {
    let trace = view.trace;
    let drive = trace.torque.points();
    let cut = trace.cut.points();
    let at = |rpm: f64| view.run.limits.torque_at(Spin::rpm(rpm)).map(Torque::value);
    let can: Vec<_> =
        trace.speed.points().into_iter().filter_map(|(t, rpm)| Some((t, at(rpm)?))).collect();
    let cannot: Vec<_> = can.iter().map(|&(t, m)| (t, -m)).collect();
    let all = drive.iter().chain(&cut).chain(&can).chain(&cannot).map(|p| p.1);
    let y = Range::of("torque / N·m", all.chain([0.0])).padded(0.08);
    let largest = trace.torque_max().value();
    let description = format!("Torque of the spindle's drive: {} N·m at most.", fixed(largest, 1));
    let mut chart = Chart::new("Spindle torque over time", &description, time(view), y, 230.0);
    saturation(&mut chart, view);
    chart.zero(false);
    chart.line(Stroke::Capability, &can, Some("available at this speed"));
    chart.line(Stroke::Capability, &cannot, None);
    chart.line(Stroke::Main, &drive, Some("drive"));
    if cut.iter().any(|p| p.1 != 0.0) {
        chart.line(Stroke::Second, &cut, Some("cut"));
    }
    if !trace.saturated.is_empty() {
        chart.legend("hot", "drive at its limit");
    }
    chart.finish(&format!("{}-m", view.id))
}
