//! What programs come to as operations. Expected values follow from the definitions of the codes.
use canon::{
    Axis, Feed, Holder, Op, OpKind, PathMode, Plane, ReturnAcceleration, SpindleOrder, TapTool,
    Tool, ToolKind, ToolLibrary,
};
use interp::{Ops, Setup, Subprogram};
use units::{Angle, Lead, Length, Spin, SpinAccel, Stiffness, Time};

fn tool(number: u32, length: f64, kind: ToolKind) -> Tool {
    Tool {
        number,
        pocket: number,
        length: Length::mm(length),
        diameter: Length::mm(6.0),
        kind,
        description: String::new(),
        stand_in: false,
    }
}

fn m6() -> ToolKind {
    ToolKind::Tap(TapTool {
        designation: "M6x1".into(),
        lead: Lead::mm_per_rev(1.0),
        chamfer_pitches: 2.5,
        thread_length: Length::mm(20.0),
        flute: canon::Flute::SpiralFlute,
        oversize: Length::um(20.0),
        holder: Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
    })
}

fn shop() -> Setup {
    let tools = ToolLibrary::new([tool(1, 80.0, ToolKind::EndMill), tool(2, 100.0, m6())]);
    Setup { tools, ..Setup::default() }
}

/// The operations of a program that must be free of errors.
#[track_caller]
fn ops_of(setup: &Setup, program: &str) -> Vec<Op> {
    let program = format!("{program}\nM2\n");
    let mut ops = Ops::new(program.as_bytes(), setup);
    let all: Vec<Op> = ops.by_ref().collect();
    assert!(!ops.has_errors(), "{:?}", ops.diagnostics());
    all
}

/// The ends of all rapids and lines, X Y Z in mm.
fn ends(ops: &[Op]) -> Vec<[f64; 3]> {
    let end = |op: &Op| match &op.kind {
        OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } => {
            Some(to.linear.map(Length::value))
        }
        _ => None,
    };
    ops.iter().filter_map(end).collect()
}

#[track_caller]
fn near(found: &[[f64; 3]], wanted: &[[f64; 3]]) {
    let close = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-9);
    assert!(
        found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| close(a, b)),
        "{found:?}"
    );
}

#[track_caller]
fn the_tap(ops: &[Op]) -> canon::Tap {
    let mut taps =
        ops.iter().filter_map(|op| if let OpKind::Tap(tap) = op.kind { Some(tap) } else { None });
    let tap = taps.next().expect("a tap");
    assert!(taps.next().is_none(), "one tap only");
    tap
}

#[track_caller]
fn refused(setup: &Setup, program: &str, code: &str) -> diag::Diagnostic {
    let found = interp::check(format!("{program}\nM2\n").as_bytes(), setup);
    let fault = found.iter().find(|d| d.code == code);
    fault.unwrap_or_else(|| panic!("expected {code}, found {found:?}")).clone()
}

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
    // Chord 6, radius 5: the centre is 4 from the chord; left of it for a short counter-clockwise arc.
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
fn g84_is_one_tap_whose_lead_is_feed_over_speed() {
    let program = "T2 M6\nG43\nG10 L2 P1 X100 Y100 Z-400\nS1000 M3 F1000\nG0 Z5\nG98 G84 X10 Y20 Z-12 R2\nG80";
    let ops = ops_of(&shop(), program);
    let tap = the_tap(&ops);
    assert_eq!(tap.start.linear.map(Length::value), [110.0, 120.0, -298.0]);
    assert_eq!((tap.bottom, tap.surface), (Length::mm(-312.0), Length::mm(-300.0)));
    assert_eq!(
        (tap.lead, tap.spin, tap.return_spin),
        (Lead::mm_per_rev(1.0), Spin::rpm(1000.0), Spin::rpm(1000.0))
    );
    assert_eq!(tap.start_angle, Some(Angle::ZERO));
    assert_eq!(
        ends(&ops).last(),
        Some(&[110.0, 120.0, -295.0]),
        "G98 goes back to the initial level"
    );
}

#[test]
fn g84_with_feed_per_revolution_takes_f_as_its_lead_and_g74_is_left_hand() {
    let ops = ops_of(&shop(), "G95 F1.25 S800 M3\nG0 Z5\nG99 G84 Z-10 R2 P0.5");
    assert_eq!(the_tap(&ops).lead, Lead::mm_per_rev(1.25));
    assert_eq!(the_tap(&ops).dwell, Time::s(0.5));
    let ops = ops_of(&shop(), "G95 F1.25 S800 M4\nG0 Z5\nG99 G74 Z-10 R2");
    assert_eq!(the_tap(&ops).lead, Lead::mm_per_rev(-1.25));
}

