//! The tool's path: where the tip went.
//!
//! ```text
//!     y  z │                oblique, from the front right above:
//!      ╲   │  ╱ x             u = x·cos 30° − y·sin 30°
//!       ╲__│╱                 v = z·cos 30° + (x·sin 30° + y·cos 30°)·sin 30°
//!
//!   turned by 30°, not by 45°: a row of holes along x = y would be one line
//!
//!   x │                     a lathe's: Z to the right, X up; of a turned thread as a diameter
//!     └──── z
//! ```
//!
//! The picture is as large as the cutting is; rapids that leave it for the tool change or the
//! machine's zero are cut off at its edge. In its first picture the path of each line of the
//! program is a link to the line.
use super::figure::figure;
use crate::record::{Point, Recorder};
use crate::svg::{Chart, Linked, Range, Stroke, fixed, ticks};
use crate::{Measure, Run};
use std::collections::{BTreeMap, BTreeSet};

type Polyline = Vec<(f64, f64)>;
type View = fn([f64; 3]) -> (f64, f64);

/// With more lines of a program than this their paths are not told apart.
const LINKED: usize = 1500;

pub(super) fn oblique([x, y, z]: [f64; 3]) -> (f64, f64) {
    let (sin, cos) = 30f64.to_radians().sin_cos();
    (x * cos - y * sin, z * cos + (x * sin + y * cos) * sin)
}

const fn above([x, y, _]: [f64; 3]) -> (f64, f64) {
    (x, y)
}

const fn front([x, _, z]: [f64; 3]) -> (f64, f64) {
    (x, z)
}

const fn lathe([x, _, z]: [f64; 3]) -> (f64, f64) {
    (z, x)
}

fn diameter([x, _, z]: [f64; 3]) -> (f64, f64) {
    (z, 2.0 * x)
}

/// From where the path is looked at.
pub(super) struct Looking {
    pub(super) view: View,
    /// What the picture's axes show.
    pub(super) titles: [String; 2],
    /// A millimetre is as long both ways.
    to_scale: bool,
    /// The directions of the axes have to be drawn.
    oblique: bool,
    pub(super) measure: Measure,
}

impl Looking {
    /// A chart of what spans these ranges, with room around it.
    pub(super) fn chart(&self, title: &str, description: &str, x: Range, y: Range) -> Chart {
        let (width, height) = (x.to - x.from, y.to - y.from);
        let least = 2.0 / self.measure.unit.in_mm();
        let grown = |r: Range, by: f64| Range { from: r.from - by, to: r.to + by, ..r };
        if self.to_scale {
            let margin = (0.12 * f64::max(width, height)).max(least);
            return Chart::to_scale(title, description, grown(x, margin), grown(y, margin));
        }
        let (across, up) = ((0.06 * width).max(least), (0.12 * height).max(0.25 * least));
        Chart::new(title, description, grown(x, across), grown(y, up), 300.0)
    }
}

/// A picture of the path.
struct Drawing {
    id: &'static str,
    heading: &'static str,
    caption: &'static str,
    looking: Looking,
}

/// The views of the path, and the lines of the program whose path is in them; nothing if nothing
/// moved.
pub(crate) fn tool_path(
    run: &Run,
    recorder: &Recorder,
    listed: &dyn Fn(u32) -> bool,
) -> (String, BTreeSet<u32>) {
    let zero = run.zero();
    let measure = recorder.measure();
    let shown = |p: Point| {
        let at = std::array::from_fn(|i| (p.at[i] - zero[i]) / measure.unit.in_mm());
        Point { at, ..p }
    };
    let points: Vec<Point> = recorder.track.points().map(shown).collect();
    let mut drawn = BTreeSet::new();
    if points.len() < 2 {
        return (String::new(), drawn);
    }
    let mut pictures = String::new();
    for (nth, drawing) in drawings(run, recorder).iter().enumerate() {
        let lines = if nth == 0 {
            lines_of(&points, drawing.looking.view, listed)
        } else {
            BTreeMap::new()
        };
        drawn.extend(lines.keys());
        let picture = draw(drawing, &points, &lines);
        pictures += &figure(drawing.heading, &picture, drawing.caption);
    }
    (pictures, drawn)
}

/// From where the first of the pictures is seen: a lathe's in the plane of its axis, else
/// obliquely.
pub(super) fn looking(run: &Run, recorder: &Recorder) -> Looking {
    let measure = recorder.measure();
    let (frame, unit) = (run.frame(), measure.symbol());
    let axis = |name: &str| format!("{name} in {frame} / {unit}");
    match recorder.turned_by_diameter() {
        None => Looking {
            view: oblique,
            titles: [format!("across the view / {unit}"), format!("up the view / {unit}")],
            to_scale: true,
            oblique: true,
            measure,
        },
        Some(by_diameter) => Looking {
            view: if by_diameter { diameter } else { lathe },
            titles: [
                axis("Z"),
                if by_diameter { format!("X in {frame}, diameter / {unit}") } else { axis("X") },
            ],
            to_scale: false,
            oblique: false,
            measure,
        },
    }
}

