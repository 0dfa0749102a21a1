//! Findings, for people (carets), programs (JSON) and code hosts (SARIF).
//!
//! A finding is shown with its own line only, cut to a width that fits a screen, so that a finding
//! in a line of a hundred megabytes is as cheap and as readable as any other.
use crate::say;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet, renderer::DecorStyle};
use control::job::drawn::Drawn;
use diag::{Diagnostic, Label, Severity, Span};
use interp::Finding;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::IsTerminal;

/// Most characters of a source line that are shown.
const WIDEST: usize = 160;

/// A text that findings point into.
pub(crate) struct Source<'a> {
    /// Its name, as the user typed it.
    pub(crate) name: &'a str,
    /// Its bytes.
    pub(crate) text: &'a [u8],
    /// Files that the program draws in: what lies in the first of them has the file number 1.
    pub(crate) drawn: &'a [Drawn],
}

impl<'a> Source<'a> {
    /// A text that draws in no others.
    pub(crate) const fn alone(name: &'a str, text: &'a [u8]) -> Self {
        Self { name, text, drawn: &[] }
    }

    /// Name and bytes of the file in which a finding lies.
    fn file(&self, span: Span) -> (&'a str, &'a [u8]) {
        let drawn = usize::from(span.file).checked_sub(1).and_then(|i| self.drawn.get(i));
        drawn.map_or((self.name, self.text), |drawn| (&*drawn.path, &*drawn.sub.source))
    }
}

/// All findings with carets, one paragraph each.
pub(crate) fn text(findings: &[Diagnostic], source: &Source<'_>) -> String {
    let renderer = renderer();
    let mut out = String::new();
    for finding in findings {
        out.push_str(&one(&renderer, finding, source));
        out.push_str("\n\n");
    }
    out
}

fn renderer() -> Renderer {
    let coloured = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let renderer = if coloured { Renderer::styled() } else { Renderer::plain() };
    renderer.decor_style(DecorStyle::Ascii)
}

fn one(renderer: &Renderer, finding: &Diagnostic, source: &Source<'_>) -> String {
    let level = match finding.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let title = level.primary_title(say::shown(&finding.message)).id(finding.code);
    let (name, bytes) = source.file(finding.span);
    let excerpt = Excerpt::of(bytes, finding.span);
    let beside = |label: &Label| {
        (label.span.file, label.span.line) == (finding.span.file, finding.span.line)
    };
    let mut group = match &excerpt {
        None => Group::with_title(title),
        Some(excerpt) => {
            let mut snippet = Snippet::source(&*excerpt.text)
                .line_start(finding.span.line as usize)
                .path(say::shown(name))
                .annotation(AnnotationKind::Primary.span(excerpt.range.clone()));
            for label in finding.labels.iter().filter(|label| beside(label)) {
                if let Some(at) = excerpt.locate(label.span) {
                    snippet = snippet.annotation(
                        AnnotationKind::Context.span(at).label(say::shown(&label.text)),
                    );
                }
            }
            title.element(snippet)
        }
    };
    let elsewhere: Vec<_> = finding
        .labels
        .iter()
        .filter(|label| !beside(label))
        .map(|l| match source.file(l.span).0 {
            other if other != name => format!("{other} line {}: {}", l.span.line, l.text),
            _ => format!("line {}: {}", l.span.line, l.text),
        })
        .collect();
    for text in &elsewhere {
        group = group.element(Level::NOTE.message(say::shown(text)));
    }
    if let Some(help) = &finding.help {
        group = group.element(Level::HELP.message(say::shown(help)));
    }
    renderer.render(&[group])
}

/// The part of a line that is shown, as text, and the bytes of it that are marked.
struct Excerpt {
    text: String,
    range: std::ops::Range<usize>,
    first_byte: usize,
}

impl Excerpt {
    fn of(source: &[u8], span: Span) -> Option<Self> {
        if span.line == 0 || span.start as usize > source.len() {
            return None;
        }
        let start = span.start as usize;
        let line_start = source[..start].iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
        let line_end =
            source[start..].iter().position(|&b| b == b'\n').map_or(source.len(), |at| start + at);
        let from = line_start.max(start.saturating_sub(WIDEST / 2));
        let to = line_end.min(from + WIDEST);
        let lossless = |bytes: &[u8]| -> String {
            bytes.iter().map(|&b| if b.is_ascii_graphic() { b as char } else { ' ' }).collect()
        };
        let bytes = &source[from..to];
        let text = std::str::from_utf8(bytes).map_or_else(|_| lossless(bytes), str::to_owned);
        let text = text.trim_end_matches('\r').replace(is_latin_control, "¿"); // as long, in bytes
        let mut excerpt = Self { text, range: 0..0, first_byte: from };
        excerpt.range = excerpt.locate(span)?;
        Some(excerpt)
    }