#[test]
fn g33_1_starts_where_the_axis_stands_at_the_index_and_comes_back_there() {
    let ops = ops_of(&shop(), "G20 S500 M3\nG0 X1 Z0.2\nG33.1 Z-0.5 K0.05 I2\nG0 Z1");
    let tap = the_tap(&ops);
    assert!((tap.start.linear[2].value() - 5.08).abs() < 1e-12);
    assert!((tap.bottom.value() + 12.7).abs() < 1e-12);
    assert!(tap.surface.value().abs() < 1e-12);
    assert!((tap.lead.value() - 1.27).abs() < 1e-12);
    assert_eq!(
        (tap.spin, tap.return_spin, tap.start_angle),
        (Spin::rpm(500.0), Spin::rpm(1000.0), Some(Angle::ZERO))
    );
}

#[test]
fn m4_into_minus_z_is_a_left_hand_thread() {
    assert_eq!(
        the_tap(&ops_of(&shop(), "S500 M4\nG0 Z2\nG33.1 Z-5 K1")).lead,
        Lead::mm_per_rev(-1.0)
    );
}

#[test]
fn an_xy_word_inside_a_tap_is_refused_with_its_place() {
    let fault = refused(&shop(), "S500 M3\nG0 X10 Y4 Z5\nG33.1 X12 Y6 Z-20 K1.25", "I0705");
    assert!(fault.is_error());
    assert_eq!(fault.span.line, 3);
    assert_eq!(fault.message, "a tap moves along one axis, but this one would move X and Y and Z");
}

#[test]
fn a_tap_without_p_waits_as_long_as_the_last_cycle_that_did() {
    let drilled = "S800 M3 F1000\nG0 Z5\nG82 X1 Z-1 R2 P.25\nG81 X2 R2 Z-1\nG80";
    let tap = the_tap(&ops_of(&shop(), &format!("{drilled}\nG84 X3 Z-10 R2")));
    assert_eq!(tap.dwell, units::Time::s(0.25));
    let tap = the_tap(&ops_of(&shop(), &format!("{drilled}\nG84 X3 Z-10 R2 P0")));
    assert_eq!(tap.dwell, units::Time::ZERO);
    let fanuc = Setup { dialect: interp::Dialect::Fanuc, ..shop() };
    let tap =
        the_tap(&ops_of(&fanuc, "S800 M3 F1000\nG0 Z5.\nG82 X1. Z-1. R2. P250\nG84 X3. Z-10. R2."));
    assert_eq!(tap.dwell, units::Time::ZERO);
}

#[test]
fn a_tap_without_f_takes_the_pitch_of_the_tap_and_says_so() {
    let program = "T2 M6\nM29 S1000\nG0 Z5\nM29 S1000\nG84 Z-10 R2\nX10\nG80";
    let found = refused(&shop(), program, "I0534");
    assert_eq!(found.span.line, 3, "the move between M29 and its cycle");
    let ops = ops_of(&shop(), "T2 M6\nG0 Z5\nM29 S1000\nG99 G84 Z-10 R2");
    assert_eq!(the_tap(&ops).lead, Lead::mm_per_rev(1.0));
    let note = refused(&shop(), "T2 M6\nG0 Z5\nM29 S1000\nG99 G84 Z-10 R2\nX3\nX6", "I0712");
    assert_eq!(
        (note.span.line, note.message.as_str()),
        (4, "no F is in force: the lead is that of T2 (M6x1), 1 mm per revolution")
    );
    let inches = ops_of(&shop(), "G20 T2 M6\nG0 Z1\nM29 S1000\nG99 G84 Z-0.5 R0.1");
    assert_eq!(the_tap(&inches).lead, Lead::mm_per_rev(1.0), "a pitch has its own unit");
}

#[test]
fn m29_needs_no_m3_and_holds_for_the_holes_of_its_cycle() {
    let program = "T2 M6\nG95 F1\nG0 Z5\nM29 S1000\nG99 G84 X0 Z-10 R2\nX10\nX20\nG80";
    let taps = ops_of(&shop(), program).iter().filter(|o| matches!(o.kind, OpKind::Tap(_))).count();
    assert_eq!(taps, 3);
    refused(&shop(), "T2 M6\nG95 F1 S1000\nG0 Z5\nG99 G84 X0 Z-10 R2", "I0512");
    let again = "T2 M6\nG95 F1\nG0 Z5\nM29 S1000\nG99 G84 X0 Z-10 R2\nG80\nG84 X10 Z-10 R2";
    assert_eq!(refused(&shop(), again, "I0512").span.line, 7, "G80 ends rigid mode");
}

