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
//! A groove that is wider by e, axially and peak to peak, opens the pitch diameter of a 60° thread
//! by √3·e: a quarter of the tolerance TD2 is used up by e = TD2 / (4·√3).
use super::figure::{ThreadView, figure};
use crate::Measure;
use crate::svg::{Chart, Range, Stroke, fixed};
use units::Length;
use verify::{ProfilePoint, Thread};

/// Axial error that takes a quarter of a thread's pitch diameter tolerance.
pub(crate) fn tolerance_share(thread: &Thread) -> Length {
    thread.pitch_diameter_tolerance / (4.0 * 3f64.sqrt())
}

/// The error on the way in or out: at each depth, mm or in, least and largest, µm or µin.
type Bounds = Vec<(f64, [f64; 2])>;

/// The error over depth: as it was judged, else as it was recorded.
pub(crate) fn sync_error(view: &ThreadView) -> String {
    let judged = view.thread.filter(|thread| !thread.profile.is_empty());
    let [inward, outward] =
        judged.map_or_else(|| recorded(view), |thread| of_judge(thread, view.measure));
    let all = || inward.iter().chain(&outward);
    let errors = all().flat_map(|(_, bounds)| *bounds).filter(|e| e.is_finite());
    let largest = errors.map(f64::abs).fold(0.0, f64::max);
    let (unit, small) = (view.measure.symbol(), view.measure.small_symbol());
    let least = view.measure.small_number(Length::um(1.0));
    let widening = judged.map_or_else(Vec::new, |thread| widening(thread, view.measure));
    let limits = limits(view);
    // limits far beyond the curve would press it flat: the caption names them instead
    let near = limits.iter().map(|l| l.1).filter(|l| *l < 5.0 * largest);
    let reach = near.chain(widening.iter().map(|p| p.1)).fold(largest, f64::max).max(least);
    let depths = all().map(|p| p.0).chain([0.0]);
    let x = Range::of(&format!("depth of the tip below the surface / {unit}"), depths).padded(0.03);
    let y = Range::of(&format!("sync error / {small}"), [-reach, reach]).padded(0.09);
    let description = format!(
        "Synchronisation error over depth, in and out: {} {small} at most. Limits: {}.",
        fixed(largest, view.measure.small_decimals(1)),
        in_words(&limits)
    );
    let mut chart = Chart::new("Synchronisation error over depth", &description, x, y, 330.0);
    chart.zero(false);
    draw(&mut chart, &inward, "area in", Stroke::In, "in");
    draw(&mut chart, &outward, "area out", Stroke::Out, "out");
    chart.line(Stroke::Second, &widening, Some("widening of the groove"));
    for (stroke, limit, name) in &limits {
        chart.limits(*stroke, *limit, name);
    }
    let caption = caption(judged.is_some(), &limits, reach);
    figure("Sync error over depth", &chart.finish(&format!("{}-e", view.id)), &caption)
}

/// What the judge found, in and out.
fn of_judge(thread: &Thread, measure: Measure) -> [Bounds; 2] {
    let way = |way: fn(&ProfilePoint) -> Option<[Length; 2]>| {
        let bounds =
            |p| way(p).map_or([f64::NAN; 2], |b| b.map(|error| measure.small_number(error)));
        thread.profile.iter().map(|p| (measure.number(p.tip_depth), bounds(p))).collect()
    };
    [way(|p| p.inward), way(|p| p.outward)]
}

/// By how much the groove is wider than the tap's tooth.
fn widening(thread: &Thread, measure: Measure) -> Vec<(f64, f64)> {
    let point =
        |p: &ProfilePoint| Some((measure.number(p.tip_depth), measure.small_number(p.widening?)));
    thread.profile.iter().filter_map(point).collect()
}

fn draw(chart: &mut Chart, bounds: &Bounds, class: &'static str, stroke: Stroke, name: &str) {
    chart.area(class, bounds, None);
    let middle: Vec<_> = bounds.iter().map(|&(x, [a, b])| (x, f64::midpoint(a, b))).collect();
    chart.line(stroke, &middle, Some(name));
}

fn limits(view: &ThreadView) -> Vec<(Stroke, f64, String)> {
    let of_run = &view.run.limits;
    let measure = view.measure;
    let limit = |stroke, name: &str, at: Length, decimals| {
        let text = format!("{name} ±{} {}", measure.small(at, decimals), measure.small_symbol());
        (stroke, measure.small_number(at), text)
    };
    let mut limits = vec![
        limit(Stroke::Stop, "stop", of_run.sync_stop, 0),
        limit(Stroke::Warn, "warn", of_run.sync_warn, 0),
    ];
    limits.extend(
        view.thread.map(|thread| limit(Stroke::Share, "25 % of TD2", tolerance_share(thread), 1)),
    );
    limits.retain(|(_, limit, _)| limit.is_finite() && *limit > 0.0);
    limits
}

fn in_words(limits: &[(Stroke, f64, String)]) -> String {
    limits.iter().map(|l| l.2.as_str()).collect::<Vec<_>>().join(", ")
}

/// What was recorded, where nothing was judged.
fn recorded(view: &ThreadView) -> [Bounds; 2] {
    let trace = view.trace;
    let lead = trace.tap.lead.value().abs();
    let clearance = trace.clearance().value();
    trace.error.each_ref().map(|series| {
        let point = |(turns, e): (f64, f64)| {
            let depth = Length::mm(turns * lead - clearance);
            (view.measure.number(depth), [view.measure.small_number(Length::um(e)); 2])
        };
        series.points().into_iter().map(point).filter(|(depth, _)| *depth >= 0.0).collect()
    })
}

fn caption(judged: bool, limits: &[(Stroke, f64, String)], reach: f64) -> String {
    let what = if judged {
        "How far the axis left the ideal helix, least to largest at each depth, in the material only; plus is deeper."
    } else {
        "How far the axis left its line below the programmed surface; plus is deeper. No material was cut here."
    };
    if !judged {
        return what.to_owned();
    }
    let outside: Vec<_> = limits.iter().filter(|l| l.1 > reach * 1.09).cloned().collect();
    let beyond = if outside.is_empty() {
        String::new()
    } else {
        format!(" Beyond the picture: {}.", in_words(&outside))
    };
    format!(
        "{what} A groove that is wider by e opens the pitch diameter by 1.73·e: up to the dotted lines that is \
         less than a quarter of the tolerance TD2.{beyond}"
    )
}
