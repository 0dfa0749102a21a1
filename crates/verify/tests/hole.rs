//! Holes judged from synthetic records.
use crate::common::{self, config, drill, drilling, hole_ops};
use canon::{Op, OpKind, Tool, ToolKind, ToolLibrary};
use units::{Angle, Length};
use verify::{Config, Feature, FeatureKind, Hole, Judge, Stock};

fn tools() -> ToolLibrary {
    let spot = ToolKind::SpotDrill { point_angle: Angle::deg(90.0) };
    ToolLibrary::new([
        drill(1, 5.0),
        Tool { kind: spot, ..drill(2, 10.0) },
        Tool { kind: ToolKind::Other, ..drill(3, 8.0) },
    ])
}

fn cut(
    tool: u32,
    at_mm: [f64; 2],
    programmed_mm: f64,
    depth_mm: f64,
    config: Config,
) -> Vec<Feature> {
    let mut judge = Judge::new(config);
    let programmed_at = [30.0, 20.0];
    for (index, op) in hole_ops(7, programmed_at, programmed_mm).iter().enumerate() {
        judge.op(index as u32, op);
    }
    for sample in drilling(0, tool, at_mm, depth_mm) {
        judge.sample(&sample);
    }
    judge.finish()
}

fn one(tool: u32, at_mm: [f64; 2], depth_mm: f64) -> (Feature, Hole) {
    let feature = cut(tool, at_mm, 12.0, depth_mm, config(tools())).remove(0);
    let FeatureKind::Hole(hole) = feature.kind.clone() else { panic!("{feature:?}") };
    (feature, hole)
}

fn near(found: Length, expected_mm: f64) {
    assert!((found.value() - expected_mm).abs() < 1e-3, "expected {expected_mm}, found {found}");
}

#[test]
fn a_hole_is_as_deep_as_its_tip_went_and_full_down_to_the_point() {
    let (feature, hole) = one(1, [30.0, 20.0], 12.0);
    assert!(feature.verdict.is_pass(), "{:?}", feature.verdict);
    assert_eq!((feature.kind_name(), feature.line, feature.tool), ("hole", 7, Some(1)));
    near(hole.depth, 12.0);
    near(hole.full_diameter_depth, 12.0 - 2.5 / 59.0_f64.to_radians().tan());
    near(hole.diameter, 5.0);
    near(hole.position_error, 0.0);
}

#[test]
fn too_deep_and_too_shallow_say_by_how_much() {
    assert!(one(1, [30.0, 20.0], 12.04).0.verdict.is_pass());
    let (deep, hole) = one(1, [30.0, 20.0], 12.08);
    near(hole.depth_error, 0.08);
    assert_eq!(
        deep.verdict.reason().unwrap(),
        "80 µm too deep: 12.080 mm instead of 12.000 mm, 50 µm allowed"
    );
    let (shallow, _) = one(1, [30.0, 20.0], 11.8);
    assert!(shallow.verdict.reason().unwrap().starts_with("200 µm too shallow"));
}

#[test]
fn a_hole_beside_its_place_fails_by_the_distance() {
    let (feature, hole) = one(1, [30.06, 20.08], 12.0);
    near(hole.position_error, 0.1);
    near(hole.x, 30.06);
    assert_eq!(feature.verdict.reason().unwrap(), "100 µm off its position, 50 µm allowed");
}

#[test]
fn a_spot_drill_leaves_a_cone_as_wide_as_twice_its_depth() {
    let mut features = cut(2, [30.0, 20.0], 1.5, 1.5, config(tools()));
    let FeatureKind::Hole(hole) = features.remove(0).kind else { panic!("a hole") };
    near(hole.diameter, 3.0);
    near(hole.full_diameter_depth, 0.0);
}

#[test]
fn a_tool_that_makes_no_feature_is_not_judged() {
    assert!(cut(3, [30.0, 20.0], 12.0, 12.0, config(tools())).is_empty());
}

#[test]
fn a_hole_that_was_never_reached_says_how_near_the_tip_came() {
    let (feature, _) = one(1, [30.0, 20.0], -0.5);
    assert_eq!(
        feature.verdict.reason().unwrap(),
        "not cut: the tip came no nearer than 0.500 mm to the stock"
    );
}

/// A hole 12 mm below the program's zero, which the tip touches at −150; top and zero of the work
/// are there.
fn on_stock(top_mm: f64, zero_mm: f64) -> (Feature, Hole) {
    let stock = Some(common::stock_at(top_mm, zero_mm));
    let config = Config { stock, ..config(tools()) };
    let feature = cut(1, [30.0, 20.0], 12.0, 12.0, config).remove(0);
    let FeatureKind::Hole(hole) = feature.kind.clone() else { panic!("{feature:?}") };
    (feature, hole)
}

#[test]
fn depth_counts_from_the_real_stock_wherever_its_top_lies_over_the_works_zero() {
    // what is to be faced off later is drilled through too
    for (top_mm, depth_mm) in [(-150.0, 12.0), (-149.0, 13.0), (-151.0, 11.0)] {
        let (feature, hole) = on_stock(top_mm, -150.0);
        assert!(feature.verdict.is_pass(), "{:?}", feature.verdict);
        near(hole.depth, depth_mm);
        near(feature.contact.reach.unwrap(), depth_mm);
    }
}

#[test]
fn a_programs_zero_that_is_not_the_works_is_an_error_of_depth() {
    for (zero_mm, depth_mm, what) in
        [(-153.0, 9.0, "3000 µm too shallow"), (-147.0, 15.0, "3000 µm too deep")]
    {
        let (feature, hole) = on_stock(zero_mm, zero_mm);
        near(hole.depth, depth_mm);
        let reason = feature.verdict.reason().unwrap();
        assert!(reason.contains(what) && reason.contains("look at the work offset"), "{reason}");
    }
}

