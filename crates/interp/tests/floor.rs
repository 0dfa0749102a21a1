//! What programs of the shop floor write, and what must not be read as something else without a
//! word.
use canon::{Hole, OpKind};
use interp::{Dialect, MissingTools, Ops, Setup};

fn setup(dialect: Dialect) -> Setup {
    Setup { dialect, missing_tools: MissingTools::StandIn, ..Setup::default() }
}

fn ops(text: &str, dialect: Dialect) -> Vec<OpKind> {
    let setup = setup(dialect);
    let mut ops = Ops::new(text.as_bytes(), &setup);
    let kinds = ops.by_ref().map(|op| op.kind).collect();
    let found: Vec<_> = ops.diagnostics().into_iter().filter(diag::Diagnostic::is_error).collect();
    assert!(found.is_empty(), "{text}: {found:?}");
    kinds
}

fn places(kinds: &[OpKind]) -> Vec<[f64; 3]> {
    let ends = kinds.iter().filter_map(|kind| match kind {
        OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } => Some(to),
        _ => None,
    });
    ends.map(|to| to.linear.map(units::Length::value)).collect()
}

fn holes(text: &str, dialect: Dialect) -> Vec<Hole> {
    let kinds = ops(text, dialect).into_iter();
    kinds.filter_map(|kind| if let OpKind::Hole(hole) = kind { Some(hole) } else { None }).collect()
}

#[test]
fn blank_lines_and_comments_before_the_percent_sign_are_no_program() {
    for head in ["", "\n", "\r\n \r\n", "(made by a post)\n", "; made by a post\n\n(today)\n"] {
        for dialect in Dialect::ALL {
            let is_fanuc = dialect.grammar() == gcode::Grammar::Fanuc;
            let number = if is_fanuc { "O1\n" } else { "" };
            let text = format!("{head}%\n{number}G21 G90\nG0 X10.\nM30\n%\nwhatever follows\n");
            let found = places(&ops(&text, dialect));
            assert!(!found.is_empty(), "{head:?} in {} is empty", dialect.name());
        }
    }
}

#[test]
fn a_percent_sign_behind_blocks_ends_the_program_and_its_subprograms() {
    let kinds = ops("G21 G90\nG0 X10\n%\nG0 X20\nM2\n", Dialect::LinuxCnc);
    assert_eq!(places(&kinds).len(), 1);
    let setup = setup(Dialect::LinuxCnc);
    let text = "%\nG21 G90\no100 call\n%\no100 sub\nG0 X1\no100 endsub\nM2\n";
    let mut ops = Ops::new(text.as_bytes(), &setup);
    assert_eq!(places(&ops.by_ref().map(|op| op.kind).collect::<Vec<_>>()), [[0.0; 3]; 0]);
    assert!(ops.diagnostics().iter().any(diag::Diagnostic::is_error), "o100 is not there");
}

#[test]
fn comments_stand_between_the_arguments_of_a_call() {
    let text = "o100 sub\nG0 X#1 Y#2\no100 endsub\nG21 G90\no100 call (x) [1] (y) [2] (done)\nM2\n";
    assert_eq!(places(&ops(text, Dialect::LinuxCnc)), [[1.0, 2.0, 0.0]]);
}

/// Fanuc: of the block that sets an offset, its own G90 or G91 counts, and not the one of a block
/// before.
#[test]
fn an_offset_is_set_or_added_to_as_its_own_block_says() {
    let z = |offsets: &str| {
        let text = format!("O1\nG21 G90\n{offsets}\nG90 G0 G43 H1 Z0.\nM30\n");
        places(&ops(&text, Dialect::Fanuc)).last().unwrap()[2]
    };
    assert!((z("G10 L10 P1 R100.\nG91 G10 L10 P1 R-0.1") - 99.9).abs() < 1e-9);
    assert!((z("G91\nG90 G10 L10 P1 R100.\nG90 G10 L10 P1 R50.") - 50.0).abs() < 1e-9);
    let x = |offsets: &str| {
        let text = format!("O1\nG21 G90 G54\n{offsets}\nG90 G0 X1.\nM30\n");
        places(&ops(&text, Dialect::Fanuc)).last().unwrap()[0]
    };
    assert!((x("G10 L2 P1 X10.\nG91 G10 L2 P1 X5.") - 16.0).abs() < 1e-9);
    assert!((x("G91 G10 L2 P1 X10.\nG90 G10 L2 P1 X5.") - 6.0).abs() < 1e-9);
}

/// Fanuc: R and Z that a cycle keeps lie where they were meant, though G90 or G91 comes between.
#[test]
fn a_cycle_keeps_its_levels_when_it_goes_on_in_increments() {
    let levels = |cycle: &str| -> Vec<[f64; 3]> {
        let text = format!("O1\nG21 G90 G94 F100 S500 M3\nG0 X0 Y0 Z50.\n{cycle}\nG80\nM30\n");
        let holes = holes(&text, Dialect::Fanuc).into_iter();
        holes
            .map(|hole| {
                [hole.at.linear[0], hole.at.linear[2], hole.bottom].map(units::Length::value)
            })
            .collect()
    };
    let row: Vec<_> = (0..4).map(|i| [10.0 * f64::from(i), 2.0, -10.0]).collect();
    assert_eq!(levels("G99 G81 X0 Y0 Z-10. R2.\nG91 X10. K3"), row);
    assert_eq!(levels("G91 G99 G81 X0 Y0 Z-12. R-48.\nG90 X10.\nX20.\nX30."), row);
    // a word that is written anew means what is in force with it
    let deeper = levels("G99 G81 X0 Y0 Z-10. R2.\nG91 X10. Z-15.");
    assert_eq!(deeper, [[0.0, 2.0, -10.0], [10.0, 2.0, -13.0]]);
}

