//! The workpiece by sizes: one row per size of thread and diameter of hole.
use crate::pictures::figure;
use crate::svg::{Tag, fixed};
use crate::{Measure, Standing};
use std::collections::BTreeMap;
use verify::{Feature, FeatureKind, Thread};

/// Rows at most.
const MOST: usize = 40;

/// One row per size of thread and diameter of hole: how many, and the spread of what matters;
/// nothing where no size has more than one, for then the tables of features say the same.
pub(super) fn sizes(features: &[Feature], measure: Measure) -> String {
    let mut by_size: BTreeMap<String, Vec<&Feature>> = BTreeMap::new();
    for feature in features {
        by_size.entry(super::features::name(feature, measure)).or_default().push(feature);
    }
    if by_size.values().all(|of_size| of_size.len() < 2) {
        return String::new();
    }
    let rows: Vec<[String; 5]> =
        by_size.iter().take(MOST).map(|(size, of_size)| row(size, of_size, measure)).collect();
    let heads = [
        ("size", ""),
        ("good", ""),
        ("depth error", measure.small_symbol()),
        ("sync error, max", measure.small_symbol()),
        ("margin", measure.small_symbol()),
    ];
    // a column in which nothing was measured says nothing
    let used: Vec<usize> = (0..5).filter(|at| rows.iter().any(|row| row[*at] != "–")).collect();
    let cell = |tag: &'static str, at: usize| {
        if at == 0 { Tag::new(tag).class("l") } else { Tag::new(tag) }
    };
    let head: String = used
        .iter()
        .map(|&at| {
            let (name, unit) = heads[at];
            let unit = if unit.is_empty() { String::new() } else { Tag::new("small").text(unit) };
            cell("th", at).around(&(name.to_owned() + &unit))
        })
        .collect();
    let body: String = rows
        .iter()
        .map(|row| {
            let cells: String = used.iter().map(|&at| cell("td", at).text(&row[at])).collect();
            Tag::new("tr").around(&cells)
        })
        .collect();
    let head = Tag::new("thead").around(&Tag::new("tr").around(&head));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&body)));
    let scroll = Tag::new("div").class("scroll").with("tabindex", "0").around(&table);
    let caption = if used.len() > 2 {
        "Least to largest over all of a size that were cut. Depth error: plus is too deep. A wide spread within one size points to \
         the machine, a common offset to the program or the tool table."
    } else {
        "How many of each size are within tolerance."
    };
    figure("By size", &scroll, caption)
}

fn row(size: &str, features: &[&Feature], measure: Measure) -> [String; 5] {
    let good = features.iter().filter(|f| f.verdict.is_pass()).count();
    let cut = features.iter().copied().filter(|f| Standing::of(f) != Standing::NotCut);
    let cut: Vec<&Feature> = cut.collect();
    let small = |error: units::Length| measure.small_number(error);
    let depth = spread(&cut, measure, |f| match &f.kind {
        FeatureKind::Hole(hole) => Some(small(hole.depth_error)),
        FeatureKind::Thread(thread) => Some(small(thread.depth_error)),
        FeatureKind::Polygon(_)
        | FeatureKind::Turned(_)
        | FeatureKind::Gear(_)
        | FeatureKind::Milled(_)
        | FeatureKind::Cam(_) => None,
    });
    let of_thread = |value: fn(&Thread) -> Option<units::Length>| {
        spread(&cut, measure, move |f| match &f.kind {
            FeatureKind::Thread(thread) => value(thread).map(small),
            _ => None, // no other feature has one
        })
    };
    let (sync, margin) =
        (of_thread(|t| Some(t.sync_error_max)), of_thread(|t| t.is_gauged().then_some(t.margin)));
    let worst = features.iter().map(|f| Standing::of(f)).min().unwrap_or(Standing::Good);
    [size.to_owned(), format!("{} {good}/{}", worst.sign(), features.len()), depth, sync, margin]
}

fn spread(
    features: &[&Feature],
    measure: Measure,
    value: impl Fn(&Feature) -> Option<f64>,
) -> String {
    let values = features.iter().filter_map(|f| value(f)).filter(|v| v.is_finite());
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let decimals = usize::from(measure == Measure::METRIC);
    let (from, to) = (fixed(low, decimals), fixed(high, decimals));
    if low > high {
        "–".into()
    } else if from == to {
        from
    } else {
        format!("{from} … {to}")
    }
}
