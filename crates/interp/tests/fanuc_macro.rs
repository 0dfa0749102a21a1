//! Fanuc's custom macro B: variables, calls and jumps, with what they come to by the manual's
//! rules.
use canon::OpKind;
use interp::{Dialect, Increments, Limits, MissingTools, Ops, Setup, Subprogram};

fn setup() -> Setup {
    let limits = Limits { blocks: 20_000, ..Limits::default() };
    let missing_tools = MissingTools::StandIn;
    Setup { dialect: Dialect::Fanuc, limits, missing_tools, ..Setup::default() }
}

fn run(program: &str, setup: &Setup) -> (Vec<OpKind>, Vec<String>) {
    let mut ops = Ops::new(program.as_bytes(), setup);
    let kinds = ops.by_ref().map(|op| op.kind).collect();
    let told = ops.diagnostics().into_iter();
    (kinds, told.map(|d| format!("{}@{} {}", d.code, d.span.line, d.message)).collect())
}

/// Ends of the moves of a program in which nothing is found.
#[track_caller]
fn ends(program: &str, setup: &Setup) -> Vec<[f64; 3]> {
    let (kinds, told) = run(program, setup);
    assert_eq!(told, [""; 0], "{program}");
    let ends = kinds.iter().filter_map(|kind| match kind {
        OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } => {
            Some(to.linear.map(units::Length::value))
        }
        _ => None,
    });
    ends.collect()
}

#[track_caller]
fn goes_to(program: &str, wanted: &[[f64; 3]]) {
    near(&ends(program, &setup()), wanted);
}

#[track_caller]
fn near(found: &[[f64; 3]], wanted: &[[f64; 3]]) {
    let close = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    let same = found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| close(a, b));
    assert!(same, "found {found:?}, wanted {wanted:?}");
}

/// The X of the last move: what a macro has computed.
#[track_caller]
fn comes_to(program: &str, wanted: f64) {
    let ends = ends(program, &setup());
    let found = ends.last().map_or(0.0, |end| end[0]); // it stands at 0
    assert!((found - wanted).abs() < 1e-9, "{program}: found {found}, wanted {wanted}");
}

#[track_caller]
fn is_told(program: &str, wanted: &str) {
    let (_, told) = run(program, &setup());
    assert!(told.iter().any(|found| found.starts_with(wanted)), "{wanted}: {told:#?}");
}

/// Texts that a program writes.
fn writes(program: &str) -> Vec<String> {
    let (kinds, told) = run(program, &setup());
    assert_eq!(told, [""; 0]);
    let texts = kinds.into_iter().filter_map(|kind| match kind {
        OpKind::Message(text) => Some(text.to_string()),
        _ => None,
    });
    texts.collect()
}

#[test]
fn a_variable_in_a_word_is_rounded_to_the_least_increment() {
    // the manual's own example: 1.2345 and 2.3456 become 1.235 and 2.346, their sum 3.580
    goes_to(
        "O1\n#1=1.2345\n#2=2.3456\nG91G0X-#1\nX-#2\nX[#1+#2]\nM30\n",
        &[[-1.235, 0.0, 0.0], [-3.581, 0.0, 0.0], [-0.001, 0.0, 0.0]],
    );
    // and with ROUND the tool comes back
    comes_to(
        "O1\n#1=1.2345\n#2=2.3456\nG91G0X-#1\nX-#2\nX[ROUND[#1*1000]/1000+ROUND[#2]]\nM30\n",
        0.0,
    );
    comes_to("O1\n#1=12.3456\nG0X#1\nM30\n", 12.346);
    // IS-C has one digit more
    let fine = Setup { increments: Increments::C, ..setup() };
    near(&ends("O1\n#1=1.23456\nG0X#1\nM30\n", &fine), &[[1.2346, 0.0, 0.0]]);
}

#[test]
fn increments_are_those_of_the_machine() {
    for (increments, wanted) in [(Increments::A, 10.0), (Increments::B, 1.0), (Increments::C, 0.1)]
    {
        let (kinds, _) = run("O1\nG0X1000\nG4P1000\nM30\n", &Setup { increments, ..setup() });
        let moved = kinds.iter().any(
            |k| matches!(k, OpKind::Rapid { to } if (to.linear[0].value() - wanted).abs() < 1e-12),
        );
        let waited = kinds
            .iter()
            .any(|k| matches!(k, OpKind::Dwell { time } if (time.value() - wanted).abs() < 1e-12));
        assert!(moved && waited, "{increments:?}: {kinds:?}");
    }
    // an inch has one digit more, and G20 holds for its own block
    let (kinds, _) = run("O1\nG20G0X10000\nM30\n", &setup());
    assert!(
        kinds.iter().any(
            |k| matches!(k, OpKind::Rapid { to } if (to.linear[0].value() - 25.4).abs() < 1e-9)
        )
    );
}

