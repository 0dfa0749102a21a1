//! The multiple cycles of Fanuc's lathes: each stroke by hand, from the drawing of the manual.
use interp::{Call, Dialect, Interpreter, Place, Setup, Sink};

/// Strokes as text: R rapid, F feed (X as a radius), @ lead.
#[derive(Default)]
struct Strokes(Vec<String>);

impl Sink for Strokes {
    fn call(&mut self, _: &Place, call: &Call<'_>) {
        let text = match call {
            Call::Rapid(to) => format!("R {:.3} {:.3}", to[0], to[2]),
            Call::Line(to) => format!("F {:.3} {:.3}", to[0], to[2]),
            Call::Arc { to, turns, .. } => format!("A{turns} {:.3} {:.3}", to[0], to[2]),
            Call::SyncStart(lead) => format!("@ {lead:.3}"),
            Call::SyncStop => "@".to_owned(),
            Call::GrowingThread(thread) => {
                let [x, _, z, ..] = thread.to;
                format!("G {:.4} {:.4} {x:.3} {z:.3}", thread.lead, thread.growth)
            }
            Call::ThreadAngle(degrees) => format!("Q {degrees:.3}"),
            Call::FeedRate { rate, .. } if *rate > 0.0 => format!("f {rate:.3}"),
            _ => return,
        };
        self.0.push(text);
    }
}

fn run(dialect: Dialect, program: &str) -> (Vec<String>, Vec<String>) {
    let setup = Setup { dialect, ..Setup::default() };
    let program = format!("O1\nG97 S500 M3\n{program}\nM30\n");
    let mut interpreter = Interpreter::new(program.as_bytes(), &setup);
    let mut strokes = Strokes::default();
    interpreter.run(&mut strokes);
    let told = |d: &diag::Diagnostic| format!("{}@{} {}", d.code, d.span.line, d.message);
    (strokes.0, interpreter.diagnostics().iter().map(told).collect())
}

#[track_caller]
fn does(program: &str, wanted: &str) {
    for dialect in [Dialect::FanucLatheA, Dialect::FanucLatheB] {
        let (found, told) = run(dialect, program);
        assert!(told.is_empty(), "{told:#?}");
        let wanted: Vec<_> = wanted.split(',').map(str::trim).collect();
        assert_eq!(found, wanted, "{dialect:?}");
    }
}

#[track_caller]
fn is_told(program: &str, wanted: &str) {
    let (_, told) = run(Dialect::FanucLatheA, program);
    assert!(told.iter().any(|told| told.starts_with(wanted)), "{told:#?}");
}

#[test]
fn g71_clears_a_step_and_leaves_what_u_and_w_say() {
    // Ø30 down to Ø10 over 10 mm, in passes of 4; 0.4 on the diameter and 0.1 along Z are left
    does(
        "G0 X30. Z2.\nG71 U4. R1.\nG71 P10 Q20 U0.4 W0.1 F0.3\nN10 G0 X10.\nG1 Z-10. F0.1\nN20 X30.\nG0 X50.",
        "R 15.000 2.000, f 0.300, R 15.200 2.100,
         R 11.200 2.100, F 11.200 -9.900, R 12.200 -8.900, R 12.200 2.100,
         R 7.200 2.100, F 7.200 -9.900, R 8.200 -8.900, R 8.200 2.100,
         R 5.200 2.100, F 5.200 -9.900, F 15.200 -9.900,
         R 15.000 2.000, R 25.000 2.000",
    );
}

#[test]
fn g70_finishes_with_the_feeds_of_the_profile_and_goes_on_behind_its_own_block() {
    does(
        "G0 X30. Z2.\nG71 U20. R1.\nG71 P10 Q20 U0 W0 F0.3\nN10 G0 X10.\nG1 Z-10. F0.1\nN20 X30. F0.2\nG70 P10 Q20\nG0 X50.",
        "R 15.000 2.000, f 0.300, R 15.000 2.000, R 5.000 2.000, F 5.000 -10.000, F 15.000 -10.000, R 15.000 2.000,
         R 5.000 2.000, f 0.100, F 5.000 -10.000, f 0.200, F 15.000 -10.000, R 15.000 2.000, R 25.000 2.000",
    );
}