#[test]
fn g84_2_and_g84_3_are_rigid_by_themselves_right_and_left_hand() {
    let start = "G95 F1.25 S800\nG0 Z5\nG99";
    let right = ops_of(&shop(), &format!("{start} G84.2 Z-10 R2"));
    assert_eq!(the_tap(&right).lead, Lead::mm_per_rev(1.25));
    let left = ops_of(&shop(), &format!("{start} G84.3 Z-10 R2"));
    assert_eq!(the_tap(&left).lead, Lead::mm_per_rev(-1.25));
}

#[test]
fn a_tap_takes_its_start_angle_its_return_speed_and_its_pecks_from_words() {
    let program = |words: &str| format!("G95 F1.25 S800 M3\nG0 Z5\nG99 G84 Z-10 R2 {words}");
    let tap = the_tap(&ops_of(&shop(), &program("A90 J2 Q4")));
    assert_eq!(tap.start_angle, Some(Angle::rev(0.25)));
    assert_eq!(tap.return_spin, Spin::rpm(1600.0));
    assert_eq!(tap.peck, Some(Length::mm(4.0)));
    assert_eq!(the_tap(&ops_of(&shop(), &program("J1500"))).return_spin, Spin::rpm(1500.0));
    assert_eq!(the_tap(&ops_of(&shop(), &program(""))).peck, None);
    let acceleration = |words: &str| the_tap(&ops_of(&shop(), &program(words))).return_acceleration;
    assert_eq!(acceleration(""), ReturnAcceleration::AsSet);
    assert_eq!(acceleration("I1"), ReturnAcceleration::AsSet);
    assert_eq!(acceleration("I0.4"), ReturnAcceleration::Share(0.4));
    assert_eq!(acceleration("I250"), ReturnAcceleration::Limit(SpinAccel::rev_per_s2(250.0)));
    let wild = refused(&shop(), &program("I0.001"), "I0539");
    assert!(wild.message.contains("0.01 to 1") && wild.message.ends_with("found 0.001"));
    refused(&shop(), &program("J0"), "I0535");
    refused(&shop(), &program("Q-1"), "I0536");
    let small = refused(&shop(), &program("Q0.01"), "I0538");
    assert_eq!(small.message, "Q0.01 would make more than 200 pecks: at least 0.06 is needed");
    let inch = "G20 G95 F0.05 S800 M3\nG0 Z1\nG99 G84 Z-0.5 R0.1 Q0.2";
    assert!((the_tap(&ops_of(&shop(), inch)).peck.unwrap().value() - 5.08).abs() < 1e-12);
}

#[test]
fn the_plane_cannot_change_in_rigid_mode_and_g96_has_no_place_in_it() {
    let start = "G95 F1\nG0 X5 Y5 Z5\nM29 S1000\n";
    assert_eq!(refused(&shop(), &format!("{start}G18\nG84 Z-10 R2"), "I0533").span.line, 4);
    refused(&shop(), &format!("{start}G99 G84 Z-10 R2\nG18 Y-10 R2"), "I0533");
    refused(&shop(), "G96 S100 M3\nM29 S1000", "I0531");
    refused(&shop(), "M29", "I0532");
    assert!(ops_of(&shop(), &format!("{start}G99 G84 Z-10 R2\nG80 G18")).len() > 3);
}

#[test]
fn a_missing_tool_is_refused_with_those_there_are() {
    let fault = refused(&shop(), "T7 M6", "I0611");
    assert_eq!(fault.message, "tool 7 is not in the tool table");
    assert_eq!(fault.help.as_deref(), Some("it has 1, 2"));
}

