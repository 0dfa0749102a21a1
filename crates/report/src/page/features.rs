//! The table of features, worst first; a click on a column's head sorts by it.
use crate::Run;
use crate::svg::{Tag, escape, fixed};
use units::{Length, Torque};
use verify::{Criterion, Feature, FeatureKind, Headroom, Verdict};

/// Columns: name, unit, and whether they hold words.
const COLUMNS: [(&str, &str, bool); 15] = [
    ("No.", "", false),
    ("verdict", "", true),
    ("feature", "", true),
    ("line", "", false),
    ("X", "mm", false),
    ("Y", "mm", false),
    ("depth", "mm", false),
    ("depth error", "µm", false),
    ("sync error, max", "µm", false),
    ("pitch ⌀", "mm", false),
    ("class", "", true),
    ("gauge margin", "µm", false),
    ("torque of the cut", "N·m", false),
    ("speed", "rpm", false),
    ("tolerance left", "%", false),
];
/// Which of them hold the verdict and the feature's name.
const VERDICT: usize = 1;
const NAME: usize = 2;

/// The order of badness: what failed first, then by the share of the nearest tolerance that is left.
pub(super) fn by_badness(run: &Run, features: &[Feature]) -> Vec<(usize, Headroom)> {
    let mut order: Vec<_> =
        features.iter().map(|f| f.headroom(&run.tolerances)).enumerate().collect();
    let passed = |&(index, _): &(usize, Headroom)| features[index].verdict.is_pass();
    order.sort_by(|a, b| passed(a).cmp(&passed(b)).then(a.1.share().total_cmp(&b.1.share())));
    order
}

/// The table, or a sentence if there is nothing to put into it.
pub(super) fn table(run: &Run, features: &[Feature]) -> String {
    if features.is_empty() {
        return Tag::new("p").class("soft").text("The program cut no hole and no thread.");
    }
    let order = by_badness(run, features).into_iter();
    let rows: String =
        order.map(|(index, left)| row(run, index + 1, &features[index], &left)).collect();
    let heads: String =
        COLUMNS.iter().map(|&(name, unit, words)| head(name, unit, words)).collect();
    let head = Tag::new("thead").around(&Tag::new("tr").around(&heads));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&rows)));
    let words = format!(
        "Worst first: what is out of tolerance, then by the share of the tolerance that is left. X and Y in {}; \
         depths from the surface, plus is deeper; of a thread, the length of full thread. Sync error: distance of the axis from \
         the ideal helix, in the material. Tolerance left: of the tolerance nearest to its limit. A click on a head sorts.",
        run.frame()
    );
    let scroll = Tag::new("div")
        .class("scroll")
        .with("tabindex", "0")
        .with("role", "region")
        .with("aria-label", "Features");
    Tag::new("p").class("soft").text(&words) + &scroll.around(&table)
}

fn head(name: &str, unit: &str, words: bool) -> String {
    let unit = if unit.is_empty() { String::new() } else { Tag::new("small").text(unit) };
    let button = Tag::new("button").with("type", "button").around(&(escape(name) + &unit));
    let head = Tag::new("th").with("scope", "col");
    if words { head.class("l").around(&button) } else { head.around(&button) }
}