#[test]
fn g72_clears_along_x() {
    does(
        "G0 X30. Z1.\nG72 W2. R0.5\nG72 P10 Q20 U0 W0 F0.3\nN10 G0 Z-4.\nG1 X10.\nN20 Z1.",
        "R 15.000 1.000, f 0.300, R 15.000 1.000,
         R 15.000 -1.000, F 5.000 -1.000, R 5.500 -0.500, R 15.000 -0.500,
         R 15.000 -3.000, F 5.000 -3.000, R 5.500 -2.500, R 15.000 -2.500,
         R 15.000 -4.000, F 5.000 -4.000, F 5.000 1.000, R 15.000 1.000",
    );
}

#[test]
fn g73_repeats_a_pattern_from_afar() {
    // three times, from 2 (radius) and 1 away: at 2 and 1, 1 and 0.5, 0 and 0
    does(
        "G0 X30. Z2.\nG73 U2. W1. R3\nG73 P10 Q20 U0 W0 F0.3\nN10 G0 X20. Z0\nN20 G1 X24. Z-5.",
        "R 15.000 2.000, f 0.300,
         R 17.000 3.000, R 12.000 1.000, F 14.000 -4.000,
         R 16.000 2.500, R 11.000 0.500, F 13.000 -4.500,
         R 15.000 2.000, R 10.000 0.000, F 12.000 -5.000, R 15.000 2.000",
    );
}

#[test]
fn g74_pecks_along_z_and_steps_across() {
    does(
        "G0 X20. Z1.\nG74 R0.5\nG74 X16. Z-4. P2000 Q3000 F0.1",
        "R 10.000 1.000, f 0.100, F 10.000 -2.000, R 10.000 -1.500, F 10.000 -4.000, R 10.000 1.000,
         R 8.000 1.000, F 8.000 -2.000, R 8.000 -1.500, F 8.000 -4.000, R 8.000 1.000, R 10.000 1.000",
    );
}

#[test]
fn g75_pecks_along_x() {
    does(
        "G0 X20. Z-5.\nG75 R0.2\nG75 X14. P2000 F0.1",
        "R 10.000 -5.000, f 0.100, F 8.000 -5.000, R 8.200 -5.000, F 7.000 -5.000, R 10.000 -5.000, R 10.000 -5.000",
    );
}

#[test]
fn g76_deepens_with_the_square_root_and_finishes_as_often_as_it_is_told() {
    // height 1, first pass 0.5: 0.5, 0.707, 0.866 (at most 1 − 0.1 = 0.9), 0.9, then twice at 1;
    // tool of 0°
    let (found, told) = run(
        Dialect::FanucLatheA,
        "G0 X22. Z3.\nG76 P020000 Q50 R0.1\nG76 X18. Z-20. P1000 Q500 F1.5",
    );
    assert!(told.is_empty(), "{told:#?}");
    let floors: Vec<_> = found.iter().filter_map(|stroke| stroke.strip_prefix("F ")).collect();
    let wanted = [0.5, 0.5f64.sqrt(), 0.75f64.sqrt(), 0.9, 1.0, 1.0];
    let wanted: Vec<_> =
        wanted.iter().map(|depth| format!("{:.3} -20.000", 10.0 - depth)).collect();
    assert_eq!(floors, wanted);
    assert!(found.contains(&"@ 1.500".to_owned()));
}

