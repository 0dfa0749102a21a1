//! Turned threads: how far the tool was from the helix, along the thread.
use crate::pictures::figure;
use crate::svg::{Chart, Range, Stroke, fixed};
use verify::{Feature, FeatureKind, LeadOfTurn, TurnedThread};

/// Pictures at most.
const MOST: usize = 12;

/// A picture for each; nothing if there are none.
pub(super) fn pictures(features: &[Feature]) -> String {
    let turned = features.iter().enumerate().filter_map(|(index, feature)| match &feature.kind {
        FeatureKind::Turned(thread) if !thread.profile.is_empty() => Some((index, thread)),
        _ => None,
    });
    turned
        .take(MOST)
        .map(|(index, thread)| {
            along(index, thread) + &leads(index, thread) + &passes(index, thread)
        })
        .collect()
}

fn along(index: usize, thread: &TurnedThread) -> String {
    let points: Vec<_> = thread.profile.iter().map(|[w, e]| (w.value(), e.in_um())).collect();
    let most = points.iter().map(|p| p.1.abs()).fold(0.1, f64::max);
    let y = Range::of("distance from the helix / µm", [-most, most]).padded(0.08);
    let x = Range::of("depth along the thread / mm", points.iter().map(|p| p.0).chain([0.0]));
    let heading = format!("{}: {}, along it", index + 1, thread.name());
    let caption = format!(
        "The worst of {} passes, {}: {} µm at most, {} µm rms over all. The lead is {} µm off over the thread's length. The axes and the \
         spindle as they moved; no force of a cut is simulated.",
        thread.passes,
        thread.lead_in_words(),
        fixed(thread.sync_error_max.in_um(), 2),
        fixed(thread.sync_error_rms.in_um(), 2),
        fixed(thread.lead_error.in_um(), 2),
    );
    let mut chart = Chart::new(&heading, &caption, x, y, 230.0);
    chart.zero(false);
    chart.line(Stroke::Main, &points, None);
    figure(&heading, &chart.finish(&format!("tt{index}")), &caption)
}

/// Turn by turn, where the lead is not the same everywhere.
fn leads(index: usize, thread: &TurnedThread) -> String {
    let Some(worst) = thread.worst_turn() else { return String::new() };
    let points = |of: fn(&LeadOfTurn) -> f64| -> Vec<_> {
        thread.leads.iter().map(|turn| (turn.depth.value(), of(turn))).collect()
    };
    let (ordered, cut) = (points(|turn| turn.ordered.value()), points(|turn| turn.cut.value()));
    let x = Range::of("depth at which the turn begins / mm", ordered.iter().map(|p| p.0));
    let y = Range::of("lead / mm", ordered.iter().chain(&cut).map(|p| p.1)).padded(0.08);
    let heading = format!("{}: {}, turn by turn", index + 1, thread.name());
    let caption = format!(
        "The {}, as ordered (line) and as the last pass was cut (dots). The turn at {} mm is {} µm off, and no other more.",
        thread.lead_in_words(),
        fixed(worst.depth.value(), 1),
        fixed((worst.cut - worst.ordered).value().abs() * 1e3, 2),
    );
    let mut chart = Chart::new(&heading, &caption, x, y, 230.0);
    chart.line(Stroke::Main, &ordered, None);
    chart.dots(&cut, "a turn");
    figure(&heading, &chart.finish(&format!("tl{index}")), &caption)
}

fn passes(index: usize, thread: &TurnedThread) -> String {
    let points: Vec<_> =
        (1..).zip(&thread.pass_means).map(|(n, mean)| (f64::from(n), mean.in_um())).collect();
    let most = points.iter().map(|p| p.1.abs()).fold(0.1, f64::max);
    let y = Range::of("mean distance / µm", [-most, most]).padded(0.08);
    let x = Range::of("pass", [0.0, points.len() as f64 + 1.0]);
    let heading = format!("{}: {}, pass by pass", index + 1, thread.name());
    let caption = format!(
        "How well each pass finds the groove of the others: they lie within {} µm of one another, at up to {} rpm.",
        fixed(thread.pass_spread.in_um(), 2),
        fixed(thread.spin_max.in_rpm(), 0),
    );
    let mut chart = Chart::new(&heading, &caption, x, y, 230.0);
    chart.zero(false);
    chart.dots(&points, "a pass");
    figure(&heading, &chart.finish(&format!("tp{index}")), &caption)
}
