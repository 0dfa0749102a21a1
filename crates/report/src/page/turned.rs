//! Turned threads: what the insert left of the bar, the sizes against their limits, and how far the
//! tool was from the helix.
use crate::pictures::figure;
use crate::svg::{Chart, Range, Stroke, Tag, fixed};
use units::Length;
use verify::{Feature, FeatureKind, LeadOfTurn, TurnedSizes, TurnedThread};

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
            section(index, thread)
                + &sizes(index, thread)
                + &along(index, thread)
                + &leads(index, thread)
                + &passes(index, thread)
        })
        .collect()
}

/// The bar before and after in an axial section, Z along the page.
fn section(index: usize, thread: &TurnedThread) -> String {
    let (Some(first), Some(before)) = (thread.section.first(), thread.before) else {
        return String::new();
    };
    let of = |k: usize| -> Vec<_> {
        thread.section.iter().map(|at| ((at[0] - first[0]).value(), at[k].value())).collect()
    };
    let (was, is) = (of(1), of(2));
    let x = Range::of("along the axis / mm", is.iter().map(|p| p.0));
    let y = Range::of("radius / mm", was.iter().chain(&is).map(|p| p.1)).padded(0.08);
    let heading = format!("{}: {}, in section", index + 1, thread.name());
    let what = if thread.internal { "bore" } else { "bar" };
    let caption = format!(
        "What the insert ({}) has left of the {what} of ⌀{} mm, in one axial section of it; dashed, the {what} before. Contact with it over {} % of \
         the ordered length.",
        thread.insert,
        fixed(before.value(), 3),
        fixed(thread.contact.unwrap_or(0.0) * 100.0, 0),
    );
    let mut chart = Chart::new(&heading, &caption, x, y, 230.0);
    chart.line(Stroke::Ideal, &was, Some("before"));
    chart.line(Stroke::Main, &is, Some("after"));
    figure(&heading, &chart.finish(&format!("ts{index}")), &caption)
}

/// Diameters and lengths, with their limits.
fn sizes(index: usize, thread: &TurnedThread) -> String {
    let Some(sizes) = &thread.sizes else { return String::new() };
    let limits = thread.limits.as_ref();
    let range = |[low, high]: [Length; 2]| {
        let (low, high) = (fixed(low.value(), 3), fixed(high.value(), 3));
        if low == high { low } else { format!("{low} to {high}") }
    };
    let limit = |limits: Option<[Length; 2]>| match limits {
        Some([low, high]) if high.value().is_finite() => range([low, high]),
        Some([low, _]) => format!("{} or more", fixed(low.value(), 3)),
        None => "not judged".to_owned(),
    };
    let mm = |length: Length| fixed(length.value(), 2);
    let rows = [
        ("major diameter", range(sizes.major), limit(limits.map(|l| l.major))),
        ("pitch diameter", range(sizes.pitch), limit(limits.map(|l| l.pitch))),
        ("virtual pitch diameter", fixed(sizes.virtual_pitch.value(), 3), String::new()),
        ("minor diameter", range(sizes.minor), limit(limits.map(|l| l.minor))),
        ("full thread", mm(sizes.full_length), String::new()),
        ("run-in, run-out", run_in_and_out(sizes), String::new()),
    ];
    let row = |(name, found, limits): &(&str, String, String)| {
        let cells = [found, limits].map(|cell| Tag::new("td").text(cell)).concat();
        Tag::new("tr").around(&(Tag::new("td").class("l").text(name) + &cells))
    };
    let head = "<thead><tr><th class=\"l\">of the thread</th><th>found<small>mm</small></th><th>limits<small>mm</small></th></tr></thead>";
    let body: String = rows.iter().map(row).collect();
    let table = Tag::new("table").around(&(head.to_owned() + &Tag::new("tbody").around(&body)));
    let heading = format!("{}: {}, sizes", index + 1, thread.name());
    let basis = if thread.size.is_some() {
        format!(
            "Taken for {}, by its pitch and the diameter before. The standard thread is not stated in the program.",
            thread.class_and_size()
        )
    } else {
        match thread.not_judged.strip_prefix("not judged: ") {
            Some(why) => format!("Not judged: {why}."),
            None => thread.not_judged.clone() + ".",
        }
    };
    let force = thread.force_max.filter(|force| force.value() > 0.0).map_or_else(
        || " No force of the cut is known.".to_owned(),
        |force| format!(" Largest force of the cut {} N.", fixed(force.value(), 0)),
    );
    let scroll = Tag::new("div").class("scroll").with("tabindex", "0").around(&table);
    figure(&heading, &scroll, &(basis + &force))
}

fn run_in_and_out(sizes: &TurnedSizes) -> String {
    format!("{}, {}", fixed(sizes.run_in.value(), 2), fixed(sizes.run_out.value(), 2))
}

fn along(index: usize, thread: &TurnedThread) -> String {
    let points: Vec<_> = thread.profile.iter().map(|[w, e]| (w.value(), e.in_um())).collect();
    let most = points.iter().map(|p| p.1.abs()).fold(0.1, f64::max);
    let y = Range::of("off the helix / µm", [-most, most]).padded(0.08);
    let x = Range::of("depth along the thread / mm", points.iter().map(|p| p.0).chain([0.0]));
    let heading = format!("{}: {}, along it", index + 1, thread.name());
    let caption = format!(
        "The worst of {} passes, {}: {} µm at most, {} µm rms over all. The lead is {} µm off over the thread's length. The axes and the \
         spindle as they moved.",
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
