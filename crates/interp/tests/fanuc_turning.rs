//! The multiple cycles of Fanuc's lathes: each stroke by hand, from the drawing of the manual.
#![allow(clippy::unwrap_used)] // helpers of tests
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
    // height 1, first pass 0.5: 0.5, 0.707, 0.866 (at most 1 − 0.1 = 0.9), 0.9, then twice at 1; tool of 0°
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
    // one pass to the full height of 1 with a tool of 60°: it begins tan 30° further on; pull-off of one lead; once more
    let pass = "R 11.000 2.423, R 9.000 2.423, @ 2.000, F 9.000 -18.000, F 11.000 -20.000, @,
         R 11.000 -20.000, R 11.000 3.000";
    does(
        "G0 X22. Z3.\nG76 P011060 Q50 R0\nG76 X18. Z-20. P1000 Q1000 F2.",
        &format!("R 11.000 3.000, {pass}, {pass}"),
    );
}

#[test]
fn g34_grows_turn_by_turn() {
    // 2 mm per turn, 0.5 more in each: after 1, 2, 3 turns at 2.25, 5, 8.25; 9 is reached in the fourth
    does(
        "G0 X20. Z0\nG34 Z-9. F2. K0.5",
        "R 10.000 0.000, @ 2.250, F 10.000 -2.250, @ 2.750, F 10.000 -5.000, @ 3.250, F 10.000 -8.250,
         @ 3.750, F 10.000 -9.000, @",
    );
    is_told("G0 X20. Z0\nG34 Z-9. F2. K-0.5", "I1034");
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