#[test]
fn all_errors_come_at_once_each_with_its_line() {
    let found = interp::check(b"G1 X1\nG2 X1\nQ5\nG12\nG1 X[1/0] F1\nX#<nothing>\nM2\n", &shop());
    let lines: Vec<_> = found.iter().map(|d| (d.span.line, d.code)).collect();
    assert_eq!(
        lines,
        [(1, "I0408"), (2, "I0411"), (3, "I0110"), (4, "I0102"), (5, "I0203"), (6, "I0207")]
    );
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
fn a_program_that_is_cut_off_is_refused() {
    let found = interp::check(b"G0 X1\nG0 X2", &shop());
    assert_eq!(found.iter().map(|d| (d.code, d.span.line)).collect::<Vec<_>>(), [("I0301", 2)]);
}

#[test]
fn an_endless_loop_is_stopped_by_a_stated_limit() {
    let mut setup = shop();
    setup.limits.blocks = 1000;
    let fault = refused(&setup, "o1 while [1]\n#1=[#1+1]\no1 endwhile", "I0803");
    assert_eq!(fault.message, "stopped after 1000 blocks: does this loop end?");
}

#[test]
fn a_subprogram_that_calls_itself_for_ever_is_stopped() {
    let fault = refused(&shop(), "o1 sub\no1 call\no1 endsub\no1 call", "I0801");
    assert_eq!(fault.message, "subprograms call each other more than 64 levels deep");
}

#[test]
fn subprograms_take_arguments_give_values_back_and_keep_their_own_parameters() {
    let program = "#1=7 #<mine>=3\no<twice> sub\n#<mine>=1\no<twice> endsub [#1*2]\no<twice> call [21]\nG0 X#<_value> Y#1 Z#<mine>";
    near(&ends(&ops_of(&shop(), program)), &[[42.0, 7.0, 3.0]]);
}

#[test]
fn loops_and_branches_go_where_they_should() {
    let program = "o1 repeat [3]\n#5=[#5+1]\no2 if [#5 EQ 2]\no1 continue\no2 elseif [#5 EQ 3]\nG0 Y#5\no2 else\nG0 X#5\no2 endif\no1 endrepeat\n\
                   o3 do\n#5=[#5+1]\no4 if [#5 GT 5]\no3 break\no4 endif\no3 while [1]\nG0 Z#5";
    near(&ends(&ops_of(&shop(), program)), &[[1.0, 0.0, 0.0], [1.0, 3.0, 0.0], [1.0, 3.0, 6.0]]);
}

#[test]
fn o_words_that_do_not_match_are_all_reported_before_any_is_executed() {
    let found = interp::check(b"o1 if [1]\no2 endif\no3 while [1]\nM2\n", &shop());
    assert_eq!(found.iter().map(|d| d.code).collect::<Vec<_>>(), ["I0305", "I0308", "I0305"]);
}

#[test]
fn m98_calls_a_program_as_often_as_l_says() {
    near(
        &ends(&ops_of(&shop(), "G91\nM98 P100 L3\nM2\nO100\nG0 X1\nM99")),
        &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]],
    );
}

#[test]
fn a_subprogram_may_be_a_file_of_its_own() {
    let mut setup = shop();
    setup.subprograms.push(Subprogram {
        name: "go".into(),
        source: b"o<go> sub\nG0 X#1\no<go> endsub\nM2\n".to_vec(),
    });
    let program = "o<go> call [4]\nG0 Y1";
    near(&ends(&ops_of(&setup, program)), &[[4.0, 0.0, 0.0], [4.0, 1.0, 0.0]]);
    assert_eq!(interp::called_files(program.as_bytes(), gcode::Grammar::Rs274), ["go"]);
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
fn a_loop_whose_counting_fails_does_not_run_for_ever() {
    let found = interp::check(b"o1 while [#1 LT 5]\n#1=[#1+1/0]\no1 endwhile\nM2\n", &shop());
    assert_eq!(found.iter().map(|d| d.code).collect::<Vec<_>>(), ["I0203"]);
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
fn block_delete_leaves_out_what_begins_with_a_stroke() {
    let program = "/G0 X1\nG0 X2";
    near(&ends(&ops_of(&shop(), program)), &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    near(&ends(&ops_of(&Setup { block_delete: true, ..shop() }, program)), &[[2.0, 0.0, 0.0]]);
}

#[test]
fn pockets_are_those_of_the_tool_table() {
    let mut nine = tool(5, 80.0, ToolKind::EndMill);
    nine.pocket = 9;
    let mut setup = shop();
    setup.tools = ToolLibrary::new([nine, tool(4, 90.0, ToolKind::EndMill)]);
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
fn a_profile_with_an_error_is_not_cut_however_often_it_is_called() {
    let program = "G18 F400\nO100 SUB\nG0 X10 Z0\nG1 Z-10\nX16 Z[1/0]\nZ-15\nO100 ENDSUB\nG7\n\
        G0 X28 Z4\nG70 Q100\nG70 Q100\nM2\n";
    let setup = shop();
    let mut ops = Ops::new(program.as_bytes(), &setup);
    let all: Vec<Op> = ops.by_ref().collect();
    assert_eq!(ops.diagnostics().iter().map(|d| d.code).collect::<Vec<_>>(), ["I0203"]);
    assert!(all.iter().all(|op| !matches!(op.kind, OpKind::Line { .. })), "{all:?}");
}