#[test]
fn functions_have_two_arguments_and_short_names() {
    comes_to("O1\nG0X[ATAN[1,-1]]\nM30\n", 135.0);
    comes_to("O1\nG0X[POW[2,3]+POW[4,0.5]]\nM30\n", 10.0);
    comes_to("O1\nG0X[SQR[16]+SQ[9]+AB[-2]+ATN[1]]\nM30\n", 54.0);
    comes_to("O1\nG0X[[[[[1+1]*2]+1]*2]+1]\nM30\n", 11.0);
    is_told("O1\nG0X[2**3]\nM30\n", "P0120");
    is_told("O1\nG0X[SINE[3]]\nM30\n", "P0123");
}

#[test]
fn vacant_variables_are_compared_as_the_manual_says() {
    // EQ, NE, GE, GT with a vacant one, then with one that is 0
    for (value, wanted) in [("#0", [1, 0, 1, 0]), ("0", [0, 1, 1, 0])] {
        for (operator, wanted) in ["EQ", "NE", "GE", "GT"].into_iter().zip(wanted) {
            let program =
                format!("O1\n#1={value}\n#2=0\nIF[#1{operator}#0]THEN #2=1\nG0X9.\nX#2\nM30\n");
            comes_to(&program, f64::from(wanted));
        }
    }
    // an address with a vacant variable is left out; one that is multiplied is 0
    comes_to("O1\nG0X7.\nG0X#1Y1.\nM30\n", 7.0);
    comes_to("O1\n#2=#1*5\nG0X7.\nX#2\nM30\n", 0.0);
}

#[test]
fn modal_codes_and_last_words_are_told() {
    let begin = "O7\nN5G21G17G90G94G98G55G40G49G80G0F100S500T3\nN6M8\n";
    for (number, wanted) in [
        (4001, 0.0),
        (4002, 17.0),
        (4003, 90.0),
        (4005, 94.0),
        (4006, 21.0),
        (4007, 40.0),
        (4008, 49.0),
        (4009, 80.0),
        (4010, 98.0),
        (4011, 50.0),
        (4012, 67.0),
        (4013, 97.0),
        (4014, 55.0),
        (4015, 64.0),
        (4016, 69.0),
        (4017, 15.0),
        (4109, 100.0),
        (4113, 8.0),
        (4114, 6.0),
        (4115, 7.0),
        (4119, 500.0),
        (4120, 3.0),
        (4130, 0.0),
        (4203, 90.0),
    ] {
        comes_to(&format!("{begin}#100=#{number}\nG53G0X#100\nM30\n"), wanted);
    }
    comes_to(
        "O1\nS500M3\nG0Z5.\nF50\nG99G83X1.Z-3.R1.Q1.\n#1=#4009\n#2=#4001\n#3=#4010\nG80\nG0X[#1+#2*1000+#3*10]\nM30\n",
        1073.0,
    );
    is_told("O1\n#1=#4999\nM30\n", "I1013");
}

#[test]
fn positions_offsets_and_tools_are_told_and_set() {
    // G54 at 10, external offset 1, tool offset 3 of length 50 with a wear of 0.5
    let program = "O1\n#5221=10.\n#5201=1.\n#2203=50.\n#2003=0.5\nG54G43H3G0X5.Z2.\n";
    for (expression, wanted) in [
        ("#5001", 5.0),
        ("#5041", 5.0),
        ("#5021", 16.0),
        ("#5023", 52.5),
        ("#5083", 50.5),
        ("#5003", 2.0),
        ("#11003+#10003", 50.5),
        ("#4111", 3.0),
        ("#5221", 10.0),
        ("#5201", 1.0),
    ] {
        comes_to(&format!("{program}#100={expression}\nG53G0X#100\nM30\n"), wanted);
    }
}

