//! Constant surface speed (G96), as it is planned.
use crate::common::{findings_of, line, planner_at, program, rapid, steps_of, turn};
use canon::{Axis, Feed, OpKind, Position, ProgramFrame, SpindleOrder};
use plan::Planner;
use plan::{SpindleStep, Step, StepKind};
use units::{Angle, Lead, Length, Speed, Spin};

/// A lathe whose work turns about X-30, standing on a diameter of 60 mm.
fn lathe() -> Planner {
    let mut planner = planner_at(Position::default(), 0).turning_work();
    let (origin, tool) = (Position::xyz(-50.0, 0.0, 0.0), Position::xyz(20.0, 0.0, 0.0));
    planner.written_in(ProgramFrame { origin, tool, ..ProgramFrame::default() });
    planner
}

/// 100 m/min.
fn surface(limit_rpm: Option<f64>) -> OpKind {
    let limit = limit_rpm.map(Spin::rpm);
    let speed = Speed::mm_per_min(100_000.0);
    let order = SpindleOrder::ConstantSurfaceSpeed { speed, limit };
    OpKind::Spindle { spindle: 0, order }
}

fn words(steps: &[Step]) -> String {
    let word = |step: &Step| match &step.kind {
        StepKind::Spindle { order: SpindleStep::Surface { surface, ramp }, .. } => format!(
            "surface({:.0},{:.0},{:.0},{:.0})",
            surface.speed.in_mm_per_min(),
            surface.limit.in_rpm(),
            surface.axis.value(),
            ramp.end().v * 60.0,
        ),
        StepKind::Spindle { order: SpindleStep::Turn { spin, .. }, .. } => {
            format!("turn({:.0})", spin.in_rpm())
        }
        StepKind::Spindle { order: SpindleStep::AwaitSpeed, .. } => "await".into(),
        StepKind::Move(order) if order.rapid => {
            format!("rapid({})", order.path.to().along(Axis::X).value())
        }
        StepKind::Move(order) => format!("cut({})", order.path.to().along(Axis::X).value()),
        StepKind::End => "end".into(),
        other => format!("{other:?}"),
    };
    steps.iter().map(word).collect::<Vec<_>>().join(" ")
}

/// 100 m/min at X0 of this machine, 30 mm from the axis: 530.5 rpm.
#[test]
fn it_goes_about_the_programs_x_zero_and_each_cut_after_a_rapid_awaits_it() {
    let ops = [
        surface(Some(2500.0)),
        rapid(-10.0, 0.0, 0.0),
        line(-29.0, 0.0, 0.0, 200.0),
        rapid(-10.0, 0.0, 0.0),
        line(-29.0, 0.0, 0.0, 200.0),
        turn(600.0),
        line(-10.0, 0.0, 0.0, 200.0),
        OpKind::End,
    ];
    assert_eq!(
        words(&steps_of(lathe(), ops)),
        "surface(100000,2500,-30,796) rapid(-10) await cut(-29) rapid(-10) await cut(-29) turn(600) await \
         cut(-10) turn(0) end"
    );
}

#[test]
fn a_limit_above_the_spindles_own_is_its_own_and_none_is_said() {
    let steps = steps_of(lathe(), [surface(Some(99_000.0)), line(-29.0, 0.0, 0.0, 200.0)]);
    assert!(words(&steps).starts_with("surface(100000,10000,-30,531)"), "{}", words(&steps));
    let said = findings_of(lathe(), [surface(None), line(-29.0, 0.0, 0.0, 200.0)]);
    assert!(said.starts_with("M0319 Warning line 1: G96 without a limit: near the work's axis the spindle turns at its highest speed, 10000 rpm"), "{said}");
}

fn thread(axis: Axis, to: [f64; 3]) -> OpKind {
    OpKind::Threading(canon::Threading {
        to: Position::xyz(to[0], to[1], to[2]),
        lead: Lead::mm_per_rev(1.5),
        growth: units::LeadGrowth::ZERO,
        start_angle: Angle::ZERO,
        axis,
        surface: Length::mm(-10.0),
    })
}

