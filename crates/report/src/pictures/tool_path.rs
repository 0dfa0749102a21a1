//! The tool's path: where the tip went, in a view from the front right above and one from the front.
//!
//! ```text
//!     y  z │                u = x·cos 30° − y·sin 30°
//!      ╲   │  ╱ x           v = z·cos 30° + (x·sin 30° + y·cos 30°)·sin 30°
//!       ╲__│╱
//!
//!   turned by 30°, not by 45°: a row of holes along x = y would be one line
//! ```
//!
//! The picture is as large as the cutting is; rapids that leave it for the tool change or the
//! machine's zero are cut off at its edge.
use super::figure;
use crate::Run;
use crate::record::{Point, Recorder};
use crate::svg::{Chart, Range, Stroke, fixed, ticks};

type Line = Vec<(f64, f64)>;
type View = fn([f64; 3]) -> (f64, f64);

pub(super) fn above([x, y, z]: [f64; 3]) -> (f64, f64) {
    let (sin, cos) = 30f64.to_radians().sin_cos();
    (x * cos - y * sin, z * cos + (x * sin + y * cos) * sin)
}

const fn front([x, _, z]: [f64; 3]) -> (f64, f64) {
    (x, z)
}

/// The two views of the path; empty if nothing moved.
pub(crate) fn tool_path(run: &Run, recorder: &Recorder) -> [String; 2] {
    let zero = run.zero();
    let relative = |p: Point| Point { at: std::array::from_fn(|i| p.at[i] - zero[i]), ..p };
    let points: Vec<Point> = recorder.track.points().map(relative).collect();
    if points.len() < 2 {
        return [String::new(), String::new()];
    }
    let frame = run.frame();
    let above =
        draw("above", &points, above, ["across the view / mm".into(), "up the view / mm".into()]);
    let front =
        draw("front", &points, front, [format!("X in {frame} / mm"), format!("Z in {frame} / mm")]);
    let caption = "Path of the tool's tip: cutting drawn through, rapids dashed. Look for rapids that pass lower than the \
        work's clamps, and for returns that climb higher than they need: they are time. Rapids to the tool change \
        leave the picture.";
    let above = figure("Tool path, from above", &above, caption);
    let of_front = "The same path from the front, X to the right, Z up, to scale.";
    [above, figure("Tool path, from the front", &front, of_front)]
}

fn draw(id: &str, points: &[Point], view: View, titles: [String; 2]) -> String {
    let [rapids, feeds] = split(points, view);
    let shown = if feeds.is_empty() { &rapids } else { &feeds };
    let flat = || shown.iter().flatten();
    let [across, up] = titles;
    let (x, y) = (Range::of(&across, flat().map(|p| p.0)), Range::of(&up, flat().map(|p| p.1)));
    let margin = (0.12 * f64::max(x.to - x.from, y.to - y.from)).max(2.0);
    let grown = |r: Range| Range { from: r.from - margin, to: r.to + margin, ..r };
    let title =
        format!("Tool path, {}", if id == "above" { "from above" } else { "from the front" });
    let description = "Path of the tool's tip; rapids are dashed.";
    let mut chart = Chart::to_scale(&title, description, grown(x), grown(y));
    chart.lines(Stroke::Rapid, &rapids, Some("rapid"));
    chart.lines(Stroke::Feed, &feeds, Some("cutting"));
    axes(&mut chart, view);
    chart.finish(&format!("path-{id}"))
}

/// The directions of the axes, in the lower left corner, each arm of one round length.
pub(super) fn axes(chart: &mut Chart, view: View) {
    let wanted = chart.inside(0.12, 0.0).0 - chart.inside(0.0, 0.0).0;
    let arm = ticks(0.0, wanted, 1).step;
    let (left, low) = chart.inside(0.14, 0.07);
    let ends = [("X", [arm, 0.0, 0.0]), ("Y", [0.0, arm, 0.0]), ("Z", [0.0, 0.0, arm])];
    let seen =
        ends.map(|(name, end)| (name, view(end))).into_iter().filter(|(_, at)| *at != (0.0, 0.0));
    for (name, (across, up)) in seen {
        let end = (left + across, low + up);
        chart.line(Stroke::Axis, &[(left, low), end], None);
        chart.word(end, (across / arm * 9.0, 4.0 - up / arm * 9.0), "axis", name);
    }
    chart.legend(
        "line axes",
        &format!("axes, {} mm long", fixed(arm, if arm < 1.0 { 2 } else { 0 })),
    );
}

/// Lines of rapids and lines of cuts. A line begins where the one before ended.
fn split(points: &[Point], view: View) -> [Vec<Line>; 2] {
    let mut lines: [Vec<Line>; 2] = [Vec::new(), Vec::new()];
    let mut before: Option<Point> = None;
    for &point in points {
        let from = before.replace(point).filter(|_| !point.lifted);
        let Some(from) = from else { continue };
        let (a, b) = (view(from.at), view(point.at));
        let kind = &mut lines[usize::from(!point.rapid)];
        match kind.last_mut() {
            Some(line) if line.last() == Some(&a) => line.push(b),
            _ => kind.push(vec![a, b]),
        }
    }
    lines
}
