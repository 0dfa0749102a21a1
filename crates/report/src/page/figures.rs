//! Key figures: what a reader looks for first, each with one line of why.
use super::features::by_badness;
use crate::Run;
use crate::pictures::tolerance_share;
use crate::record::Recorder;
use crate::svg::{Tag, fixed};
use units::{Length, Time};
use verify::{Count, Feature, FeatureKind, Summary, Thread};

/// The figures as a row of cards.
pub(super) fn figures(run: &Run, recorder: &Recorder, features: &[Feature]) -> String {
    let summary = Summary::of(features, &run.tolerances);
    let mut cards = vec![card("Cycle time", &duration(run.cycle_time), &rate(run, recorder))];
    let nothing = features.is_empty();
    let counts = [("Holes", summary.holes), ("Threads", summary.threads)];
    cards.extend(
        counts.iter().filter(|(_, c)| nothing || c.total() > 0).map(|(name, c)| count(name, *c)),
    );
    cards.extend(largest_error(run, features));
    cards.extend(depth_error(&summary));
    cards.extend(tightest(run, features));
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

fn count(name: &str, count: Count) -> String {
    let why = match (count.total(), count.failed, count.not_judged) {
        (0, ..) => "none cut".into(),
        (_, 0, 0) => "✓ all".into(),
        (_, 0, open) => format!("○ {open} not judged"),
        (_, bad, 0) => format!("✗ {bad} out of tolerance"),
        (_, bad, open) => format!("✗ {bad} out of tolerance, {open} not judged"),
    };
    let value = format!("{} of {}", count.passed, count.total());
    card(&format!("{name} within tolerance"), &value, &why)
}

fn threads(features: &[Feature]) -> impl Iterator<Item = (usize, &Thread)> {
    features.iter().enumerate().filter_map(|(index, feature)| match &feature.kind {
        FeatureKind::Thread(thread) => Some((index + 1, thread.as_ref())),
        FeatureKind::Hole(_)
        | FeatureKind::Polygon(_)
        | FeatureKind::Cam(_)
        | FeatureKind::Turned(_)
        | FeatureKind::Gear(_) => None,
    })
}

fn largest_error(run: &Run, features: &[Feature]) -> Option<String> {
    let finite = threads(features).filter(|(_, t)| t.sync_error_max.is_finite());
    let (number, thread) =
        finite.max_by(|a, b| a.1.sync_error_max.value().total_cmp(&b.1.sync_error_max.value()))?;
    let why = format!(
        "No. {number}, {} deep; warn {} µm, a quarter of TD2 is {} µm",
        format_args!("{} mm", fixed(thread.sync_error_depth.value(), 1)),
        fixed(run.limits.sync_warn.in_um(), 0),
        fixed(tolerance_share(thread).in_um(), 0)
    );
    let value = format!("{} µm", fixed(thread.sync_error_max.in_um(), 1));
    Some(card("Largest sync error in the material", &value, &why))
}

fn depth_error(summary: &Summary) -> Option<String> {
    let (index, error) = summary.depth_error_max?;
    let sense = match error {
        e if e.abs() < Length::um(0.05) => "as programmed",
        e if e < Length::ZERO => "not deep enough",
        _ => "deeper than programmed",
    };
    let value = format!("{} µm", fixed(error.abs().in_um(), 1));
    Some(card("Largest depth error of a thread", &value, &format!("No. {}, {sense}", index + 1)))
}

fn tightest(run: &Run, features: &[Feature]) -> Option<String> {
    let (index, left) = *by_badness(run, features).first()?;
    let feature = &features[index];
    let why = feature.verdict.reason().map_or_else(|| left.to_string(), Into::into);
    let name = if feature.verdict.is_pass() { "Nearest to its limit" } else { "Worst feature" };
    Some(card(name, &format!("No. {}", index + 1), &format!("line {}: {why}", feature.line)))
}