#[test]
fn wear_is_set_and_not_added_up() {
    let program = "O1\nG10L10P4R100.\nG10L11P4R0.1\nG10L11P4R0.2\nG43H4G0Z0\nM30\n";
    goes_to(program, &[[0.0, 0.0, 100.2]]);
    goes_to(
        "O1\nG10L10P4R100.\nG91G10L11P4R0.1\nG10L11P4R0.2\nG90G43H4G0Z0\nM30\n",
        &[[0.0, 0.0, 100.3]],
    );
    goes_to("O1\nG10L10P4R100.\nG44H4G0Z0\nM30\n", &[[0.0, 0.0, -100.0]]);
    // L1 is the older L11
    goes_to("O1\nG10L10P4R100.\nG10L1P4R1.\nG43H4G0Z0\nM30\n", &[[0.0, 0.0, 101.0]]);
}

#[test]
fn forty_eight_more_work_offsets_and_an_external_one() {
    goes_to(
        "O1\nG10L20P48X10.Y20.\nG10L2P0X1.\nG54.1P48G0X0Y0\nG54P48X1.Y0\n#7941=30.\nX0\nG54X0Y0\nM30\n",
        &[[11.0, 20.0, 0.0], [12.0, 20.0, 0.0], [31.0, 20.0, 0.0], [1.0, 0.0, 0.0]],
    );
    comes_to("O1\nG10L20P3X-5.\nG54.1P3\n#1=#4130\n#2=#4014\nG53G0X[#1+#2]\nM30\n", 57.1);
    is_told("O1\nG54.1P49X0\nM30\n", "I1021");
    is_told("O1\nG10L2P7X0\nM30\n", "I0617");
}

#[test]
fn a_common_variable_is_kept_over_runs_and_a_zero_is_one() {
    let setup = setup();
    let mut first = Ops::new(b"O1\n#500=0\n#501=7.\n#502=1.\n#502=#0\n#100=5.\nM30\n", &setup);
    while first.next().is_some() {}
    let next = Setup { parameters: first.parameters().clone(), ..setup };
    let program = "O1\n#2=0\nIF[#500EQ#0]THEN #2=1\nIF[#502NE#0]THEN #2=2\nIF[#100NE#0]THEN #2=3\nG0X[#501+#2]\nM30\n";
    near(&ends(program, &next), &[[7.0, 0.0, 0.0]]);
}

#[test]
fn modal_macros_nest_the_last_one_first() {
    // each move calls O3, whose move calls O2, whose move calls nothing
    goes_to(
        "O1\nG66P2Z1.\nG66P3Y2.\nG0X10.\nG67\nX20.\nG67\nX30.\nM30\nO2\nG0Z#26\nM99\nO3\nG0Y#25\nM99\n",
        &[[10.0, 0.0, 0.0], [10.0, 2.0, 0.0], [10.0, 2.0, 1.0], [20.0, 2.0, 1.0], [30.0, 2.0, 1.0]],
    );
    // also in a subprogram that M98 calls
    goes_to(
        "O1\nG66P2Z1.\nM98P4\nG67\nM30\nO2\nG0Z#26\nM99\nO4\nG0X1.\nM99\n",
        &[[1.0, 0.0, 0.0], [1.0, 0.0, 1.0]],
    );
    is_told("O1\nG66.1P2\nM30\n", "I0103");
}

#[test]
fn calls_begin_at_a_block_and_in_the_program_at_hand() {
    let tail = "M30\nO1000\nN10G0X1.\nN20G0Y1.\nM99\n";
    goes_to(&format!("O1\nM98P1000Q20\n{tail}"), &[[0.0, 1.0, 0.0]]);
    goes_to(
        &format!("O1\nG91\nM98P0041000Q20\n{tail}"),
        &[[0.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 3.0, 0.0], [0.0, 4.0, 0.0]],
    );
    goes_to("O1\nM98Q50\nG0X9.\nM30\nN50G0X1.\nM99\n", &[[1.0, 0.0, 0.0], [9.0, 0.0, 0.0]]);
    is_told(&format!("O1\nM98P1000Q70\n{tail}"), "I1006");
}

