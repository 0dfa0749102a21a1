//! The whole run: spindle speed over time, with the tool changes.
use super::figure::figure;
use crate::Run;
use crate::record::Recorder;
use crate::svg::{Chart, Range, Stroke};

/// With more changes than this they are not named.
const MOST_NAMES: usize = 10;

/// Spindle speed over the run, or nothing if nothing was recorded.
pub(crate) fn timeline(run: &Run, recorder: &Recorder) -> String {
    let points = recorder.spindle.points();
    if points.len() < 2 {
        return String::new();
    }
    let end = points.iter().map(|p| p.0).fold(0.0, f64::max);
    let (unit, per_unit) = if end > 600.0 { ("min", 60.0) } else { ("s", 1.0) };
    let points: Vec<_> = points.into_iter().map(|(t, n)| (t / per_unit, n)).collect();
    let x = Range::of(&format!("time of the run / {unit}"), points.iter().map(|p| p.0));
    let y = Range::of("spindle speed / rpm", points.iter().map(|p| p.1).chain([0.0])).padded(0.16);
    let (top, bottom) = (y.to, y.from);
    let description = format!("Spindle speed over the run of {}.", run.program);
    let mut chart = Chart::new("Spindle speed over the whole run", &description, x, y, 250.0);
    chart.zero(false);
    chart.line(Stroke::Main, &points, None);
    let few = recorder.changes.len() <= MOST_NAMES;
    let mut named = 0;
    for (time, tool) in &recorder.changes {
        let at = time.value() / per_unit;
        chart.line(Stroke::Ideal, &[(at, bottom), (at, top)], None);
        if few && *tool != 0 {
            let down = 12.0 + 13.0 * f64::from(named % 2);
            named += 1;
            chart.word((at, top), (3.0, down), "name start", &format!("T{tool}"));
        }
    }
    let caption = "Dotted lines are tool changes. Equal threads must look equal; a spindle that comes down to zero between holes \
        of one drill, or idles long at speed, costs time.";
    figure("The run", &chart.finish("run"), caption)
}