#[test]
fn g76_goes_in_along_the_flank_and_pulls_off_at_the_end() {
    // one pass to the full height of 1 with a tool of 60°: it begins tan 30° further on; pull-off
    // of one lead; once more
    let pass =
        "R 11.000 2.423, R 9.000 2.423, @ 2.000, F 9.000 -18.000, @ 2.828, F 11.000 -20.000, @,
         R 11.000 -20.000, R 11.000 3.000";
    does(
        "G0 X22. Z3.\nG76 P011060 Q50 R0\nG76 X18. Z-20. P1000 Q1000 F2.",
        &format!("R 11.000 3.000, {pass}, {pass}"),
    );
}

#[test]
fn g34_says_lead_and_growth_and_is_modal() {
    does(
        "G0 X20. Z0\nG34 Z-9. F2. K0.5\nZ-20. K0.25\nS600\nU4. W-2.\nG0 X30.",
        "R 10.000 0.000, G 2.0000 0.5000 10.000 -9.000, G 2.0000 0.2500 10.000 -20.000,
         G 2.8284 0.0000 12.000 -22.000, R 15.000 -22.000",
    );
    // what counts along X, where that goes farther; increments of F and K are ten thousandths
    does(
        "G0 X20. Z0\nG34 X80. Z-10. F20000 K500",
        "R 10.000 0.000, G 2.1082 0.0527 40.000 -10.000",
    );
    // another code of its group ends it
    let (found, _) = run(Dialect::FanucLatheA, "G0 X20. Z0\nG34 Z-9. F2. K0.5\nG32 Z-20.\nZ-30.");
    assert_eq!(
        found[2..],
        ["@ 2.000", "F 10.000 -20.000", "@", "@ 2.000", "F 10.000 -30.000", "@"]
    );
}

#[test]
fn g34_is_listed_turn_by_turn() {
    // 2 mm per turn, 0.5 more in each: after 1, 2, 3 turns at 2.25, 5, 8.25; 9 is reached in the
    // fourth
    let setup = Setup { dialect: Dialect::FanucLatheA, ..Setup::default() };
    let program = b"O1\nG97 S500 M3\nG0 X20. Z0\nG34 Z-9. F2. K0.5\nM30\n";
    let mut interpreter = Interpreter::new(program, &setup);
    let mut listing = interp::Listing::new(Vec::new());
    interpreter.run(&mut listing);
    let text = String::from_utf8(listing.finish().unwrap()).unwrap();
    let said = |line: &str| {
        let sync =
            line.split("SPEED_FEED_SYNC(").nth(1).map(|t| t.split(',').next().unwrap().to_owned());
        let feed =
            line.split("STRAIGHT_FEED(").nth(1).map(|t| t.split(", ").nth(2).unwrap().to_owned());
        sync.or(feed)
    };
    let found: Vec<_> = text.lines().filter_map(said).collect();
    let wanted = [
        "2.250000", "-2.2500", "2.750000", "-5.0000", "3.250000", "-8.2500", "3.750000", "-9.0000",
    ];
    assert_eq!(found, wanted, "{text}");
}

#[test]
fn g34_that_cannot_be_is_refused_in_a_sentence() {
    // 2²/(2·9) is the K that uses the lead up at the end
    let (_, told) = run(Dialect::FanucLatheA, "G0 X20. Z0\nG34 Z-9. F2. K-0.5");
    assert_eq!(
        told,
        ["I1034@4 the lead of 2 shrinks to nothing after 4 of 9: K takes 0.5 from it in each turn"]
    );
    is_told("G0 X20. Z0\nG34 Z-9. K0.5", "I0425");
    is_told("G0 X20. Z0\nG34 Z-9. F0 K0.5", "I0426");
    is_told("G0 X20. Z0\nG34 Z0 F2. K0.5", "I0423");
    is_told("G0 X20. Z0\nG34 F2. K0.5", "I0423");
    is_told("G0 X20. Z0\nM5\nG34 Z-9. F2. K0.5", "I0427");
    is_told("G0 X20. Z0\nG34 Z-900. F0.001 K0", "I1034");
    let (found, told) = run(Dialect::FanucLatheA, "G0 X20. Z0\nG34 Z-9. F2. K-0.2222");
    assert_eq!((found.len(), told), (2, vec![]), "{found:?}");
}

