//! Hole by hole: how the synchronism of equal threads goes (learning), and how the torque of a tap
//! goes (wear).
use super::figure::figure;
use crate::svg::{Chart, Mark, Range, Stroke, fixed};
use crate::{Measure, Run, Standing};
use units::Length;
use verify::{Feature, FeatureKind, Thread, TorqueTrend};

/// With fewer threads of a tap there is no course to look at.
const FEWEST: usize = 3;
/// Taps that get a picture.
const MOST_TAPS: usize = 6;

/// A picture of the sync error and one of the torque for each tap with threads enough.
pub(crate) fn hole_by_hole(run: &Run, measure: Measure, features: &[Feature]) -> String {
    let trends = TorqueTrend::of(features);
    // a thread that is not there has no error and no torque
    let cut = || features.iter().filter(|f| Standing::of(f) != Standing::NotCut);
    let mut tools: Vec<u32> = cut().filter_map(|f| thread(f).and(f.tool)).collect();
    tools.sort_unstable();
    tools.dedup();
    let mut all = String::new();
    for tool in tools.into_iter().take(MOST_TAPS) {
        let threads: Vec<&Thread> =
            cut().filter(|f| f.tool == Some(tool)).filter_map(thread).collect();
        if threads.len() < FEWEST {
            continue;
        }
        all += &convergence(run, measure, tool, &threads);
        for trend in trends.iter().filter(|trend| trend.tool == tool) {
            if trend.threads.len() >= FEWEST {
                all += &torque(run, trend);
            }
        }
    }
    all
}

fn thread(feature: &Feature) -> Option<&Thread> {
    match &feature.kind {
        FeatureKind::Thread(thread) => Some(thread),
        _ => None,
    }
}

fn convergence(run: &Run, measure: Measure, tool: u32, threads: &[&Thread]) -> String {
    let points = |of: fn(&Thread) -> Length| -> Vec<(f64, f64)> {
        let point = |(n, t): (usize, &&Thread)| (n as f64 + 1.0, measure.small_number(of(t)));
        threads.iter().enumerate().map(point).collect()
    };
    let (small, decimals) = (measure.small_symbol(), measure.small_decimals(2));
    let largest = points(|t| t.sync_error_max);
    let rms = points(|t| t.sync_error_rms);
    let x = Range::of("thread of this tap, in the order cut", [0.5, threads.len() as f64 + 0.5])
        .counted();
    let y = Range::of(&format!("sync error / {small}"), largest.iter().map(|p| p.1).chain([0.0]));
    let y = y.padded(0.08);
    let (first, last) = (largest[0].1, largest[largest.len() - 1].1);
    let description = format!(
        "{} {small} in the first thread, {} {small} in the last.",
        fixed(first, decimals),
        fixed(last, decimals)
    );
    let mut chart = Chart::new("Sync error hole by hole", &description, x, y, 200.0);
    chart.zero(false);
    chart.line(Stroke::Main, &largest, Some("largest in the material"));
    chart.line(Stroke::Second, &rms, Some("root of the mean square"));
    dots(&mut chart, &largest, small);
    let caption = format!(
        "{description} Learning (--learning, or the machine's own) gives what one thread missed to the next one: then the curve \
         falls over the first threads."
    );
    let heading = format!("Sync error, hole by hole: {}", run.tool(tool));
    figure(&heading, &chart.finish(&format!("conv-{tool}")), &caption)
}

fn torque(run: &Run, trend: &TorqueTrend) -> String {
    let at = |k: usize| trend.threads[k].0.value() * 1e-3;
    let inward: Vec<_> =
        trend.threads.iter().map(|(cut, m, _)| (cut.value() * 1e-3, m.value())).collect();
    let outward: Vec<_> = trend
        .threads
        .iter()
        .filter_map(|(cut, _, m)| m.map(|m| (cut.value() * 1e-3, m.value())))
        .collect();
    let (from, to) = (0.0, at(trend.threads.len() - 1));
    let x = Range::of("thread cut by this tap / m", [from, to]).padded(0.02);
    let band = trend.expected.map(|t| {
        let t = t.value();
        [t * (1.0 - Thread::TORQUE_BAND), t * (1.0 + Thread::TORQUE_BAND)]
    });
    let all = inward.iter().chain(&outward).map(|p| p.1).chain(band.into_iter().flatten());
    let y = Range::of("torque / N·m", all.chain([0.0])).padded(0.08);
    let shown = trend.significant();
    let words = match shown {
        Some(rise) => format!(
            "{}{} ± {} % by metre of thread: {}.",
            if rise < 0.0 { "" } else { "+" },
            fixed(rise * 100.0, 1),
            fixed(trend.uncertainty_per_m * 100.0, 1),
            if rise > 0.0 { "the tap gets duller" } else { "the torque falls" }
        ),
        None => format!(
            "{} threads over {} m: no trend that is more than chance.",
            trend.threads.len(),
            fixed(at(trend.threads.len() - 1), 2)
        ),
    };
    let mut chart = Chart::new("Torque of a tap over its threads", &words, x, y, 210.0);
    chart.zero(false);
    if let Some(band) = band {
        chart.area("air", &[(from, band), (to, band)], Some("the tap makers' formula"));
    }
    if shown.is_some() {
        let line = |x: f64| (x, trend.fitted(Length::mm(x * 1e3)).value());
        chart.line(Stroke::Ideal, &[line(from), line(to)], Some("least squares"));
    }
    chart.line(Stroke::Main, &inward, Some("in"));
    chart.line(Stroke::Second, &outward, Some("out"));
    dots(&mut chart, &inward, "N·m");
    let heading = format!("Torque: {} {}", run.tool(trend.tool), trend.size);
    figure(&heading, &chart.finish(&format!("wear-{}-{}", trend.tool, trend.threads.len())), &words)
}

fn dots(chart: &mut Chart, points: &[(f64, f64)], unit: &str) {
    if points.len() > 60 {
        return;
    }
    for (at, value) in points {
        let title = format!("{} {unit}", fixed(*value, 2));
        chart.mark(&Mark {
            at: (*at, *value),
            radius: 2.2,
            class: "mark hole",
            title: &title,
            crossed: false,
        });
    }
}
