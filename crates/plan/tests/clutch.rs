//! The cycles of taps that nothing ties to the spindle: a clutch holder, and a floating one.
//!
//! Expected values are worked out by hand from the closed forms of spec/G84-clutch.md.
use crate::common::{
    OPTIONS, TOP, findings_of, machine, rapid, steps_of, tap, tap_tool, tools, turn,
};
use canon::{Axis, Holder, LengthUnit, OpKind, ProgramFrame, ToolKind, ToolLibrary};
use motion::TiedCut;
use plan::{DwellCheck, Effort, Options, PlainDrive, Planner, Start, TapMethod, Unsynchronised};
use plan::{SpindleStep, Step, StepKind};
use units::{Angle, Length, Spin, SpinAccel, Stiffness, Time};

/// D 5 mm, β 0.1 rev.
const CLUTCH: Holder = Holder::Clutch {
    spline_length: Length::mm(5.0),
    pawl_backlash: Angle::rev(0.1),
    stiffness: Stiffness::n_per_mm(10.0),
    compression: Length::mm(3.0),
};
const FLOATING: Holder =
    Holder::TensionCompression { stiffness: Stiffness::n_per_mm(25.0), travel: Length::mm(8.0) };

/// S3000 stops in 0.08 s, 20 ms after it was told.
const DRIVE: PlainDrive =
    PlainDrive { delay: Time::s(0.02), accel: SpinAccel::rev_per_s2(50.0 / 0.08) };

fn planner(holder: Holder, tapping: Unsynchronised) -> Planner {
    let mut held = tap_tool(2, "M6x1", 6.0, 1.0);
    if let ToolKind::Tap(tap) = &mut held.kind {
        tap.holder = holder;
    }
    let library = ToolLibrary::new(tools().iter().cloned().chain([held]));
    let at = tap(10.0, 10.0, 5.0, -15.0, 1.0, 3000.0).start;
    let start = Start { position: at, tool: 2 };
    Planner::new(machine(), library, Options { taps: tapping, ..OPTIONS }, start)
}

/// M6 from R5 to Z−15 at S3000.
fn order(dwell_s: f64) -> [OpKind; 3] {
    let mut tap = tap(10.0, 10.0, 5.0, -15.0, 1.0, 3000.0);
    tap.dwell = Time::s(dwell_s);
    [turn(3000.0), OpKind::Tap(tap), rapid(10.0, 10.0, TOP + 130.0)]
}

/// Where the axis goes, how long it dwells, what the spindle is told; one word a step.
fn said(steps: &[Step]) -> Vec<String> {
    let said = |step: &Step| match &step.kind {
        StepKind::Move(m) => {
            let z = m.path.to().along(Axis::Z).value() - TOP - 100.0;
            format!("{}{z:.0}", if m.rapid { "rapid " } else { "feed " })
        }
        StepKind::Dwell(_) => "dwell".into(),
        StepKind::Spindle { order: SpindleStep::Turn { spin, .. }, .. } => {
            format!("turn {:.0}", spin.in_rpm())
        }
        StepKind::Spindle { order: SpindleStep::AwaitSpeed, .. } => "await".into(),
        StepKind::SpindleOverride(acts) => format!("spindle override {acts}"),
        StepKind::WayOut(Some(way_out)) => {
            assert!(way_out.cut == TiedCut::FloatingTap && !way_out.is_straight());
            "kept in the work".into()
        }
        StepKind::WayOut(None) => "kept as out of it".into(),
        other => format!("{other:?}"),
    };
    steps.iter().map(said).collect()
}

fn dwells(steps: &[Step]) -> Vec<f64> {
    let dwell = |step: &Step| match step.kind {
        StepKind::Dwell(time) => Some(time.value()),
        _ => None,
    };
    steps.iter().filter_map(dwell).collect()
}

#[test]
fn the_clutch_cycle_is_its_seven_steps_and_leaves_the_spindle_forward() {
    let steps = steps_of(planner(CLUTCH, Unsynchronised::default()), order(0.0));
    let expected = [
        "turn 3000",
        "spindle override false",
        "await",
        "kept in the work",
        "feed -10",
        "dwell",
        "turn -3000",
        "dwell",
        "feed 5",
        "kept as out of it",
        "rapid 30",
        "await",
        "turn 3000",
    ];
    assert_eq!(said(&steps), expected);
    assert_eq!(dwells(&steps).len(), 2);
}

