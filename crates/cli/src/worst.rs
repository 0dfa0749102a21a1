//! What an engineer asks of a good run: which feature is nearest to its limit, and how the taps'
//! torque goes.
//!
//! ```text
//!   headroom   least share of a tolerance that is left, over all features and tolerances
//!   torque     of each tap over the thread that it cut: wear; and against the tap makers' formula
//! ```
use crate::check::plural;
use report::{Measure, Standing, headroom_text, why_nearest};
use verify::{Feature, FeatureKind, Summary, Tolerances, TorqueTrend};

/// A line for the worst feature and why, one for each tap that cut two threads or more of one size,
/// and one for torques that the formula does not explain.
pub(crate) fn text(features: &[Feature], tolerances: &Tolerances, measure: Measure) -> String {
    // what was not cut or not judged is not near to anything
    let measured =
        |f: &&Feature| !matches!(Standing::of(f), Standing::NotCut | Standing::NotJudged);
    let cut: Vec<Feature> = features.iter().filter(measured).cloned().collect();
    let summary = Summary::of(&cut, tolerances);
    let mut said = String::new();
    if let Some((index, left)) = summary.worst {
        let feature = &cut[index];
        said += &format!(
            "nearest to its limit: line {}, {}: {}{}\n",
            feature.line,
            feature.kind_name(),
            headroom_text(&left, measure),
            why_nearest(feature, &left, measure)
                .map_or_else(String::new, |why| format!(", because: {why}")),
        );
    }
    for trend in TorqueTrend::of(features) {
        said += &torque(&trend).unwrap_or_default();
    }
    said += &unexpected(features);
    said
}

/// How the torque of a tap has gone over the thread that it cut.
fn torque(trend: &TorqueTrend) -> Option<String> {
    let [first, .., last] = trend.threads.as_slice() else { return None };
    let wear = match trend.significant() {
        Some(rise) => {
            let (rise, doubt) = (rise * 100.0, trend.uncertainty_per_m * 100.0);
            let called = if rise > 0.0 { "wear" } else { "falling" };
            format!("; {rise:+.1} ± {doubt:.1} % by metre of thread: {called}")
        }
        None => "; no significant wear".to_owned(),
    };
    Some(format!(
        "torque of T{} over {}, {:.2} m: in {:.2} N·m in the first, {:.2} N·m in the last, out {}{wear}\n",
        trend.tool,
        plural(trend.threads.len(), "thread"),
        last.0.value() * 1e-3,
        first.1.value(),
        last.1.value(),
        last.2.map_or("not known".to_owned(), |out| format!("{:.2} N·m", out.value())),
    ))
}

/// Threads whose torque the tap makers' formula does not explain.
fn unexpected(features: &[Feature]) -> String {
    let threads = features.iter().filter_map(|f| match &f.kind {
        FeatureKind::Thread(thread) => Some((f.line, thread)),
        _ => None,
    });
    let odd: Vec<_> = threads.filter(|(_, t)| t.torque_is_expected() == Some(false)).collect();
    let Some((line, thread)) = odd.first() else { return String::new() };
    let known = |torque: Option<units::Torque>| torque.map_or(f64::NAN, units::Torque::value);
    format!(
        "torque outside of what the tap makers' formula expects in {}: line {line}, in {:.2} N·m, out {:.2} N·m, \
         formula {:.2} N·m ± {:.0} % in and 10 to 30 % of that out\n",
        plural(odd.len(), "thread"),
        known(thread.torque_in),
        known(thread.torque_out),
        known(thread.torque_expected),
        verify::Thread::TORQUE_BAND * 100.0,
    )
}
