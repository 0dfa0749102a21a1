//! Loops that never end are refused as soon as nothing in them changes; loops that end are not.
use interp::{Dialect, MissingTools, Ops, Setup, check, example_setup};

fn found(dialect: Dialect, program: &str) -> Vec<String> {
    let missing_tools = MissingTools::StandIn;
    let setup = Setup { dialect, missing_tools, ..Setup::default() };
    let mut ops = Ops::new(program.as_bytes(), &setup);
    let mut count = 0_u32;
    ops.by_ref().for_each(|_| count += 1);
    assert!(count < 100_000, "it was stopped by something else");
    let told = ops.diagnostics().into_iter().filter(diag::Diagnostic::is_error);
    told.map(|d| format!("{}@{}", d.code, d.span.line)).collect()
}

/// It is said at the block that leads back: of two loops within each other, at the outer one.
#[test]
fn a_loop_in_which_nothing_changes_is_refused_at_once() {
    let fanuc = [
        (
            "O1\nG90 G54 G21 G17\nT2 M6\nM3 S1000\nG81 X0 Y0 Z-5. R2. F100\n#1=0\nWHILE [#1 LT 10] DO1\nX#1\nEND1\nM30\n",
            9,
        ),
        ("O1\nG0 X0\nN10 G0 X1.\nG0 X2.\nGOTO 10\nM30\n", 5),
        ("O1\nDO1\n#1=0\nWHILE [#1 LT 3] DO2\n#1=#1+1\nEND2\nEND1\nM30\n", 7),
    ];
    for (program, line) in fanuc {
        assert_eq!(found(Dialect::Fanuc, program), [format!("I0803@{line}")], "{program}");
    }
    let o_words = [
        ("o1 while [1]\nG0 X1\nG0 X0\no1 endwhile\nM2\n", 4),
        ("o1 do\nG91 G0 X0\no1 while [#1 EQ 0]\nM2\n", 3),
    ];
    for (program, line) in o_words {
        assert_eq!(found(Dialect::LinuxCnc, program), [format!("I0803@{line}")], "{program}");
    }
}

/// It is not refused, and it is said from where on nothing was looked at.
#[test]
fn a_loop_that_ends_by_an_answer_of_the_machine_is_left_to_the_run() {
    let loops = [
        "o1 while [#5399 EQ 0]\nM66 P0 L0\nG4 P0.1\no1 endwhile\nG0 X1\nM2\n",
        "o1 do\nM66 P0 L3 Q2\no1 while [#5399 EQ 1]\nG0 X1\nM2\n",
        "o1 while [1]\nM66 P0 L3 Q0.5\no1 endwhile\nM2\n",
        "F100\no1 do\nG91 G38.3 X0.1\nG0 X-0.1\no1 while [#5070 EQ 1]\nM2\n",
    ];
    for program in loops {
        let setup = Setup { missing_tools: MissingTools::StandIn, ..Setup::default() };
        let mut ops = Ops::new(program.as_bytes(), &setup);
        ops.by_ref().for_each(drop);
        let found = ops.diagnostics();
        assert!(!found.iter().any(diag::Diagnostic::is_error), "{found:?}");
        let last = found.iter().filter(|d| d.message.contains("when this loop ends is known"));
        assert_eq!(last.count(), 1, "{found:?}");
    }
}

#[test]
fn a_loop_that_ends_is_not_refused_however_little_changes_in_it() {
    let fanuc = [
        "O1\n#1=0\nWHILE [#1 LT 5000] DO1\n#1=#1+1\nEND1\nM30\n",
        // the inner loop is the same in each round of the outer one
        "O1\n#2=0\nWHILE [#2 LT 3000] DO1\n#1=0\nWHILE [#1 LT 2] DO2\n#1=#1+1\nEND2\n#2=#2+1\nEND1\nM30\n",
        "O1\nM98 P2 L5000\nM30\nO2\n#1=1\nWHILE [#1 GT 0] DO1\n#1=0\nEND1\nM99\n",
        // it ends by where the axis stands
        "O1\nG90 G0 X0\nWHILE [#5001 LT 30.] DO1\nG91 X0.01\nEND1\nM30\n",
        // and by what a tool's offset comes to
        "O1\nG90 G10 L11 P1 R0\nWHILE [#2001 LT 30.] DO1\nG91 G10 L11 P1 R0.01\nEND1\nM30\n",
    ];
    for program in fanuc {
        assert_eq!(found(Dialect::Fanuc, program), [""; 0], "{program}");
    }
    let o_words = [
        "o1 repeat [5000]\nG0 X0\no1 endrepeat\nM2\n",
        "o2 repeat [3000]\n#1=0\no1 while [#1 LT 2]\n#1=[#1+1]\no1 endwhile\no2 endrepeat\nM2\n",
        "o9 sub\n#<_n>=[#<_n>+1]\no9 endsub\n#<_n>=0\no1 while [#<_n> LT 4000]\no9 call\no1 endwhile\nM2\n",
        "o1 while [#5420 LT 30]\nG91 G0 X0.01\no1 endwhile\nM2\n",
    ];
    for program in o_words {
        assert_eq!(found(Dialect::LinuxCnc, program), [""; 0], "{program}");
    }
}

