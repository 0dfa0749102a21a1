//! Programs as hobby CAM posts make them and senders stream them to Grbl.
use canon::OpKind;
use diag::Diagnostic;
use interp::{CodeAction, Dialect, Leaves, MachineCode, MissingTools, Ops, Setup, looks_like};

fn read(text: &str, setup: &Setup) -> (Vec<OpKind>, Vec<Diagnostic>) {
    let mut ops = Ops::new(text.as_bytes(), setup);
    let kinds = ops.by_ref().map(|op| op.kind).collect();
    (kinds, ops.diagnostics())
}

fn grbl() -> Setup {
    Setup { dialect: Dialect::Grbl, missing_tools: MissingTools::StandIn, ..Setup::default() }
}

fn codes(found: &[Diagnostic]) -> Vec<&'static str> {
    found.iter().map(|finding| finding.code).collect()
}

#[test]
fn lines_for_the_controller_are_left_out_and_said_once() {
    let (kinds, found) = read("$H\n$X\n?\nG21\nG0 X1\n$10=1\nM2\n", &grbl());
    assert_eq!(codes(&found), ["P0196"]);
    assert_eq!(kinds.iter().filter(|kind| matches!(kind, OpKind::Rapid { .. })).count(), 1);
}

#[test]
fn a_program_ends_with_its_text_and_begins_with_g0() {
    let (kinds, found) = read("%\nG21 G90\nX10 Y5\nG1 X20 F300\n%\nM5\n", &grbl());
    assert_eq!(codes(&found), ["I0323"]);
    assert!(matches!(kinds.last(), Some(OpKind::End)), "{kinds:?}");
    assert!(kinds.iter().any(|kind| matches!(kind, OpKind::Rapid { .. })));
    // elsewhere it is an error, unless the machine lets it be
    let (_, found) = read("G0 X10\n", &Setup::default());
    assert_eq!(codes(&found), ["I0301"]);
    let leaves = Leaves { end: true, ..Leaves::default() };
    let (_, found) = read("G0 X10\n", &Setup { leaves, ..Setup::default() });
    assert_eq!(codes(&found), ["I0323"]);
}

#[test]
fn words_of_a_post_that_say_nothing_are_none() {
    let (_, found) = read("G1 X0 F100\nG2 X10 I5 J0 K0.000\nM2\n", &grbl());
    assert_eq!(codes(&found), [""; 0]);
    let (_, found) = read("G1 X0 F100\nG2 X10 I5 J0 K1\nM2\n", &grbl());
    assert_eq!(codes(&found), ["I0410"]);
}

#[test]
fn a_feed_that_is_missing_is_the_machines_or_an_error() {
    let text = "G21\nG1 X5\nX10\nM2\n";
    let (_, found) = read(text, &grbl());
    assert!(codes(&found).contains(&"I0408"), "{found:?}");
    let feed = Some(units::Speed::mm_per_min(500.0));
    let setup = Setup { leaves: Leaves { feed, ..Leaves::default() }, ..grbl() };
    let (kinds, found) = read(text, &setup);
    assert_eq!(codes(&found), ["I0324"]);
    let feeds: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            OpKind::Line { feed, .. } => Some(format!("{feed:?}")),
            _ => None,
        })
        .collect();
    assert_eq!(feeds.len(), 2);
    // the same in inches: 500 mm/min all the same
    let (_, found) = read("G20\nG1 X5\nM2\n", &setup);
    assert!(found[0].message.contains("F19.685"), "{}", found[0].message);
}

