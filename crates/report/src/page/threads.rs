//! The threads that deserve a closer look: the worst one, the first one, and the runners-up.
use super::features::by_badness;
use crate::pictures::{self, ThreadView};
use crate::record::{Recorder, TapTrace};
use crate::svg::{Tag, fixed};
use crate::{Measure, Run, Standing};
use verify::{Feature, FeatureKind, Thread};

/// A thread of the page: its number, how it stands, and what was judged.
type Judged<'a> = (usize, Standing, &'a Thread);

fn judged(features: &[Feature], op: u32) -> Option<Judged<'_>> {
    features.iter().enumerate().find_map(|(index, feature)| match &feature.kind {
        FeatureKind::Thread(thread) if feature.op == op => {
            Some((index + 1, Standing::of(feature), thread.as_ref()))
        }
        _ => None,
    })
}

/// Pictures of the worst and the first thread, and of others folded away; nothing without a tap.
pub(super) fn threads(run: &Run, recorder: &Recorder, features: &[Feature]) -> String {
    let mut kept = recorder.kept_taps();
    // what the judge found bad stands before what merely had the larger error of the axis
    let standing = |trace: &TapTrace| {
        let of_tap = features.iter().filter(|f| f.op == trace.op).map(Standing::of);
        of_tap.min().unwrap_or(Standing::Good)
    };
    kept.sort_by_key(|trace| (trace.completed, standing(trace)));
    let nearest = nearest(run, features);
    let first = recorder.first.as_ref().map(|trace| trace.op);
    let (mut open, mut folded) = (String::new(), String::new());
    for (rank, trace) in kept.iter().enumerate() {
        let is_first = first == Some(trace.op);
        let role = match (rank, is_first) {
            (0, true) if recorder.taps <= 1 => "The thread".to_owned(),
            (0, true) => format!("{}, which is the first", role(trace, standing(trace), nearest)),
            (0, false) => role(trace, standing(trace), nearest).to_owned(),
            (_, true) => "First thread".to_owned(),
            (_, false) => "Next largest sync error".to_owned(),
        };
        let one = thread(run, recorder.measure(), trace, judged(features, trace.op), &role);
        let place = if rank == 0 || is_first { &mut open } else { &mut folded };
        *place += &one;
    }
    if !folded.is_empty() {
        let summary = Tag::new("summary").text("Threads with the next largest sync errors");
        open += &Tag::new("details").around(&(summary + &folded));
    }
    open
}

/// The op of the thread that is nearest to its limit, as the page's figures and table have it.
fn nearest(run: &Run, features: &[Feature]) -> Option<u32> {
    let order = by_badness(run, features);
    let mut threads = order.iter().map(|(index, _)| &features[*index]);
    threads.find(|f| matches!(f.kind, FeatureKind::Thread(_))).map(|f| f.op)
}

/// What the first of the threads that were kept is: pictures are kept of those with the largest
/// sync error, and that need not be the one with the least of its tolerance left.
fn role(trace: &TapTrace, standing: Standing, nearest: Option<u32>) -> &'static str {
    match (nearest == Some(trace.op), standing) {
        (_, Standing::NotCut) => "Thread not cut",
        (_, Standing::NotJudged) => "Thread not judged",
        (true, Standing::Bad) => "Worst thread",
        (true, Standing::Good) => "Thread nearest to its limit",
        (false, Standing::Bad) => "Thread out of tolerance",
        (false, Standing::Good) => {
            "Largest sync error, and yet not the thread nearest to its limit"
        }
    }
}

fn thread(
    run: &Run,
    measure: Measure,
    trace: &TapTrace,
    judged: Option<Judged<'_>>,
    role: &str,
) -> String {
    let name = judged.map_or_else(
        || format!("line {}", trace.line),
        |(number, _, t)| format!("{}, No. {number}, line {}", t.size, trace.line),
    );
    // of a thread that is not there nothing was judged: the pictures show how the tap was moved
    let cut = judged.filter(|(_, standing, _)| *standing != Standing::NotCut);
    let thread = cut.map(|(_, _, thread)| thread);
    let view = ThreadView { id: format!("t{}", trace.op), run, trace, measure, thread };
    let pictures = pictures::sync_error(&view)
        + &pictures::torque_plane(&view)
        + &pictures::phase_plane(&view)
        + &pictures::spindle_over_time(&view);
    let facts = Tag::new("p").class("facts").text(&facts(&view, measure));
    super::section::section(&format!("{role}: {name}"), &(facts + &super::section::grid(&pictures)))
}

fn torque(thread: &Thread) -> Option<String> {
    let found = fixed(thread.torque_max?.value(), 2);
    let expected =
        thread.torque_expected.map(|t| format!(" (a sharp tap: {} N·m)", fixed(t.value(), 2)));
    let force = thread.axial_force_max.map(|f| format!(", axial force {} N", fixed(f.value(), 0)));
    Some(format!(
        "torque of the cut {found} N·m{}{}",
        expected.unwrap_or_default(),
        force.unwrap_or_default()
    ))
}

fn facts(view: &ThreadView, measure: Measure) -> String {
    let trace = view.trace;
    let (unit, small) = (measure.symbol(), measure.small_symbol());
    let mut facts = vec![format!(
        "{} {unit}/rev {}, {} {unit} deep, programmed {} rpm in and {} rpm out",
        measure.length(trace.tap.lead.abs() * units::Angle::rev(1.0)),
        if trace.tap.lead.value() < 0.0 { "left-hand" } else { "right-hand" },
        measure.length(trace.whole() - trace.clearance()),
        fixed(trace.tap.spin.in_rpm(), 0),
        fixed(trace.tap.return_spin.in_rpm(), 0)
    )];
    if let Some(thread) = view.thread {
        facts.push(format!(
            "sync error {} {small} at most, {} {small} rms; reached {} rpm in the material",
            measure.small(thread.sync_error_max, 1),
            measure.small(thread.sync_error_rms, 1),
            fixed(thread.spin_max.in_rpm(), 0)
        ));
    }
    if view.thread.is_none() {
        facts.push("no contact with the material".into());
    }
    facts.extend(view.thread.and_then(torque));
    if !trace.completed {
        facts.push("it did not come out in step".into());
    }
    if let Some(limiting) = view.run.limiting.get(&trace.op) {
        facts.push(format!("limited by: {limiting}"));
    }
    facts.join(" · ")
}
