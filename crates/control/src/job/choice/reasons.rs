//! What is said of a choice.
use canon::Tool;
use diag::{Diagnostic, Span};
use interp::Dialect;

/// How a program is read, and where.
pub(super) fn read_as(dialect: Dialect, machine: &str, why: &str) -> Diagnostic {
    let text = format!("read with --dialect {} on --machine {machine}: {why}", dialect.name());
    Diagnostic::note("A0106", Span::default(), text)
        .with_help("--machine and --dialect name others; with --machine the dialect is the one of the machine's file")
}

/// How numbers without a point are read.
pub(super) fn whole_units(reason: &str) -> Diagnostic {
    let text = format!("read with --decimal-point calculator: {reason}");
    Diagnostic::note("A0107", Span::default(), text)
        .with_help("as increments they would be a thousandth of that; --decimal-point increments reads them so")
}

/// Where the tools come from.
pub(super) fn tools(why: &str) -> Diagnostic {
    let text = format!("tools are taken from the program, not from the built-in table: {why}");
    Diagnostic::note("A0114", Span::default(), text)
        .with_help("--tools FILE names the shop's own; tools.toml or tool.tbl beside the program is found by itself")
}

/// The evidence of a text without an end.
pub(super) fn no_end(line: u32) -> String {
    format!("no M2 or M30 up to line {line}, its last, and it stops at rest")
}

/// The evidence of a word that `LinuxCNC` does not have.
pub(super) fn strange_word(strange: &Diagnostic, dialect: Dialect) -> String {
    format!(
        "not LinuxCNC's, which --dialect {} takes: line {}, {}",
        dialect.name(),
        strange.span.line,
        strange.message
    )
}

/// A comment that describes another tool than the table has.
pub(super) fn other_tool(described: &Tool, known: &Tool) -> String {
    format!("its comment \"{}\" is not \"{}\" there", described.description, known.description)
}

/// A cut that a tool of the table is not made for.
pub(super) fn other_use(known: &Tool, line: u32) -> String {
    format!(
        "line {line} does not use T{} as {}, which it is there",
        known.number,
        known.kind_name()
    )
}

/// What a machine is too small for, counted.
pub(super) fn too_small(found: &[Diagnostic], machine: &str) -> String {
    let kinds = [
        ("M0301", "beyond its travel"),
        ("M0303", "above its feed"),
        ("M0305", "an axis that it lacks"),
        ("M0308", "above its spindle's speed"),
        ("M0317", "a pocket that it lacks"),
        ("M0321", "above its tapping speed"),
    ];
    let count = |code: &str| found.iter().filter(|f| f.is_error() && f.code == code).count();
    let counted: Vec<_> = kinds
        .iter()
        .filter(|(code, _)| count(code) > 0)
        .map(|(code, what)| format!("{} {what}", count(code)))
        .collect();
    let counted = if counted.is_empty() { "what it lacks".to_owned() } else { counted.join(", ") };
    format!("{machine} is too small for this program ({counted})")
}