#[test]
fn holes_on_a_circle_stay_on_it_however_many_one_block_makes() {
    let text = "O1\nG21 G90 G94 F100 S500 M3\nG0 X0 Y0 Z50.\nG16\nG99 G81 X20. Y0 Z-10. R2.\nG91 Y60. K5\nG15 G80\nM30\n";
    let holes = holes(text, Dialect::Fanuc);
    assert_eq!(holes.len(), 6);
    for (i, hole) in (0..).zip(&holes) {
        let angle = (60.0 * f64::from(i)).to_radians();
        let [x, y, z] = hole.at.linear.map(units::Length::value);
        assert!(
            (x - 20.0 * angle.cos()).abs() < 1e-9 && (y - 20.0 * angle.sin()).abs() < 1e-9,
            "{i}: {x} {y}"
        );
        assert!((z - 2.0).abs() < 1e-9, "{z}");
    }
}

/// Without a radius the tool is led on the programmed way: no corner is rounded, none is too
/// narrow.
#[test]
fn a_cutter_of_no_radius_is_led_on_the_programmed_way() {
    let corners = "X20\nY20\nX40\nY10\nG2 X60 Y10 I10 J0\nG1 X60 Y-20\nX0";
    let plain =
        ops(&format!("G21 G90 F100\nG0 X0 Y0\nG1 X10 Y0\n{corners}\nM2\n"), Dialect::LinuxCnc);
    for side in ["G41.1 D0", "G42.1 D0"] {
        let text = format!("G21 G90 F100\nG0 X0 Y0\n{side}\nG1 X10 Y0\n{corners}\nG40\nM2\n");
        assert_eq!(places(&ops(&text, Dialect::LinuxCnc)), places(&plain), "{side}");
    }
}

/// Fanuc: in brackets a number is an expression, and counts whole units; alone, without a point, it
/// counts increments.
#[test]
fn a_number_in_brackets_counts_whole_units() {
    let x =
        |word: &str| places(&ops(&format!("O1\nG21 G90\nG0 {word}\nM30\n"), Dialect::Fanuc))[0][0];
    for (word, wanted) in [
        ("X[1]", 1.0),
        ("X-[1]", -1.0),
        ("X[1.]", 1.0),
        ("X[0.5+0.5]", 1.0),
        ("X1", 0.001),
        ("X1.", 1.0),
    ] {
        assert!((x(word) - wanted).abs() < 1e-12, "{word}: {}", x(word));
    }
}

/// Fanuc's lathe: nose 3 points to the chuck and to the axis, as an insert for turning along a bar
/// does.
#[test]
fn the_nose_of_a_turning_tool_lies_where_fanuc_numbers_it() {
    let end = |nose: u32, side: &str| {
        let text = format!(
            "O1\nG21 G18 G97 S500 M3\nG98 F100\nG10 P10001 R1. Q{nose}\nT0101\nG0 X30. Z5.\n{side} G1 X20. Z2.\nZ-30.\nG40 X40.\nM30\n"
        );
        let found = places(&ops(&text, Dialect::FanucLatheA));
        let along = found.iter().find(|place| (place[2] + 30.0).abs() < 3.0).unwrap();
        2.0 * along[0]
    };
    // on the cylinder the imagined tip is on the programmed diameter; tip 2 is on the other side of
    // the nose
    assert!((end(3, "G42") - 20.0).abs() < 1e-6, "{}", end(3, "G42"));
    assert!((end(4, "G42") - 20.0).abs() < 1e-6, "{}", end(4, "G42"));
    assert!((end(2, "G42") - 24.0).abs() < 1e-6, "{}", end(2, "G42"));
    assert!((end(8, "G42") - 20.0).abs() < 1e-6 && (end(0, "G42") - 22.0).abs() < 1e-6);
    // what a macro reads is what was written
    let text = "O1\nG21\nG10 P10001 R1. Q3\nG0 X#2301\nM30\n";
    assert!((2.0 * places(&ops(text, Dialect::FanucLatheA))[0][0] - 3.0).abs() < 1e-12);
}

#[test]
fn a_format_of_print_has_as_many_decimals_as_linuxcnc_writes() {
    let text = "#1=1.23456789\n(print,#1 %f#1 %d#1 %.2f#1)\nM2\n";
    let said = ops(text, Dialect::LinuxCnc).into_iter().find_map(|kind| match kind {
        OpKind::Message(text) => Some(text.to_string()),
        _ => None,
    });
    assert_eq!(said.unwrap().trim(), "1.234568 1.2346 1 1.23");
}

/// Fanuc: what a profile's blocks say of the side of the way is meant where G70 finishes it, as if
/// they stood there alone.
#[test]
fn a_profile_is_finished_on_the_side_that_its_blocks_say() {
    let head = "O1\nG21 G18 G97 S500 M3\nG98 F100\nG10 P10001 R1. Q3\nT0101\nG0 X50. Z2.\n";
    let profile = "N10 G0 G42 X20.\nG1 Z-20.\nX40. Z-30.\nZ-40.\n";
    for last in ["N20 G40 X50.\n", "N20 X50.\n"] {
        let finish = "G71 U2. R1.\nG71 P10 Q20 U0.5 W0.1\n";
        let rest = "G70 P10 Q20\nM30\n";
        let cycle = format!("{head}{finish}{profile}{last}{rest}");
        let alone = format!("{head}{profile}{last}G40 G0 X50. Z2.\nM30\n");
        let [cycle, alone] = [cycle, alone].map(|text| places(&ops(&text, Dialect::FanucLatheA)));
        // from the profile's begin to the end of its last cylinder
        let wanted = &alone[1..alone.len() - 3];
        let found = cycle.windows(wanted.len()).filter(|part| part == &wanted).count();
        assert_eq!(found, 1, "{wanted:?} in {cycle:?}");
    }
}

/// All that is found in a program of a dialect, errors and remarks, by their codes.
fn found(text: &str, dialect: Dialect) -> Vec<&'static str> {
    let setup = setup(dialect);
    let mut ops = Ops::new(text.as_bytes(), &setup);
    ops.by_ref().for_each(drop);
    ops.diagnostics().iter().map(|finding| finding.code).collect()
}