#[test]
fn above_the_stock_and_beside_it_nothing_is_cut() {
    let (feature, hole) = on_stock(-165.0, -165.0);
    near(hole.depth, 0.0);
    let reason = feature.verdict.reason().unwrap();
    assert!(
        reason.contains("not cut: the tip came no nearer than 3.000 mm to the stock"),
        "{reason}"
    );
    assert!(!feature.contact.is_cut());
    let [_, y, z] = common::stock().to;
    let beside = Stock { to: [Length::mm(20.0), y, z], ..common::stock() };
    let config = Config { stock: Some(beside), ..config(tools()) };
    let feature = cut(1, [30.0, 20.0], 12.0, 12.0, config).remove(0);
    let reason = feature.verdict.reason().unwrap();
    assert_eq!(reason, "not cut: the tool passed 7.500 mm beside the stock");
}

#[test]
fn a_hole_at_the_stocks_side_breaks_through_it() {
    let stock = common::stock();
    let [_, y, z] = stock.to;
    let stock = Stock { to: [Length::mm(31.0), y, z], ..stock };
    let config = Config { stock: Some(stock), ..config(tools()) };
    let feature = cut(1, [30.0, 20.0], 12.0, 12.0, config).remove(0);
    let reason = feature.verdict.reason().unwrap();
    assert_eq!(reason, "it breaks through a side of the stock: 1.50 mm of it are in the air");
}

#[test]
fn without_a_stock_a_hole_is_not_judged() {
    let feature = cut(1, [30.0, 20.0], 12.0, 12.0, Config::new(tools())).remove(0);
    assert_eq!((feature.verdict.name(), feature.verdict.is_pass()), ("not judged", false));
    assert!(feature.contact.reach.is_none());
    // what is bad anyhow is bad
    let off = cut(1, [30.5, 20.0], 12.0, 12.0, Config::new(tools())).remove(0);
    assert_eq!(off.verdict.name(), "fail");
}

#[test]
fn a_drill_that_nothing_resists_has_cut_nothing() {
    let mut judge = Judge::new(config(tools()));
    for (index, op) in hole_ops(7, [30.0, 20.0], 12.0).iter().enumerate() {
        judge.op(index as u32, op);
    }
    for mut sample in drilling(0, 1, [30.0, 20.0], 12.0) {
        if let Some(truth) = &mut sample.truth {
            truth.cutting_torque = units::Torque::ZERO;
        }
        judge.sample(&sample);
    }
    let feature = judge.finish().remove(0);
    let reason = feature.verdict.reason().unwrap();
    assert!(reason.starts_with("not cut: 12.00 mm deep in the stock nothing resisted"), "{reason}");
}

#[test]
fn a_forgotten_tool_length_offset_is_found() {
    // zero on the stock's top, and the axis goes there as if the tool had no length
    let (feature, hole) = on_stock(-50.0, -50.0);
    near(hole.depth, 112.0);
    let reason = feature.verdict.reason().unwrap();
    assert!(reason.contains("no tool length offset was in force (G43)"), "{reason}");
    assert!(reason.contains("100000 µm too deep"), "{reason}");
}

#[test]
fn a_length_offset_of_another_tool_is_named() {
    let mut long = drill(6, 5.0);
    long.length = Length::mm(113.25);
    let tools = ToolLibrary::new([drill(1, 5.0), long]);
    // T6 would touch the work's zero where the program has its own; T1 is 13.25 mm shorter
    let stock = Some(common::stock_at(-163.25, -163.25));
    let feature = cut(1, [30.0, 20.0], 12.0, 12.0, Config { stock, ..config(tools) }).remove(0);
    let reason = feature.verdict.reason().unwrap();
    assert!(reason.contains("the length offset in force was that of T6, 113.250 mm"), "{reason}");
}

#[test]
fn the_moves_of_the_next_block_are_no_part_of_a_hole() {
    let mut judge = Judge::new(config(tools()));
    let ops = hole_ops(7, [30.0, 20.0], 12.0);
    for (index, op) in ops.iter().enumerate() {
        judge.op(index as u32, op);
    }
    judge.op(3, &Op { span: common::span(8), kind: OpKind::End });
    for sample in drilling(0, 1, [30.0, 20.0], 12.0) {
        judge.sample(&sample);
    }
    // line 8 goes far deeper, elsewhere
    for mut sample in drilling(0, 1, [90.0, 20.0], 30.0) {
        sample.report.op = 3;
        judge.sample(&sample);
    }
    assert_eq!(judge.features().len(), 1, "judged as soon as its block is over");
    assert!(judge.finish()[0].verdict.is_pass());
}

#[test]
fn a_block_that_repeats_makes_one_hole_each_time() {
    let mut judge = Judge::new(config(tools()));
    let places = [[30.0, 20.0], [40.0, 20.0], [50.0, 20.0]];
    for (k, at) in places.into_iter().enumerate() {
        for (index, op) in hole_ops(7, at, 12.0).iter().enumerate() {
            judge.op((3 * k + index) as u32, op);
        }
    }
    for (k, at) in places.into_iter().enumerate() {
        for sample in drilling(3 * k as u32, 1, at, 12.0) {
            judge.sample(&sample);
        }
    }
    let features = judge.finish();
    assert_eq!(features.len(), 3);
    for (feature, at) in features.iter().zip(places) {
        assert!(feature.verdict.is_pass(), "{:?}", feature.verdict);
        near(feature.position().unwrap()[0], at[0]);
    }
}
