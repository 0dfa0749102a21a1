//! The table of features, worst first; a click on a column's head sorts by it.
use crate::Run;
use crate::svg::{Tag, escape, fixed};
use units::{Length, Torque};
use verify::{Feature, FeatureKind};

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
    ("sync error, rms", "µm", false),
    ("pitch ⌀", "mm", false),
    ("class", "", true),
    ("margin", "µm", false),
    ("torque of the cut", "N·m", false),
    ("speed", "rpm", false),
];
/// Which of them hold the verdict and the feature's name.
const VERDICT: usize = 1;
const NAME: usize = 2;

/// How little of its tolerance a feature leaves: bad ones before good ones; of threads the one with
/// the smaller share of TD2 left, of holes the one with the larger depth error.
pub(super) fn badness(feature: &Feature) -> f64 {
    let failed = if feature.verdict.is_pass() { 0.0 } else { 1e6 };
    let used = match &feature.kind {
        FeatureKind::Hole(hole) => hole.depth_error.abs() / Length::mm(1.0),
        FeatureKind::Thread(thread) => 1.0 - thread.margin / thread.pitch_diameter_tolerance,
    };
    failed + if used.is_finite() { used } else { 1e3 }
}

/// The table, or a sentence if there is nothing to put into it.
pub(super) fn table(run: &Run, features: &[Feature]) -> String {
    if features.is_empty() {
        return Tag::new("p").class("soft").text("The program cut no hole and no thread.");
    }
    let mut order: Vec<usize> = (0..features.len()).collect();
    order.sort_by(|&a, &b| badness(&features[b]).total_cmp(&badness(&features[a])));
    let rows: String =
        order.into_iter().map(|index| row(run, index + 1, &features[index])).collect();
    let heads: String =
        COLUMNS.iter().map(|&(name, unit, words)| head(name, unit, words)).collect();
    let head = Tag::new("thead").around(&Tag::new("tr").around(&heads));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&rows)));
    let words = format!(
        "Worst first: what is out of tolerance, then by the share of the tolerance that is left. X and Y in {}; \
         depths from the surface, plus is deeper; of a thread, the length of full thread. Sync: distance of the tap's edges from \
         their ideal helix, in the material. A click on a head sorts.",
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

fn row(run: &Run, number: usize, feature: &Feature) -> String {
    let [x0, y0, _] = run.zero();
    let [x, y] = feature.position().map(Length::value);
    let (class, verdict) =
        if feature.verdict.is_pass() { ("pass", "✓ pass") } else { ("fail", "✗ fail") };
    let um = |value: Length, decimals| fixed(value.in_um(), decimals);
    let mut cells = vec![
        number.to_string(),
        verdict.into(),
        String::new(),
        feature.line.to_string(),
        fixed(x - x0, 3),
        fixed(y - y0, 3),
    ];
    match &feature.kind {
        FeatureKind::Hole(hole) => {
            cells[2] = format!("hole ⌀{}", fixed(hole.diameter.value(), 2));
            cells.extend([fixed(hole.depth.value(), 3), um(hole.depth_error, 1)]);
            cells.extend(std::iter::repeat_n(String::new(), 7));
        }
        FeatureKind::Thread(thread) => {
            let left = if thread.hand.sign() < 0.0 { " left" } else { "" };
            cells[2] = format!("{}{left}", thread.size);
            cells.extend([
                fixed(thread.depth.value(), 3),
                um(thread.depth_error, 1),
                um(thread.sync_error_max, 1),
                um(thread.sync_error_rms, 1),
                fixed(thread.pitch_diameter.value(), 3),
                thread.class.map_or("none", |class| class.name()).into(),
                um(thread.margin, 0),
                thread.torque_max.map_or(String::new(), |torque: Torque| fixed(torque.value(), 2)),
                fixed(thread.spin_max.in_rpm(), 0),
            ]);
        }
    }
    let why = feature.verdict.reason();
    let cells: String =
        cells.iter().enumerate().map(|(column, cell)| data(column, cell, why)).collect();
    Tag::new("tr").class(class).around(&cells)
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
