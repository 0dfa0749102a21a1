//! The stop's track and the ways back in the (θ, z) plane, and the same as the distance from the
//! coupling.
//!
//! ```text
//!   z │╲               z − g(θ) │      ╭─○ Pb: at rest
//!     │ ╲  ○ Pb                 │     ╱  │
//!     │  ╲╱╎                    │    ╱   │ back
//!     │   ● Pc                  │───╯────● Pc ────  the coupling
//!     └──────── θ               └───────────────── θ
//! ```
use super::figure::figure;
use crate::stops::{PlanePoint, ThreadStop};
use crate::svg::{Chart, Range, Stroke, fixed};

/// Points of a line that are drawn.
const POINTS: usize = 600;

/// Two pictures of one recovery.
pub(crate) fn recovery_plane(recovery: &ThreadStop, index: usize) -> String {
    let plane = "Height over spindle angle where it stopped; the dotted line is the coupling, one lead a turn.";
    let off = "The same as the distance from the coupling, enlarged. The shaded area, between the stop's track and the way back that was \
        taken, is what the recovery cuts anew: the damage index. A way back that lies on the stop's track cuts nothing.";
    figure("Stop and way back", &height(recovery, index), plane)
        + &figure("Distance from the coupling", &residual(recovery, index), off)
}

/// The end of the stop and the beginning of the ways back: as many turns as the stop took, and one
/// each side.
fn window(recovery: &ThreadStop) -> (f64, f64) {
    let angles = recovery.stop.iter().map(|at| at.0.value());
    let (from, to) = angles.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
    (from - 0.5, to + 0.5)
}

fn within<'a>(
    track: &'a [PlanePoint],
    (from, to): (f64, f64),
    y: impl Fn(PlanePoint) -> f64 + 'a,
) -> Vec<(f64, f64)> {
    let inside: Vec<_> = track.iter().filter(|at| (from..=to).contains(&at.0.value())).collect();
    let step = inside.len().div_ceil(POINTS).max(1);
    let last = inside.last().map(|at| **at);
    let mut points: Vec<_> =
        inside.iter().step_by(step).map(|at| (at.0.value(), y(**at))).collect();
    points.extend(last.map(|at| (at.0.value(), y(at))));
    points
}

fn draw(
    recovery: &ThreadStop,
    mut chart: Chart,
    span: (f64, f64),
    y: impl Fn(PlanePoint) -> f64 + Copy,
) -> Chart {
    const STROKES: [Stroke; 2] = [Stroke::Out, Stroke::Second];
    chart.line(Stroke::In, &within(&recovery.stop, span, y), Some("the stop"));
    for (way, stroke) in recovery.ways.iter().zip(STROKES) {
        chart.line(stroke, &within(&way.track, span, y), Some(&way.name));
    }
    chart
}

fn height(recovery: &ThreadStop, index: usize) -> String {
    let span = window(recovery);
    let ((angle0, place0), lead) = recovery.coupling;
    let top = recovery.stop.iter().map(|at| at.1.value()).fold(f64::MIN, f64::max);
    let y = |at: PlanePoint| at.1.value() - top;
    let ideal =
        [span.0, span.1].map(|rev| (rev, (place0 + lead * (rev - angle0.value())).value() - top));
    let shown = recovery.ways.iter().flat_map(|w| within(&w.track, span, y));
    let all: Vec<_> =
        within(&recovery.stop, span, y).into_iter().chain(shown).chain(ideal).collect();
    let x = Range::of("spindle angle / rev", [span.0, span.1]);
    let z = Range::of("z from the stop / mm", all.iter().map(|p| p.1)).padded(0.06);
    let description = "Height over spindle angle from the stop's beginning to the way back.";
    let mut chart =
        Chart::new("Stop and way back over the spindle angle", description, x, z, 260.0);
    chart.line(Stroke::Ideal, &ideal, Some("the coupling"));
    draw(recovery, chart, span, y).finish(&format!("recovery-{index}-z"))
}

/// The stop's distance from the coupling, and that of the way back where the spindle stands at the
/// same angle.
fn between(recovery: &ThreadStop, span: (f64, f64)) -> Vec<(f64, [f64; 2])> {
    let Some(way) = recovery.ways.first() else { return Vec::new() };
    let back = within(&way.track, span, |at| recovery.off_um(at));
    let at = |rev: f64| {
        let nearest = back.iter().min_by(|a, b| (a.0 - rev).abs().total_cmp(&(b.0 - rev).abs()));
        nearest.map_or(0.0, |point| point.1)
    };
    let stop = within(&recovery.stop, span, |at| recovery.off_um(at));
    stop.into_iter().map(|(rev, off)| (rev, [off, at(rev)])).collect()
}

fn residual(recovery: &ThreadStop, index: usize) -> String {
    let span = window(recovery);
    let y = |at: PlanePoint| recovery.off_um(at);
    let shown = recovery.ways.iter().flat_map(|w| within(&w.track, span, y));
    let all: Vec<_> = within(&recovery.stop, span, y).into_iter().chain(shown).collect();
    let x = Range::of("spindle angle / rev", [span.0, span.1]);
    let e =
        Range::of("off the coupling / µm", all.iter().map(|p| p.1).chain([-1.0, 1.0])).padded(0.08);
    let description = format!("At rest it is {} µm off.", fixed(recovery.rest_um(), 1));
    let mut chart = Chart::new("Distance from the coupling", &description, x, e, 260.0);
    chart.zero(false);
    chart.area("area out", &between(recovery, span), None);
    draw(recovery, chart, span, y).finish(&format!("recovery-{index}-e"))
}