#[test]
fn g28_takes_the_axis_words_beside_a_motion_which_is_in_force_afterwards() {
    for block in ["G0 G91 G28 Z0", "G91 G28 G0 Z0.", "G28G91G0Z0"] {
        let text = format!("O1\nG90 G1 X1. Y2. Z3. F100\n{block}\nG90 X7.\nM30\n");
        let kinds = ops(&text, Dialect::Fanuc);
        let rapids = kinds.iter().filter(|kind| matches!(kind, OpKind::Rapid { .. })).count();
        assert_eq!(places(&kinds).last(), Some(&[7.0, 2.0, 0.0]), "{block}");
        assert!(rapids >= 2, "{block}: X7 goes by rapid as well: {kinds:?}");
    }
}

#[test]
fn an_arc_that_says_nothing_of_its_circle_goes_straight_and_stays_an_arc() {
    let text = "O1\nG90 G1 X0 Y0 F100\nG3 X10. Y0 R5.\nX20.\nX30. R5.\nM30\n";
    let kinds = ops(text, Dialect::Fanuc);
    let arcs = kinds.iter().filter(|kind| matches!(kind, OpKind::Arc { .. })).count();
    assert_eq!((arcs, places(&kinds).len()), (2, 3), "{kinds:?}");
    assert_eq!(found(text, Dialect::Fanuc), ["I0419"]);
    assert!(found("G1 X1 F9\nG3 X10\nM2\n", Dialect::LinuxCnc).contains(&"I0411"));
}

#[test]
fn words_that_no_code_takes_are_left_out_and_said_once_for_each_letter() {
    let text = "O1\nT1 M6\nG43 H1 D1 Z50.\nF100.\nG81 X1. Z-5. R2. Q.5\nX2. Q.5\nG83 X3. Z-5. R2. Q1. P500\nM30\n";
    assert_eq!(found(text, Dialect::Fanuc), ["I0113", "I0113", "I0113"]);
    assert_eq!(holes(text, Dialect::Fanuc).len(), 3);
    assert!(found("G0 X1 Q5\nM2\n", Dialect::LinuxCnc).contains(&"I0110"));
}

#[test]
fn a_lathe_calls_its_tool_beside_m6_and_ends_its_tape_behind_m30() {
    let text = "O1\nT0101 M06\nG0 X20. Z5.\nM30%\n";
    assert_eq!(places(&ops(text, Dialect::FanucLatheA)).len(), 1);
}

#[test]
fn two_letters_of_a_macros_words_are_enough() {
    let text = "O1\n#1=0\nWH[#1LT3]DO1\n#1=#1+1\nG0 X#1\nEN1\nIF[#1EQ3]GO20\nG0 X99.\nN20 M30\n";
    assert_eq!(
        places(&ops(text, Dialect::Fanuc)),
        [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]
    );
    // the letter O in the place of a zero is no jump
    assert!(found("O1\nGO X5.\nM30\n", Dialect::Fanuc).contains(&"P0101"));
}

#[test]
fn a_file_may_end_in_the_mark_of_old_systems() {
    for end in ["\u{1a}", "\r\n\u{1a}\u{1a}\0\0", "\n \u{1a}\n"] {
        let text = format!("G0 X1\nM2{end}");
        assert_eq!(places(&ops(&text, Dialect::LinuxCnc)).len(), 1, "{end:?}");
    }
    assert!(found("G0 X1\u{1a}\nG0 X2\nM2\n", Dialect::LinuxCnc).contains(&"P0192"));
}

#[test]
fn the_last_rapid_of_a_profile_takes_the_tool_away_and_is_none_of_its_shape() {
    let turned = |last: &str| {
        format!(
            "O1\nS500 M3\nG0 X32. Z1.\nG71 U2. R1.\nG71 P10 Q20 U0.2 W0.1 F0.2\nN10 G0 X10.\nG1 Z-10.\nX20.\nZ-20.\nX32.\n{last}\nM30\n"
        )
    };
    let with = places(&ops(&turned("N20 G0 G40 Z1."), Dialect::FanucLatheA));
    let without = places(&ops(&turned("N20 X32."), Dialect::FanucLatheA));
    assert_eq!(with, without);
    // by feed it is a part of the shape, which runs back; the place is said as it is programmed
    let setup = setup(Dialect::FanucLatheA);
    let text = turned("N20 G1 Z-5.");
    let mut ops = Ops::new(text.as_bytes(), &setup);
    ops.by_ref().for_each(drop);
    let back = ops.diagnostics().into_iter().find(|finding| finding.code == "I0585").unwrap();
    assert!(back.message.ends_with("diameter 32.0000 Z-5.0000"), "{}", back.message);
}

#[test]
fn h_names_the_tools_radius_where_no_d_stands() {
    let with = |block: &str| {
        format!(
            "O1\nG90 G10 L12 P19 R3.\nG10 L12 P18 R0\nG0 X0 Y0\n{block}\nG1 X50. Y10. F100\nX60.\nG40 G0 X80.\nM30\n"
        )
    };
    let beside = places(&ops(&with("G42 D19"), Dialect::Fanuc));
    assert_eq!(places(&ops(&with("G42 H19"), Dialect::Fanuc)), beside);
    assert_ne!(places(&ops(&with("G42 D18"), Dialect::Fanuc)), beside);
    let longer = "O1\nG91 G10 L12 P14 R3.\nG0 G45 X10. H14\nM30\n";
    assert_eq!(places(&ops(longer, Dialect::Fanuc)), [[13.0, 0.0, 0.0]]);
}