#[test]
fn the_pecks_of_one_block_are_bounded_before_any_is_made() {
    let errors = |block: &str| -> Vec<String> {
        let text = format!("G21 G90\nT1 M6\nS1000 M3\nG0 X0 Y0 Z20\nG91 {block}\nG80\nM2\n");
        let found = check(text.as_bytes(), &example_setup(Dialect::LinuxCnc));
        let errors = found.into_iter().filter(diag::Diagnostic::is_error);
        errors.map(|found| format!("{} {}", found.code, found.message)).collect()
    };
    let found = errors("G83 X0.01 Z-20 R-5 Q0.003 F900 L3000");
    assert!(found.len() == 1 && found[0].starts_with("I0511 L3000 of these holes"), "{found:?}");
    assert!(found[0].contains("20001000 pecks"), "{found:?}");
    assert!(errors("G73 X0.01 Z-20 R-5 Q0.02 F900 L101")[0].starts_with("I0511"));
    assert_eq!(errors("G73 X0.01 Z-20 R-5 Q0.02 F900 L100"), [""; 0]);
}

/// What a loop counts changes in each of its rounds: it is refused after a stated number of blocks
/// in which nothing moves or waits, and not before.
#[test]
fn a_loop_that_only_counts_is_refused_where_it_leads_back() {
    let stopped = |program: &str, most: u64| -> Vec<String> {
        let dialect = if program.starts_with('O') { Dialect::Fanuc } else { Dialect::LinuxCnc };
        let mut setup = Setup { dialect, missing_tools: MissingTools::StandIn, ..Setup::default() };
        setup.limits.idle_blocks = most;
        let mut ops = Ops::new(program.as_bytes(), &setup);
        ops.by_ref().for_each(drop);
        let found = ops.diagnostics().into_iter().filter(diag::Diagnostic::is_error);
        found.map(|d| format!("{}@{}", d.code, d.span.line)).collect()
    };
    let idle = [
        ("o1 while [1]\n#1=[#1+1]\no1 endwhile\nM2\n", 3),
        ("o1 while [1]\n#1=[#1+1]\nG4 P0\nM8\nM3 S[#1]\n(MSG, waits)\no1 endwhile\nM2\n", 7),
        ("G0 X5\no1 do\n#1=[#1+1]\nG0 X5\no1 while [1]\nM2\n", 5),
        ("O1\nN10 #1=#1+1\nGOTO 10\nM30\n", 3),
        ("O1\n#1=0\nWHILE [#1 GE 0] DO1\n#1=#1+1\nEND1\nM30\n", 5),
    ];
    for (program, line) in idle {
        assert_eq!(stopped(program, 5000), [format!("I0803@{line}")], "{program}");
    }
    // a long block counts for more than one, and a program that is not wanted is broken off
    let sines = format!("#1=[#1+1{}]\n", "+abs[sin[#1]]".repeat(30)).repeat(40);
    let long = format!("o1 do\n{sines}o1 while [1]\nM2\n");
    assert_eq!(stopped(&long, 500_000), ["I0803@42"]);
    let asked = std::sync::Arc::new(std::sync::atomic::AtomicU32::new(0));
    let asks = std::sync::Arc::clone(&asked);
    let came = move || asks.fetch_add(1, std::sync::atomic::Ordering::Relaxed) == 3;
    let setup = Setup { break_off: interp::BreakOff::by(came), ..Setup::default() };
    let mut ops = Ops::new(long.as_bytes(), &setup);
    ops.by_ref().for_each(drop);
    assert_eq!((ops.diagnostics().len(), asked.load(std::sync::atomic::Ordering::Relaxed)), (0, 4));
    let busy = [
        "o1 while [#1 LT 3000]\n#1=[#1+1]\nG0 X[#1]\no1 endwhile\nM2\n",
        "o1 while [#1 LT 3000]\n#1=[#1+1]\nG4 P0.1\no1 endwhile\nM2\n",
        "o1 while [#1 LT 3000]\n#1=[#1+1]\nM66 P0 L3 Q1\no1 endwhile\nM2\n",
        "o1 while [#1 LT 3000]\n#1=[#1+1]\nM66 P0 L0\nG4 P0.01\no1 endwhile\nM2\n",
        "o1 while [#1 LT 3000]\n#1=[#1+1]\nG91 G38.3 Z-0.001 F100\no1 endwhile\nM2\n",
        "O1\nWHILE [#1 LT 3000] DO1\n#1=#1+1\nM0\nEND1\nM30\n",
        "o1 while [#1 LT 1500]\n#1=[#1+1]\no1 endwhile\nG0 X1\no1 while [#1 LT 3000]\n#1=[#1+1]\no1 endwhile\nM2\n",
    ];
    for program in busy {
        assert_eq!(stopped(program, 5000), [""; 0], "{program}");
    }
}

