//! Interpretation kept over edits is the interpretation of the edited text.
use super::*;
use interp::Dialect;
use lsp_types::{PositionEncodingKind, TextDocumentContentChangeEvent};
use proptest::prelude::*;

pub(crate) fn open(text: String) -> (Document, Analysis) {
    let document = Document::new(text, &PositionEncodingKind::UTF16);
    (document, Analysis::new(Setup::default()))
}

pub(crate) fn finish(document: &Document, analysis: &mut Analysis) {
    while !analysis.is_done() {
        analysis.advance(document);
    }
}

pub(crate) fn x_after(document: &Document, analysis: &mut Analysis, line: u32) -> Option<f64> {
    analysis.visit(document, line, None).map(|visit| visit.after.program[0])
}

/// G91 steps of 1: X after line n is n − 2.
fn staircase(steps: usize) -> String {
    format!("G21 G91\nF100 G1\n{}M2\n", "X1\n".repeat(steps))
}

pub(crate) fn replace(line: u32, text: &str) -> TextDocumentContentChangeEvent {
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
    let edit = document.apply(replace(16_000, "X5"));
    analysis.edited(&edit, &document);
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
    let edit = document.apply(TextDocumentContentChangeEvent {
        range: Some(lsp_types::Range {
            start: lsp_types::Position::new(1, 4),
            end: lsp_types::Position::new(1, 5),
        }),
        range_length: None,
        text: "9".into(),
    });
    analysis.edited(&edit, &document);
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
fn what_follows_an_edit_follows_again_where_things_stand_as_before() {
    let steps: Vec<_> = (0..20_000).map(|i| format!("X{} Y{}\n", i % 97, i % 89)).collect();
    let steps = steps.concat();
    let (mut document, mut analysis) = open(format!("G21 G90\nF100 G1\n{steps}M2\n"));
    finish(&document, &mut analysis);
    let slices = analysis.slices;
    for text in ["X7 Y8\nX", "(\n) X", ""] {
        let edit = document.apply(replace(3, text));
        analysis.edited(&edit, &document);
        finish(&document, &mut analysis);
    }
    assert!(analysis.slices <= slices + 3, "{} slices were executed", analysis.slices - slices);
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

pub(crate) fn lines(menu: &'static [&'static str], most: usize) -> impl Strategy<Value = String> {
    let line = prop::sample::select(menu);
    prop::collection::vec(line, 0..most)
        .prop_map(|lines| lines.iter().fold(String::new(), |text, line| text + line + "\n"))
}

/// Edit by edit, with slices executed between them: every line stands as in an interpretation from the beginning.
pub(crate) fn holds_over_edits(
    dialect: Dialect,
    text: String,
    edits: &[(u32, u32, String, usize)],
) {
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
        let edit = document.apply(change);
        analysis.edited(&edit, &document);
        let now = String::from_utf8(document.text.clone()).unwrap();
        let fresh_document = Document::new(now.clone(), &encoding);
        let mut fresh = Analysis::new(setup());
        for line in 1..=document.lines() as u32 {
            let both = |visit: Option<Visit>| {
                visit.map(|v| (rounded(v.before), rounded(v.after), v.parameter))
            };
            let found = both(analysis.visit(&document, line, Some("#1")));
            let wanted = both(fresh.visit(&fresh_document, line, Some("#1")));
            prop_assert_same(&found, &wanted, &format!("line {line} of\n{now}"));
        }
        finish(&document, &mut analysis);
        finish(&fresh_document, &mut fresh);
        let sorted = |analysis: &Analysis| {
            let mut all: Vec<_> = analysis
                .findings()
                .into_iter()
                .map(|f| (f.span.start, f.span.line, f.span.end, f.code, f.message))
                .collect();
            all.sort();
            all
        };
        prop_assert_same(&sorted(&analysis), &sorted(&fresh), &format!("findings of\n{now}"));
    }
}

/// Sums that were made in another order differ in their last bits.
fn rounded(mut standing: Standing) -> (Standing, [f64; 9]) {
    let round = |value: f64| (value * 1e6).round() / 1e6 + 0.0;
    let machine = canon::Axis::ALL.map(|axis| round(crate::hover::along(&standing.machine, axis)));
    standing.program = standing.program.map(round);
    standing.machine = canon::Position::xyz(0.0, 0.0, 0.0);
    (standing, machine)
}

fn prop_assert_same<T: PartialEq + std::fmt::Debug>(found: &T, wanted: &T, what: &str) {
    assert!(found == wanted, "{what}\nfound {found:?}\nwanted {wanted:?}");
}

pub(crate) fn edits(
    menu: &'static [&'static str],
) -> impl Strategy<Value = Vec<(u32, u32, String, usize)>> {
    let edit = (any::<u32>(), any::<u32>(), lines(menu, 3), 0..12_usize);
    prop::collection::vec(edit, 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(40) })]

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
