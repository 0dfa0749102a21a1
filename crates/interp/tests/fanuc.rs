//! Fanuc's dialect: programs as its manuals describe them, and what they come to by arithmetic.
use canon::{Feed, OpKind, SpindleOrder};
use interp::{Dialect, Limits, MissingTools, Ops, Setup};

fn setup(dialect: Dialect) -> Setup {
    let limits = Limits { blocks: 20_000, ..Limits::default() };
    Setup { dialect, limits, missing_tools: MissingTools::StandIn, ..Setup::default() }
}

fn ops_with(program: &str, setup: &Setup) -> (Vec<OpKind>, Vec<String>) {
    let mut ops = Ops::new(program.as_bytes(), setup);
    let kinds = ops.by_ref().map(|op| op.kind).collect();
    let found = ops.diagnostics();
    let findings = found.iter().map(|d| format!("{}@{} {}", d.code, d.span.line, d.message));
    (kinds, findings.collect())
}

/// Where the axes go, rapidly or not, of a program without errors.
fn places_of(dialect: Dialect, program: &str) -> Vec<[f64; 3]> {
    let (kinds, findings) = ops_with(program, &setup(dialect));
    let refused: Vec<_> = findings.iter().filter(|f| !f.starts_with("I1023")).collect();
    assert!(refused.is_empty(), "{refused:#?}");
    let places = kinds.iter().filter_map(|kind| match kind {
        OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } => {
            Some(to.linear.map(units::Length::value))
        }
        _ => None,
    });
    places.collect()
}

fn places(program: &str) -> Vec<[f64; 3]> {
    places_of(Dialect::Fanuc, program)
}

#[track_caller]
fn goes_to(program: &str, wanted: &[[f64; 3]]) {
    close(&places(program), wanted);
}

#[track_caller]
fn close(found: &[[f64; 3]], wanted: &[[f64; 3]]) {
    let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    let same = found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| near(a, b));
    assert!(same, "found {found:?}, wanted {wanted:?}");
}

#[track_caller]
fn is_told(program: &str, code: &str) {
    let (_, findings) = ops_with(program, &setup(Dialect::Fanuc));
    assert!(findings.iter().any(|f| f.starts_with(code)), "{code} is not among {findings:#?}");
}

#[test]
fn a_number_without_a_point_counts_thousandths_and_says_so() {
    goes_to(
        "O1\nG0 X10\nX10.\nY-2500\nM30\n",
        &[[0.01, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, -2.5, 0.0]],
    );
    is_told("O1\nG0 X10\nM30\n", "I1023@2");
    goes_to("O1\nG20\nG0 X10000\nM30\n", &[[25.4, 0.0, 0.0]]);
    let calculator = Setup { whole_units_without_point: true, ..setup(Dialect::Fanuc) };
    let (kinds, findings) = ops_with("O1\nG0 X10\nM30\n", &calculator);
    assert!(findings.is_empty());
    assert!(
        kinds.iter().any(|k| matches!(k, OpKind::Rapid { to } if to.linear[0].value() == 10.0))
    );
}

#[test]
fn a_dwell_counts_milliseconds_by_p_and_seconds_by_x() {
    let (kinds, findings) =
        ops_with("O1\nG4 P1500\nG4 X1.5\nG04 X250\nM30\n", &setup(Dialect::Fanuc));
    assert!(findings.is_empty(), "{findings:#?}");
    let waits = kinds.iter().filter_map(|k| match k {
        OpKind::Dwell { time } => Some(time.value()),
        _ => None,
    });
    let waits: Vec<f64> = waits.collect();
    assert_eq!(waits, [1.5, 1.5, 0.25]);
    is_told("O1\nG4 P1.5\nM30\n", "I1020");
}

#[test]
fn a_macro_gets_its_arguments_by_both_ways() {
    // A, I, J, K and again I, J, K: #1, #4 #5 #6, #7 #8 #9
    let program = "O1\nG65 P2 A1. I2. J3. K4. I5. J6. K7.\nG65 P3 D1. Z2. F3.\nM30\n\
        O2\nG0 X#1 Y#4 Z#5\nX#6 Y#7 Z#8\nX#9\nM99\nO3\nG0 X#7 Y#26 Z#9\nM99\n";
    goes_to(program, &[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 5.0, 6.0], [1.0, 2.0, 3.0]]);
}

