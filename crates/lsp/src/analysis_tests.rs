//! Interpretation kept over edits is the interpretation of the edited text.
use super::*;
use gcode::Grammar;
use interp::Dialect;
use lsp_types::{PositionEncodingKind, TextDocumentContentChangeEvent};
use proptest::prelude::*;

fn open(text: String) -> (Document, Analysis) {
    let document = Document::new(text, &PositionEncodingKind::UTF16);
    (document, Analysis::new(Setup::default()))
}

fn finish(document: &Document, analysis: &mut Analysis) {
    while !analysis.is_done() {
        analysis.advance(document);
    }
}

fn x_after(document: &Document, analysis: &mut Analysis, line: u32) -> Option<f64> {
    analysis.visit(document, line, None).map(|visit| visit.after.program[0])
}

/// G91 steps of 1: X after line n is n − 2.
fn staircase(steps: usize) -> String {
    format!("G21 G91\nF100 G1\n{}M2\n", "X1\n".repeat(steps))
}

fn replace(line: u32, text: &str) -> TextDocumentContentChangeEvent {
    use lsp_types::{Position, Range};
    let range = Range { start: Position::new(line, 0), end: Position::new(line, 2) };
    TextDocumentContentChangeEvent { range: Some(range), range_length: None, text: text.into() }
}

#[test]
fn each_block_is_known_before_and_after() {
    let (document, mut analysis) = open(staircase(5000));
    let visit = analysis.visit(&document, 4002, None);
    let both = visit.map(|v| (v.before.program[0], v.after.program[0]));
    assert_eq!(both, Some((3999.0, 4000.0)));
}

#[test]
fn an_edit_keeps_what_lies_before_it_and_changes_what_follows() {
    let (mut document, mut analysis) = open(staircase(20_000));
    finish(&document, &mut analysis);
    let edit = document.apply(replace(16_000, "X5"), Grammar::Rs274);
    analysis.edited(&edit);
    assert!(analysis.kept.len() >= 3, "snapshots before the edit were thrown away");
    assert_eq!(x_after(&document, &mut analysis, 3000), Some(2998.0));
    assert_eq!(x_after(&document, &mut analysis, 16_001), Some(15_999.0 + 4.0));
    finish(&document, &mut analysis);
    assert_eq!(x_after(&document, &mut analysis, 20_002), Some(20_004.0));
}

#[test]
fn an_edit_in_a_subprogram_that_was_executed_starts_anew() {
    let text = "o1 sub\nG0 X1\no1 endsub\nG21 G90\no1 call\nM2\n";
    let (mut document, mut analysis) = open(text.to_owned());
    finish(&document, &mut analysis);
    let edit = document.apply(
        TextDocumentContentChangeEvent {
            range: Some(lsp_types::Range {
                start: lsp_types::Position::new(1, 4),
                end: lsp_types::Position::new(1, 5),
            }),
            range_length: None,
            text: "9".into(),
        },
        Grammar::Rs274,
    );
    analysis.edited(&edit);
    assert_eq!(x_after(&document, &mut analysis, 2), Some(9.0));
}

#[test]
fn a_line_never_executed_has_no_visit() {
    let (document, mut analysis) = open("G21\nM2\nG0 X1\n".to_owned());
    assert!(analysis.visit(&document, 3, None).is_none());
}

#[test]
fn an_endless_loop_does_not_hold_the_editor() {
    let (document, mut analysis) = open("o1 while [1]\no1 endwhile\nM2\n".to_owned());
    analysis.setup.limits.blocks = 600_000;
    finish(&document, &mut analysis);
    assert!(analysis.kept.len() <= MOST_KEPT + 1);
    assert!(analysis.findings().is_empty());
}

#[test]
fn an_edited_line_is_known_after_one_slice_from_the_snapshot_before_it() {
    for (dialect, end) in [(Dialect::LinuxCnc, "M2\n"), (Dialect::Fanuc, "M30\n")] {
        let text = format!("G21 G91\nF100. G1\n{}{end}", "X1.\n".repeat(100_000));
        let mut document = Document::new(text, &PositionEncodingKind::UTF16);
        let limits = interp::Limits::default();
        let setup = Setup { dialect, limits, ..interp::example_setup(dialect) };
        let mut analysis = Analysis::new(setup);
        finish(&document, &mut analysis);
        let all = analysis.slices;
        assert_eq!(u64::from(all), 100_003_u64.div_ceil(SLICE));
        for line in [90_000, 50_000, 10] {
            let edit = document.apply(replace(line, "X5"), dialect.grammar());
            analysis.edited(&edit);
            let before = analysis.slices;
            assert!(x_after(&document, &mut analysis, line + 1).is_some());
            assert!(analysis.slices <= before + 1, "line {line} of {dialect:?}");
            finish(&document, &mut analysis);
            let again = u64::from(analysis.slices - before);
            let behind = u64::from(100_003 - line);
            assert!(again <= behind.div_ceil(SLICE) + 1, "{again} slices behind line {line}");
        }
    }
}