#[test]
fn a_dwell_that_is_left_out_is_the_middle_of_the_window_of_the_measured_spindle() {
    let tapping = Unsynchronised { drive: Some(DRIVE), ..Unsynchronised::default() };
    let steps = steps_of(planner(CLUTCH, tapping), order(0.0));
    // the way back: 15 mm at 50 mm/s; what it takes longer than 0.3 s is lost half at each end
    let mut back = steps.iter().filter_map(|s| match &s.kind {
        StepKind::Move(m) if !m.rapid => Some(m.profile.duration()),
        _ => None,
    });
    let lag_s = (back.next_back().expect("it comes back") - 0.3) / 2.0;
    assert!(lag_s > 0.0 && lag_s < 0.02, "{lag_s}");
    // t_d + delay + 1.5·t_stop + β/n − lag, less clr/(n·H) = 0.1 at the lower end
    let most = 0.1 + 0.02 + 0.12 + 0.002 - lag_s;
    let exact = most - 0.05;
    for dwell in dwells(&steps) {
        assert!((dwell - exact).abs() < 1e-9, "{dwell} for {exact}");
    }
}

/// The spindle's reversal between two feeds is a turn like any other: no preset of tapping changes
/// it, and so none may change the dwell that is made for it.
#[test]
fn a_preset_changes_neither_the_reversal_nor_the_dwell_that_waits_for_it() {
    let held = |effort: Effort| {
        let mut held = tap_tool(2, "M6x1", 6.0, 1.0);
        if let ToolKind::Tap(tap) = &mut held.kind {
            tap.holder = CLUTCH;
        }
        let library = ToolLibrary::new(tools().iter().cloned().chain([held]));
        let at = tap(10.0, 10.0, 5.0, -15.0, 1.0, 3000.0).start;
        let mut limits = machine();
        (limits.tapping.inward, limits.tapping.outward) = (effort, effort);
        let start = Start { position: at, tool: 2 };
        steps_of(Planner::new(limits, library, OPTIONS, start), order(0.0))
    };
    let [gentle, hard] =
        [(0.5, 0.5), (0.95, 1.6)].map(|(margin, jerk)| held(Effort { margin, jerk }));
    assert_eq!(dwells(&gentle).len(), 2);
    assert_eq!(dwells(&gentle), dwells(&hard));
}

#[test]
fn a_dwell_outside_the_window_is_refused_with_one_that_works() {
    for (dwell, because) in [(0.11, "still"), (0.5, "beyond its home")] {
        let found = findings_of(planner(CLUTCH, Unsynchronised::default()), order(dwell));
        assert!(found.contains("M0340 Error") && found.contains(because), "{found}");
        let works = found.split("; P").nth(1).and_then(|rest| rest.split(' ').next());
        let works: f64 = works.and_then(|word| word.parse().ok()).expect("a number that works");
        let found = findings_of(planner(CLUTCH, Unsynchronised::default()), order(works));
        assert!(!found.contains("M0340"), "{works}: {found}");
    }
}

#[test]
fn a_dwell_outside_the_window_is_done_if_the_user_only_wants_to_be_warned() {
    let tapping = Unsynchronised { dwell: DwellCheck::Warn, ..Unsynchronised::default() };
    let found = findings_of(planner(CLUTCH, tapping), order(0.11));
    assert!(found.contains("M0340 Warning"), "{found}");
    assert_eq!(dwells(&steps_of(planner(CLUTCH, tapping), order(0.11))), [0.11, 0.11]);
}

#[test]
fn a_thread_in_which_the_tap_has_not_cut_a_turn_when_the_feed_stops_is_refused() {
    let found = |depth: f64| {
        let short = tap(10.0, 10.0, 5.0, -depth, 1.0, 3000.0);
        findings_of(planner(CLUTCH, Unsynchronised::default()), [turn(3000.0), OpKind::Tap(short)])
    };
    // 5 mm of splines and a turn of 1 mm; the stroke begins 5 mm above the work
    for depth in [0.5, 4.8, 5.9] {
        assert!(found(depth).contains("M0341 Error"), "{depth}: {}", found(depth));
    }
    assert!(!found(6.1).contains("M0341"), "{}", found(6.1));
}