#[test]
fn a_macros_variables_are_its_own_and_common_ones_are_not() {
    let program = "O1\n#1=5.\n#100=1.\nG65 P2 A9.\nG0 X#1 Y#100\nM30\nO2\n#100=#1+1.\n#1=7.\nM99\n";
    goes_to(program, &[[5.0, 10.0, 0.0]]);
}

#[test]
fn a_variable_without_a_value_makes_its_word_vanish_and_is_not_zero() {
    goes_to("O1\nG0 X1. Y2.\nG0 X#1 Y3.\nM30\n", &[[1.0, 2.0, 0.0], [1.0, 3.0, 0.0]]);
    let program = "O1\nIF [#1 EQ #0] THEN #2=1.\n#1=0\nIF [#1 EQ #0] THEN #2=8.\nG0 X#2\nM30\n";
    goes_to(program, &[[1.0, 0.0, 0.0]]);
}

#[test]
fn goto_searches_on_and_then_from_the_programs_begin() {
    let program = "O1\n#1=1\nGOTO 20\nN10 G0 X9.\nM30\nN20 G0 X1.\nIF [#1 GT 0] GOTO 10\nM30\nO2\nN10 G0 Y9.\nM99\n";
    goes_to(program, &[[1.0, 0.0, 0.0], [9.0, 0.0, 0.0]]);
    is_told("O1\nGOTO 77\nM30\n", "I1006");
}

#[test]
fn loops_nest_and_end() {
    // 3 · 2 steps of 1 mm
    let program = "O1\nG91\n#1=0\nWHILE[#1LT3]DO1\n#2=0\nWHILE[#2LT2]DO2\nG0X1.\n#2=#2+1\nEND2\n#1=#1+1\nEND1\nM30\n";
    assert_eq!(places(program).last().unwrap()[0], 6.0);
    is_told("O1\nWHILE [1 EQ 1] DO1\nM30\n", "I1004");
    is_told("O1\nDO1\nEND2\nM30\n", "I1003");
    is_told("O1\nDO1\nEND1\nM30\n", "I0803");
}

#[test]
fn functions_are_fanucs_own() {
    let value = |expression: &str| {
        let program = format!("O1\n#500={expression}\nG0 X#500\nM30\n");
        places(&program).last().map_or(0.0, |p| p[0])
    };
    for (expression, wanted) in [
        ("FIX[-1.2]", -1.0), // towards zero
        ("FUP[-1.2]", -2.0),
        ("ROUND[1.5]", 2.0),
        ("ATAN[-1]/[-1]", 225.0),
        ("ATAN[1]/[-1]", 135.0),
        ("ATAN[-1]", -45.0),
        ("BCD[12]", 18.0),
        ("BIN[18]", 12.0),
        ("6 AND 3", 2.0),
        ("6 OR 3", 7.0),
        ("6 XOR 3", 5.0),
        ("2+3*4", 14.0),
        ("1 OR 2 AND 2", 3.0),
        ("-7 MOD 3", -1.0),
        ("SQRT[16]+ABS[-2]", 6.0),
        ("EXP[LN[7]]", 7.0),
        ("SIN[30]+COS[60]+TAN[45]", 2.0),
        ("ASIN[1]-ACOS[1]", 90.0),
    ] {
        let found = value(&format!("[{expression}]"));
        assert!((found - wanted).abs() < 1e-9, "{expression} is {wanted}, found {found}");
    }
}

#[test]
fn subprograms_repeat_by_l_or_by_the_long_p() {
    let tail = "M30\nO1002\nG91 G0 X1.\nM99\n";
    assert_eq!(places(&format!("O1\nM98 P1002 L4\n{tail}")).last().unwrap()[0], 4.0);
    assert_eq!(places(&format!("O1\nM98 P51002\n{tail}")).last().unwrap()[0], 5.0);
    is_told("O1\nM98 P7\nM30\n", "I0313");
}

#[test]
fn m99_p_goes_on_elsewhere_in_the_caller() {
    goes_to("O1\nM98 P2\nG0 X1.\nN50 G0 Y2.\nM30\nO2\nM99 P50\n", &[[0.0, 2.0, 0.0]]);
}