#[test]
fn behind_a_semicolon_stands_a_block_or_a_comment() {
    for dialect in [Dialect::Fanuc, Dialect::Haas, Dialect::Mitsubishi] {
        let text = "O1\nG21 G90; mm mode\nG0 X1.; G0 X2.; over there\n; drilling at (1, 2)\nIF[1 EQ 1]THEN #1=3.;GOTO 5\nN5 X#1;\nM30\n";
        let found = places(&ops(text, dialect));
        assert_eq!(found.iter().map(|at| at[0]).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
    }
    assert!(found("O1\nG0 X1.; over there\nM30\n", Dialect::Fanuc).contains(&"P0197"));
}

/// A file of an old Macintosh or of a control that ends its lines with CR alone.
#[test]
fn lines_may_end_with_a_bare_carriage_return() {
    for dialect in [Dialect::LinuxCnc, Dialect::Fanuc, Dialect::Grbl] {
        let number = if dialect == Dialect::Fanuc { "O1\r" } else { "" };
        let mut text = format!("{number}G21 G90\rG0 X1.\rX2.\rM30\r").into_bytes();
        gcode::end_lines_with_lf(&mut text);
        let text = String::from_utf8(text).unwrap();
        assert_eq!(places(&ops(&text, dialect)).len(), 2);
    }
    assert_eq!(places(&ops("G21 G90\r\r\nG0 X1.\r\r\nM2\r\r\n", Dialect::LinuxCnc)).len(), 1);
    let mut mixed = b"G0 X1\r\nG0 \rX2\n".to_vec();
    gcode::end_lines_with_lf(&mut mixed);
    assert_eq!(mixed, b"G0 X1\r\nG0 \rX2\n", "a CR among other line ends is a slip, and is said");
}

#[test]
fn numbers_without_a_point_that_make_no_sense_are_said_once() {
    let whole = "O1\nF100\nG0 X50 Y40 Z5\nG1 Z-5\nX100\nM30\n";
    let said = found(whole, Dialect::Fanuc);
    assert_eq!(said.iter().filter(|code| **code == "I1068").count(), 1);
    let is_said = |text: &str, calculator: bool| {
        let setup = Setup { whole_units_without_point: calculator, ..setup(Dialect::Fanuc) };
        interp::check(text.as_bytes(), &setup).iter().any(|finding| finding.code == "I1068")
    };
    assert!(!is_said(whole, true));
    let increments = "O1\nF100\nG0 X50000 Y40000 Z5000\nG1 Z-5000\nM30\n";
    assert!(is_said(increments, true) && !is_said(increments, false));
    // with points nothing is to be guessed, and few words tell nothing
    assert!(!is_said("O1\nG0 X50. Y40. Z5.\nX0.5 Y1.\nM30\n", false));
    assert!(!is_said("O1\nG0 X50 Y40\nM30\n", false));
    let reason = interp::counts_whole_units(whole.as_bytes(), &setup(Dialect::Fanuc)).unwrap();
    assert_eq!(
        reason,
        "5 of 5 axis words have none, and the largest of them, X100 in line 5, is 0.1 mm"
    );
}

#[test]
fn s_of_a_dwell_is_seconds_to_grbls_kin() {
    let dwell = |text: &str| {
        let kinds = ops(text, Dialect::Grbl);
        kinds.iter().find_map(|kind| match kind {
            OpKind::Dwell { time } => Some(time.value()),
            _ => None,
        })
    };
    assert_eq!(dwell("G4 S2\n"), Some(2.0));
    assert_eq!(dwell("G4 P0.5\n"), Some(0.5));
}

#[test]
fn what_stands_beside_the_percent_sign_is_skipped_and_said() {
    let text = "%O0003( 300-11 FIXTURE)\nG21 G90\nG0 X10.\nM30\n%\n";
    assert_eq!(places(&ops(text, Dialect::Fanuc)), [[10.0, 0.0, 0.0]]);
    assert_eq!(found(text, Dialect::Fanuc), ["P0198"]);
    assert!(found(text, Dialect::LinuxCnc).contains(&"P0110"), "LinuxCNC refuses it");
}

/// Operator's manual of series 30i, "Reference position return in cutter compensation": the vector
/// is cancelled in the movement to the intermediate point (CCN of parameter 5003 is 0), and
/// restored by a start-up after the return.
#[test]
fn g28_ends_the_compensation_on_its_way_and_starts_it_up_again_behind() {
    let head = "O1\nG21 G90 G54 G17\nG10 L12 P1 R5.\nG0 X0 Y0\nG1 G41 D1 X10. Y0 F100.\nX40.\n";
    // X is named: it is at the programmed X50 in the intermediate point, Y stays beside the path
    let text = format!("{head}G28 X50.\nG1 X60. Y20.\nX80.\nG40 X90.\nM30\n");
    let found = places(&ops(&text, Dialect::Fanuc));
    let [.., end, by, home, beside, _, _] = found[..] else { panic!("{found:?}") };
    assert_eq!(end, [40.0, 5.0, 0.0], "5 mm on the left of the way along X");
    assert_eq!(by, [50.0, 5.0, 0.0]);
    assert_eq!(home[1..], [5.0, 0.0]);
    assert_eq!(beside, [60.0, 25.0, 0.0], "started up, beside the move along X that follows");
    // without an axis of the plane the tool stays where it is, and Z alone goes home
    let text = format!("{head}G1 Z-20.\nG0 G91 G28 Z0\nM30\n");
    let found = places(&ops(&text, Dialect::Fanuc));
    assert_eq!(found[found.len() - 2..], [[40.0, 5.0, -20.0], [40.0, 5.0, 0.0]]);
}

#[test]
fn turns_and_periods_of_a_polygon_are_whole_numbers_with_a_point_or_without() {
    for dialect in [Dialect::Fanuc, Dialect::Haas, Dialect::Mitsubishi] {
        for words in ["P1 Q2", "P1. Q2.", "P2 Q4"] {
            let text = format!("%\nO1\nG21 G90\nS500 M3\nG251 {words}\nG250\nM30\n%\n");
            let kinds = ops(&text, dialect);
            let ratio = kinds.iter().find_map(|kind| match kind {
                OpKind::Polygon(polygon) => Some(polygon.ratio.value()),
                _ => None,
            });
            assert_eq!(ratio, Some(2.0), "{words} in {}", dialect.name());
        }
    }
}

/// Haas, mill operator's manual, G84 and G74: the control starts the spindle itself.
#[test]
fn a_haas_starts_the_spindle_of_a_tap_by_itself() {
    for (before, block) in [
        ("", "G84 Z-15. R3. F500. S500"),
        ("S500", "G84 Z-15. R3. F500."),
        ("G95 S500", "G84 Z-15. R3. F1."),
        ("S500", "G74 Z-15. R3. F500."),
        ("S500 M03", "G84 Z-15. R3. F500."),
    ] {
        let text = format!("%\nO1\nG21 G90\nG00 X0. Y0. Z10.\n{before}\n{block}\nG80\nM30\n%\n");
        let kinds = ops(&text, Dialect::Haas);
        let taps = kinds.iter().filter(|kind| matches!(kind, OpKind::Tap(_)));
        assert_eq!(taps.count(), 1, "{before} {block}");
    }
}

#[test]
fn a_link_of_no_length_with_k0_does_nothing() {
    let text = "G21 G90 G18\nS100 M3\nG0 X10 Z2\nG33 X10 Z2 K0\nG33 X10 Z1 K1\nM2\n";
    let kinds = ops(text, Dialect::LinuxCnc);
    let links = kinds.iter().filter(|kind| matches!(kind, OpKind::Threading(_)));
    assert_eq!(links.count(), 1);
    let setup = setup(Dialect::LinuxCnc);
    for (link, code) in [("G33 X10 Z1 K0", "I0426"), ("G33 K0", "I0423")] {
        let text = format!("G21 G90 G18\nS100 M3\nG0 X10 Z2\n{link}\nM2\n");
        let mut ops = Ops::new(text.as_bytes(), &setup);
        ops.by_ref().for_each(drop);
        assert!(ops.diagnostics().iter().any(|found| found.code == code), "{link}");
    }
}

/// Grbl 1.1, `gcode.c`: G53 is absolute whatever the distance mode is.
#[test]
fn a_grbl_takes_a_machine_coordinate_under_g91() {
    let text = "G21 G91 G94\nG10 L2 P1 X50 Y0 Z0\nG53 G0 X-5\nX2\nM2\n";
    assert_eq!(places(&ops(text, Dialect::Grbl)), [[-5.0, 0.0, 0.0], [-3.0, 0.0, 0.0]]);
}

#[test]
fn a_rigid_tap_that_is_refused_moves_nothing() {
    let setup = setup(Dialect::LinuxCnc);
    let mut ops = Ops::new(b"G21 G90\nG0 X20 Y20 Z5\nG33.1 Z-10 K1\nG0 X0\nM2\n", &setup);
    let found = places(&ops.by_ref().map(|op| op.kind).collect::<Vec<_>>());
    assert_eq!(found, [[20.0, 20.0, 5.0], [0.0, 20.0, 5.0]]);
    let codes: Vec<_> = ops.diagnostics().iter().map(|found| found.code).collect();
    assert_eq!(codes, ["I0427"]);
}

/// Operator's manual of series 30i: P and Q of a polygon are integers, as are blocks, programs,
/// teeth and degrees of an orientation; the least input increment is none of them.
#[test]
fn words_that_count_are_read_alike_with_a_point_and_without() {
    // each row of the table, as a program: `{}` stands for the point
    let programs = |code: &str, is_lathe: bool| -> &'static [&'static str] {
        match code {
            "G10" if is_lathe => &["G10 P1{} X1. Z1. R1. Q3{}\nG0 X#2001 Z#2301"],
            "G10" => &["G90 G10 L2{} P1{} X5.\nG90 G0 X0 Y0"],
            "G30" => &["G91 G30 P2{} Z0"],
            "G54.1" => &["G54.1 P3{}\nG0 X1."],
            "G51.2" => &["S500 M3\nG51.2 P1{} Q2{}\nG50.2", "S500 M3\nG51.2 P2{} Q6{}\nG50.2"],
            "G251" => &["S500 M3\nG251 P1{} Q2{}\nG250"],
            "G51.4" => &["S500 M3\nG51.2 P1 Q2\nG51.4 P4{}\nG50.2"],
            "G51.3" => &["S500 M3\nG51.2 P1 Q2\nG51.3 L6{} A0.81\nG50.2"],
            "G65" | "G66" => &["G65 P9010{} L2{} A1.\nM30\nO9010\nG91 G0 X#1\nM99"],
            "M98" => &[
                "M98 P20{} L3{}\nM30\nO20\nG0 W1.\nM99",
                "M98 P20{} Q5{}\nM30\nO20\nG0 X9.\nN5 G0 X1.\nM99",
            ],
            "M99" => &["M98 P20\nG0 X5.\nN7 G0 X1.\nM30\nO20\nM99 P7{}"],
            "M19" => &["M19 R90{}"],
            "G81" => &["S300 M3\nG81 T40{} L1{} Q2{} P20{}\nG80"],
            "G70" | "G71" | "G72" | "G73" | "G74" | "G75" if is_lathe => &[
                "S500 M3\nG0 X32. Z1.\nG71 U2. R1.\nG71 P10{} Q20{} U0.2 W0.1 F0.2\nN10 G0 X10.\nG1 Z-10.\nN20 X32.\nG70 P10{} Q20{}",
            ],
            _ => &[],
        }
    };
    for dialect in Dialect::ALL {
        let is_lathe = dialect.has_turret();
        for (code, letters) in interp::counting_words(dialect) {
            if matches!(code.as_str(), "M97" | "M198")
                || dialect == Dialect::FanucLatheC && code.starts_with("G7")
            {
                continue; // M97 is Haas' alone, a file is not at hand, and C writes G72 for G70
            }
            let texts = programs(&code, is_lathe);
            assert!(
                !texts.is_empty(),
                "{code} {letters} of {} has no program here",
                dialect.name()
            );
            for text in texts {
                let text =
                    if is_lathe { text.replace("G91 ", "") } else { text.replace(" W1.", " X1.") };
                let both = ["", "."].map(|point| {
                    let text = format!("O1\nG21\n{}\nM30\n", text.replace("{}", point));
                    let setup = setup(dialect);
                    let mut ops = Ops::new(text.as_bytes(), &setup);
                    let kinds: Vec<_> = ops.by_ref().map(|op| format!("{:?}", op.kind)).collect();
                    let codes: Vec<_> = ops
                        .diagnostics()
                        .iter()
                        .map(|d| d.code)
                        .filter(|code| *code != "I1023")
                        .collect();
                    (kinds, codes)
                });
                assert_eq!(both[0], both[1], "{code} {letters} of {}: {text}", dialect.name());
            }
        }
    }
}

