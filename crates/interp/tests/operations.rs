//! What programs come to as operations. Expected values follow from the definitions of the codes.

use crate::shop::{ends, near, ops_of, refused, shop, tool};
use canon::{Axis, Feed, Op, OpKind, PathMode, Plane, SpindleOrder, ToolKind, ToolLibrary};
use interp::{Ops, Setup};
use units::{Angle, Length, Spin, Time, TurnDirection};

#[test]
fn a_work_offset_moves_the_program_and_g53_does_not_care() {
    let program = "G21 G90\nG10 L2 P2 X100 Y50 Z-300\nG55 G0 X1 Y2 Z3\nG53 G0 X7\nG0 X0";
    near(
        &ends(&ops_of(&shop(), program)),
        &[[101.0, 52.0, -297.0], [7.0, 52.0, -297.0], [100.0, 52.0, -297.0]],
    );
}

#[test]
fn a_tool_length_offset_lifts_the_axis_by_the_tools_length() {
    near(
        &ends(&ops_of(&shop(), "T1 M6\nG43\nG0 Z5\nG49 G0 Z5")),
        &[[0.0, 0.0, 85.0], [0.0, 0.0, 5.0]],
    );
}

#[test]
fn wear_is_part_of_the_tool_length_offset_and_of_the_radius_that_g41_keeps() {
    let mut worn = tool(1, 80.0, ToolKind::EndMill(canon::Mill::default()));
    worn.wear = canon::ToolWear { length: Length::mm(-0.25), radius: Length::mm(-0.5) };
    let setup = Setup { tools: ToolLibrary::new([worn]), ..Setup::default() };
    near(&ends(&ops_of(&setup, "T1 M6\nG43\nG0 Z5")), &[[0.0, 0.0, 84.75]]);
    // 6 mm across, 0.5 mm of each side worn off: 2.5 mm to the left of Y0
    let beside = "T1 M6\nF600\nG0 X0 Y-20\nG41\nG1 X10 Y0\nX50\nG40\nG1 Y20";
    let ends = ends(&ops_of(&setup, beside));
    assert!(ends.iter().any(|at| (at[1] - 2.5).abs() < 1e-9 && at[0] > 40.0), "{ends:?}");
}

#[test]
fn fanucs_variables_show_the_tool_tables_wear_and_geometry_apart() {
    let mut worn = tool(1, 80.0, ToolKind::EndMill(canon::Mill::default()));
    worn.wear = canon::ToolWear { length: Length::mm(-0.25), radius: Length::mm(-0.5) };
    let tools = ToolLibrary::new([worn]);
    let setup = Setup { tools, dialect: interp::Dialect::Fanuc, ..Setup::default() };
    let program =
        "O1\nG21 G90\nG0 X#10001 Y#11001\nG0 X#12001 Y#13001\n#10001=-0.5\nG43 H1 Z0\nM30";
    let mut ops = Ops::new(program.as_bytes(), &setup);
    let all: Vec<Op> = ops.by_ref().collect();
    assert!(!ops.has_errors(), "{:?}", ops.diagnostics());
    near(&ends(&all), &[[-0.25, 80.0, 0.0], [-0.5, 3.0, 0.0], [-0.5, 3.0, 79.5]]);
}

#[test]
fn g92_names_the_place_and_g92_1_forgets_it() {
    near(
        &ends(&ops_of(&shop(), "G0 X10\nG92 X3\nG0 X4\nG92.1 G0 X4")),
        &[[10.0, 0.0, 0.0], [11.0, 0.0, 0.0], [4.0, 0.0, 0.0]],
    );
}

#[test]
fn a_rotated_offset_turns_x_and_y_about_its_origin() {
    let half = 0.5 * 3f64.sqrt();
    near(
        &ends(&ops_of(&shop(), "G10 L2 P1 X10 Y20 R30\nG0 X2 Y0")),
        &[[10.0 + 2.0 * half, 21.0, 0.0]],
    );
}

#[test]
fn inches_and_diameters_end_at_the_edge() {
    near(&ends(&ops_of(&shop(), "G20 G7\nG0 X2 Z1")), &[[25.4, 0.0, 25.4]]);
}

#[test]
fn feed_per_minute_in_inches_comes_out_in_millimetres_per_second() {
    let ops = ops_of(&shop(), "G20\nF6\nG1 X1");
    let OpKind::Line { feed: Feed::PerTime(speed), .. } = ops[1].kind else { panic!("{ops:?}") };
    assert!((speed.value() - 2.54).abs() < 1e-12);
}

#[test]
fn inverse_time_is_a_duration() {
    let ops = ops_of(&shop(), "G93\nG1 X1 F20");
    let OpKind::Line { feed: Feed::Duration(time), .. } = ops[1].kind else { panic!("{ops:?}") };
    assert_eq!(time, Time::s(3.0));
}