#[test]
fn a_modal_macro_follows_each_move() {
    let program = "O1\nG66 P2 Z-3.\nG0 X1.\nX2.\nG67\nX3.\nM30\nO2\nG0 Z#26\nZ0\nM99\n";
    goes_to(
        program,
        &[
            [1.0, 0.0, 0.0],
            [1.0, 0.0, -3.0],
            [1.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 0.0, -3.0],
            [2.0, 0.0, 0.0],
            [3.0, 0.0, 0.0],
        ],
    );
}

#[test]
fn m29_taps_without_m3_and_k_repeats() {
    let program =
        "O1\nT3 M6\nG0 Z10.\nM29 S800\nG91 G99 G84 X5. Z-12. R-8. P250 F1000. K3\nG80\nM30\n";
    let (kinds, _) = ops_with(program, &setup(Dialect::Fanuc));
    let taps = kinds.iter().filter_map(|k| match k {
        OpKind::Tap(tap) => Some((
            tap.start.linear[0].value(),
            tap.bottom.value(),
            tap.lead.value(),
            tap.dwell.value(),
        )),
        _ => None,
    });
    let taps: Vec<_> = taps.collect();
    // lead 1000/800 mm; R 8 below 10, Z 12 below R
    assert_eq!(
        taps,
        [(5.0, -10.0, 1.25, 0.25), (10.0, -10.0, 1.25, 0.25), (15.0, -10.0, 1.25, 0.25)]
    );
}

#[test]
fn a_semicolon_ends_a_block() {
    goes_to("O1;G0 X1.;Y2.; (A;B)\nM30;\n", &[[1.0, 0.0, 0.0], [1.0, 2.0, 0.0]]);
}

#[test]
fn blocks_are_skipped_by_level() {
    let program = "O1\n/G0 X1.\n/2 G0 Y2.\nM30\n";
    let with = |levels: u16, first: bool| {
        let setup =
            Setup { block_delete: first, block_delete_levels: levels, ..setup(Dialect::Fanuc) };
        ops_with(program, &setup).0.iter().filter(|k| matches!(k, OpKind::Rapid { .. })).count()
    };
    assert_eq!(
        [with(0, false), with(1 << 2, false), with(0, true), with(1 << 2, true)],
        [2, 1, 1, 0]
    );
}

#[test]
fn g10_sets_offsets_and_system_variables_read_positions() {
    let program = "O1\nG10 L2 P1 X10. Y20. Z0\nG54 G0 X1. Y1.\n#100=#5021\n#101=#5041\n#5221=30.\nG0 X#101 Y#100\nM30\n";
    goes_to(program, &[[11.0, 21.0, 0.0], [31.0, 31.0, 0.0]]);
}

#[test]
fn alarms_and_stops_speak() {
    is_told(
        "O1\n#3000=21 (TOOL TOO SHORT)\nM30\n",
        "I0316@2 the program stops itself with alarm 3021: TOOL TOO SHORT",
    );
    let (kinds, _) = ops_with("O1\n#3006=1 (TURN THE PART)\nM30\n", &setup(Dialect::Fanuc));
    assert!(kinds.contains(&OpKind::Message("TURN THE PART".into())));
    assert!(kinds.contains(&OpKind::Pause { optional: false }));
}

#[test]
fn what_is_not_known_or_has_no_effect_is_said() {
    is_told("O1\nG5.7 Q1\nM30\n", "I0102");
    is_told("O1\nM77\nM30\n", "I0105");
    is_told("O1\nG68.2\nM30", "I0103");
    is_told("O1\nG1 X1. F100. E3\nM30\n", "I0110");
    is_told("O1\nG1 X1. F100. H3\nM30\n", "I0113");
    is_told("O1\nG0 X1. I2. I3.\nM30\n", "I0101");
    is_told("O1\n#<name>=1\nM30\n", "I1011");
    is_told("O1\nG0 X1.\nO2\nM30\n", "I0301");
}

