//! The short table at the end of a run.
use crate::check::plural;
use crate::run::Job;
use crate::simulate::Outcome;
use crate::tables;
use comfy_table::{Cell, CellAlignment, Table};
use kernel::EventKind;
use std::path::Path;
use verify::{Feature, FeatureKind, Thread};

/// Most failures listed one by one.
const MOST_FAILURES: usize = 20;
/// Most warnings listed one by one.
const MOST_WARNINGS: usize = 5;

/// For people. `quiet`: the verdicts only.
pub(crate) fn text(job: &Job, outcome: &Outcome, out: Option<&Path>, quiet: bool) -> String {
    let mut said = String::new();
    if !quiet {
        let (machine, material) = (&job.session.machine.name, job.material.name);
        said += &format!("{} on {machine}, {material}, seed {}\n", job.program, job.seed);
        said += &format!("tools from {}\n", job.session.tools_from);
    }
    if !outcome.features.is_empty() {
        said += &format!("{}\n", table(outcome));
    }
    let bad: Vec<_> = outcome.features.iter().filter(|f| !f.verdict.is_pass()).collect();
    let unjudged =
        bad.iter().filter(|f| matches!(f.verdict, verify::Verdict::NotJudged { .. })).count();
    for feature in bad.iter().take(MOST_FAILURES) {
        let reason = feature.verdict.reason().unwrap_or_default();
        said += &format!("line {}: {}: {reason}\n", feature.line, feature.kind_name());
    }
    if bad.len() > MOST_FAILURES {
        said += &format!("and {} more\n", bad.len() - MOST_FAILURES);
    }
    if !quiet {
        said += &crate::worst::text(&outcome.features, &job.tolerances());
    }
    for breach in outcome.watch.breaches().iter().take(MOST_FAILURES) {
        said += &format!("INVARIANT BROKEN: {}\n", crate::papers::breach(breach));
    }
    said += &saturation(outcome);
    said += &warnings(outcome);
    said += &crate::learning::text(&outcome.lessons);
    for line in &outcome.cams.said {
        said += line;
        said.push('\n');
    }
    said += &crate::stops::text(&outcome.stops, &outcome.happened, &outcome.withdrawn);
    for fault in &outcome.faults {
        said += &format!("{fault}\n  {}\n", fault.kind.remedy());
    }
    said += &format!("{}, cycle time {}\n", verdict(outcome, [bad.len() - unjudged, unjudged]), clock(outcome));
    if let Some(out) = out.filter(|_| !quiet) {
        said += &format!("report: {}\n", out.join("report.html").display());
    }
    said
}

fn verdict(outcome: &Outcome, [bad, unjudged]: [usize; 2]) -> String {
    if !outcome.ended {
        let what = if outcome.faults.is_empty() { "STOPPED" } else { "STOPPED BY AN ALARM" };
        return match (outcome.stops.is_empty(), outcome.withdrawn.is_empty()) {
            (false, _) => format!("{what}, THE TAP IS OUT"),
            (true, false) => format!("{what}, THE TOOL IS OFF THE WORK"),
            (true, true) => what.to_owned(),
        };
    }
    match (bad, outcome.features.len()) {
        (0, all) if unjudged > 0 => {
            format!("NOT JUDGED: {unjudged} of {}", plural(all, "feature"))
        }
        (0, _) if !outcome.watch.breaches().is_empty() => {
            "FAIL: what must never be was seen on the way".to_owned()
        }
        (0, 0) => "ENDED, no holes or threads to judge".to_owned(),
        (0, all) => format!("PASS: {} within tolerance", plural(all, "feature")),
        (bad, all) => bad_features(outcome, bad, all),
    }
}

/// Some are bad, or not judged.
fn bad_features(outcome: &Outcome, bad: usize, all: usize) -> String {
    let is_open = |f: &&Feature| matches!(f.verdict, verify::Verdict::NotJudged { .. });
    let open = outcome.features.iter().filter(is_open).count();
    match (bad - open, open) {
        (failed, 0) => format!("FAIL: {failed} of {all} features out of tolerance"),
        (0, open) => format!("NOT JUDGED: {open} of {all} features"),
        (failed, open) => {
            format!("FAIL: {failed} of {all} features out of tolerance, {open} not judged")
        }
    }
}

fn clock(outcome: &Outcome) -> String {
    let seconds = outcome.cycle_time.value();
    if seconds < 60.0 {
        return format!("{seconds:.2} s");
    }
    format!("{seconds:.1} s ({} min {:04.1} s)", (seconds / 60.0) as u64, seconds % 60.0)
}

/// Drives that could not give what was asked of them: whoever reads a bad thread must know.
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

