//! What is looked for ahead of execution is what execution comes to, and costs a few stretches of it.
use crate::analysis::tests::{edits, finish, holds_over_edits, lines, open, replace};
use crate::analysis::{Analysis, SLICE};
use crate::document::Document;
use interp::{Dialect, Setup};
use lsp_types::PositionEncodingKind;
use proptest::prelude::*;

/// Lines that a program has by the thousand.
const PLAIN: &[&str] = &[
    "X1 Y2",
    "X3.5",
    "Y-1 Z2",
    "Z-1",
    "G1 X5 F100",
    "G0 Y3",
    "G2 X3 Y2 I1 J1",
    "G3 X4 Y1 R20",
    "N7 X2 Y1",
    "G91",
    "G90",
    "G99",
    "X2 Y2",
    "Z3 A5",
    "U1",
];
const CYCLES: &[&str] = &[
    "G81 X1 Y1 Z-1 R2",
    "X2",
    "Y3",
    "X1.5 Y2",
    "G98",
    "G99",
    "G83 X1 Z-2 R1 Q1",
    "G80",
    "G0 Z9",
    "F90",
];
const MACRO: &[&str] = &[
    "#1=5",
    "#2=[#1+1]",
    "#3=#2",
    "X#1",
    "Y[#2*2]",
    "#<a>=4",
    "#<_b>=[#<a>+1]",
    "Z#<_b>",
    "X3 Y4",
    "o4 call [#2]",
    "o4 call [1]",
    "G91",
    "G90",
    "#5=7",
];
const TAPE: &[&str] = &[
    "X1. Y2.",
    "X3.5",
    "Y-1. Z2.",
    "G1 X5. F100.",
    "G0 Y3.",
    "G2 X3. Y2. I1. J1.",
    "N7 X2. Y1.",
    "#101=5.",
    "X#101",
    "#102=#101+1.",
    "G91",
    "G90",
    "IF [#101 LT 3] GOTO 7",
    "G81 X1. Z-1. R2.",
    "G80",
    "M98 P7",
];
/// What is done to their beginnings.
const MODES: &[&str] = &[
    "G55",
    "G92 X3 Y1",
    "G52 X2",
    "G10 L2 P1 X3 R10",
    "G20",
    "G21",
    "G18",
    "G17",
    "F250",
    "S300 M4",
    "M8",
    "T2 M6",
    "G43 H1",
    "G49",
    "G98",
    "G99",
    "G91",
    "G90",
    "G0",
    "G1",
    "G80",
    "G41 D1",
    "G40",
    "#1=9",
    "#2=3",
    "#<a>=2",
    "#<_b>=8",
    "X2",
    "Z7",
    "G64 P0.1",
    "G61",
    "G95 F1",
    "X[",
    "(o)",
    "",
    "G68 X0 Y0 R30",
    "#101=2",
    "M70",
];

fn program(head: &str, body: &str, end: &str) -> String {
    format!("{head}{body}{end}\n")
}

/// Blocks executed for this line.
fn steps(document: &Document, analysis: &mut Analysis, line: u32) -> u64 {
    analysis.steps.set(0);
    assert!(analysis.visit(document, line, None).is_some());
    analysis.steps.get()
}

#[test]
fn what_an_edit_does_not_matter_to_is_not_executed_again() {
    let head = "G21 G90\nF100 G1\nG54\nT1 M6\nZ5\nX0 Y0\n";
    let many = |line: &dyn Fn(i32) -> String| (0..40_000).map(line).collect::<Vec<_>>().concat();
    let absolute = many(&|i| format!("X{} Y{}\n", i % 97, i % 89));
    let relative = format!("G91\n{}", many(&|i| format!("X{} Y{}\n", i % 3, i % 5 - 2)));
    let holes = format!("G99 G81 X1 Y1 Z-1 R2\n{absolute}");
    for body in [absolute, relative, holes] {
        let (mut document, mut analysis) = open(program(head, &body, "M2"));
        finish(&document, &mut analysis);
        let end = document.lines() as u32 - 3;
        for (line, text) in
            [(5, "X7"), (2, "G55;"), (3, "T2"), (1, "F90"), (5, "#5=3\nX2"), (2, "G92 X4")]
        {
            let edit = document.apply(replace(line, text));
            analysis.edited(&edit, &document);
            let lines = end + u32::from(document.lines() as u32 > end + 3);
            let steps = steps(&document, &mut analysis, lines);
            assert!(steps < 3 * SLICE, "{steps} blocks after {text} before {}", &body[..30]);
            finish(&document, &mut analysis);
        }
    }
}