#[test]
fn a_line_that_was_executed_is_at_most_one_slice_behind_a_snapshot() {
    let (document, mut analysis) = open(staircase(100_000));
    finish(&document, &mut analysis);
    let slices = analysis.slices;
    for line in [100_002, 100_001, 51_234, 2] {
        let block = analysis.first_block(&document, line).unwrap();
        let from = analysis.slice_before(block).map_or(0, Slice::end);
        assert!(block - from <= SLICE, "{} blocks up to line {line}", block - from);
    }
    assert_eq!(x_after(&document, &mut analysis, 100_002), Some(100_000.0));
    assert_eq!(analysis.slices, slices, "nothing is executed again for a hover");
}

#[test]
fn a_line_far_behind_what_was_executed_is_not_waited_for() {
    let (document, mut analysis) = open(staircase(200_000));
    assert!(analysis.visit(&document, 200_002, None).is_none());
    assert!(!analysis.is_done());
    finish(&document, &mut analysis);
    assert_eq!(x_after(&document, &mut analysis, 200_002), Some(200_000.0));
}

/// Lines of which programs are made: what carries over, what does not, and what is wrong.
const LINES: &[&str] = &[
    "G0 X1 Y2",
    "G1 X5 F100",
    "G2 X3 Y2 I1 J1",
    "X7",
    "Z-1",
    "G90",
    "G91",
    "G20",
    "G21",
    "G54",
    "G55",
    "G92 X3",
    "#1=5",
    "#1=[#1+1]",
    "X#1",
    "#<a>=#<_line>",
    "#<a>=#<_x>",
    "X#<a>",
    "(note)",
    "",
    "G41 D1",
    "G40",
    "G81 Z-1 R2",
    "G80",
    "M3 S100",
    "T1 M6",
    "G43",
    "M70",
    "M72",
    "X[",
    "G1 G2",
    "Q9",
    "G33 Z-1 K1",
    "G5.2 X1 Y1",
    "G5.3",
    "M62 P1",
    "G3 X4 Y1 R20",
    "G91 G2 X1 Y1 I1 J0",
    "G17",
    "G18",
    "F250",
    "S300",
    "M8",
    "G98",
    "G99",
    "G83 X2 Z-3 R1 Q1",
    "G52 Y1",
    "G10 L2 P1 X3 R10",
    "G64 P0.1",
    "G53 G0 X1",
    "G95 F1",
    "G94 F100",
    "G49",
    "#2=#1",
    "Y[#2*2] Z#1",
    "G28",
];
const STEERING: &[&str] = &[
    "o1 if [#1 gt 3]",
    "o1 endif",
    "o2 repeat [3]",
    "o2 endrepeat",
    "o3 while [#1 lt 9]",
    "o3 endwhile",
    "o4 sub",
    "o4 endsub",
    "o4 call [2]",
    "o4 call",
    "o5 if [#1 gt 2]\no5 endif",
    "o6 repeat [2]\nX1\no6 endrepeat",
    "M2",
    "%",
];
const FANUC: &[&str] = &[
    "G0 X1. Y2.",
    "G1 X5 F100.",
    "X7.5",
    "G90",
    "G91",
    "#1=5",
    "#100=#100+1",
    "X#1",
    "G81 Z-1. R2.",
    "G80",
    "",
    "X[",
    "IF [#100 LT 3] GOTO 5",
    "N5",
    "IF [#100 LT 5] GOTO 6",
    "N6 X3.",
    "GOTO 6",
    "WHILE [#100 LT 4] DO1",
    "END1",
    "M98 P7",
    "O7",
    "M99",
    "G65 P7 A2.",
    "M30",
    "G68 X0 Y0 R30.",
    "G69",
    "G66 P7 A1.",
    "G67",
    "Y2. Z-1.",
    "G2 X3. I1.",
    "G55",
    "G52 X2.",
    "S500",
    "F200.",
    "G99",
    "G20",
    "T2 M6",
    "#101=#100*2",
    "Y#101",
];