    fn locate(&self, span: Span) -> Option<std::ops::Range<usize>> {
        let last = self.text.len();
        let start = (span.start as usize).checked_sub(self.first_byte)?.min(last);
        let end = (span.end as usize).saturating_sub(self.first_byte).clamp(start, last);
        let floor = |mut at: usize| {
            while !self.text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        Some(floor(start)..floor(end))
    }
}

/// A control character of Latin-1, which the renderer hands on.
const fn is_latin_control(c: char) -> bool {
    matches!(c, '\u{80}'..='\u{9f}')
}

/// Columns of a span: first and one past the last, counted from 1, in characters.
fn columns(source: &[u8], span: Span) -> (usize, usize) {
    let start = (span.start as usize).min(source.len());
    let end = (span.end as usize).clamp(start, source.len());
    let line_start = source[..start].iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
    // whatever is no character counts as one, a byte at a time
    let characters = |bytes: &[u8]| -> usize {
        bytes.utf8_chunks().map(|c| c.valid().chars().count() + c.invalid().len()).sum()
    };
    let first = characters(&source[line_start..start]) + 1;
    (first, first + characters(&source[start..end]))
}

fn severity_name(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// One finding as a JSON object.
pub(crate) fn json(finding: &Diagnostic, source: &Source<'_>) -> Value {
    let place = |span: Span| {
        let (column, end_column) = columns(source.file(span).1, span);
        json!({ "line": span.line, "column": column, "end_column": end_column })
    };
    let label = |l: &Label| json!({ "text": l.text, "file": source.file(l.span).0, "place": place(l.span) });
    let labels: Vec<_> = finding.labels.iter().map(label).collect();
    json!({
        "file": source.file(finding.span).0,
        "code": finding.code,
        "severity": severity_name(finding.severity),
        "message": finding.message,
        "help": finding.help,
        "place": if finding.span.line == 0 { Value::Null } else { place(finding.span) },
        "labels": labels,
    })
}

/// What is refused in one sentence, with no text that it points into, as a finding.
pub(crate) fn sentence_json(sentence: &str) -> Value {
    json!({
        "file": Value::Null,
        "code": Value::Null,
        "severity": severity_name(Severity::Error),
        "message": sentence,
        "help": Value::Null,
        "place": Value::Null,
        "labels": [],
    })
}

/// One finding as a SARIF result.
pub(crate) fn sarif_result(finding: &Diagnostic, source: &Source<'_>) -> Value {
    let (name, bytes) = source.file(finding.span);
    let (column, end_column) = columns(bytes, finding.span);
    let text = match &finding.help {
        Some(help) => format!("{} {help}", finding.message),
        None => finding.message.clone(),
    };
    json!({
        "ruleId": finding.code,
        "level": severity_name(finding.severity),
        "message": { "text": text },
        "locations": [{ "physicalLocation": {
            "artifactLocation": { "uri": uri(name) },
            "region": {
                "startLine": finding.span.line.max(1),
                "startColumn": column,
                "endColumn": end_column,
            },
        }}],
    })
}

/// A path as a relative reference: what a URI does not allow is written with per cent signs.
fn uri(path: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    path.bytes().fold(String::with_capacity(path.len()), |mut out, byte| {
        match (plain(byte), byte) {
            (true, byte) => out.push(byte as char),
            (false, b'\\') if cfg!(windows) => out.push('/'),
            (false, byte) => _ = write!(out, "%{byte:02X}"), // a String takes everything
        }
        out
    })
}

/// What a kind of finding means, with a wrong and a right program where there is one; else what was
/// said first.
fn rule(id: &str, results: &[Value]) -> Value {
    let said = || {
        let first = results.iter().find(|result| result["ruleId"] == id);
        first.map_or(Value::Null, |result| result["message"]["text"].clone())
    };
    match interp::explain(id) {
        Some(finding) if finding.wrong.is_empty() => json!({
            "id": id,
            "shortDescription": { "text": finding.sentence },
            "help": { "text": finding.sentence },
        }),
        Some(finding) => {
            let Finding { sentence, wrong, right, .. } = finding;
            let text = format!("{sentence}\n\nWrong:\n{wrong}\n\nRight:\n{right}\n");
            json!({ "id": id, "shortDescription": { "text": sentence }, "help": { "text": text } })
        }
        None => {
            json!({ "id": id, "shortDescription": { "text": said() }, "help": { "text": said() } })
        }
    }
}

/// A SARIF 2.1.0 log of all results.
pub(crate) fn sarif(results: &[Value]) -> Value {
    let mut rules: Vec<_> = results.iter().map(|r| r["ruleId"].clone()).collect();
    rules.sort_by_key(Value::to_string);
    rules.dedup();
    let rules: Vec<_> =
        rules.iter().map(|id| rule(id.as_str().unwrap_or_default(), results)).collect();
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "leadscrew",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": rules,
            }},
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(line: u32, start: u32, end: u32) -> Span {
        Span { file: 0, line, start, end }
    }