#[test]
fn words_that_count_are_what_they_say() {
    let hobs = |text: &str| {
        let kinds = ops(&format!("O1\nG21 G90\nS300 M3\n{text}\nG80\nM30\n"), Dialect::Fanuc);
        kinds.into_iter().find_map(|kind| match kind {
            OpKind::Hob(hob) => {
                Some((hob.teeth, hob.starts, hob.module.value(), hob.helix.in_deg()))
            }
            _ => None,
        })
    };
    for text in ["G81 T40 L1 Q2 P20", "G81 T40. L1. Q2. P20.", "G81 L1 Q2 T40 P20"] {
        let (teeth, starts, module, helix) = hobs(text).unwrap();
        assert_eq!((teeth, starts, module), (40, 1, 2.0), "{text}");
        assert!((helix - 20.0).abs() < 1e-9, "{text}");
    }
    let degrees = |text: &str, dialect| {
        ops(&format!("O1\n{text}\nM30\n"), dialect).into_iter().find_map(|kind| match kind {
            OpKind::Spindle { order: canon::SpindleOrder::Orient { to, .. }, .. } => {
                Some(to.angle.in_deg())
            }
            _ => None,
        })
    };
    for (text, dialect) in [
        ("M19 R90", Dialect::Fanuc),
        ("M19 R90.", Dialect::Fanuc),
        ("M19 P90", Dialect::Haas),
        ("M19 R90.", Dialect::Haas),
        ("M19 R90", Dialect::Mitsubishi),
    ] {
        let found = degrees(text, dialect).unwrap();
        assert!((found - 90.0).abs() < 1e-9, "{text} in {}: {found}", dialect.name());
    }
    // a depth and a wait are none of them
    let text =
        "O1\nG21 G90 G94 F100 S500 M3\nG0 Z50.\nG99 G83 X0 Y0 Z-10000 R2000 Q3000\nG80\nM30\n";
    let hole = holes(text, Dialect::Fanuc)[0];
    assert_eq!([hole.at.linear[2], hole.bottom].map(units::Length::value), [2.0, -10.0]);
}