#[test]
fn loops_and_subprograms_are_passed_over_too() {
    let head = "o1 sub\nG1 X#1 Y#2\nG91\nZ0.1\nG90\no1 endsub\nG21 G90\nF100 G1\nG54\nX0 Y0\n";
    let round = |i: u32| {
        format!("#5=[#6+{i}]\no{} if [#5 gt 50]\n#5=0\no{} endif\no1 call [#5] [2]\n", i + 9, i + 9)
    };
    let body: String = (0..4000).map(round).collect();
    let (mut document, mut analysis) = open(program(head, &body, "M2"));
    finish(&document, &mut analysis);
    let end = document.lines() as u32 - 3;
    for (line, text) in [(9, "X7"), (8, "G55;"), (9, "#7=4\nX2"), (1, "G0")] {
        let edit = document.apply(replace(line, text));
        analysis.edited(&edit, &document);
        let far =
            steps(&document, &mut analysis, end + u32::from(document.lines() as u32 > end + 3));
        // a line of the subprogram is one of every stretch
        let most = if line == 1 { u64::MAX } else { 3 * SLICE };
        assert!(far < most, "{far} blocks after {text}");
        finish(&document, &mut analysis);
    }
}

fn tail(menu: &'static [&'static str]) -> impl Strategy<Value = Vec<(u32, u32, String, usize)>> {
    // at the beginning, so that much follows; all executed before, so that all of it can be passed over
    let edit = (0..9_u32, 0..3_u32, lines(menu, 3), 20..60_usize);
    prop::collection::vec(edit, 1..5)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    #[test]
    fn plain_lines_stand_as_if_read_anew(body in lines(PLAIN, 150), edits in tail(MODES)) {
        let head = "G21 G90\nF100 S500 M3\nG54\nT1 M6\nZ5\nX1 Y2 Z3\nG1 X0\n\n";
        holds_over_edits(Dialect::LinuxCnc, program(head, &body, "M2"), &edits);
    }

    #[test]
    fn so_do_cycles(body in lines(CYCLES, 150), edits in tail(MODES)) {
        let head = "G21 G90\nF100 S500 M3\nG54\nT1 M6\nZ5\nX1 Y2 Z3\nG81 X1 Z-1 R2\n\n";
        holds_over_edits(Dialect::LinuxCnc, program(head, &body, "M2"), &edits);
    }

    #[test]
    fn so_do_macros(body in lines(MACRO, 100), more in lines(PLAIN, 40), edits in tail(MODES)) {
        let head = "o4 sub\nX#1\n#2=8\nY#2\no4 endsub\nG21 G90 G1\nF100 S500 M3\n#1=2 #<a>=1\n#<_b>=3\n";
        holds_over_edits(Dialect::LinuxCnc, program(head, &(body + &more), "M2"), &edits);
    }

    #[test]
    fn so_do_tapes_of_plain_lines(body in lines(TAPE, 100), edits in tail(MODES)) {
        let head = "O1\nG21 G90\nF100 S500 M3\nG54\nT1 M6\nZ5.\nX1. Y2.\n#101=1.\n";
        holds_over_edits(Dialect::Fanuc, program(head, &body, "M30\nO7\nX#101\nM99"), &edits);
    }

    #[test]
    fn so_they_do_while_they_are_written(body in lines(PLAIN, 90), more in lines(MACRO, 60), edits in edits(PLAIN)) {
        let head = "o4 sub\nX#1\n#2=8\nY#2\no4 endsub\nG21 G90 G1\nF100 S500 M3\n#1=2 #<a>=1\n#<_b>=3\n";
        holds_over_edits(Dialect::LinuxCnc, program(head, &(body + &more), "M2"), &edits);
    }
}

#[test]
fn a_line_that_is_never_executed_is_not_found_ahead() {
    let document = Document::new("G21\nM2\nG0 X1\n".to_owned(), &PositionEncodingKind::UTF16);
    let mut analysis = Analysis::new(Setup::default());
    assert!(analysis.ahead(&document, 3).is_none());
    assert!(analysis.ahead(&document, 2).is_some());
}

#[test]
fn a_call_of_a_tape_goes_back_to_where_its_block_has_moved() {
    let head = "O1\nG21 G90\nF100 S500 M3\nG54\nT1 M6\nZ5.\nX1. Y2.\n#101=1.\n";
    let body = "X#101\nX1. Y2.\nX#101\nN7 X2. Y1.\nX1. Y2.\nM98 P7\nX1. Y2.\nX1. Y2.\nX1. Y2.\nIF [#101 LT 3] GOTO 7\n";
    let text = program(head, body, "M30\nO7\nX#101\nM99");
    holds_over_edits(Dialect::Fanuc, text, &[(3, 1, "G49\n".to_owned(), 35)]);
}