#[test]
fn a_lead_is_that_of_the_axis_that_goes_farther() {
    // 45°: 2 mm of Z in each turn are √8 of the path
    for thread in ["G32 U20. W-10. F2.", "G32 X40. Z-10. F2."] {
        let (found, _) = run(Dialect::FanucLatheA, &format!("G0 X20. Z0\n{thread}"));
        assert_eq!(found[1..], ["@ 2.828", "F 20.000 -10.000", "@"]);
    }
    does("G0 X30. Z0\nG34 X30. Z-10. F2. K0", "R 15.000 0.000, G 2.0000 0.0000 15.000 -10.000");
}

#[test]
fn a_thread_begins_where_q_says() {
    let (found, _) = run(Dialect::FanucLatheA, "G0 X20. Z3.\nG32 Z-9. F2. Q180000");
    assert_eq!(found[1..], ["Q 180.000", "@ 2.000", "F 10.000 -9.000", "@"]);
    let setup = Setup { dialect: Dialect::FanucLatheA, ..Setup::default() };
    let program =
        b"O1\nG97 S500 M3\nG0 X20. Z3.\nG32 Z-9. F2. Q180000\nG0 X30.\nZ3.\nX20.\nG32 Z-9.\nM30\n";
    let angles: Vec<_> = interp::Ops::new(program, &setup)
        .filter_map(|op| match op.kind {
            canon::OpKind::Threading(thread) => Some(thread.start_angle.in_deg()),
            _ => None,
        })
        .collect();
    assert_eq!(angles, [180.0, 0.0]);
}

#[test]
fn offsets_of_radius_and_more_work_offsets_are_set() {
    let (found, told) = run(Dialect::FanucLatheB, "G10 L20 P2 X10. Z5.\nG54.1 P2\nG0 X0 Z0");
    assert!(told.is_empty(), "{told:#?}");
    assert_eq!(found, ["R 0.000 0.000"]);
    let (_, told) = run(Dialect::FanucLatheB, "G10 L20 P49 X10.");
    assert!(told[0].starts_with("I0617"), "{told:#?}");
}

#[test]
fn what_a_cycle_lacks_is_said() {
    is_told(
        "G0 X30. Z2.\nG71 P10 Q20 F0.3\nN10 G0 X10.\nN20 G1 Z-10.",
        "I1031@4 G71 does not know",
    );
    is_told("G0 X30. Z2. F0.2\nG70 P10", "I1030");
    is_told("G0 X30. Z2. F0.2\nG70 P10 Q99\nN10 G0 X10.", "I1032@4 there is no block N99");
    is_told("G0 X30. Z2.\nG71 U0 R1.", "I1031");
    is_told(
        "G0 X30. Z2.\nG71 U2. R1.\nG71 P10 Q20 F0.3\nN10 G0 X10.\nG71 P10 Q20\nN20 G1 Z-10.",
        "I1033",
    );
    is_told(
        "G0 X30. Z2.\nG71 U2. R1.\nG71 P10 Q20 F0.3\nN10 G0 X10.\nG1 Z-5.\nX12.\nZ-4.\nN20 X30.",
        "I0585@5",
    );
    is_told("G0 X22. Z3.\nG76 P123 Q50", "I1031");
}

/// The same strokes by two ways to write them.
#[track_caller]
fn are_alike(one: &str, other: &str) {
    let [one, other] = [one, other].map(|program| run(Dialect::FanucLatheA, program));
    assert_eq!(one.1, [""; 0]);
    assert_eq!(other.1, [""; 0]);
    assert!(one.0.len() > 5, "{one:?}");
    assert_eq!(one.0, other.0);
}