#[test]
fn a_lathe_reads_diameters_increments_and_cycles() {
    // system A: G90 turns from X30 Z2 down to diameter 20, to Z-10; then a deeper pass
    let program = "O1\nG50 S2500\nG96 S150 M3\nG0 X30. Z2.\nU-2. W-1.\nX30. Z2.\nG90 X20. Z-10. F0.2\nX16.\nM30\n";
    close(
        &places_of(Dialect::FanucLatheA, program),
        &[
            [15.0, 0.0, 2.0],
            [14.0, 0.0, 1.0],
            [15.0, 0.0, 2.0],
            [10.0, 0.0, 2.0],
            [10.0, 0.0, -10.0],
            [15.0, 0.0, -10.0],
            [15.0, 0.0, 2.0],
            [8.0, 0.0, 2.0],
            [8.0, 0.0, -10.0],
            [15.0, 0.0, -10.0],
            [15.0, 0.0, 2.0],
        ],
    );
    let (kinds, _) = ops_with(program, &setup(Dialect::FanucLatheA));
    let feeds = kinds.iter().filter_map(|k| match k {
        OpKind::Line { feed: Feed::PerRevolution(lead), .. } => Some(lead.value()),
        _ => None,
    });
    assert!(feeds.eq([0.2; 4]));
    let limited = kinds.iter().any(|k| matches!(k, OpKind::Spindle { order: SpindleOrder::ConstantSurfaceSpeed { limit: Some(limit), .. }, .. } if (limit.in_rpm() - 2500.0).abs() < 1e-9));
    assert!(limited, "{kinds:?}");
}

#[test]
fn systems_a_and_b_say_the_same_in_other_codes() {
    let a = places_of(Dialect::FanucLatheA, "O1\nG98\nG0 X30. Z2.\nG94 X10. Z-1. F100.\nM30\n");
    let b = places_of(Dialect::FanucLatheB, "O1\nG94\nG90 G0 X30. Z2.\nG79 X10. Z-1. F100.\nM30\n");
    close(&a, &b);
    close(&a[1..], &[[15.0, 0.0, -1.0], [5.0, 0.0, -1.0], [5.0, 0.0, 2.0], [15.0, 0.0, 2.0]]);
}

#[test]
fn threads_of_a_lathe_follow_the_spindle_from_the_index_on() {
    for (program, passes) in [
        ("O1\nG97 S500 M3\nG0 X22. Z3.\nG92 X19. Z-20. F1.5\nX18.6\nM30\n", 2),
        ("O1\nG97 S500 M3\nG0 X19. Z3.\nG32 Z-20. F1.5\nM30\n", 1),
    ] {
        let (ops, findings) = ops_with(program, &setup(Dialect::FanucLatheA));
        assert!(findings.is_empty(), "{findings:#?}");
        let threads: Vec<_> = ops
            .iter()
            .filter_map(|op| match op {
                OpKind::Threading(stretch) => Some(stretch),
                _ => None,
            })
            .collect();
        assert_eq!(threads.len(), passes);
        for stretch in threads {
            assert_eq!((stretch.lead.value(), stretch.start_angle.value()), (1.5, 0.0));
            // the work begins at its own zero, Z3 lies before it
            assert_eq!((stretch.axis, stretch.surface.value()), (canon::Axis::Z, 0.0));
            assert!((stretch.to.linear[2].value() - -20.0).abs() < 1e-9);
        }
    }
}

#[test]
fn return_speed_and_acceleration_of_a_tap_are_no_lengths() {
    // without a point they count what they are, not thousandths of a millimetre
    for (words, back_rpm, limit) in [("J3000 I250", 3000.0, 250.0), ("J2 I300.", 2400.0, 300.0)] {
        let program =
            format!("O1\nG0 Z5.\nM29 S1200\nG99 G84 X0 Z-10. R2. F1200 {words}\nG80\nM30\n");
        let (kinds, findings) = ops_with(&program, &setup(Dialect::Fanuc));
        let tap = kinds.iter().find_map(|kind| match kind {
            OpKind::Tap(tap) => Some(*tap),
            _ => None,
        });
        let tap = tap.unwrap_or_else(|| panic!("{findings:#?}"));
        assert!((tap.return_spin.in_rpm() - back_rpm).abs() < 1e-9, "{words}: {tap:?}");
        let wanted = canon::ReturnAcceleration::Limit(units::SpinAccel::rev_per_s2(limit));
        assert_eq!(tap.return_acceleration, wanted);
    }
}

