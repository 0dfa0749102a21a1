//! Feeds with an empty spindle.
use super::*;

/// A program that selects T7 in line 2, feeds in line 4 and does something else then.
fn with_no_tool(spin: f64, orders: &[(u32, OpKind)]) -> Mover {
    let mut mover = Mover::new(MillForm::FLAT, 10.0, [-20.0, 30.0, 5.0]);
    (mover.sample.feedback.tool, mover.spin) = (Some(0), spin);
    for (index, kind) in orders {
        let span = canon::Span { line: index + 1, ..canon::Span::default() };
        mover.milling.op(*index, &Op { span, kind: kind.clone() });
    }
    mover.sample.report.op = 2;
    mover.sample.report.line = 3;
    mover.rapid([-20.0, 30.0, -3.0]);
    mover.feed([120.0, 30.0, -3.0]);
    mover
}

#[test]
fn what_an_empty_spindle_was_to_mill_is_not_judged() {
    let found = with_no_tool(50.0, &[(1, OpKind::SelectTool { number: 7 })]).finish().unwrap();
    assert_eq!(
        found.verdict.reason(),
        Some(
            "no tool was in the spindle, and nothing was cut: line 2 selects T7, and no M6 brings it into the spindle"
        )
    );
    assert_eq!((found.verdict.name(), found.op, found.tool), ("not judged", 4, None));
    assert!(found.duration.value() > 6.9, "{}", found.duration);
}

#[test]
fn an_empty_spindle_is_said_once_for_each_tool_that_is_missing() {
    let orders = [(1, OpKind::SelectTool { number: 7 }), (5, OpKind::SelectTool { number: 8 })];
    let mut mover = with_no_tool(50.0, &orders);
    mover.feed([120.0, 10.0, -3.0]);
    mover.feed([0.0, 10.0, -3.0]);
    let first: Vec<u32> = mover.features.iter().map(|feature| feature.op).collect();
    assert_eq!(first, [4], "T7 is given up when T8 is called");
    mover.sample.feedback.tool = Some(1);
    mover.feed([-30.0, 10.0, -3.0]);
    assert_eq!(mover.features.len(), 2, "T8 has come by hand");
    assert!(mover.features[1].verdict.reason().is_some_and(|why| why.contains("selects T8")));
}

#[test]
fn a_tool_that_was_not_called_is_not_missing_nor_one_whose_spindle_stands() {
    assert!(with_no_tool(50.0, &[]).finish().is_none());
    let call = (1, OpKind::SelectTool { number: 7 });
    assert!(with_no_tool(0.0, std::slice::from_ref(&call)).finish().is_none());
    let emptied = (2, OpKind::ChangeTool { number: 0 });
    assert!(with_no_tool(50.0, &[call, emptied]).finish().is_none());
}