const LATHE: &[&str] = &[
    "G71 U2. R1.\nG71 P10 Q20 U.5 W.1 F.3\nN10 G0 X10.\nG1 Z-5.\nX20.\nN20 Z-20.",
    "G70 P10 Q20",
    "N10 G0 X12.",
    "N20 G1 X30.",
    "G1 X20. Z-3.",
    "X22.",
    "Z-9. F.1",
    "G0 X50. Z2.",
    "U1. W-1.",
    "G2 X30. Z-12. R9.",
    "T0101",
    "T0202",
    "G92 X19. Z-10. F1.5",
    "G90 X18. Z-8.",
    "G96 S120",
    "G97 S600",
    "G50 S2000",
    "#100=#100+1",
    "IF [#100 LT 3] GOTO 5",
    "N5",
    "M98 P7",
    "M30",
    "O7",
    "M99",
    "X[",
    "G999",
    "",
];

fn lines(menu: &'static [&'static str], most: usize) -> impl Strategy<Value = String> {
    let line = prop::sample::select(menu);
    prop::collection::vec(line, 0..most)
        .prop_map(|lines| lines.iter().fold(String::new(), |text, line| text + line + "\n"))
}

/// Edit by edit, with slices executed between them: every line stands as in an interpretation from
/// the beginning.
fn holds_over_edits(dialect: Dialect, text: String, edits: &[(u32, u32, String, usize)]) {
    let encoding = PositionEncodingKind::UTF16;
    let mut document = Document::new(text, &encoding);
    let setup = || {
        let mut setup = Setup { dialect, ..interp::example_setup(dialect) };
        setup.limits.blocks = 5000; // some loops never end
        setup
    };
    let mut analysis = Analysis::new(setup());
    analysis.slice = 12;
    for (line, character, new, slices) in edits {
        for _ in 0..*slices {
            analysis.advance(&document);
        }
        let line = line % document.lines() as u32;
        let mut change = replace(line, new);
        if let Some(range) = &mut change.range {
            range.start.character = character % 3;
            range.end = lsp_types::Position::new(line + character / 3 % 4, character % 5);
        }
        let edit = document.apply(change, dialect.grammar());
        analysis.edited(&edit);
        let now = String::from_utf8(document.text.clone()).unwrap();
        let fresh_document = Document::new(now.clone(), &encoding);
        let mut fresh = Analysis::new(setup());
        for line in 1..=document.lines() as u32 {
            let both = |visit: Option<Visit>| visit.map(|v| (v.before, v.after, v.parameter));
            let found = both(analysis.visit(&document, line, Some("#1")));
            let wanted = both(fresh.visit(&fresh_document, line, Some("#1")));
            assert_eq!(found, wanted, "line {line} of\n{now}");
        }
        finish(&document, &mut analysis);
        finish(&fresh_document, &mut fresh);
        assert_eq!(analysis.findings(), fresh.findings(), "findings of\n{now}");
    }
}

fn edits(menu: &'static [&'static str]) -> impl Strategy<Value = Vec<(u32, u32, String, usize)>> {
    let edit = (any::<u32>(), any::<u32>(), lines(menu, 3), 0..12_usize);
    prop::collection::vec(edit, 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(test_support::size::of(40, 800)) })]

    #[test]
    fn edited_programs_are_as_if_read_anew(text in lines(LINES, 90), edits in edits(LINES)) {
        holds_over_edits(Dialect::LinuxCnc, text + "M2\n", &edits);
    }

    #[test]
    fn so_are_those_that_steer(
        text in lines(LINES, 40),
        subs in lines(STEERING, 12),
        rest in lines(LINES, 40),
        edits in edits(STEERING),
        more in edits(LINES),
    ) {
        let text = format!("o4 sub\nX#1\nG91\no4 endsub\n{text}o2 repeat [4]\n{rest}o2 endrepeat\no4 call [1]\n{subs}M2\n");
        holds_over_edits(Dialect::LinuxCnc, text.clone(), &more);
        holds_over_edits(Dialect::LinuxCnc, text, &edits);
    }

    #[test]
    fn so_are_tapes(text in lines(FANUC, 60), edits in edits(FANUC)) {
        holds_over_edits(Dialect::Fanuc, format!("O1\n{text}M30\n"), &edits);
    }

    #[test]
    fn so_are_tapes_that_jump_before_and_call_behind_what_is_edited(
        text in lines(FANUC, 40),
        edits in edits(FANUC),
    ) {
        let loops = "WHILE [#120 LT 3] DO2\n#120=#120+1\nM98 P8\nEND2\nG66 P8\nX1.\n";
        let subprogram = "M30\nO8\nY[#120]\nM99\n";
        holds_over_edits(Dialect::Fanuc, format!("O1\n{loops}{text}{subprogram}"), &edits);
    }

    #[test]
    fn so_are_those_of_other_controls(text in lines(LINES, 60), edits in edits(LINES)) {
        holds_over_edits(Dialect::Brother, text.clone() + "M30\n", &edits);
        holds_over_edits(Dialect::Toyoda, text + "M30\n", &edits);
    }

    #[test]
    fn so_are_those_of_lathes(text in lines(LATHE, 60), edits in edits(LATHE)) {
        let text = format!("O1\nG99 F.2 S500 M3\nG0 X50. Z2.\n{text}M30\n");
        holds_over_edits(Dialect::FanucLatheA, text, &edits);
    }
}