fn drawings(run: &Run, recorder: &Recorder) -> Vec<Drawing> {
    let first = looking(run, recorder);
    if !first.oblique {
        return vec![Drawing {
            id: "lathe",
            heading: "Tool path, in the plane of the axis",
            caption: "Path of the tool's tip, Z along the work's axis, X across it: cutting drawn through, rapids dashed. Look for \
                      rapids that come nearer to the work than the cut, and for ways in the air: they are time. Z and X each have \
                      their own scale.",
            looking: first,
        }];
    }
    let (frame, unit) = (run.frame(), recorder.measure().symbol());
    let along = |names: [&str; 2], view: View| Looking {
        view,
        titles: names.map(|name| format!("{name} in {frame} / {unit}")),
        to_scale: true,
        oblique: false,
        measure: recorder.measure(),
    };
    vec![
        Drawing {
            id: "oblique",
            heading: "Tool path, oblique",
            caption: "Path of the tool's tip, seen from the front right above: cutting drawn through, rapids dashed. Look for rapids \
                      that pass lower than the work's clamps, and for returns that climb higher than they need: they are time. \
                      Rapids to the tool change leave the picture.",
            looking: first,
        },
        Drawing {
            id: "above",
            heading: "Tool path, from above",
            caption: "The same path seen along Z, X to the right, Y up, to scale: what goes straight down is a point.",
            looking: along(["X", "Y"], above),
        },
        Drawing {
            id: "front",
            heading: "Tool path, from the front",
            caption: "The same path from the front, X to the right, Z up, to scale.",
            looking: along(["X", "Z"], front),
        },
    ]
}

fn draw(drawing: &Drawing, points: &[Point], lines: &BTreeMap<u32, Vec<Polyline>>) -> String {
    let Looking { view, titles, oblique, .. } = &drawing.looking;
    let view = *view;
    let [rapids, feeds] = split(points, view);
    let shown = if feeds.is_empty() { &rapids } else { &feeds };
    let flat = || shown.iter().flatten();
    let [across, up] = titles;
    let (x, y) = (Range::of(across, flat().map(|p| p.0)), Range::of(up, flat().map(|p| p.1)));
    let description = "Path of the tool's tip; rapids are dashed.";
    let mut chart = drawing.looking.chart(drawing.heading, description, x, y);
    chart.lines(Stroke::Rapid, &rapids, Some("rapid"));
    chart.lines(Stroke::Feed, &feeds, Some("cutting"));
    let points: Vec<(f64, f64)> = feeds
        .iter()
        .filter(|line| is_point(line))
        .filter_map(|line| line.first().copied())
        .collect();
    if !points.is_empty() {
        chart.dots(&points, "cutting, straight down");
    }
    for (line, path) in lines {
        let linked = Linked {
            id: format!("P{line}"),
            to: format!("#L{line}"),
            title: format!("line {line}"),
        };
        chart.linked(Stroke::Feed, &linked, path);
    }
    if *oblique {
        axes(&mut chart, &drawing.looking);
    }
    chart.finish(&format!("path-{}", drawing.id))
}

/// A line that is seen along itself.
fn is_point(line: &Polyline) -> bool {
    let near = |p: &(f64, f64)| (p.0 - line[0].0).hypot(p.1 - line[0].1) < 0.02;
    line.iter().all(near)
}

/// The cuts of each line that is listed; nothing if there are too many to be told apart.
fn lines_of(
    points: &[Point],
    view: View,
    listed: &dyn Fn(u32) -> bool,
) -> BTreeMap<u32, Vec<Polyline>> {
    let mut lines: BTreeMap<u32, Vec<Polyline>> = BTreeMap::new();
    for pair in points.windows(2) {
        let [from, to] = [&pair[0], &pair[1]];
        if to.rapid || to.lifted || !listed(to.line) {
            continue;
        }
        let (a, b) = (view(from.at), view(to.at));
        let of_line = lines.entry(to.line).or_default();
        match of_line.last_mut() {
            Some(line) if line.last() == Some(&a) => line.push(b),
            _ => of_line.push(vec![a, b]),
        }
        if lines.len() > LINKED {
            return BTreeMap::new();
        }
    }
    lines
}

/// The directions of the axes, in the lower left corner, each arm of one round length.
pub(super) fn axes(chart: &mut Chart, looking: &Looking) {
    let Looking { view, measure, oblique: true, .. } = looking else { return };
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
        &format!("axes, {} {} long", fixed(arm, if arm < 1.0 { 2 } else { 0 }), measure.symbol()),
    );
}

/// Lines of rapids and lines of cuts. A line begins where the one before ended.
fn split(points: &[Point], view: View) -> [Vec<Polyline>; 2] {
    let mut lines: [Vec<Polyline>; 2] = [Vec::new(), Vec::new()];
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