#[test]
fn cycles_of_one_line_are_those_of_two() {
    let profile = "N10 G0 X20.\nG1 Z-10.\nN20 X30.";
    are_alike(
        &format!("G0 X30. Z2.\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.2\n{profile}"),
        &format!("G0 X30. Z2.\nG71 P10 Q20 U0.4 W0.1 D2000 F0.2\n{profile}"),
    );
    are_alike(
        "G0 X30. Z2.\nG72 W2. R0.5\nG72 P10 Q20 U0 W0.1 F0.2\nN10 G0 Z-5.\nN20 G1 X20.",
        "G0 X30. Z2.\nG72 P10 Q20 U0 W0.1 D2. F0.2\nN10 G0 Z-5.\nN20 G1 X20.",
    );
    are_alike(
        &format!("G0 X30. Z2.\nG73 U2. W1. R3\nG73 P10 Q20 U0 W0 F0.3\n{profile}"),
        &format!("G0 X30. Z2.\nG73 P10 Q20 I2. K1. U0 W0 D3 F0.3\n{profile}"),
    );
    are_alike(
        "G0 X20. Z1.\nG74 R0\nG74 X16. Z-4. P2000 Q3000 F0.1",
        "G0 X20. Z1.\nG74 X16. Z-4. I2. K3. F0.1",
    );
    are_alike(
        "G0 X20. Z1.\nG75 R0\nG75 X16. Z-4. P1000 Q3000 F0.1",
        "G0 X20. Z1.\nG75 X16. Z-4. I1. K3. F0.1",
    );
    are_alike(
        "G0 X22. Z3.\nG76 P010060 Q0 R0\nG76 X18. Z-20. R-0.5 P1000 Q500 F1.5",
        "G0 X22. Z3.\nG76 X18. Z-20. I-0.5 K1. D500 F1.5 A60",
    );
    is_told("G0 X22. Z3.\nG76 X18. Z-20. K1. D500 F1.5 P2", "I1031");
}

#[test]
fn tapers_are_called_i_and_k_too() {
    are_alike(
        "G0 X30. Z2.\nG90 X20. Z-10. R-1. F0.2\nG94 X10. Z-1. R-2.\nG92 X20. Z-10. R-1. F1.5",
        "G0 X30. Z2.\nG90 X20. Z-10. I-1. F0.2\nG94 X10. Z-1. K-2.\nG92 X20. Z-10. I-1. F1.5",
    );
}

#[test]
fn what_a_cycle_does_not_take_is_said_and_the_codes_beside_it_hold() {
    is_told("G0 X30. Z2.\nG71 U2. R1. E3.", "I0110");
    is_told("G0 X30. Z2. F0.2\nG70 P10 Q20 D3.\nN10 G0 X10.\nN20 G1 Z-10.", "I0113");
    // G98 in the cycle's own line: F is per minute
    let program = b"O1\nG97 S500 M3\nG0 X20. Z1.\nG98 G74 Z-4. Q2000 F100.\nM30\n";
    let setup = Setup { dialect: Dialect::FanucLatheA, ..Setup::default() };
    let per_minute = |op: canon::Op| {
        matches!(op.kind, canon::OpKind::Line { feed: canon::Feed::PerTime(_), .. })
    };
    assert!(interp::Ops::new(program, &setup).any(per_minute));
}

#[test]
fn increments_of_system_b_hold_in_a_cycle() {
    // from X50 down by 5, twice from the same start
    let (found, told) =
        run(Dialect::FanucLatheB, "G0 X50. Z2.\nG77 X48. Z-10. F0.2\nG91 X-5.\nG90");
    assert_eq!(told, [""; 0]);
    let feeds: Vec<_> = found.iter().filter(|stroke| stroke.starts_with("F ")).collect();
    assert_eq!(
        feeds,
        ["F 24.000 -10.000", "F 25.000 -10.000", "F 22.500 -10.000", "F 25.000 -10.000"]
    );
}