#[test]
fn a_turn_of_a_rotary_axis_alone_takes_its_degrees_over_f() {
    let ops = ops_of(&shop(), "F90\nG1 A45");
    let OpKind::Line { feed: Feed::Duration(time), to } = ops[1].kind else { panic!("{ops:?}") };
    assert_eq!(time, Time::s(30.0));
    assert_eq!(to.rotary[0], Angle::deg(45.0));
}

#[test]
fn a_quarter_circle_sweeps_a_quarter_turn_and_two_more_with_p3() {
    for (word, sweep) in [
        ("G3 X0 Y5 I-5", 0.25),
        ("G2 X0 Y5 I-5", -0.75),
        ("G3 X0 Y5 I-5 P3", 2.25),
        ("G3 I-5", 1.0),
        ("G2 I-5 P2", -2.0),
    ] {
        let ops = ops_of(&shop(), &format!("F100 G0 X5 Y0\n{word}"));
        let arc = ops
            .iter()
            .find_map(|op| if let OpKind::Arc { arc, .. } = op.kind { Some(arc) } else { None })
            .unwrap();
        assert!((arc.sweep.value() - sweep).abs() < 1e-12, "{word}: {}", arc.sweep);
        assert!(arc.centre.iter().all(|c| c.value().abs() < 1e-12), "{word}");
        assert_eq!(arc.plane, Plane::XY);
    }
}

#[test]
fn an_arc_by_radius_has_the_centre_of_its_chord() {
    // Chord 6, radius 5: the centre is 4 from the chord; left of it for a short counter-clockwise
    // arc.
    let ops = ops_of(&shop(), "F100\nG3 X6 Y0 R5");
    let OpKind::Arc { arc, .. } = ops[1].kind else { panic!("{ops:?}") };
    assert!(
        (arc.centre[0].value() - 3.0).abs() < 1e-12 && (arc.centre[1].value() - 4.0).abs() < 1e-12
    );
}

#[test]
fn g81_is_a_hole_and_its_moves() {
    let ops = ops_of(&shop(), "F100 S1000 M3\nG0 Z5\nG98 G81 X1 Y2 Z-10 R1");
    let at = ops.iter().position(|op| matches!(op.kind, OpKind::Hole(_))).unwrap();
    let OpKind::Hole(hole) = ops[at].kind else { unreachable!() };
    assert_eq!((hole.axis, hole.bottom, hole.surface), (Axis::Z, Length::mm(-10.0), Length::ZERO));
    assert_eq!(hole.at.linear.map(Length::value), [1.0, 2.0, 1.0]);
    near(
        &ends(&ops[at..]),
        &[[1.0, 2.0, 5.0], [1.0, 2.0, 1.0], [1.0, 2.0, -10.0], [1.0, 2.0, 5.0]],
    );
    assert!(ops[at..at + 5].iter().all(|op| op.span == ops[at].span));
    assert_eq!(ops[at - 1].kind, OpKind::PathMode(PathMode::Exact));
}

#[test]
fn a_missing_tool_is_refused_with_those_there_are() {
    let fault = refused(&shop(), "T7 M6", "I0611");
    assert_eq!(fault.message, "tool 7 is not in the tool table");
    assert_eq!(fault.help.as_deref(), Some("it has 1, 2"));
}

#[test]
fn a_spindle_order_is_said_once() {
    let ops = ops_of(&shop(), "S500 M3\nM3\nS500\nS600\nM5\nM5");
    let orders: Vec<_> = ops
        .iter()
        .filter_map(
            |op| if let OpKind::Spindle { order, .. } = op.kind { Some(order) } else { None },
        )
        .collect();
    assert_eq!(
        orders,
        [
            SpindleOrder::Turn(Spin::rpm(500.0)),
            SpindleOrder::Turn(Spin::rpm(600.0)),
            SpindleOrder::Stop
        ]
    );
}

#[test]
fn reference_points_are_machine_coordinates() {
    let program = "G10 L2 P1 X100\nG0 X1 Y2 Z3\nG28.1\nG0 X9 Z9\nG91 G28 Z1";
    near(
        &ends(&ops_of(&shop(), program)),
        &[[101.0, 2.0, 3.0], [109.0, 2.0, 9.0], [109.0, 2.0, 10.0], [109.0, 2.0, 3.0]],
    );
}

#[test]
fn feed_in_the_block_that_changes_units_is_warned_about() {
    assert!(!refused(&shop(), "G20 G1 X1 F10", "I0403").is_error());
}

#[test]
fn polar_words_place_a_bolt_circle() {
    let half = 0.5 * 3f64.sqrt();
    near(
        &ends(&ops_of(&shop(), "G0 @10 ^30\n^90\n@5\nG91 ^90")),
        &[[10.0 * half, 5.0, 0.0], [0.0, 10.0, 0.0], [0.0, 5.0, 0.0], [-5.0, 0.0, 0.0]],
    );
}

