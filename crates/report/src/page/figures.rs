//! Key figures: what a reader looks for first, each with one line of why.
use super::features::by_badness;
use crate::pictures::tolerance_share;
use crate::record::Recorder;
use crate::svg::{Tag, fixed};
use crate::{Measure, Run, Standing, headroom_text};
use units::{Length, Time};
use verify::{Feature, FeatureKind, Summary, Thread};

/// The figures as a row of cards.
pub(super) fn figures(run: &Run, recorder: &Recorder, features: &[Feature]) -> String {
    let summary = Summary::of(features, &run.tolerances);
    let mut cards = vec![card("Cycle time", &duration(run.cycle_time), &rate(run, recorder))];
    let nothing = features.is_empty();
    for (name, of_kind) in KINDS {
        let some: Vec<Standing> =
            features.iter().filter(|f| of_kind(f)).map(Standing::of).collect();
        if !some.is_empty() || nothing && name == "Holes" {
            cards.push(count(name, &some));
        }
    }
    let measure = recorder.measure();
    cards.extend(largest_error(run, measure, features));
    cards.extend(depth_error(&summary, measure, features));
    cards.extend(tightest(run, measure, features));
    let see = if run.alarms.is_empty() { "none" } else { "see below" };
    cards.push(card("Alarms", &run.alarms.len().to_string(), see));
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

/// A kind that is counted, and whether a feature is of it.
type CountedKind = (&'static str, fn(&Feature) -> bool);

/// Kinds that are counted.
const KINDS: [CountedKind; 6] = [
    ("Holes", |f| matches!(f.kind, FeatureKind::Hole(_))),
    ("Threads", |f| matches!(f.kind, FeatureKind::Thread(_) | FeatureKind::Turned(_))),
    ("Polygons", |f| matches!(f.kind, FeatureKind::Polygon(_))),
    ("Cams", |f| matches!(f.kind, FeatureKind::Cam(_))),
    ("Gears", |f| matches!(f.kind, FeatureKind::Gear(_))),
    ("Mills", |f| matches!(f.kind, FeatureKind::Milled(_))),
];

fn count(name: &str, all: &[Standing]) -> String {
    let of = |standing: Standing| all.iter().filter(|s| **s == standing).count();
    let some = [Standing::Bad, Standing::NotCut, Standing::NotJudged]
        .into_iter()
        .filter(|standing| of(*standing) > 0)
        .map(|standing| {
            let word = if standing == Standing::Bad { "out of tolerance" } else { standing.name() };
            format!("{} {} {word}", standing.sign(), of(standing))
        });
    let why = match (all.len(), some.collect::<Vec<_>>().join(", ")) {
        (0, _) => "none cut".into(),
        (_, none) if none.is_empty() => "✓ all".into(),
        (_, bad) => bad,
    };
    let value = format!("{} of {}", of(Standing::Good), all.len());
    card(&format!("{name} within tolerance"), &value, &why)
}

fn threads(features: &[Feature]) -> impl Iterator<Item = (usize, &Thread)> {
    features.iter().enumerate().filter_map(|(index, feature)| match &feature.kind {
        FeatureKind::Thread(thread) => Some((index + 1, thread.as_ref())),
        FeatureKind::Hole(_)
        | FeatureKind::Polygon(_)
        | FeatureKind::Cam(_)
        | FeatureKind::Turned(_)
        | FeatureKind::Milled(_)
        | FeatureKind::Gear(_) => None,
    })
}

fn largest_error(run: &Run, measure: Measure, features: &[Feature]) -> Option<String> {
    let finite = threads(features)
        .filter(|(_, t)| t.sync_error_max.is_finite() && t.tip_depth > Length::ZERO);
    let (number, thread) =
        finite.max_by(|a, b| a.1.sync_error_max.value().total_cmp(&b.1.sync_error_max.value()))?;
    let (unit, small) = (measure.symbol(), measure.small_symbol());
    let why = format!(
        "No. {number}, {} {unit} deep; warn {} {small}, a quarter of TD2 is {} {small}",
        measure.length(thread.sync_error_depth),
        measure.small(run.limits.sync_warn, 0),
        measure.small(tolerance_share(thread), 0)
    );
    let value = format!("{} {small}", measure.small(thread.sync_error_max, 1));
    Some(card("Largest sync error in the material", &value, &why))
}

fn depth_error(summary: &Summary, measure: Measure, features: &[Feature]) -> Option<String> {
    let (index, error) = summary.depth_error_max?;
    if Standing::of(features.get(index)?) == Standing::NotCut {
        return None; // how far it is from a thread that is not there says nothing
    }
    let sense = match error {
        e if e.abs() < Length::um(0.05) => "as programmed",
        e if e < Length::ZERO => "not deep enough",
        _ => "deeper than programmed",
    };
    let value = format!("{} {}", measure.small(error.abs(), 1), measure.small_symbol());
    Some(card("Largest depth error of a thread", &value, &format!("No. {}, {sense}", index + 1)))
}

fn tightest(run: &Run, measure: Measure, features: &[Feature]) -> Option<String> {
    let (index, left) = *by_badness(run, features).first()?;
    let feature = &features[index];
    let why = feature.verdict.reason().map_or_else(|| headroom_text(&left, measure), Into::into);
    let name = match Standing::of(feature) {
        Standing::Good => "Nearest to its limit",
        Standing::Bad => "Worst feature",
        Standing::NotCut => "Not cut",
        Standing::NotJudged => "Not judged",
    };
    Some(card(name, &format!("No. {}", index + 1), &format!("line {}: {why}", feature.line)))
}