/// A row for every kind and size.
fn table(outcome: &Outcome) -> Table {
    let mut table = tables::table([
        "feature",
        "good",
        "depth mm",
        "depth error",
        "sync error",
        "class",
        "margin",
        "rpm",
        "limited by",
    ]);
    for group in groups(&outcome.features) {
        table.add_row(row(&group, outcome));
    }
    for column in 1..8 {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

/// Features of one kind and size, in the order in which the first of each was cut.
fn groups(features: &[Feature]) -> Vec<Vec<&Feature>> {
    let mut groups: Vec<(String, Vec<&Feature>)> = Vec::new();
    for feature in features {
        let name = name(feature);
        match groups.iter_mut().find(|(n, _)| *n == name) {
            Some((_, group)) => group.push(feature),
            None => groups.push((name, vec![feature])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

fn name(feature: &Feature) -> String {
    match &feature.kind {
        FeatureKind::Hole(hole) => format!("hole Ø{:.2}", hole.diameter.value()),
        FeatureKind::Thread(thread) => match thread.hand {
            verify::Hand::Right => thread.size.clone(),
            verify::Hand::Left if thread.size.ends_with("LH") => thread.size.clone(),
            verify::Hand::Left => format!("{} left", thread.size),
        },
        FeatureKind::Polygon(polygon) => polygon.name(),
        FeatureKind::Gear(gear) => gear.name(),
        FeatureKind::Cam(cam) => format!("cam {} at {:.0} rpm", cam.name, cam.spin.in_rpm()),
        FeatureKind::Turned(thread) => thread.name(),
    }
}

fn row(group: &[&Feature], outcome: &Outcome) -> Vec<Cell> {
    let good = group.iter().filter(|f| f.verdict.is_pass()).count();
    let mut cells = vec![Cell::new(name(group[0])), Cell::new(format!("{good}/{}", group.len()))];
    let cut = || group.iter().filter(|f| f.is_cut());
    if cut().next().is_none() {
        cells.push(Cell::new("not cut"));
        return cells;
    }
    let worst = |value: &dyn Fn(&Feature) -> f64| {
        cut().map(|f| value(f)).fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
    };
    let least =
        |value: &dyn Fn(&Feature) -> f64| cut().map(|f| value(f)).fold(f64::INFINITY, f64::min);
    if let FeatureKind::Turned(_) = &group[0].kind {
        cells.extend(turned_cells(group));
        return cells;
    }
    let FeatureKind::Thread(first) = &group[0].kind else {
        cells.push(Cell::new(format!("{:.3}", worst(&|f| hole(f).0))));
        cells.push(Cell::new(format!("{:+.1} µm", worst(&|f| hole(f).1))));
        return cells;
    };
    let limited = outcome.limiting.get(&group[0].op).map_or("", String::as_str);
    cells.extend([
        Cell::new(format!("{:.3}", least(&|f| thread(f).map_or(f64::NAN, |t| t.depth.value())))),
        Cell::new(format!(
            "{:+.1} µm",
            worst(&|f| thread(f).map_or(0.0, |t| t.depth_error.in_um()))
        )),
        Cell::new(format!(
            "{:.1} µm",
            worst(&|f| thread(f).map_or(0.0, |t| t.sync_error_max.in_um()))
        )),
        Cell::new(first.class_name()),
        Cell::new(format!(
            "{:.0} µm",
            least(&|f| thread(f).map_or(f64::NAN, |t| t.margin.in_um()))
        )),
        Cell::new(format!("{:.0}", worst(&|f| thread(f).map_or(0.0, |t| t.spin_max.in_rpm())))),
        Cell::new(limited),
    ]);
    cells
}

/// Length, error of the infeed, sync error, and the speed of turned threads.
fn turned_cells(group: &[&Feature]) -> Vec<Cell> {
    let threads = || {
        group.iter().filter_map(|feature| match &feature.kind {
            FeatureKind::Turned(thread) => Some(thread.as_ref()),
            _ => None,
        })
    };
    let most = |value: fn(&verify::TurnedThread) -> f64| threads().map(value).fold(0.0, f64::max);
    vec![
        Cell::new(format!("{:.3}", most(|t| t.length().value()))),
        Cell::new(format!("{:.1} µm", most(|t| t.infeed_error.in_um()))),
        Cell::new(format!("{:.1} µm", most(|t| t.sync_error_max.in_um()))),
        Cell::new(threads().next().map_or(String::new(), verify::TurnedThread::class_and_size)),
        Cell::new(
            threads()
                .filter_map(verify::TurnedThread::pitch_margin)
                .map(|margin| margin.in_um())
                .reduce(f64::min)
                .map_or(String::new(), |least| format!("{least:.0} µm")),
        ),
        Cell::new(format!("{:.0}", most(|t| t.spin_max.in_rpm()))),
    ]
}

fn thread(feature: &Feature) -> Option<&Thread> {
    match &feature.kind {
        FeatureKind::Thread(thread) => Some(thread),
        FeatureKind::Hole(_)
        | FeatureKind::Polygon(_)
        | FeatureKind::Cam(_)
        | FeatureKind::Turned(_)
        | FeatureKind::Gear(_) => None,
    }
}

/// Depth, mm, and its error, µm.
fn hole(feature: &Feature) -> (f64, f64) {
    match &feature.kind {
        FeatureKind::Hole(hole) => (hole.depth.value(), hole.depth_error.in_um()),
        FeatureKind::Thread(_) | FeatureKind::Turned(_) => (f64::NAN, 0.0),
        FeatureKind::Cam(cam) => {
            let lift = cam.lift.iter().map(|l| l.value()).fold(0.0, f64::max);
            (lift, cam.contour_error_max.in_um())
        }
        FeatureKind::Gear(gear) => {
            ((gear.z_to - gear.z_from).value(), gear.helix_deviation.in_um())
        }
        FeatureKind::Polygon(polygon) => {
            let over = polygon.across_flats - polygon.across_flats_ordered;
            ((polygon.z_to - polygon.z_from).value(), over.in_um())
        }
    }
}