#[test]
fn the_floating_cycle_feeds_all_the_way_stops_and_reverses() {
    let tapping = Unsynchronised { method: TapMethod::Floating, ..Unsynchronised::default() };
    let steps = steps_of(planner(FLOATING, tapping), order(0.0));
    let expected = [
        "turn 3000",
        "spindle override false",
        "await",
        "kept in the work",
        "feed -15",
        "turn 0",
        "await",
        "turn -3000",
        "feed 5",
        "kept as out of it",
        "rapid 30",
        "await",
        "turn 3000",
    ];
    assert_eq!(said(&steps), expected);
}

#[test]
fn a_floating_holder_must_have_the_travel_that_coast_and_run_up_take() {
    // H·n·(delay + t_stop/2) in, and the same again out: 2·50·(0.02 + 0.04) = 6 mm
    let tapping = Unsynchronised {
        method: TapMethod::Floating,
        drive: Some(DRIVE),
        ..Unsynchronised::default()
    };
    let with = |travel| Holder::TensionCompression {
        stiffness: Stiffness::n_per_mm(25.0),
        travel: Length::mm(travel),
    };
    assert!(!findings_of(planner(with(6.001), tapping), order(0.0)).contains("M0342"));
    let found = findings_of(planner(with(4.0), tapping), order(0.0));
    // 2·n·(0.02 + n·0.08/50/2) = 4: n = 38.9 rev/s
    let n = (-0.02 + (0.02_f64.powi(2) + 4.0 * 0.0008 * 2.0).sqrt()) / (2.0 * 0.0008);
    let works = format!("S{} works", Spin::rev_per_s(n).in_rpm().floor());
    assert!(
        found.contains("M0342 Error") && found.contains("6 mm") && found.contains(&works),
        "{found}"
    );
    let rigid = Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) };
    assert!(findings_of(planner(rigid, tapping), order(0.0)).contains("M0342 Error"));
}

#[test]
fn pecks_and_a_faster_return_are_refused_where_nothing_ties_the_tap_to_the_spindle() {
    let mut pecked = tap(10.0, 10.0, 5.0, -15.0, 1.0, 3000.0);
    pecked.peck = Some(Length::mm(5.0));
    pecked.return_spin = Spin::rpm(4000.0);
    let ops = [turn(3000.0), OpKind::Tap(pecked)];
    let found = findings_of(planner(CLUTCH, Unsynchronised::default()), ops);
    assert!(found.contains("pecks (Q)") && found.contains("a return speed (J)"), "{found}");
}

/// 5 mm are 0.1969 in, 4 mm 0.1575: a program in inches is answered in inches.
#[test]
fn what_is_said_of_holders_is_in_the_programs_unit() {
    let inches = ProgramFrame { unit: LengthUnit::Inch, work_offset: 1, ..ProgramFrame::default() };
    let said = |holder, kinds: [OpKind; 3]| {
        let mut planner = planner(holder, Unsynchronised::default());
        planner.written_in(inches);
        findings_of(planner, kinds)
    };
    let mut short = tap(10.0, 10.0, 5.0, 1.0, 1.0, 3000.0);
    short.surface = Length::mm(TOP + 103.0);
    let text = said(CLUTCH, [turn(3000.0), OpKind::Tap(short), rapid(10.0, 10.0, TOP + 130.0)]);
    assert!(
        text.contains("pulls the tap in by 0.1969 in") && text.contains("0.2362 in or more works"),
        "{text}"
    );
    for dwell in [0.11, 0.5] {
        let text = said(CLUTCH, order(dwell));
        assert!(text.contains("M0340") && text.contains(" in ") && !text.contains(" mm"), "{text}");
    }
    let text = said(FLOATING, order(0.0));
    assert!(!text.contains(" mm"), "{text}");
}