#[test]
fn numbered_blocks_and_o_words_come_and_go_without_the_rest_being_executed_again() {
    let round = |i: u32| format!("IF[#101 LT 5.]GOTO{i}\n#101=0\nN{i} G1 X{}.\n", i % 97);
    let tape: String = (10..9000).map(round).collect();
    let round = |i: u32| format!("o{i} if [#5 gt 50]\n#5=0\no{i} endif\nX{}\n", i % 97);
    let loops: String = (10..6000).map(round).collect();
    let of_tape = [(6, "N9 X7."), (6, "X5."), (1, "(note)\nG2"), (7, "N9 X7.\nN8 X8.")];
    let of_loops = [(5, "o1 if [1]\no1 endif"), (7, "X3"), (7, "o2 repeat [2]\nX1\no2 endrepeat")];
    for (dialect, text, edits) in [
        (
            Dialect::Fanuc,
            program("O1\nG21 G90\nF100. G1\nG54\nX0. Y0.\n#101=1.\nX1.\n", &tape, "M30"),
            &of_tape[..],
        ),
        (
            Dialect::LinuxCnc,
            program("G21 G90\nF100 G1\nG54\nX0 Y0\n#5=1\nX1\nX2\n", &loops, "M2"),
            &of_loops,
        ),
    ] {
        let mut document = Document::new(text, &PositionEncodingKind::UTF16);
        let mut analysis = Analysis::new(Setup { dialect, ..interp::example_setup(dialect) });
        finish(&document, &mut analysis);
        for (line, text) in edits {
            let edit = document.apply(replace(*line, text));
            analysis.edited(&edit, &document);
            let end = document.lines() as u32 - 2;
            let steps = steps(&document, &mut analysis, end);
            assert!(steps < 3 * SLICE, "{steps} blocks after {text}");
            finish(&document, &mut analysis);
        }
    }
}

#[test]
fn a_call_more_or_less_leaves_the_others_as_they_were() {
    let call = |i: u32| format!("G0 X{}. Y{}.\nM98 P7\n", i % 97, i % 89);
    let tape: String = (0..4000).map(call).collect();
    let call = |i: u32| format!("o1 call [{}] [{}]\n", i % 97, i % 89);
    let calls: String = (0..6000).map(call).collect();
    let head = "O1\nG21 G90\nF100. G1\nG0 X0. Y0.\nM98 P7\nX1.\n";
    let tape = program(head, &tape, "M30\nO7\nG91 X1.\nG1 Y2.\nG90\nM99\n");
    let head =
        "o1 sub\nG1 X#1 Y#2\nG91 Z1\nG90\no1 endsub\nG21 G90\nF100 G1\nX0 Y0\no1 call [2]\nX1\n";
    let calls = program(head, &calls, "M2");
    for (dialect, text, line) in [(Dialect::Fanuc, tape, 4), (Dialect::LinuxCnc, calls, 8)] {
        let mut document = Document::new(text, &PositionEncodingKind::UTF16);
        let end = document.lines() as u32 - 12;
        let mut analysis = Analysis::new(Setup { dialect, ..interp::example_setup(dialect) });
        analysis.setup.limits.blocks = 100_000;
        finish(&document, &mut analysis);
        // the call becomes a note, another one, and a line that moves
        for text in ["(", "(n", "X2.\n("] {
            let edit = document.apply(replace(line, text));
            analysis.edited(&edit, &document);
            let steps = steps(&document, &mut analysis, end);
            assert!(steps < 3 * SLICE, "{steps} blocks after {text}");
            finish(&document, &mut analysis);
        }
    }
}

#[test]
fn a_corner_is_cut_for_the_block_behind_it_also_where_a_slice_ends_between_them() {
    // slices end after every twelfth block
    let line = |i: usize| format!("X{}.\n", i + 1);
    let fill = |count: usize| (0..count).map(line).collect::<Vec<_>>().concat();
    for before in 7..9 {
        let head = "O1\nG21 G90 G94\nF100 G1\n";
        let text =
            format!("{head}{}X50. ,C2.\nY10. ,C3.\nX0. ,R1.\nY0.\n{}M30\n", fill(before), fill(30));
        // what is written before the corner's second way, or in the place of its first two letters
        let corner = before as u32 + 4;
        for (line, character, new) in [
            (corner, 0, "Y-10. ,C3.\n"),
            (corner, 0, "G0 Y10.\n"),
            (corner, 0, "X90.\n"),
            (corner, 12, "Y-1"),
            (corner, 12, "X1"),
            // farther into its line than the corner's block has read
            (corner, 13, "1"),
            (corner, 2, "5"),
            (corner + 1, 0, "X70. ,R1.\n"),
            (corner + 1, 12, "(X"),
        ] {
            holds_over_edits(Dialect::Fanuc, text.clone(), &[(line, character, new.to_owned(), 9)]);
        }
    }
}
