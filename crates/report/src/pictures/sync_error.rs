//! Synchronisation error over depth, with the limits it is held against.
//!
//! ```text
//!   e │┄┄┄┄┄┄┄┄┄┄┄┄┄ stop
//!     │┄┄┄┄┄┄┄┄┄┄┄┄┄ warn
//!     │· · · · · · · 25 % of TD2
//!     │~~~in~~~╮
//!     │~~~out~~╯
//!     └─────────── depth
//! ```
//!
//! A groove that is wider by e, axially and peak to peak, opens the pitch diameter of a 60° thread by
//! √3·e: a quarter of the tolerance TD2 is used up by e = TD2 / (4·√3).
use super::{ThreadView, figure};
use crate::svg::{Chart, Range, Stroke, fixed};
use units::Length;
use verify::{ProfilePoint, Thread};

/// Axial error that takes a quarter of a thread's pitch diameter tolerance.
pub(crate) fn tolerance_share(thread: &Thread) -> Length {
    thread.pitch_diameter_tolerance / (4.0 * 3f64.sqrt())
}

/// The error on the way in or out: at each depth, mm, least and largest, µm.
type Bounds = Vec<(f64, [f64; 2])>;

/// The error over depth: at the tap's edges where they were judged, else of the axis.
pub(crate) fn sync_error(view: &ThreadView) -> String {
    let judged = view.thread.filter(|thread| !thread.profile.is_empty());
    let [inward, outward] = judged.map_or_else(
        || of_axis(view),
        |thread| {
            let way = |way: fn(&ProfilePoint) -> Option<[Length; 2]>| {
                thread
                    .profile
                    .iter()
                    .map(|p| {
                        (
                            p.tip_depth.value(),
                            way(p).map_or([f64::NAN; 2], |b| b.map(Length::in_um)),
                        )
                    })
                    .collect()
            };
            [way(|p| p.inward), way(|p| p.outward)]
        },
    );
    let errors = || inward.iter().chain(&outward).flat_map(|(_, b)| *b).filter(|e| e.is_finite());
    let largest = errors().map(f64::abs).fold(0.0, f64::max);
    let limits = limits(view);
    let reach = limits
        .iter()
        .map(|l| l.1)
        .filter(|l| *l < 5.0 * largest.max(5.0))
        .fold(largest, f64::max)
        .max(1.0);
    let x = Range::of(
        "depth of the tip below the surface / mm",
        inward.iter().chain(&outward).map(|p| p.0).chain([0.0]),
    )
    .padded(0.03);
    let y = Range::of("sync error / µm", [-reach, reach]).padded(0.09);
    let description = format!(
        "Synchronisation error over depth, in and out: {} µm at most. Limits: {}.",
        fixed(largest, 1),
        in_words(&limits)
    );
    let mut chart = Chart::new("Synchronisation error over depth", &description, x, y, 330.0);
    chart.zero(false);
    draw(&mut chart, &inward, ["area in", "line in"], Stroke::In, "in");
    draw(&mut chart, &outward, ["area out", "line out"], Stroke::Out, "out");
    for (stroke, limit, name) in &limits {
        chart.limits(*stroke, *limit, name);
    }
    figure(
        "Sync error over depth",
        &chart.finish(&format!("{}-e", view.id)),
        &caption(judged.is_some(), &limits, reach),
    )
}

fn draw(
    chart: &mut Chart,
    bounds: &Bounds,
    classes: [&'static str; 2],
    stroke: Stroke,
    name: &str,
) {
    chart.area(classes[0], bounds, None);
    let middle: Vec<_> = bounds.iter().map(|&(x, [a, b])| (x, f64::midpoint(a, b))).collect();
    chart.line(stroke, &middle, Some(name));
}

fn limits(view: &ThreadView) -> Vec<(Stroke, f64, String)> {
    let of_run = &view.run.limits;
    let mut limits = vec![
        (
            Stroke::Stop,
            of_run.sync_stop.in_um(),
            format!("stop ±{} µm", fixed(of_run.sync_stop.in_um(), 0)),
        ),
        (
            Stroke::Warn,
            of_run.sync_warn.in_um(),
            format!("warn ±{} µm", fixed(of_run.sync_warn.in_um(), 0)),
        ),
    ];
    if let Some(thread) = view.thread {
        let share = tolerance_share(thread).in_um();
        limits.push((Stroke::Share, share, format!("25 % of TD2 ±{} µm", fixed(share, 1))));
    }
    limits.retain(|(_, limit, _)| limit.is_finite() && *limit > 0.0);
    limits
}

fn in_words(limits: &[(Stroke, f64, String)]) -> String {
    limits.iter().map(|l| l.2.as_str()).collect::<Vec<_>>().join(", ")
}

/// Error of the axis, where no judge has seen the edges.
fn of_axis(view: &ThreadView) -> [Bounds; 2] {
    let trace = view.trace;
    let lead = trace.tap.lead.value().abs();
    let clearance = trace.clearance().value();
    trace.error.each_ref().map(|series| {
        let over_depth =
            series.points().into_iter().map(|(turns, e)| (turns * lead - clearance, [e, e]));
        over_depth.filter(|(depth, _)| *depth >= 0.0).collect()
    })
}

fn caption(judged: bool, limits: &[(Stroke, f64, String)], reach: f64) -> String {
    let what = if judged {
        "How far the tap's edges left their ideal helix, in the material only: least to largest at each depth."
    } else {
        "How far the axis left its line, in the material only; the judge saw no cut here."
    };
    let outside: Vec<_> = limits.iter().filter(|l| l.1 > reach * 1.09).cloned().collect();
    let beyond = if outside.is_empty() {
        String::new()
    } else {
        format!(" Beyond the picture: {}.", in_words(&outside))
    };
    format!(
        "{what} The gap between in and out widens the groove: e µm of it open the pitch diameter by 1.73·e. \
         Within the dotted lines it takes less than a quarter of the tolerance TD2.{beyond}"
    )
}