#[test]
fn programs_have_names_and_colons() {
    goes_to(
        "%\n<PART-A>\nG0X1.\nM98<SUB>\nG65<SUB>A1.\nM30\n<SUB>\nG0Y2.\nM99\n%\n",
        &[[1.0, 0.0, 0.0], [1.0, 2.0, 0.0]],
    );
    goes_to(
        "O<MAIN>\nM98<SUB>L2\nM30\nO<SUB>(WITH O)\nG91G0Y2.\nM99\n",
        &[[0.0, 2.0, 0.0], [0.0, 4.0, 0.0]],
    );
    goes_to(":0001\nM98P2\nM30\n:0002\nG0Y2.\nM99\n", &[[0.0, 2.0, 0.0]]);
    is_told("O1\nM98<NONE>\nM30\n", "I0313");
    is_told("O1\nG0X1.<NONE>\nM30\nO<NONE>\nM99\n", "I1049");
}

#[test]
fn subprograms_lie_in_files_of_their_own() {
    let file = |name: &str, text: &str| Subprogram { name: name.into(), source: text.into() };
    let subprograms = vec![
        file("O1000", "%\nO1000(DEEP)\nN10G0X1.\nG65P2000A2.\nM99\n%\n"),
        file("2000", "N10G0Y#1\nGOTO20\nX99.\nN20M99\n"),
        file("POCKET", "%\nG0Z3.\nM99\n%\n"),
        file("O3000", "G0Z4.\n"),
    ];
    let with = Setup { subprograms, ..setup() };
    near(
        &ends("O1\nN10M98P1000\nM98<POCKET>\nGOTO30\nN20M30\nN30X0\nGOTO20\n", &with),
        &[[1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, 2.0, 3.0], [0.0, 2.0, 3.0]],
    );
    let (_, told) = run("O1\nM98P3000\nM30\n", &with);
    assert!(told[0].starts_with("I0301"), "{told:?}");
    is_told("O1\nM98P3000\nM30\n", "I0313");
    is_told("O1\nM198P3000\nM30\n", "I0313");
}

#[test]
fn m99_repeats_the_main_program_while_it_counts() {
    goes_to(
        "O1\n#1=#1+1\nIF[#1GT3]GOTO90\nG0X#1\nM99\nN90M30\n",
        &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]],
    );
    for head in ["%\n<PART>\n", "%\n", "O<PART>(X)\n", "%\nO0007;\n"] {
        let program = format!("{head}#1=#1+1\nIF[#1GT2]GOTO90\nG0X#1\nM99\nN90M30\n%\n");
        goes_to(&program, &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    }
    let (kinds, told) = run("O1\nG0X1.\nX2.\nM99\n", &setup());
    assert!(told.len() == 1 && told[0].starts_with("I1050@4"), "{told:?}");
    assert!(kinds.contains(&OpKind::End), "{kinds:?}");
    assert_eq!(kinds.iter().filter(|kind| matches!(kind, OpKind::Rapid { .. })).count(), 2);
    is_told("O1\n#1=#1+1\nM99\n", "I1051");
    // the block skip switch ends it
    let skips = Setup { block_delete: true, ..setup() };
    near(&ends("O1\nG0X1.\n/M99\nM30\n", &skips), &[[1.0, 0.0, 0.0]]);
}

#[test]
fn skips_stand_behind_n_too() {
    let skips = Setup { block_delete_levels: 1 << 3, ..setup() };
    near(&ends("O1\nN10/3G0X1.\nN20/2G0Y1.\nM30\n", &skips), &[[0.0, 1.0, 0.0]]);
}

#[test]
fn what_is_written_out_is_said() {
    let program = "O1\n#2=128.47398\n#5=-91.2\n#30=123.456\nPOPEN\nDPRNT[X#2[53]Y#5[53]T#30[20]]\nDPRNT[**HELLO*WORLD]\nBPRNT[C*X#2[3]]\nPCLOS\nM30\n";
    // the manual's example; 128.47398 · 1000 = 128474 = 1F5DA
    let wanted = ["X128.474Y-91.200T123", "  HELLO WORLD", "C X0001F5DA"];
    assert_eq!(writes(program), wanted);
}

#[test]
fn timers_counters_and_switches_answer() {
    goes_to(
        "O1\n#3001=0\nWHILE[#3001LT50]DO1\nEND1\n#3002=0\n#3003=1\n#3004=7\n#3005=0\n#3901=#3901+2\nG0X#3901Y#3003Z#3004\nM30\n",
        &[[2.0, 1.0, 7.0]],
    );
    comes_to("O1\nG0X[#3011-20000000]\nM30\n", 101.0);
}
