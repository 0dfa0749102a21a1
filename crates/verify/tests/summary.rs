//! What is told first about a workpiece.
use crate::common::{self, Record, config, drilling, hole_ops, judge, tools};
use units::Length;
use verify::{Count, Criterion, Feature, Gauge, Judge, Summary, Tolerances};

fn tolerances() -> Tolerances {
    Tolerances::default()
}

/// An M6 that is wider by so many micrometres out than in; its tap is 40 µm oversize.
fn m6(widening_um: f64) -> Feature {
    let mut tool = common::tap_tool(2, "M6x1", 1.0);
    if let canon::ToolKind::Tap(tap) = &mut tool.kind {
        tap.oversize = Length::um(40.0);
    }
    let config = config(canon::ToolLibrary::new([tool]));
    common::judge_with(
        config,
        &Record::new(2, 1.0),
        |_, out| {
            if out { -widening_um * 1e-3 } else { 0.0 }
        },
    )
}

fn hole(depth_mm: f64) -> Feature {
    let mut judge = Judge::new(config(tools()));
    for (index, op) in hole_ops(7, [30.0, 20.0], 12.0).iter().enumerate() {
        judge.op(index as u32, op);
    }
    for sample in drilling(0, 1, [30.0, 20.0], depth_mm) {
        judge.sample(&sample);
    }
    judge.finish().remove(0)
}

#[test]
fn a_narrow_thread_is_limited_by_go_and_a_wide_one_by_no_go() {
    // M6 6H: TD2 150 µm, tap 40 µm oversize
    let narrow = m6(0.0).headroom(&tolerances());
    assert_eq!(narrow.of, Criterion::PitchDiameter(Gauge::Go));
    assert!((narrow.share() - 40.0 / 150.0).abs() < 1e-6);
    let wide = m6(50.0).headroom(&tolerances());
    assert_eq!(wide.of, Criterion::PitchDiameter(Gauge::NoGo));
    assert!((wide.left.in_um() - (150.0 - 40.0 - 3.0_f64.sqrt() * 50.0)).abs() < 0.01);
}

#[test]
fn the_worst_is_the_one_with_the_least_share_of_its_own_tolerance_left() {
    let features = [hole(12.03), m6(0.0), m6(55.0), hole(12.0)];
    let summary = Summary::of(&features, &tolerances());
    assert_eq!(summary.holes, Count { passed: 2, failed: 0, not_judged: 0 });
    assert_eq!((summary.threads.total(), summary.passes()), (2, true));
    let (index, headroom) = summary.worst.unwrap();
    assert_eq!((index, headroom.of), (2, Criterion::PitchDiameter(Gauge::NoGo)));
    assert_eq!(summary.sync_error_max.unwrap().0, 2);
}

#[test]
fn a_feature_out_of_tolerance_comes_before_every_good_one() {
    let summary = Summary::of(&[m6(0.0), hole(12.2), m6(0.0)], &tolerances());
    assert!(!summary.passes());
    let (index, headroom) = summary.worst.unwrap();
    assert_eq!(index, 1);
    assert_eq!(headroom.of, Criterion::Depth);
    assert!((headroom.left.in_um() + 150.0).abs() < 0.5, "{headroom:?}");
}

#[test]
fn what_failed_without_a_measure_is_the_worst_of_all() {
    let broken = judge(&Record::new(9, 1.0), |_, _| 0.0); // T9 is in no table
    let summary = Summary::of(&[hole(12.2), broken], &tolerances());
    let (index, headroom) = summary.worst.unwrap();
    assert_eq!(index, 1);
    assert!(headroom.share() < -1.0, "{headroom:?}");
}

#[test]
fn an_empty_workpiece_passes_and_has_no_worst() {
    let summary = Summary::of(&[], &tolerances());
    assert!(summary.passes() && summary.worst.is_none() && summary.sync_error_max.is_none());
}

#[test]
fn what_was_not_judged_is_counted_and_no_pass() {
    let unknown = verify::Config::new(tools());
    let feature = common::judge_with(unknown, &Record::new(2, 1.0), |_, _| 0.0);
    assert_eq!((feature.verdict.name(), feature.verdict.is_pass()), ("not judged", false));
    assert!(feature.verdict.reason().unwrap_or_default().contains("[setup.stock]"));
    let features = [m6(0.0), feature];
    let summary = Summary::of(&features, &tolerances());
    assert_eq!(summary.threads, Count { passed: 1, failed: 0, not_judged: 1 });
    assert!(!summary.passes());
    assert_eq!(summary.worst.map(|(index, left)| (index, left.of)), Some((1, Criterion::Whole)));
}