/// Fanuc, multiple repetitive cycles: no M98, M99, G65 or G66 between the first and the last block
/// of a profile.
#[test]
fn a_call_inside_of_a_profile_is_refused_with_its_place() {
    let text = |cycle: &str, inside: &str| {
        format!(
            "O1\nG21 G40 G97 G99\nS500 M03\nG00 X60. Z2. F0.2\n{cycle}\nN10 G00 X20.\nG01 Z-10. F0.2\n{inside}\nN20 X50.\nM30\nO349\nG01 X30. Z-25.\nM99\n"
        )
    };
    let cycles = [
        "G71 U2. R1.\nG71 P10 Q20 U0.4 W0.1 F0.2",
        "G72 W2. R1.\nG72 P10 Q20 U0.4 W0.1 F0.2",
        "G73 U5. W5. R3\nG73 P10 Q20 U0.4 W0.1 F0.2",
        "G70 P10 Q20",
    ];
    for cycle in cycles {
        for inside in [
            "M98 P349",
            "M98 P0349 L2",
            "M98 P1234",
            "G65 P349 A1.",
            "G66 P349",
            "G1 X25. M98 P349",
        ] {
            if inside == "M98 P1234" && cycle.starts_with("G70") {
                continue; // behind a G70 its profile's blocks are executed once more, by themselves
            }
            let text = text(cycle, inside);
            let setup = setup(Dialect::FanucLatheA);
            let mut ops = Ops::new(text.as_bytes(), &setup);
            ops.by_ref().for_each(drop);
            let found = ops.diagnostics();
            let errors: Vec<_> = found.iter().filter(|d| d.is_error()).collect();
            let line = text.lines().position(|line| line == inside).unwrap() as u32 + 1;
            assert_eq!(errors.len(), 1, "{cycle}: {inside}: {errors:?}");
            assert_eq!((errors[0].code, errors[0].span.line), ("I1033", line), "{cycle}: {inside}");
        }
        let plain = text(cycle, "G01 X30. Z-25.");
        assert!(!found(&plain, Dialect::FanucLatheA).contains(&"I1033"), "{cycle}");
    }
    // beside the profile a call is one
    let beside = "O1\nG21 G97 G99\nS500 M3\nM98 P349\nM30\nO349\nG0 X60. Z2.\nG71 U2. R1.\nG71 P10 Q20 U0.4 W0.1 F0.2\nN10 G0 X20.\nG1 Z-10.\nN20 X50.\nM99\n";
    assert!(places(&ops(beside, Dialect::FanucLatheA)).len() > 5);
}

/// Fanuc's label skip: what comes before the first end of block behind the percent sign is no
/// program.
#[test]
fn the_leader_of_a_tape_is_skipped() {
    let tape = "%\nO0001 (PART)\nG21 G90\nG0 X10.\nM30\n%\n";
    let nuls = "\0".repeat(64);
    for (head, tail, said) in [
        (nuls.as_str(), nuls.as_str(), false),
        ("\0\0\r\n\0\0\r\n", "\0\0", false),
        ("", "\r\n\0\0\0\r\n\0", false),
        ("setup sheet for part 7\nclamp left\n", "", true),
        ("PART NO 4711 REV B\r\n\r\nT1 = DRILL 6\r\n", "", true),
        ("program 12, Meier\n(a comment)\n", "whatever\n", true),
        ("X100 Y50 Z20\n", "", true), // the size of the blank: behind the sign a numbered program begins
        ("\0\0\0setup of part 7\n", "\0\0\0", true),
        ("M10X1.5 GEWINDE\n", "", true),
        ("From: DNC server\n\n", "", true),
    ] {
        for dialect in [Dialect::Fanuc, Dialect::Haas, Dialect::Mitsubishi, Dialect::FanucLatheA] {
            let text = format!("{head}{tape}{tail}");
            let along = places(&ops(&text, dialect))[0][0];
            let wanted = if dialect.has_turret() { 5.0 } else { 10.0 };
            assert_eq!(along, wanted, "{head:?} in {}", dialect.name());
            assert_eq!(found(&text, dialect).contains(&"P0198"), said, "{head:?}");
        }
    }
    // a place in the text is where it was
    let text = "setup\nsheet\n%\nO1\nG0 X1.\nG777\nM30\n%\n";
    let all = interp::check(text.as_bytes(), &setup(Dialect::Fanuc));
    assert!(all.iter().any(|d| d.code == "I0102" && d.span.line == 6), "{all:?}");
}