#[test]
fn a_lathe_goes_home_by_increments() {
    // by U (a diameter) and W from where it stands, then home with the axes named, and with no
    // others
    let program = "O1\nG0 X40. Z-10.\nG28 U10. W5.\nG0 X40. Z-10.\nG28 U0\nG28 W0\nM30\n";
    let wanted = [
        [20.0, 0.0, -10.0],
        [25.0, 0.0, -5.0],
        [0.0, 0.0, 0.0],
        [20.0, 0.0, -10.0],
        [0.0, 0.0, -10.0],
        [0.0, 0.0, 0.0],
    ];
    for dialect in [Dialect::FanucLatheA, Dialect::FanucLatheB] {
        close(&places_of(dialect, program), &wanted);
    }
}

#[test]
fn look_ahead_is_switched_on_and_off_without_effect() {
    goes_to(
        "O1\nG5.1Q1\nG8P1\nG5P10000\nG5.1Q2X0Y0Z0\nG0X1.\nG5P0\nG8P0\nG5.1Q0\nG11\nM30\n",
        &[[1.0, 0.0, 0.0]],
    );
}

#[test]
fn an_exact_stop_holds_for_its_block() {
    let (kinds, findings) = ops_with("O1\nG64\nG9G1X1.F100\nX2.\nM30\n", &setup(Dialect::Fanuc));
    assert!(findings.is_empty(), "{findings:#?}");
    let modes: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            OpKind::PathMode(mode) => Some(format!("{mode:?}")),
            OpKind::Line { to, .. } => Some(format!("X{}", to.linear[0].value())),
            _ => None,
        })
        .collect();
    let stop = modes.iter().position(|mode| mode.contains("ExactStop"));
    assert_eq!(stop.map(|at| modes[at + 1].as_str()), Some("X1"), "{modes:?}");
    assert!(modes[stop.unwrap() + 2].contains("Blend"), "{modes:?}");
}

#[test]
fn g29_comes_back_by_where_g28_went() {
    goes_to(
        "O1\nG0X5.Y5.\nG28X10.Y8.\nG29X20.Y1.\nG90M30\n",
        &[[5.0, 5.0, 0.0], [10.0, 8.0, 0.0], [0.0, 0.0, 0.0], [10.0, 8.0, 0.0], [20.0, 1.0, 0.0]],
    );
    is_told("O1\nG29X1.\nM30\n", "I1053");
}

#[test]
fn a_skip_ends_where_it_was_told_to_and_says_so() {
    goes_to(
        "O1\nG0X5.\nG31Z-3.F50\nX7.\nG0X#5061Z#5063\nM30\n",
        &[[5.0, 0.0, 0.0], [5.0, 0.0, -3.0], [7.0, 0.0, -3.0], [5.0, 0.0, -3.0]],
    );
}

#[test]
fn a_cycle_that_is_not_repeated_only_keeps_its_words() {
    // K0 makes no hole and no move; the next block does
    for none in ["K0", "L0"] {
        let program = format!("O1\nS500M3\nG0Z10.\nG99G81X1.Y1.Z-5.R2.F100{none}\nX2.\nG80\nM30\n");
        goes_to(
            &program,
            &[
                [0.0, 0.0, 10.0],
                [2.0, 0.0, 10.0],
                [2.0, 0.0, 2.0],
                [2.0, 0.0, -5.0],
                [2.0, 0.0, 2.0],
            ],
        );
    }
}

#[test]
fn codes_that_are_not_executed_say_what_is() {
    for (code, help) in [("G43.4", "along Z"), ("G66.1", "G65"), ("G68.2", "plane")] {
        let program = format!("O1\n{code}\nM30\n");
        let setup = setup(Dialect::Fanuc);
        let mut ops = Ops::new(program.as_bytes(), &setup);
        while ops.next().is_some() {}
        let found = ops.diagnostics();
        let told = found.iter().any(|d| {
            d.code == "I0103" && d.help.as_deref().is_some_and(|told| told.contains(help))
        });
        assert!(told, "{code}: {found:#?}");
    }
}