#[test]
fn a_lathe_drills_along_z() {
    // R lies 3 below the initial level; pecks of 5 from there, back to the initial level at the end
    let strokes = "R 0.000 5.000, f 0.100, R 0.000 5.000, R 0.000 2.000,
         F 0.000 -3.000, R 0.000 2.000, R 0.000 -2.746, F 0.000 -8.000, R 0.000 2.000, R 0.000 -7.746,
         F 0.000 -10.000, R 0.000 5.000";
    does("G0 X0 Z5.\nG83 Z-10. R-3. Q5000 F0.1\nG80", strokes);
    let (found, told) = run(Dialect::FanucLatheA, "G0 X0 Z5.\nG83 W-12. R-3. Q5000 F0.1\nG80");
    assert_eq!(told, [""; 0]);
    assert_eq!(found, strokes.split(',').map(str::trim).collect::<Vec<_>>());
    does(
        "G0 X0 Z5.\nG83 Z-10. F0.1\nG80",
        "R 0.000 5.000, f 0.100, R 0.000 5.000, F 0.000 -10.000, R 0.000 5.000",
    );
    is_told("G0 X0 Z5.\nG87 X-10. F0.1", "I0103");
}

#[test]
fn a_lathes_tool_offsets_are_geometry_and_wear() {
    // geometry X 4 (diameter), Z 10; wear X 0.2, Z -0.5, set twice; then added to
    let offsets = "G10 P10001 X4. Z10. R0.8 Q3\nG10 P1 X0.2 Z-0.5\nG10 P1 X0.2 Z-0.5";
    let places = |program: &str| {
        let missing_tools = interp::MissingTools::StandIn;
        let setup = Setup { dialect: Dialect::FanucLatheA, missing_tools, ..Setup::default() };
        let text = format!("O1\n{program}\nM30\n");
        let mut ops = interp::Ops::new(text.as_bytes(), &setup);
        let ends: Vec<_> = ops
            .by_ref()
            .filter_map(|op| match op.kind {
                canon::OpKind::Rapid { to } => Some([to.linear[0].value(), to.linear[2].value()]),
                _ => None,
            })
            .collect();
        let told = ops.diagnostics();
        assert!(told.is_empty(), "{told:#?}");
        ends.last().copied().unwrap_or_default()
    };
    let near = |[x, z]: [f64; 2], wanted: [f64; 2]| {
        assert!((x - wanted[0]).abs() < 1e-9 && (z - wanted[1]).abs() < 1e-9, "{x} {z}");
    };
    near(places(&format!("{offsets}\nT0101\nG0 X0 Z0")), [2.1, 9.5]);
    near(places(&format!("{offsets}\nG10 P1 U0.2 W1.\nT0101\nG0 X0 Z0")), [2.2, 10.5]);
    near(places(&format!("{offsets}\n#2001=1.\n#2801=20.\nT0101\nG0 X0 Z0")), [2.5, 19.5]);
    near(places(&format!("{offsets}\nG0 X[#2901*10+#2301]Z#2101")), [5.5, -0.5]);
    // P0 is the external work offset
    near(places("G10 P0 Z7.\nG0 X10. Z1."), [5.0, 8.0]);
    is_told("G10 P1", "I1022");
}

#[test]
fn h_and_v_are_increments_too() {
    let setup = Setup { dialect: Dialect::FanucLatheA, ..Setup::default() };
    let ops = interp::Ops::new(b"O1\nG0 C90.\nH10.\nH5000\nM30\n", &setup);
    let turns: Vec<_> = ops
        .filter_map(|op| match op.kind {
            canon::OpKind::Rapid { to } => Some(to.rotary[2].in_deg().round()),
            _ => None,
        })
        .collect();
    assert_eq!(turns, [90.0, 100.0, 105.0]);
}