#[test]
fn what_can_be_a_program_is_no_leader() {
    // no sign at the begin; a sign between two tapes; a block that nothing numbered follows
    for text in
        ["O1\nG21 G90\nG0 X10.\nM30\n%\n", "O1\nG21 G90\nG0 X10.\nM30\n%\nO2\nG0 X20.\nM30\n%\n"]
    {
        assert_eq!(places(&ops(text, Dialect::Fanuc)), [[10.0, 0.0, 0.0]], "{text}");
    }
    assert!(
        found("G21 G90 oops\n%\nG0 X1.\nM30\n%\n", Dialect::LinuxCnc)
            .iter()
            .any(|c| c.starts_with('P'))
    );
    assert!(
        found("G0 X1.\0\0Y2.\nM30\n", Dialect::Fanuc).contains(&"P0191"),
        "NULs within a program"
    );
    assert!(found("\0G\x000\0 \0X\x001\0\n\0", Dialect::Fanuc).contains(&"P0191"), "UTF-16");
}

/// Grbl 1.1, `gcode.c`, and grblHAL: errors 20 to 38. Each row: what fails there, the code here;
/// and a neighbour that works there.
#[test]
fn what_grbl_answers_with_an_error_is_said() {
    let head = "G21 G90 G94\nF100\nM3 S1000\nG0 X10 Y0 Z5\n";
    for (number, block, code, neighbour) in [
        (20, "G20.5 X1", "I0102", "G20"),
        (20, "G31 Z-1", "I0102", "G38.2 Z-1"),
        (20, "G41 D1 X12", "I0115", "G40 X12"),
        (20, "G52 X1", "I0115", "G92 X1"),
        (20, "G84 X1 Y1 Z-5 R1", "I0115", "G81 X1 Y1 Z-5 R1"),
        (20, "G90.1", "I0115", "G91.1"),
        (21, "G0 G1 X1", "I0104", "G1 X1"),
        (21, "M3 M5", "I0107", "M5"),
        (22, "G93\nG1 X1", "I0407", "G93\nG1 X1 F2"),
        (23, "M3.5", "I0105", "M3"),
        (23, "T1.5 M6", "I0610", "T1 M6"),
        (24, "G92 G1 X1", "I0111", "G1 X1"),
        (25, "G1 X1 X2", "P0105", "G1 X1"),
        (26, "G92", "I0613", "G92 X0"),
        (26, "G3 I-4.5", "I0435", "G3 X10 Y0 I-4.5"),
        (26, "G2 J5 F50", "I0435", "G2 X10 Y0 J5 F50"),
        (26, "G38.2", "I0570", "G38.2 Z-1"),
        (27, "N10000000 G0 X1", "I0436", "N9999999 G0 X1"),
        (27, "N-5 G0 X1", "P0101", "N5 G0 X1"),
        (28, "G4", "I0609", "G4 P1"),
        (28, "G10 L2 X1", "I0617", "G10 L2 P1 X1"),
        (29, "G59.4", "I0102", "G59"),
        (30, "G53 G2 X10 Y0 I5 J0", "I0401", "G53 G0 X10"),
        (31, "G80\nX1", "I0109", "G0 X1"),
        (32, "G2 Z1 I5", "I0435", "G2 X10 Y0 Z1 I5"),
        (32, "G18 G3 Y1 K5", "I0435", "G18 G3 X10 Z5 K5"),
        (33, "G2 X100 Y0 R5", "I0418", "G2 X20 Y0 R5"),
        (35, "G2 X20 Y0", "I0411", "G2 X20 Y0 I5"),
        (36, "G0 X1 I5", "I0112", "G0 X1"),
        (36, "G1 X1 R3", "I0110", "G1 X1"),
        (37, "G43.1", "I0435", "G43.1 Z5"),
        (38, "T-1", "I0610", "T1"),
    ] {
        let wrong = found(&format!("{head}{block}\nM30\n"), Dialect::Grbl);
        assert!(wrong.contains(&code), "error {number}: {block}: {wrong:?}");
        let setup = setup(Dialect::Grbl);
        let text = format!("{head}{neighbour}\nM30\n");
        let right = interp::check(text.as_bytes(), &setup);
        assert!(!right.iter().any(|d| d.is_error() || d.code == code), "{neighbour}: {right:?}");
    }
    let full = "G20\nG90\nG17\nG0 X10.375 Y5.8438\nM3 S1000\nG3 I-4.5312 F100.0\nM30\n";
    let all = interp::check(full.as_bytes(), &setup(Dialect::Grbl));
    assert_eq!(all.iter().map(|d| d.code).collect::<Vec<_>>(), ["I0435"]);
    assert!(all[0].help.as_deref().unwrap().contains("X10.375 Y5.8438 works"), "{all:?}");
    assert!(!found(full, Dialect::LinuxCnc).contains(&"I0435"), "LinuxCNC has full circles");
}

#[test]
fn probing_tells_no_more_of_linuxcnc_than_of_grbl() {
    for code in ["G38.2", "G38.3", "G38.4", "G38.5"] {
        let text = format!("G21 G90\nG0 Z3\nF100 {code} Z-10\nG92 Z0\nM30\n");
        assert_eq!(interp::looks_like(text.as_bytes(), Dialect::Grbl), None, "{code}");
        assert_eq!(interp::looks_like(text.as_bytes(), Dialect::LinuxCnc), None, "{code}");
    }
}

#[test]
fn a_code_of_mach3_has_its_name_in_the_finding() {
    for (block, what) in [
        ("G31 Z-1 F50", "Mach3"),
        ("G12 I5", "Mach3"),
        ("G68 A0 B0 R45", "Mach3"),
        ("G16", "Mach3"),
    ] {
        for dialect in [Dialect::Grbl, Dialect::LinuxCnc] {
            let text = format!("G21\n{block}\nM30\n");
            let all = interp::check(text.as_bytes(), &setup(dialect));
            let named = all.iter().find(|d| d.code == "I0102").unwrap();
            assert!(named.message.contains(what), "{block}: {}", named.message);
        }
    }
}