#[test]
fn variables_of_fanuc_are_shown_as_they_are_and_vacant_ones_have_none() {
    let text = "O1\n#100=5.\nG0 X#100 Y#101\nG65 P2 A7.\nM30\nO2\nG0 Z#1\nM99\n";
    let document = Document::new(text.to_owned(), &PositionEncodingKind::UTF16);
    let setup = Setup { dialect: Dialect::Fanuc, ..Setup::default() };
    let mut analysis = Analysis::new(setup);
    let mut value = |line, name: &str| {
        analysis.visit(&document, line, Some(name)).and_then(|visit| visit.parameter)
    };
    assert_eq!(value(3, "#100"), Some(5.0));
    assert_eq!(value(3, "#101"), None);
    assert_eq!(value(7, "#1"), Some(7.0));
}

#[test]
fn what_is_written_behind_a_program_that_did_not_end_goes_on_with_it() {
    // a slice ends with the last line, and the one behind it only finds that there is no more
    let line = |i: i32| format!("X{i}.\n");
    let lines = |count: i32| (1..=count).map(line).collect::<Vec<_>>().concat();
    for count in 9..13 {
        let edits = [(count as u32 + 2, 0, String::new(), 9), (count as u32 + 2, 0, lines(2), 0)];
        let text = format!("O1\nG0\n{}", lines(count));
        holds_over_edits(Dialect::Fanuc, text.clone(), &edits);
        holds_over_edits(Dialect::LinuxCnc, text, &edits);
    }
}

#[test]
fn a_call_of_a_tape_goes_back_to_where_its_block_has_moved() {
    let head = "O1\nG21 G90\nF100 S500 M3\nG54\nT1 M6\nZ5.\nX1. Y2.\n#101=1.\n";
    let body = "X#101\nX1. Y2.\nX#101\nN7 X2. Y1.\nX1. Y2.\nM98 P7\nX1. Y2.\nX1. Y2.\nX1. Y2.\nIF [#101 LT 3] GOTO 7\n";
    let text = format!("{head}{body}M30\nO7\nX#101\nM99\n");
    holds_over_edits(Dialect::Fanuc, text, &[(3, 1, "G49\n".to_owned(), 35)]);
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

#[test]
fn a_profile_with_an_unreadable_block_is_not_cut_the_second_time_either() {
    let head = "O1\nG99 F.2 S500 M3\nG0 X50. Z2.\n";
    let text = format!("{head}G70 P10 Q20\nG70 P10 Q20\nM30\nN10 G0 X12.\n0 P\nN20 G1 X30.\n");
    holds_over_edits(Dialect::FanucLatheA, text, &[(6, 0, "\n".to_owned(), 9)]);
    let document = Document::new(
        "O1\nG99 F.2 S500 M3\nG0 X50. Z2.\nG70 P10 Q20\nG70 P10 Q20\nM30\nN10 G0 X12.\n0 P\nN20 G1 X30.\n".to_owned(),
        &PositionEncodingKind::UTF16,
    );
    let setup = Setup { dialect: Dialect::FanucLatheA, ..Setup::default() };
    let mut interpreter = Interpreter::new(&document.text, &setup);
    let mut lengths = Vec::new();
    while interpreter.step(&mut Silence) == Progress::More {
        lengths.push(interpreter.standing().codes[0].clone());
    }
    let after = |block: usize| lengths[block].clone();
    // three blocks, the call, its three; and the same again
    assert_eq!(after(6), after(10), "{lengths:?}");
}

/// The loop above it is not closed any more.
#[test]
fn a_percent_that_comes_into_a_loop_ends_the_text_there() {
    let text = format!("G0 X1\no2 repeat [4]\n{}o2 endrepeat\nM2\n", "X2\n".repeat(40));
    for line in [20, 30] {
        holds_over_edits(Dialect::LinuxCnc, text.clone(), &[(line, 0, "%\n".to_owned(), 1)]);
    }
}