    #[test]
    fn a_finding_shows_its_line_and_marks_its_word() {
        let source = Source::alone("part.ngc", b"G21\nG1 X10 Q5\nM2\n");
        let finding = Diagnostic::error("I0001", at(2, 11, 13), "Q has no meaning here.");
        let shown = text(&[finding], &source);
        assert!(shown.contains("part.ngc:2:8"), "{shown}");
        assert!(shown.contains("G1 X10 Q5"), "{shown}");
        assert!(shown.contains("^^"), "{shown}");
    }

    #[test]
    fn every_sarif_rule_has_help() {
        let source = Source::alone("part.ngc", b"G1 X10\nM2\n");
        let results: Vec<_> = ["I0408", "P9999"]
            .map(|code| sarif_result(&Diagnostic::error(code, at(1, 0, 2), "No feed."), &source))
            .into();
        let log = sarif(&results);
        let rules = log["runs"][0]["tool"]["driver"]["rules"].as_array().unwrap();
        let help = |i: usize| rules[i]["help"]["text"].as_str().unwrap();
        assert!(help(0).contains("Right:"), "{rules:?}");
        assert_eq!(help(1), "No feed.");
    }

    #[test]
    fn a_line_of_a_megabyte_is_cut_to_a_screen() {
        let line = vec![b'X'; 1 << 20];
        let source = Source::alone("long.ngc", &line);
        let finding = Diagnostic::error("P0001", at(1, 500_000, 500_001), "too long.");
        assert!(text(&[finding], &source).len() < 1000);
    }

    #[test]
    fn a_span_inside_a_broken_character_does_not_panic() {
        let source = Source::alone("b.ngc", "(é)\n".as_bytes());
        for start in 0..6 {
            for end in start..7 {
                let _ = text(&[Diagnostic::note("X", at(1, start, end), "n")], &source);
            }
        }
    }

    #[test]
    fn what_lies_in_a_file_that_is_drawn_in_is_shown_there() {
        let sub =
            interp::Subprogram { name: "hole".into(), source: b"o<hole> sub\nG1 Q9\n".to_vec() };
        let drawn = [Drawn { path: "subs/hole.ngc".into(), sub }];
        let source = Source { name: "part.ngc", text: b"G21\no<hole> call\nM2\n", drawn: &drawn };
        let there = Span { file: 1, line: 2, start: 15, end: 17 };
        let finding = Diagnostic::error("I0001", there, "m").with_label(at(2, 4, 17), "called");
        let shown = text(std::slice::from_ref(&finding), &source);
        assert!(shown.contains("subs/hole.ngc:2:4") && shown.contains("G1 Q9"), "{shown}");
        assert!(shown.contains("part.ngc line 2: called"), "{shown}");
        assert_eq!(json(&finding, &source)["file"], "subs/hole.ngc");
        assert_eq!(json(&finding, &source)["place"]["column"], 4);
        let place = &sarif_result(&finding, &source)["locations"][0]["physicalLocation"];
        assert_eq!(place["artifactLocation"]["uri"], "subs/hole.ngc");
    }

    #[test]
    fn columns_count_characters_and_a_path_becomes_a_reference() {
        let source = Source::alone("my parts/é.ngc", "(äöü) X1 Q5 (\u{fe}".as_bytes());
        let result = sarif_result(&Diagnostic::error("I0001", at(1, 12, 14), "m"), &source);
        let place = &result["locations"][0]["physicalLocation"];
        assert_eq!(place["region"]["startColumn"], 10);
        assert_eq!(place["region"]["endColumn"], 12);
        assert_eq!(place["artifactLocation"]["uri"], "my%20parts/%C3%A9.ngc");
    }

    #[test]
    fn json_counts_lines_and_columns_from_one() {
        let source = Source::alone("part.ngc", b"G21\nG1 X10 Q5\n");
        let value = json(&Diagnostic::error("I0001", at(2, 11, 13), "m"), &source);
        assert_eq!(value["place"]["line"], 2);
        assert_eq!(value["place"]["column"], 8);
        assert_eq!(value["place"]["end_column"], 10);
    }
}
