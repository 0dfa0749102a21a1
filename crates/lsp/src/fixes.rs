//! Quick fixes: the words that make a finding go, written into the program.
//!
//! A finding says the number that works as data ([`diag::Remedy`]), never only in its sentence. A
//! word of the block is changed; one that stays in force and stands in a block before is written
//! into this one.
use crate::open::Open;
use diag::{Diagnostic, Remedy, RemedyWord};
use gcode::{Block, Parser, Value};
use lsp_types as lsp;
use lsp_types::Uri;
use std::collections::HashMap;

/// Two numbers that differ by less are written the same, in a program's units.
const SAME: f64 = 1e-3;

/// For the findings that touch a range.
pub(crate) fn within(open: &mut Open, uri: &Uri, range: lsp::Range) -> Vec<lsp::CodeAction> {
    let findings = std::mem::take(&mut open.shown);
    let touches = |finding: &&Diagnostic| {
        let here = open.document.range(finding.span);
        here.start <= range.end && range.start <= here.end
    };
    let wanted: Vec<_> = findings.iter().filter(touches).cloned().collect();
    open.shown = findings;
    wanted.iter().filter_map(|finding| action(open, uri, finding)).collect()
}

#[allow(clippy::mutable_key_type)] // the type of the protocol
fn action(open: &mut Open, uri: &Uri, finding: &Diagnostic) -> Option<lsp::CodeAction> {
    let remedy = finding.remedy.as_ref()?;
    let (words, edits) = edits(open, remedy)?;
    let changes = HashMap::from([(uri.clone(), edits)]);
    let line = remedy.span.line;
    let place = if line == finding.span.line { String::new() } else { format!(" in line {line}") };
    Some(lsp::CodeAction {
        title: format!("Write {}{place}", words.join(" ")),
        kind: Some(lsp::CodeActionKind::QUICKFIX),
        diagnostics: Some(vec![open.told(uri, finding)]),
        edit: Some(lsp::WorkspaceEdit::new(changes)),
        is_preferred: Some(true),
        ..lsp::CodeAction::default()
    })
}

/// Words as they will be written, and how; `None`: the program does not say this in a word of this
/// block.
fn edits(open: &mut Open, remedy: &Remedy) -> Option<(Vec<String>, Vec<lsp::TextEdit>)> {
    let Remedy { span, words } = remedy;
    let visit = open.analysis.visit(&open.document, span.line, None)?;
    let codes = &visit.after.codes;
    let is_in_force = |code: &str| codes.iter().any(|is| is == code);
    // the lead of G33.1 is its K, whatever mode F is in
    let in_k = is_in_force("G33.1");
    let is_meant = |word: &&RemedyWord| match word.with {
        "" => true,
        with @ ("G94" | "G95") => is_in_force(with) && !in_k,
        with => is_in_force(with),
    };
    let mut parser = Parser::with_grammar(&open.document.text, 0, open.grammar());
    parser.seek(span.start, span.line);
    let mut block = Block::new();
    let is_here = parser.next(&mut block) && block.span.line == span.line;
    let last = block.words.last().filter(|_| is_here)?;
    let (mut said, mut edits) = (Vec::new(), Vec::new());
    for wanted in words.iter().filter(is_meant) {
        let there = block.words.iter().find(|word| word.letter == wanted.letter as u8);
        let text = format!("{}{}", wanted.letter, wanted.number);
        let edit = match (there, &wanted.instead_of) {
            (Some(word), of) => {
                let Value::Number(number) = word.value else { return None };
                let meant = of.as_ref().and_then(|of| of.parse::<f64>().ok());
                if of.is_some() && meant.is_none_or(|meant| (meant - number).abs() > SAME) {
                    return None;
                }
                lsp::TextEdit::new(open.document.range(word.span), text.clone())
            }
            (None, None) => {
                let end = open.document.place(last.span.end as usize);
                lsp::TextEdit::new(lsp::Range::new(end, end), format!(" {text}"))
            }
            (None, Some(_)) => return None,
        };
        said.push(text);
        edits.push(edit);
    }
    (!edits.is_empty()).then_some((said, edits))
}
