//! What `leadscrew explain` says of a code, and the page of all of them, as Markdown.
use super::{Finding, elsewhere::SENTENCES, example_setup, findings};
use crate::{dialect::Dialect, setup::Setup};
use diag::{Diagnostic, Severity};
use std::fmt::Write;

/// Before the list of findings.
const HEAD: &str = "# What can be wrong with a program\n\n\
    `leadscrew check FILE` or `leadscrew check FOLDER` says all findings of a program at once, to other programs as JSON or SARIF. A \
    program that does not end by itself is meant with `M2` behind it. T1 is an end mill of 10 mm, T2 a \
    tap M6.\n\n\
    *error*: the program is refused. *warning*: legal, and likely to hurt. *note*: worth knowing.\n";

/// Before the sentences of codes that no short program shows.
const ELSEWHERE: &str = "\n## Before motion, in files and on the command line\n\n\
    What the planner finds (M), what is wrong with machine files, tool tables and parameter files (S), and what command line and \
    editor say (A). Each says its own numbers.\n\n| code | what it means |\n|---|---|\n";

/// What a code means, with a program that causes it and one that does not; `None`: no such code.
pub fn explanation(code: &str) -> Option<String> {
    if let Some(finding) = findings().find(|finding| finding.code == code) {
        return Some(row(finding));
    }
    let (_, sentence) = SENTENCES.iter().find(|(known, _)| *known == code)?;
    Some(format!("### {code}\n\n{sentence}\n"))
}

/// All of them, as a page.
pub fn explanations() -> String {
    let mut page = String::from(HEAD);
    for finding in findings() {
        page += "\n";
        page += &row(finding);
    }
    page += ELSEWHERE;
    for (code, sentence) in SENTENCES {
        let _ = writeln!(page, "| {code} | {sentence} |"); // a string takes all
    }
    page
}

/// Everything that is found in a program of the list.
pub fn found_in_example(finding: &Finding, program: &str) -> Vec<Diagnostic> {
    let setup = Setup { has_example_tools: true, ..example_setup(finding.dialect) };
    let text = whole(program);
    let mut all = crate::check(text.as_bytes(), &setup);
    all.extend(crate::lint(text.as_bytes(), &setup));
    all
}

/// A program that does not end by itself ends with M2.
fn whole(program: &str) -> String {
    let is_end = |word: &str| matches!(word, "M2" | "M30" | "M99" | "%" | "(no");
    let ends = program.split_whitespace().any(is_end);
    if ends { format!("{program}\n") } else { format!("{program}\nM2\n") }
}

fn row(finding: &Finding) -> String {
    let Finding { code, sentence, wrong, right, dialect } = *finding;
    let head = format!("### {code}\n\n{sentence}\n");
    let said = found_in_example(finding, wrong);
    let Some(said) = said.iter().find(|found| found.code == code && !wrong.is_empty()) else {
        return head;
    };
    let fence = match dialect {
        Dialect::LinuxCnc => "gcode".to_owned(),
        other => format!("gcode --dialect {}", other.name()),
    };
    let severity = match said.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let help = said.help.as_ref().map(|help| format!(" — {help}")).unwrap_or_default();
    let (wrong, right) = (shown(wrong), shown(right));
    let (line, message) = (said.span.line, &said.message);
    format!(
        "{head}\n```{fence}\n{wrong}\n```\n\n> {severity}, line {line}: {message}{help}\n\nRight:\n\n```{fence}\n{right}\n```\n"
    )
}

/// Control characters made visible.
fn shown(program: &str) -> String {
    program.replace('\0', "␀").replace('\r', "␍")
}