/// 100 m/min on diameters of 60 mm and 58 mm: 530.5 and 548.8 rpm. The speed of a pass holds in the
/// rapids after it, and a cut goes by X again.
#[test]
fn each_pass_of_a_thread_turns_at_the_speed_of_its_own_diameter() {
    let ops = [
        surface(Some(2500.0)),
        thread(Axis::Z, [0.0, 0.0, -30.0]),
        rapid(10.0, 0.0, -30.0),
        rapid(10.0, 0.0, 0.0),
        rapid(-1.0, 0.0, 0.0),
        thread(Axis::Z, [-1.0, 0.0, -30.0]),
        rapid(10.0, 0.0, -30.0),
        line(-10.0, 0.0, -30.0, 200.0),
    ];
    let steps = words(&steps_of(lathe(), ops.clone()));
    let turns: Vec<_> = steps
        .split(' ')
        .filter(|word| word.starts_with("turn(") || word.starts_with("surface("))
        .collect();
    assert_eq!(turns, ["turn(531)", "turn(549)", "surface(100000,2500,-30,398)"], "{steps}");
    let said = findings_of(lathe(), ops);
    assert_eq!(said.matches("M0356 Warning line 2").count(), 1, "{said}");
    assert!(said.contains("this pass turns at S530"), "{said}");
    assert!(!said.contains("M0355"), "{said}");
}

/// The speed that a thread along Z holds is none for a thread on a face.
#[test]
fn a_thread_on_a_face_is_refused_behind_one_along_z_too() {
    let ops = [
        surface(Some(2500.0)),
        thread(Axis::Z, [0.0, 0.0, -30.0]),
        rapid(10.0, 0.0, 0.0),
        thread(Axis::X, [0.0, 0.0, 0.0]),
    ];
    let said = findings_of(lathe(), ops);
    assert!(said.contains("M0355 Error line 4: a thread on a face"), "{said}");
}

#[test]
fn a_thread_on_a_face_needs_revolutions_per_minute() {
    let face = thread(Axis::X, [-20.0, 0.0, 0.0]);
    let said = findings_of(lathe(), [surface(Some(2500.0)), face.clone(), face]);
    let refused = "M0355 Error line 2: a thread on a face needs a speed in revolutions per minute, but constant surface speed (G96) is in force: write G97 S530 before it, which is its speed at this X"; // 100 m/min / (π·60 mm)
    assert_eq!(said.matches("M0355").count(), 1, "{said}");
    assert!(said.contains(refused), "{said}");
}

/// A cut from 30 mm to 1 mm with 0.3 mm a turn, at rest at both ends: t = ∫ 2πr/(v·f)·dr, and turns
/// at the limit below r = v/(2π·n).
#[test]
fn the_time_of_a_feed_per_revolution_is_the_integral_over_the_radius() {
    let feed = Feed::PerRevolution(Lead::mm_per_rev(0.3));
    let facing = OpKind::Line { to: Position::xyz(-29.0, 0.0, 0.0), feed };
    let lasts = |ops: Vec<OpKind>| plan::preflight(lathe(), &program(ops)).duration.value();
    let alone = lasts(vec![surface(Some(2500.0)), line(-1e-6, 0.0, 0.0, 200.0)]);
    let all = lasts(vec![surface(Some(2500.0)), facing]);
    let (v, n) = (100e3 / 60.0, 2500.0 / 60.0);
    let turn = core::f64::consts::TAU;
    let knee = v / (turn * n);
    let wanted = turn / 2.0 * (900.0 - knee * knee) / (v * 0.3) + (knee - 1.0) / 0.3 / n;
    assert!(((all - alone) / wanted - 1.0).abs() < 0.01, "{} s, {wanted} s", all - alone);
}
