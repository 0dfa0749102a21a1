//! The short table at the end of a run.
use crate::check::plural;
use control::Outcome;
use kernel::EventKind;
use leadscrew::Finished;
use report::Standing;
use std::path::Path;
use verify::FeatureKind;

/// Most failures listed one by one.
const MOST_FAILURES: usize = 20;
/// Most warnings listed one by one.
const MOST_WARNINGS: usize = 5;

/// For people.
pub(crate) fn text(finished: &Finished, out: Option<&Path>) -> String {
    let Finished { job, outcome, seed, tolerances, .. } = finished;
    let (machine, material) = (&job.session.machine.name, job.material.name());
    let mut said = format!("{} on {machine}, {material}, seed {seed}\n", job.program.name);
    said += &format!("tools from {}\n", job.session.tools_from);
    said += &crate::measures::tables(outcome);
    said += &features(outcome);
    said += &crate::worst::text(&outcome.features, tolerances, outcome.recorder.measure());
    said += &went_wrong(outcome);
    said += &saturation(outcome);
    said += &warnings(outcome);
    let taps = outcome.features.iter().any(|f| matches!(f.kind, FeatureKind::Thread(_)));
    said += &control::services::supervision::text(&outcome.supervised, &job.session.machine, taps);
    said += &control::services::learning::text(&outcome.learning_records);
    for line in &outcome.cams.said {
        said += line;
        said.push('\n');
    }
    let machine_file = &job.session.machine;
    said += &control::services::sequence::text(&outcome.changes, machine_file);
    said += &control::services::sequence::wrong(outcome.carousel.as_ref());
    said += &control::stops::text(&outcome.stops, &outcome.happened, &outcome.withdrawn);
    said += &alarms(outcome);
    said += &format!("{}, cycle time {}\n", verdict(outcome), clock(outcome));
    if let Some(out) = out {
        said += &format!("report: {}\n", out.join("report.html").display());
    }
    said
}

/// Only what went wrong; nothing if nothing did.
pub(crate) fn wrong(outcome: &Outcome) -> String {
    let mut said = features(outcome) + &went_wrong(outcome);
    if !outcome.ended {
        said += &control::stops::text(&outcome.stops, &outcome.happened, &outcome.withdrawn);
        said += &alarms(outcome);
    }
    if !said.is_empty() || !outcome.ended {
        said += &format!("{}\n", verdict(outcome));
    }
    said
}

/// Features that are not good, one by one.
fn features(outcome: &Outcome) -> String {
    let bad: Vec<_> = outcome.features.iter().filter(|f| !f.verdict.is_pass()).collect();
    let mut said = String::new();
    for feature in bad.iter().take(MOST_FAILURES) {
        let reason = feature.verdict.reason().unwrap_or_default();
        let sign = Standing::of(feature).sign();
        said += &format!("{sign} line {}: {}: {reason}\n", feature.line, feature.kind_name());
    }
    if bad.len() > MOST_FAILURES {
        said += &format!("and {} more\n", bad.len() - MOST_FAILURES);
    }
    said
}

fn went_wrong(outcome: &Outcome) -> String {
    let breaches = outcome.watch.breaches().iter().take(MOST_FAILURES);
    breaches.fold(String::new(), |said, b| said + &format!("safety check violated: {b}\n"))
}

fn alarms(outcome: &Outcome) -> String {
    outcome
        .faults
        .iter()
        .fold(String::new(), |said, fault| said + &format!("{fault}\n  {}\n", fault.kind.remedy()))
}

fn verdict(outcome: &Outcome) -> String {
    if !outcome.ended {
        let what = if outcome.faults.is_empty() { "STOPPED" } else { "STOPPED BY AN ALARM" };
        let broken = outcome.stops.iter().any(|stop| stop.broken.is_some());
        return match (outcome.stops.is_empty(), outcome.withdrawn.is_empty()) {
            (false, _) if broken => format!("{what}, THE TAP BROKE"),
            (false, _) => format!("{what}, THE TAP IS OUT"),
            (true, false) => format!("{what}, THE TOOL IS OFF THE WORK"),
            (true, true) => what.to_owned(),
        };
    }
    let features = &outcome.features;
    let all = features.len();
    match Standing::counts(features) {
        Some(counts)
            if Standing::Good.count(features) + Standing::NotJudged.count(features) == all =>
        {
            format!("NOT JUDGED: of {}, {counts}", plural(all, "feature"))
        }
        Some(counts) => format!("FAIL: of {}, {counts}", plural(all, "feature")),
        None if outcome.watch.violations() > 0 => "FAIL: a safety check was violated".to_owned(),
        None if all == 0 => "ENDED, no holes or threads to judge".to_owned(),
        None => match features.iter().filter(|f| f.has_assumed_hole()).count() {
            0 => format!("PASS: {} within tolerance", plural(all, "feature")),
            unseen => format!(
                "IF THE HOLES ARE THERE, PASS: {} within tolerance, of which {} taken to be drilled before: \
                 --pre-drilled or a comment (PRE-DRILLED) states it",
                plural(all, "feature"),
                if unseen == 1 { "1 is".to_owned() } else { format!("{unseen} are") }
            ),
        },
    }
}

fn clock(outcome: &Outcome) -> String {
    let seconds = outcome.cycle_time.value();
    if seconds < 60.0 {
        return format!("{seconds:.2} s");
    }
    format!("{seconds:.1} s ({} min {:04.1} s)", (seconds / 60.0) as u64, seconds % 60.0)
}

/// Drives that could not give what was asked of them: they explain a bad thread.
fn saturation(outcome: &Outcome) -> String {
    let limited: Vec<_> = outcome
        .features
        .iter()
        .filter(|f| matches!(f.kind, FeatureKind::Thread(_)))
        .filter_map(|f| outcome.saturated.get(&f.op).map(|periods| (f.line, *periods)))
        .collect();
    let Some((line, periods)) = limited.iter().max_by_key(|(_, periods)| *periods) else {
        return String::new();
    };
    format!(
        "the spindle drive was at its torque or power limit in {} (longest in line {line}, {periods} servo periods)\n",
        plural(limited.len(), "tap")
    )
}

/// Windows that were passed on the way, and did not stop the machine.
fn warnings(outcome: &Outcome) -> String {
    let mut said = String::new();
    for event in outcome.warnings.iter().take(MOST_WARNINGS) {
        let (line, time) = (event.line, event.time.value());
        said += &match &event.kind {
            EventKind::FollowingWarning { axis, error } => {
                let (letter, way) = (axis.letter(), crate::log::small(*axis, *error));
                format!("line {line}: following error of {letter} reached {way} at {time:.3} s\n")
            }
            EventKind::SyncWarning { error } => {
                let um = error.in_um();
                format!(
                    "line {line}: sync error in the material reached {um:.1} µm at {time:.3} s\n"
                )
            }
            _ => continue,
        };
    }
    if outcome.warnings.len() > MOST_WARNINGS {
        said += &format!("and {} more warnings\n", outcome.warnings.len() - MOST_WARNINGS);
    }
    said
}