#[test]
fn a_cycle_in_a_turned_plane_other_than_g17_is_refused_where_it_is_machined() {
    refused(&shop(), "G10 L2 P1 R30\nG18 F100\nG81 X1 Y-5 R1", "I0706");
}

#[test]
fn feed_per_revolution_with_a_standing_spindle_is_refused() {
    refused(&shop(), "S500\nG95 F0.1\nG1 X1", "I0702");
    refused(&shop(), "M3\nG95 F0.1\nG1 X1", "I0434");
}

#[test]
fn constant_surface_speed_is_in_metres_per_minute_and_keeps_its_limit() {
    let ops = ops_of(&shop(), "G96 S120 D2500 M4");
    let order = ops.iter().find_map(|op| {
        if let OpKind::Spindle { order, .. } = op.kind { Some(order) } else { None }
    });
    let wanted = SpindleOrder::ConstantSurfaceSpeed {
        speed: units::Speed::mm_per_s(-2000.0),
        limit: Some(Spin::rpm(2500.0)),
    };
    assert_eq!(order, Some(wanted));
}

#[test]
fn pockets_are_those_of_the_tool_table() {
    let mut nine = tool(5, 80.0, ToolKind::EndMill(canon::Mill::default()));
    nine.pocket = 9;
    let mut setup = shop();
    setup.tools =
        ToolLibrary::new([nine, tool(4, 90.0, ToolKind::EndMill(canon::Mill::default()))]);
    let program =
        "T5\nG0 X#<_selected_pocket>\nM6 T4\nY#<_current_pocket> Z#<_selected_pocket>\nM2";
    let ops = ops_of(&setup, program);
    let last = ops.iter().rev().find_map(|op| match op.kind {
        OpKind::Rapid { to } => Some(to.linear),
        _ => None,
    });
    assert_eq!(last, Some([9.0, 4.0, 4.0].map(Length::mm)));
}

#[test]
fn an_additional_length_offset_may_be_given_by_words() {
    let ops = ops_of(&shop(), "T1 M6\nG43\nG43.2 X1 Z2\nG0 X0 Z0\nM2");
    let to = ops.iter().find_map(|op| match op.kind {
        OpKind::Rapid { to } => Some(to.linear),
        _ => None,
    });
    assert_eq!(to, Some([1.0, 0.0, 82.0].map(Length::mm)));
}

#[test]
fn a_nurbs_with_one_mistake_is_told_once() {
    // its other points, its end and the program's are as they should be
    for first in ["G5.2 X1 Y1 P1 L1", "G5.2 X1 Y1 P-1 L3", "G5.2 X1 P1"] {
        let program = format!("F100\n{first}\nX2 Y2 P1\nX4 Y0 P1\nG5.3\nM2\n");
        let found = interp::check(program.as_bytes(), &Setup::default());
        let errors: Vec<_> = found.iter().filter(|d| d.is_error()).collect();
        assert!(errors.len() == 1 && errors[0].span.line == 2, "{errors:#?}");
    }
    let found = interp::check(b"F100\nG5.2 X1 Y1 P1 L3\nX2 Y2 P1\nM2\n", &Setup::default());
    let errors: Vec<_> = found.iter().map(|d| d.code).collect();
    assert_eq!(errors, ["I0558"]);
}

#[test]
fn a_profile_with_an_error_is_not_cut_however_often_it_is_called() {
    let program = "G18 F400\nO100 SUB\nG0 X10 Z0\nG1 Z-10\nX16 Z[1/0]\nZ-15\nO100 ENDSUB\nG7\n\
        G0 X28 Z4\nG70 Q100\nG70 Q100\nM2\n";
    let setup = shop();
    let mut ops = Ops::new(program.as_bytes(), &setup);
    let all: Vec<Op> = ops.by_ref().collect();
    assert_eq!(ops.diagnostics().iter().map(|d| d.code).collect::<Vec<_>>(), ["I0203"]);
    assert!(all.iter().all(|op| !matches!(op.kind, OpKind::Line { .. })), "{all:?}");
}

#[test]
fn m19_says_where_which_way_round_and_for_how_long() {
    let order = |block: &str| {
        let ops = ops_of(&shop(), block);
        ops.iter().find_map(|op| match op.kind {
            OpKind::Spindle { order: SpindleOrder::Orient { to, longest }, .. } => {
                Some((to.angle.in_deg(), to.direction, longest.map(Time::value)))
            }
            _ => None,
        })
    };
    assert_eq!(order("M19 R90"), Some((90.0, TurnDirection::Shortest, None)));
    assert_eq!(order("M19 R90 P0"), Some((90.0, TurnDirection::Shortest, None)));
    assert_eq!(order("M19 R90 P1 Q2.5"), Some((90.0, TurnDirection::Forward, Some(2.5))));
    assert_eq!(order("M19 Q4 P2 R210"), Some((210.0, TurnDirection::Backward, Some(4.0))));
}