/// Compensation by a radius that nothing states is refused, with what states it; what a comment,
/// the program or the block states is what the tool is led by.
#[test]
fn a_mill_is_led_by_the_radius_that_something_states_or_is_refused() {
    let mill = |number: u32, diameter: f64| canon::Tool {
        number,
        pocket: number,
        length: units::Length::ZERO,
        diameter: units::Length::mm(diameter),
        kind: canon::ToolKind::EndMill(canon::Mill::default()),
        description: "T3 D=12. - flat end mill".into(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: true,
    };
    let read = |dialect: Dialect, side: &str, described: bool| {
        let mut setup = setup(dialect);
        setup.missing_tools = interp::MissingTools::StandIn;
        if described {
            setup.tools.insert(mill(3, 12.0));
        }
        let number = if dialect.grammar() == gcode::Grammar::Fanuc { "O1\n" } else { "" };
        let text = format!(
            "{number}G21 G90 G17\nT3 M6\nG0 X0. Y0. Z5.\n{side}\nG1 X20. Y0. F100.\nX60.\nG40\nG0 X80. Y40.\nM30\n"
        );
        let mut ops = Ops::new(text.as_bytes(), &setup);
        let kinds: Vec<_> = ops.by_ref().map(|op| op.kind).collect();
        let codes: Vec<_> = ops.diagnostics().iter().map(|found| found.code).collect();
        let beside = places(&kinds).iter().any(|at| (at[1] - 6.0).abs() < 1e-9);
        (codes, beside)
    };
    for dialect in [
        Dialect::LinuxCnc,
        Dialect::Grbl,
        Dialect::Brother,
        Dialect::Fanuc,
        Dialect::Haas,
        Dialect::Mitsubishi,
    ] {
        let name = dialect.name();
        for side in ["G41 D3", "G42 D3"] {
            assert!(read(dialect, side, false).0.contains(&"I0574"), "{name} {side}");
            assert!(!read(dialect, side, true).0.contains(&"I0574"), "{name} {side}");
        }
        assert!(read(dialect, "G41 D3", true).1, "{name}: 6 mm beside the way");
        assert!(read(dialect, "G41 D7", true).0.contains(&"I0574"), "{name}: D7 is another one");
    }
    for (side, codes) in [("G10 L12 P3 R6.\nG41 D3", true), ("G10 L12 P7 R6.\nG41 D7", true)] {
        assert_eq!(read(Dialect::Fanuc, side, false).1, codes, "{side}");
    }
    assert!(read(Dialect::LinuxCnc, "G41.1 D12", false).1);
    assert!(read(Dialect::LinuxCnc, "G10 L1 P3 R6\nG41 D3", false).1, "the program writes it");
}

/// A message is of its own block, whatever stands before it and whatever leads to it.
#[test]
fn a_message_has_the_line_of_its_block() {
    for (text, line) in [
        ("O1\nG21 G90\n\n\nG0 X1.\n\n\n#3006=1(TURN THE PART)\n\nG0 X2.\nM30\n", 8),
        ("O1\nG0 X1.\nIF [1 EQ 1] THEN #3006=1(TURN THE PART)\nM30\n", 3),
        ("O1\nG0 X1.\nN7 #3006=1(TURN THE PART)\nM30\n", 3),
    ] {
        for dialect in [Dialect::Fanuc, Dialect::Haas, Dialect::Mitsubishi, Dialect::FanucLatheA] {
            let setup = setup(dialect);
            let mut ops = Ops::new(text.as_bytes(), &setup);
            let found = ops.find(|op| matches!(op.kind, OpKind::Message(_))).unwrap();
            assert_eq!(found.span.line, line, "{text} in {}", dialect.name());
        }
    }
}

/// What a comment states of an offset, and what the built-in table has, is said once.
#[test]
fn what_leads_a_tool_that_no_table_of_the_shop_states_is_said_once() {
    let text = "G21 G17 G90\nS1000 M3\nG0 X0 Y0\nG41 D3\nG1 X20 Y0 F100\nX60\nG40\nG0 X80 Y40\nG42 D3\nG1 X100 Y40\nX140\nG40\nG0 X160 Y60\nM2\n";
    let mill = |stand_in| canon::Tool {
        number: 3,
        pocket: 3,
        length: units::Length::ZERO,
        diameter: units::Length::mm(12.0),
        kind: canon::ToolKind::EndMill(canon::Mill::default()),
        description: "T3 D=12. FLAT END MILL".into(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in,
    };
    let read = |stand_in, has_example_tools, wear: interp::WearOffsets| {
        let setup = Setup {
            tools: canon::ToolLibrary::new([mill(stand_in)]),
            has_example_tools,
            wear_offsets: wear,
            ..setup(Dialect::LinuxCnc)
        };
        let mut ops = Ops::new(text.as_bytes(), &setup);
        let kinds: Vec<_> = ops.by_ref().map(|op| op.kind).collect();
        let found = ops.diagnostics();
        let said = found.iter().filter(|found| found.code == "I0575").count();
        assert!(!found.iter().any(diag::Diagnostic::is_error), "{found:?}");
        (said, places(&kinds).iter().any(|at| (at[1] - 6.0).abs() < 1e-9))
    };
    let none = interp::WearOffsets::default;
    let wear = |all: bool| interp::WearOffsets {
        all: all.then(|| "WEAR COMP".into()),
        of: (!all).then(|| (3, "D3 WEAR".into())).into_iter().collect(),
    };
    assert_eq!(read(false, false, none()), (0, true), "the shop's own table");
    assert_eq!(read(true, false, none()), (1, true), "a comment states it");
    assert_eq!(read(false, true, none()), (1, true), "the built-in table has it");
    for all in [true, false] {
        assert_eq!(read(true, false, wear(all)), (1, false), "it is led on the way");
    }
}
