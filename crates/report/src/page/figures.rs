//! Key figures: what a reader looks for first, each with one line of why.
use super::verdict::worst;
use crate::Run;
use crate::pictures::tolerance_share;
use crate::record::Recorder;
use crate::svg::{Tag, fixed};
use std::collections::BTreeMap;
use units::Time;
use verify::{Feature, FeatureKind, Thread};

/// The figures as a row of cards.
pub(super) fn figures(run: &Run, recorder: &Recorder, features: &[Feature]) -> String {
    let mut cards = vec![
        card("Cycle time", &duration(run.cycle_time), &rate(run, recorder)),
        count("Holes", features, |f| matches!(f.kind, FeatureKind::Hole(_))),
        count("Threads", features, |f| matches!(f.kind, FeatureKind::Thread(_))),
    ];
    cards.extend(largest_error(run, features));
    cards.extend(tightest(features));
    cards.push(card(
        "Alarms",
        &run.alarms.len().to_string(),
        if run.alarms.is_empty() { "none" } else { "see below" },
    ));
    Tag::new("dl").class("figures").around(&cards.concat())
}

fn card(name: &str, value: &str, why: &str) -> String {
    let value = Tag::new("dd").class("value").text(value);
    let why = Tag::new("dd").class("why").text(why);
    Tag::new("div").around(&(Tag::new("dt").text(name) + &value + &why))
}

/// Minutes and seconds from a minute on.
fn duration(time: Time) -> String {
    let seconds = time.value();
    if !seconds.is_finite() || seconds < 60.0 {
        return format!("{} s", fixed(seconds, 2));
    }
    let tenths = (seconds * 10.0).round();
    let minutes = (tenths / 600.0).floor();
    format!("{} min {} s", fixed(minutes, 0), fixed((tenths - minutes * 600.0) / 10.0, 1))
}

fn rate(run: &Run, recorder: &Recorder) -> String {
    if recorder.taps == 0 || !run.ended {
        return if run.ended { "program start to end".into() } else { "until it stopped".into() };
    }
    let tapping: f64 = [bus::State::TapIn, bus::State::TapBottom, bus::State::TapOut]
        .into_iter()
        .map(|state| recorder.shares.run.of(state).value())
        .sum();
    format!("{} s per tap, in and out", fixed(tapping / recorder.taps as f64, 3))
}

fn count(name: &str, features: &[Feature], is: fn(&Feature) -> bool) -> String {
    let all = features.iter().filter(|f| is(f)).count();
    let bad = features.iter().filter(|f| is(f) && !f.verdict.is_pass()).count();
    let why = match (all, bad) {
        (0, _) => "none cut".into(),
        (_, 0) => "✓ all".into(),
        _ => format!("✗ {bad} out of tolerance"),
    };
    card(&format!("{name} within tolerance"), &format!("{} of {all}", all - bad), &why)
}

fn threads(features: &[Feature]) -> impl Iterator<Item = (usize, &Thread)> {
    features.iter().enumerate().filter_map(|(index, feature)| match &feature.kind {
        FeatureKind::Thread(thread) => Some((index + 1, thread.as_ref())),
        FeatureKind::Hole(_) => None,
    })
}

fn largest_error(run: &Run, features: &[Feature]) -> Option<String> {
    let finite = threads(features).filter(|(_, t)| t.sync_error_max.is_finite());
    let (number, thread) =
        finite.max_by(|a, b| a.1.sync_error_max.value().total_cmp(&b.1.sync_error_max.value()))?;
    let why = format!(
        "feature {number}, {} deep; warn {} µm, a quarter of TD2 is {} µm",
        format_args!("{} mm", fixed(thread.sync_error_depth.value(), 1)),
        fixed(run.limits.sync_warn.in_um(), 0),
        fixed(tolerance_share(thread).in_um(), 0)
    );
    let value = format!("{} µm", fixed(thread.sync_error_max.in_um(), 1));
    Some(card("Largest sync error in the material", &value, &why))
}

fn tightest(features: &[Feature]) -> Option<String> {
    let feature = worst(features)?;
    let number = features.iter().position(|f| std::ptr::eq(f, feature))? + 1;
    let why = match (&feature.kind, feature.verdict.reason()) {
        (_, Some(reason)) => reason.to_owned(),
        (FeatureKind::Thread(thread), None) => {
            format!(
                "{} {}: {} µm left at the {} gauge",
                thread.size,
                thread.class_asked,
                fixed(thread.margin.in_um(), 0),
                thread.limiting_gauge.name()
            )
        }
        (FeatureKind::Hole(hole), None) => {
            format!("depth off by {} µm", fixed(hole.depth_error.in_um(), 1))
        }
    };
    let name = if feature.verdict.is_pass() { "Least margin" } else { "Worst feature" };
    Some(card(name, &format!("No. {number}"), &format!("line {}: {why}", feature.line)))
}

/// One row per size of thread and diameter of hole: how many, and the spread of what matters.
pub(super) fn sizes(features: &[Feature]) -> String {
    let mut by_size: BTreeMap<String, Vec<&Feature>> = BTreeMap::new();
    for feature in features {
        let size = match &feature.kind {
            FeatureKind::Hole(hole) => format!("hole ⌀{}", fixed(hole.diameter.value(), 2)),
            FeatureKind::Thread(thread) => thread.size.clone(),
        };
        by_size.entry(size).or_default().push(feature);
    }
    if by_size.is_empty() {
        return String::new();
    }
    let rows: String = by_size.iter().take(40).map(|(size, of_size)| row(size, of_size)).collect();
    let head = "<thead><tr><th class=\"l\">size</th><th>good</th><th>depth error<small>µm</small></th><th>sync error, max<small>µm</small></th><th>margin<small>µm</small></th></tr></thead>";
    let table = Tag::new("table").around(&(head.to_owned() + &Tag::new("tbody").around(&rows)));
    let scroll = Tag::new("div").class("scroll").with("tabindex", "0").around(&table);
    let caption = "Least to largest over all of a size. Depth error: plus is too deep. A wide spread within one size points to \
        the machine, a common offset to the program or the tool table.";
    crate::pictures::figure("By size", &scroll, caption)
}

fn row(size: &str, features: &[&Feature]) -> String {
    let good = features.iter().filter(|f| f.verdict.is_pass()).count();
    let depth = spread(features, |f| match &f.kind {
        FeatureKind::Hole(hole) => Some(hole.depth_error.in_um()),
        FeatureKind::Thread(thread) => Some(thread.depth_error.in_um()),
    });
    let of_thread = |value: fn(&Thread) -> f64| {
        spread(features, move |f| match &f.kind {
            FeatureKind::Hole(_) => None,
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
