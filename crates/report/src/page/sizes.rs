//! The workpiece by sizes: one row per size of thread and diameter of hole.
use crate::pictures::figure;
use crate::svg::{Tag, fixed};
use std::collections::BTreeMap;
use verify::{Feature, FeatureKind, Thread};

/// Rows at most.
const MOST: usize = 40;

/// One row per size of thread and diameter of hole: how many, and the spread of what matters.
pub(super) fn sizes(features: &[Feature]) -> String {
    let mut by_size: BTreeMap<String, Vec<&Feature>> = BTreeMap::new();
    for feature in features {
        let size = match &feature.kind {
            FeatureKind::Hole(hole) => format!("hole ⌀{}", fixed(hole.diameter.value(), 2)),
            FeatureKind::Thread(thread) => thread.size.clone(),
            FeatureKind::Polygon(polygon) => polygon.name(),
            FeatureKind::Cam(cam) => format!("cam {}", cam.name),
            FeatureKind::Turned(thread) => thread.name(),
            FeatureKind::Gear(gear) => gear.name(),
        };
        by_size.entry(size).or_default().push(feature);
    }
    if by_size.is_empty() {
        return String::new();
    }
    let rows: String =
        by_size.iter().take(MOST).map(|(size, of_size)| row(size, of_size)).collect();
    let head = "<thead><tr><th class=\"l\">size</th><th>good</th><th>depth error<small>µm</small></th><th>sync error, max<small>µm</small></th><th>margin<small>µm</small></th></tr></thead>";
    let table = Tag::new("table").around(&(head.to_owned() + &Tag::new("tbody").around(&rows)));
    let scroll = Tag::new("div").class("scroll").with("tabindex", "0").around(&table);
    let caption = "Least to largest over all of a size. Depth error: plus is too deep. A wide spread within one size points to \
        the machine, a common offset to the program or the tool table.";
    figure("By size", &scroll, caption)
}

fn row(size: &str, features: &[&Feature]) -> String {
    let good = features.iter().filter(|f| f.verdict.is_pass()).count();
    let depth = spread(features, |f| match &f.kind {
        FeatureKind::Hole(hole) => Some(hole.depth_error.in_um()),
        FeatureKind::Thread(thread) => Some(thread.depth_error.in_um()),
        FeatureKind::Polygon(_) | FeatureKind::Turned(_) | FeatureKind::Gear(_) => None,
        FeatureKind::Cam(cam) => Some(cam.contour_error_max.in_um()),
    });
    let of_thread = |value: fn(&Thread) -> f64| {
        spread(features, move |f| match &f.kind {
            FeatureKind::Hole(_)
            | FeatureKind::Polygon(_)
            | FeatureKind::Cam(_)
            | FeatureKind::Turned(_)
            | FeatureKind::Gear(_) => None,
            FeatureKind::Thread(thread) => Some(value(thread)),
        })
    };
    let (sync, margin) = (of_thread(|t| t.sync_error_max.in_um()), of_thread(|t| t.margin.in_um()));
    let sign = if good == features.len() { "✓" } else { "✗" };
    let cells = [format!("{sign} {good}/{}", features.len()), depth, sync, margin];
    let cells: String = cells.iter().map(|cell| Tag::new("td").text(cell)).collect();
    Tag::new("tr").around(&(Tag::new("td").class("l").text(size) + &cells))
}

fn spread(features: &[&Feature], value: impl Fn(&Feature) -> Option<f64>) -> String {
    let values = features.iter().filter_map(|f| value(f)).filter(|v| v.is_finite());
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let (from, to) = (fixed(low, 1), fixed(high, 1));
    if low > high {
        "–".into()
    } else if from == to {
        from
    } else {
        format!("{from} … {to}")
    }
}