fn row(run: &Run, number: usize, feature: &Feature, left: &Headroom) -> String {
    let [x0, y0, _] = run.zero();
    let (class, verdict) = match feature.verdict {
        Verdict::Pass => ("pass", "✓ pass"),
        Verdict::Fail { .. } => ("fail", "✗ fail"),
        Verdict::NotJudged { .. } => ("none", "○ not judged"),
    };
    let um = |value: Length, decimals| fixed(value.in_um(), decimals);
    let mut cells = vec![
        number.to_string(),
        verdict.into(),
        String::new(),
        feature.line.to_string(),
        feature.position().map_or_else(String::new, |[x, _]| fixed(x.value() - x0, 3)),
        feature.position().map_or_else(String::new, |[_, y]| fixed(y.value() - y0, 3)),
    ];
    match &feature.kind {
        FeatureKind::Hole(hole) => {
            cells[2] = format!("hole ⌀{}", fixed(hole.diameter.value(), 2));
            cells.extend([fixed(hole.depth.value(), 3), um(hole.depth_error, 1)]);
            cells.extend(std::iter::repeat_n(String::new(), 6));
        }
        FeatureKind::Cam(cam) => {
            cells[2] = format!("cam {}", cam.name);
            let lift = cam.lift.iter().map(|l| l.value()).fold(0.0, f64::max);
            cells.extend([fixed(lift, 3), um(cam.contour_error_max, 1)]);
            cells.extend(std::iter::repeat_n(String::new(), 5));
            cells.push(fixed(cam.spin.in_rpm(), 0));
        }
        FeatureKind::Turned(thread) => {
            cells[2] = thread.name();
            cells.extend([
                fixed(thread.length().value(), 3),
                um(thread.infeed_error, 1),
                um(thread.sync_error_max, 1),
                thread.sizes.as_ref().map_or(String::new(), |s| fixed(s.pitch[0].value(), 3)),
                thread.class_and_size(),
                thread.pitch_margin().map_or(String::new(), |margin| um(margin, 0)),
                thread.torque_max.map_or(String::new(), |torque| fixed(torque.value(), 2)),
                fixed(thread.spin_max.in_rpm(), 0),
            ]);
        }
        FeatureKind::Polygon(polygon) => {
            cells[2] = polygon.name();
            cells.extend([fixed((polygon.z_to - polygon.z_from).value(), 3), String::new()]);
            cells.extend(std::iter::repeat_n(String::new(), 5));
            cells.push(fixed(polygon.spin.in_rpm(), 0));
        }
        FeatureKind::Gear(gear) => {
            cells[2] = gear.name();
            cells.extend([fixed((gear.z_to - gear.z_from).value(), 3), String::new()]);
            cells.extend([um(gear.pitch_total, 1), String::new()]);
            cells.push(gear.grade.map_or("none".into(), |grade| format!("grade {grade}")));
            cells.extend([String::new(), String::new(), fixed(gear.spin.in_rpm(), 0)]);
        }
        FeatureKind::Thread(thread) => {
            let hand = if thread.hand.sign() < 0.0 { " left" } else { "" };
            cells[2] = format!("{}{hand}", thread.size);
            cells.extend([
                fixed(thread.depth.value(), 3),
                um(thread.depth_error, 1),
                um(thread.sync_error_max, 1),
                fixed(thread.pitch_diameter.value(), 3),
                thread.class_name().into(),
                um(thread.margin, 0),
                thread.torque_max.map_or(String::new(), |torque: Torque| fixed(torque.value(), 2)),
                fixed(thread.spin_max.in_rpm(), 0),
            ]);
        }
    }
    cells.push(share_left(left));
    let why = feature.verdict.reason();
    let cells: String =
        cells.iter().enumerate().map(|(column, cell)| data(column, cell, why)).collect();
    Tag::new("tr").class(class).around(&cells)
}

/// In percent; what has no measure has no share.
fn share_left(left: &Headroom) -> String {
    match left.of {
        Criterion::Whole => "–".into(),
        of => format!("{} {}", fixed(left.share() * 100.0, 0), of.name()),
    }
}

fn data(column: usize, text: &str, why: Option<&str>) -> String {
    let cell = Tag::new("td");
    match (column, why) {
        (VERDICT, _) => cell.class("l verdict-cell").text(text),
        (NAME, Some(why)) => {
            cell.class("l wide").around(&(escape(text) + &Tag::new("div").text(why)))
        }
        _ if COLUMNS[column].2 => cell.class("l").text(text),
        _ => cell.text(text),
    }
}