#[test]
fn m_codes_of_a_builder_are_named_let_pass_or_refused() {
    let text = "M31\nG0 X1.\nM31\nM165 P9\nM2\n";
    let (_, found) = read(text, &grbl());
    assert_eq!(codes(&found), ["I0105", "I0105", "I0645"]);
    let leaves = Leaves { unknown_codes: true, ..Leaves::default() };
    for dialect in [Dialect::Grbl, Dialect::LinuxCnc, Dialect::Fanuc] {
        let text = if dialect == Dialect::Fanuc { format!("O1\n{text}") } else { text.to_owned() };
        let (_, found) = read(&text, &Setup { leaves, dialect, ..grbl() });
        assert_eq!(codes(&found), ["I0646", "I0646"], "{}", dialect.name());
    }
    let code = |number, action| MachineCode { number, name: "blow".into(), action };
    let user_codes = vec![
        code(31, CodeAction::Output { number: 3, on: true }),
        code(165, CodeAction::Wait(units::Time::s(0.5))),
    ];
    let (kinds, found) = read(text, &Setup { user_codes, ..grbl() });
    assert_eq!(codes(&found), [""; 0]);
    let count = |is: fn(&OpKind) -> bool| kinds.iter().filter(|kind| is(kind)).count();
    assert_eq!(count(|kind| matches!(kind, OpKind::Output(output) if output.number == 3)), 2);
    assert_eq!(count(|kind| matches!(kind, OpKind::Dwell { .. })), 1);
    assert_eq!(count(|kind| matches!(kind, OpKind::UserCode(_))), 3);
}

/// The first block of Tormach's post for Fusion 360.
#[test]
fn the_end_of_a_scaling_is_left_out() {
    let text = "G90 G54 G64 G50 G17 G40 G80 G94 G91.1 G49\nG21\nG50\nG1 X1 F100\nM2\n";
    let (kinds, found) = read(text, &grbl());
    assert_eq!(codes(&found), ["I0113"]);
    assert!(kinds.iter().any(|kind| matches!(kind, OpKind::Line { .. })));
    let (_, found) = read("G50\nM2\n", &Setup::default());
    assert_eq!(codes(&found), ["I0102"], "LinuxCNC has no such code");
    let (_, found) = read("G51 X2\nM2\n", &grbl());
    assert_eq!(codes(&found), ["I0102"]);
}

#[test]
fn a_program_tells_that_it_is_for_grbl() {
    for text in ["$H\nG21\nG0 X1\nM2\n", "(Made with a post for GRBL)\nG21\nG0 X1\nM2\n"] {
        assert_eq!(looks_like(text.as_bytes(), Dialect::LinuxCnc), Some(Dialect::Grbl), "{text}");
    }
    for text in
        ["G21\nG0 X1\nM2\n", "G21\nG0 X1\n", "%\nG21\nG0 X1\n%\n", "o1 sub\nG0 X1\no1 endsub\n"]
    {
        assert_eq!(looks_like(text.as_bytes(), Dialect::LinuxCnc), None, "{text}");
    }
}

#[test]
fn a_printers_program_gets_one_sentence() {
    let moves = "G1 X1 E1\n".repeat(300);
    let text = format!("M140 S60\nM104 S200\nG28\nM862.3 P \"MK3\"\n{moves}M84\n");
    for dialect in Dialect::ALL {
        let found = interp::check(text.as_bytes(), &Setup { dialect, ..Setup::default() });
        assert_eq!(codes(&found), ["I0910"], "{}", dialect.name());
    }
    // a polygon's E, a laser's fan, and what a builder calls by these numbers make no printer
    let shop = "O1\nM104\nM140\nM82\nM109\nG1 X1. F100.\nM30\n";
    let setup = Setup { dialect: Dialect::Fanuc, ..Setup::default() };
    assert!(!codes(&interp::check(shop.as_bytes(), &setup)).contains(&"I0910"));
    assert!(!codes(&read("M106 P0\nG1 X1 F100\nM2\n", &grbl()).1).contains(&"I0910"));
}

/// Grbl throws away what stands up to the first closing bracket.
#[test]
fn a_comment_ends_at_its_first_closing_bracket() {
    let (_, found) = read("(REPLACE (CUT); all of this)\nG1 X1 F100\nM2\n", &grbl());
    assert!(found.is_empty(), "{found:?}");
    let (_, found) = read("(ENDMILL, 3MM (R))\nG1 X1 F100\nM2\n", &grbl());
    assert_eq!(codes(&found), ["P0113"]);
    let (_, found) = read("(REPLACE (CUT); all of this)\nG1 X1 F100\nM2\n", &Setup::default());
    assert_eq!(codes(&found), ["P0112"]);
}