/// The manuals: of several codes of one group in a block, the last one specified is valid.
#[test]
fn of_two_codes_of_one_group_the_last_acts() {
    for (text, end) in
        [("O1\nG0 G90 X1.\nG90 G91 X2.\nM30\n", 3.0), ("O1\nG1 G0 X1.\nX2. G91 G90\nM30\n", 2.0)]
    {
        let (kinds, found) = ops_with(text, &setup(Dialect::Fanuc));
        assert!(found.iter().all(|f| f.starts_with("I0114")), "{found:#?}");
        let ends = kinds.iter().filter_map(|kind| match kind {
            OpKind::Rapid { to } => Some(to.linear[0].value()),
            _ => None,
        });
        assert_eq!(ends.collect::<Vec<_>>(), [1.0, end]);
    }
    is_told("O1\nG0 G90 G91 X1.\nM30\n", "I0114@2 G90 has no effect beside G91");
    for dialect in [Dialect::Haas, Dialect::LinuxCnc] {
        let (_, found) = ops_with("G0 G90 G91 X1.\nM30\n", &setup(dialect));
        assert!(found.iter().any(|f| f.starts_with("I0104@1")), "{found:#?}");
    }
}

#[test]
fn an_arc_without_a_place_is_in_force_for_the_blocks_that_follow() {
    let text = "O1\nG0 X10.\nG3 F100.\nX0 Y10. R10.\nM30\n";
    let (kinds, found) = ops_with(text, &setup(Dialect::Fanuc));
    assert!(kinds.iter().any(|kind| matches!(kind, OpKind::Arc { .. })), "{found:#?}");
    goes_to(text, &[[10.0, 0.0, 0.0], [0.0, 10.0, 0.0]]);
    let (_, found) = ops_with("G0 X10\nG3 F100\nX0 Y10 R10\nM2\n", &setup(Dialect::LinuxCnc));
    assert!(found.iter().any(|f| f.starts_with("I0411@2")), "{found:#?}");
}

#[test]
fn the_motion_from_before_a_cycle_takes_the_words_beside_g80() {
    let text = "O1\nT1 M6\nM3 S500\nG0 Z10.\nG81 X1. Z-5. R2. F100.\nG80 Z20.\nX5.\nM30\n";
    let places = places(text);
    close(&places[places.len() - 2..], &[[1.0, 0.0, 20.0], [5.0, 0.0, 20.0]]);
    let (kinds, _) = ops_with(text, &setup(Dialect::Fanuc));
    let last =
        kinds.iter().rev().find(|kind| matches!(kind, OpKind::Rapid { .. } | OpKind::Line { .. }));
    assert!(matches!(last, Some(OpKind::Rapid { .. })));
}

/// With parameter 3405#5 a comma stands before the angle too.
#[test]
fn the_angle_of_a_line_may_stand_after_a_comma() {
    let text = |a: &str| format!("O1\nM3 S500\nG0 X20. Z0.\nG1 X24.{a} F0.1\nM30\n");
    let with = places_of(Dialect::FanucLatheA, &text(",A135."));
    close(&with, &places_of(Dialect::FanucLatheA, &text("A135.")));
    close(&with[1..], &[[12.0, 0.0, -2.0]]);
    is_told("O1\nG1 X24.,A135. F100.\nM30\n", "I0110@2 A after a comma");
}

#[test]
fn a_fraction_of_repetitions_is_told_by_its_own_letter() {
    is_told(
        "O1\nT1 M6\nM3 S500\nG0 Z10.\nG73 X1. Z-5. R2. Q1. K0.2 F100.\nM30\n",
        "I0108@5 K counts",
    );
}

/// LF CR CR, as controls punch their tapes, LF CR and CR CR LF.
#[test]
fn carriage_returns_beside_a_line_feed_end_the_line_with_it() {
    for end in ["\n\r\r", "\n\r", "\r\r\n", "\r\n"] {
        let text = format!("%{end}O1(PART){end}G0 X1.{end}X2.{end}M30{end}%{end}");
        goes_to(&text, &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    }
    is_told("O1\nG0 X1.\rX2.\nM30\n", "P0193@2");
}
