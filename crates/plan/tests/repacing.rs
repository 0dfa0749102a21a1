//! Planning anew what has not been done.
use crate::common::{line, planner_at, program, rapid, turn};
use canon::OpKind;
use motion::{Superpose, Superposed, TableId};
use plan::OperatorSettings;
use plan::{Step, StepKind};
use units::Angle;

fn steps() -> (plan::Planner, Vec<Step>) {
    let mut planner = planner_at(canon::Position::default(), 0);
    let mut steps = Vec::new();
    let kinds = [turn(1000.0), rapid(0.0, 0.0, -5.0), line(100.0, 0.0, -5.0, 600.0), OpKind::End];
    for (index, op) in (0..).zip(&program(kinds)) {
        planner.push(index, op, &mut |step| steps.push(step));
    }
    planner.finish(&mut |step| steps.push(step));
    (planner, steps)
}

/// Seconds of cuts.
fn cutting(steps: &[Step]) -> f64 {
    let of = |step: &Step| match &step.kind {
        StepKind::Move(order) if !order.rapid => order.profile.duration(),
        StepKind::Follow(order) if !order.piece.rapid => order.duration(),
        _ => 0.0,
    };
    steps.iter().map(of).sum()
}

fn repaced(steps: Vec<Step>, planner: &mut plan::Planner) -> Vec<Step> {
    let mut after = Vec::new();
    let settings = OperatorSettings { share: 2.0, stops: false };
    planner.repace(settings, steps, None, &mut |step| after.push(step));
    after
}

/// 100 mm at 10 mm/s take 10 s.
#[test]
fn a_cut_takes_half_the_time_with_twice_the_feed_and_all_else_is_as_it_was() {
    let (mut planner, before) = steps();
    let others = |steps: &[Step]| -> Vec<_> {
        let is_cut = |s: &Step| {
            matches!(&s.kind, StepKind::Move(m) if !m.rapid)
                || matches!(s.kind, StepKind::Follow(_))
        };
        steps.iter().filter(|s| !is_cut(s)).cloned().collect()
    };
    let kept = others(&before);
    assert!((cutting(&before) - 10.0).abs() < 0.1);
    let after = repaced(before, &mut planner);
    assert!((cutting(&after) - 5.0).abs() < 0.1, "{} s", cutting(&after));
    assert_eq!(others(&after), kept);
}

#[test]
fn where_an_axis_begins_to_swing_among_the_steps_they_stay_as_planned() {
    let (mut planner, mut before) = steps();
    let swing = Superpose {
        on: Superposed::Axis(canon::Axis::X),
        master: 0,
        table: Some(TableId(0)),
        turns: 1.0,
        over: Angle::rev(1.0),
    };
    before.insert(0, Step { kind: StepKind::Superpose(swing), ..before[0] });
    let time = cutting(&before);
    let after = repaced(before, &mut planner);
    assert!((cutting(&after) - time).abs() < 1e-9);
}