/// A line of each kind that takes no machine time, whatever was before it.
const IDLE_LINES: [&str; 18] = [
    "M66 P0 L0",
    "M66 E0",
    "F100 G38.3 Z-0",
    "F100 G38.5 Z0",
    "G4 P0",
    "M62 P1",
    "M63 P1",
    "M64 P1",
    "M65 P1",
    "M67 E0 Q1",
    "M68 E0 Q1",
    "G10 L2 P2 X1",
    "G92 X0",
    "(MSG, once more)",
    "G0 X0",
    "F100 G1 X0 Y0",
    "M1",
    "T1 M8 M48 S500 M3 G64",
];

fn setup_with(blocks: u64, reads: u64) -> Setup {
    let mut setup = Setup { missing_tools: MissingTools::StandIn, ..Setup::default() };
    setup.user_codes.push(interp::MachineCode {
        number: 150,
        name: "blow".into(),
        action: interp::CodeAction::Output { number: 3, on: true },
    });
    (setup.limits.idle_blocks, setup.limits.idle_reads) = (blocks, reads);
    setup
}

fn errors_of(program: &str, setup: &Setup) -> Vec<diag::Diagnostic> {
    let mut ops = Ops::new(program.as_bytes(), setup);
    ops.by_ref().take(200_000).for_each(drop);
    ops.diagnostics().into_iter().filter(diag::Diagnostic::is_error).collect()
}

/// Without a count, with one, and computing one within another: in each the line that turns is
/// named, and what would end the loop.
#[test]
fn a_loop_of_lines_that_neither_move_nor_wait_is_refused_where_it_turns() {
    let setup = setup_with(6000, 900);
    for line in IDLE_LINES.into_iter().chain(["M150"]) {
        let loops = [
            (format!("o1 while [1]\n{line}\no1 endwhile\nM2\n"), 3),
            (format!("o1 while [#5399 EQ 0]\n{line}\no1 endwhile\nM2\n"), 3),
            (format!("o1 do\n#1=[#1+1]\n{line}\no1 while [1]\nM2\n"), 4),
            (
                format!("G0 X1\nG0 X0\no1 repeat [1000000]\n#1=[#1+1]\n{line}\no1 endrepeat\nM2\n"),
                6,
            ),
        ];
        for (program, turns_in) in loops {
            let found = errors_of(&program, &setup);
            let [found] = &found[..] else { panic!("{program}: {found:?}") };
            assert_eq!((found.code, found.span.line), ("I0803", turns_in), "{program}");
            let help = found.help.as_deref().unwrap_or_default();
            assert!(help.contains("G4 P0.1"), "{program}: {help}");
        }
    }
}

/// What a check does not see, because the machine answers otherwise than is assumed.
#[test]
fn a_loop_that_polls_while_the_program_runs_is_refused_after_a_stated_number_of_readings() {
    let program = "G0 X1\nM66 P0 L3 Q1\no1 while [#5399 EQ 0]\nM66 P0 L0\no1 endwhile\nG0 X0\nM2\n";
    let setup = setup_with(1_000_000, 500);
    assert_eq!(errors_of(program, &setup).len(), 0, "it is taken to have come");
    let mut live = interp::Live::new(program, setup, None);
    let mut answered = 0;
    while answered < 2000 {
        while live.next_op().is_some() {}
        if live.asked() == 0 {
            break;
        }
        live.answer(&canon::Answer::Input(Some(0.0)));
        answered += 1;
    }
    let found: Vec<_> = live.findings().into_iter().filter(diag::Diagnostic::is_error).collect();
    let [found] = &found[..] else { panic!("{found:?}") };
    assert_eq!((found.code, found.span.line, answered), ("I0803", 5, 502));
    assert!(found.message.contains("has read the machine 500 times"), "{}", found.message);
}
