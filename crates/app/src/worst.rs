//! What an engineer asks of a good run: which feature is nearest to its limit, and how the taps' torque goes.
//!
//! ```text
//!   headroom   least share of a tolerance that is left, over all features and tolerances
//!   torque     of the first and the last thread of each tap, against the tap makers' formula
//! ```
use crate::check::plural;
use std::collections::BTreeMap;
use verify::{Feature, FeatureKind, Summary, Thread, Tolerances};

/// A line for the worst feature, and one for each tap that cut two threads or more of one size.
pub(crate) fn text(features: &[Feature], tolerances: &Tolerances) -> String {
    let summary = Summary::of(features, tolerances);
    let mut said = String::new();
    if let Some((index, left)) = summary.worst {
        let feature = &features[index];
        said += &format!(
            "nearest to its limit: line {}, {}: {left}\n",
            feature.line,
            feature.kind_name()
        );
    }
    let mut taps: BTreeMap<u32, Vec<&Thread>> = BTreeMap::new();
    for feature in features {
        if let (FeatureKind::Thread(thread), Some(tool)) = (&feature.kind, feature.tool) {
            taps.entry(tool).or_default().push(thread);
        }
    }
    for (tool, threads) in taps {
        said += &torque(tool, &threads).unwrap_or_default();
    }
    said
}

/// How the torque of a tap has gone from its first thread to its last.
fn torque(tool: u32, threads: &[&Thread]) -> Option<String> {
    let [first, .., last] = threads else { return None };
    let (from, to) = (first.torque_max?.value(), last.torque_max?.value());
    let formula = last
        .torque_expected
        .map_or(String::new(), |t| format!(", {:.2} N·m by the tap makers' formula", t.value()));
    Some(format!(
        "torque of T{tool} over {}: {from:.2} N·m in the first, {to:.2} N·m in the last ({:+.0} %){formula}\n",
        plural(threads.len(), "thread"),
        (to / from - 1.0) * 100.0
    ))
}
