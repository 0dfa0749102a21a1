//! What may stand at a place: codes with what they do, and the words of the block's codes with what
//! they say to them.
use crate::document::Document;
use crate::roles;
use gcode::{Block, Parser};
use interp::{CodeInfo, Dialect};
use lsp_types as lsp;
use std::fmt::Write;

/// At a byte of a line (from 0).
pub(crate) fn at(
    document: &Document,
    dialect: Dialect,
    line: usize,
    byte: usize,
) -> Vec<lsp::CompletionItem> {
    let (first, _) = document.line(line);
    let number = line as u32 + 1;
    let mut parser = Parser::with_grammar(&document.text, 0, dialect.grammar());
    parser.seek(first as u32, number);
    let mut block = Block::new();
    while parser.next(&mut block) && block.span.line == number && (block.span.end as usize) < byte {
    }
    if block.span.line != number {
        block = Block::new();
    }
    let is_comment =
        |c: &gcode::Comment| (c.span.start as usize..c.span.end as usize).contains(&byte);
    let ends_in = |c: &gcode::Comment| c.semicolon && c.span.end as usize == byte;
    if block.comments.iter().any(|comment| is_comment(comment) || ends_in(comment)) {
        return Vec::new();
    }
    let text = &document.text[first..byte];
    let digits = text.iter().rev().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
    let letter = text.len().checked_sub(digits + 1).map(|at| text[at].to_ascii_uppercase());
    let letter = letter.filter(u8::is_ascii_alphabetic);
    if letter.is_none() && digits > 0 {
        return Vec::new();
    }
    let from = byte - digits - usize::from(letter.is_some());
    let range = lsp::Range::new(document.place(from), document.place(byte));
    let here: Vec<_> = block
        .words
        .iter()
        .filter_map(|word| Some((word.span.start as usize, meaning(word, dialect)?)))
        .collect();
    let own: Vec<_> = here.iter().filter(|(at, _)| *at != from).map(|(_, code)| code).collect();
    let has = |letter: u8| {
        block.words.iter().any(|w| w.letter == letter && w.span.start as usize != from)
    };
    let mut items = Vec::new();
    if matches!(letter, None | Some(b'G' | b'M')) {
        let known = all(dialect)
            .into_iter()
            .filter(|code| letter.is_none_or(|l| code.code.as_bytes().first() == Some(&l)));
        items.extend(known.map(|code| code_item(&code, dialect, range)));
    }
    let letters = (b'A'..=b'Z').filter(|l| letter.is_none_or(|typed| typed == *l) && !has(*l));
    for letter in letters.filter(|l| digits == 0 && !matches!(l, b'G' | b'M')) {
        let said = own.iter().filter(|code| code.letters.as_bytes().contains(&letter));
        let mut roles =
            said.filter_map(|code| Some((roles::role(dialect, letter, &code.code)?, &code.code)));
        let Some((role, code)) = roles.next_back() else { continue };
        items.push(item(
            char::from(letter).to_string(),
            lsp::CompletionItemKind::PROPERTY,
            role.to_owned(),
            format!("of {code}"),
            range,
            "0",
        ));
    }
    items
}

/// The codes that a dialect has and Leadscrew executes.
fn all(dialect: Dialect) -> Vec<CodeInfo> {
    let mut all: Vec<_> =
        interp::dialect_codes().filter(|code| code.dialects.contains(&dialect)).collect();
    let own: Vec<_> = all.iter().map(|code| code.code.clone()).collect();
    all.extend(
        interp::codes()
            .filter(|code| code.dialects.contains(&dialect) && !own.contains(&code.code)),
    );
    all.retain(|code| code.executed && !code.code.contains('–'));
    all
}

fn meaning(word: &gcode::Word, dialect: Dialect) -> Option<CodeInfo> {
    match word.value {
        gcode::Value::Number(value) => interp::describe_in(dialect, word.letter, value),
        gcode::Value::Expression(_) => None,
    }
}

fn code_item(code: &CodeInfo, dialect: Dialect, range: lsp::Range) -> lsp::CompletionItem {
    let lasting = if code.modal { "stays in force" } else { "this block only" };
    let mut about = format!("{}, {lasting}", code.group);
    for letter in code.letters.bytes() {
        match roles::role(dialect, letter, &code.code) {
            Some(role) => _ = write!(about, "\n{}: {role}", char::from(letter)), // a String takes everything
            None => _ = write!(about, "\n{}", char::from(letter)),
        }
    }
    item(
        code.code.clone(),
        lsp::CompletionItemKind::FUNCTION,
        code.name.to_owned(),
        about,
        range,
        "1",
    )
}

fn item(
    label: String,
    kind: lsp::CompletionItemKind,
    detail: String,
    about: String,
    range: lsp::Range,
    rank: &str,
) -> lsp::CompletionItem {
    lsp::CompletionItem {
        text_edit: Some(lsp::CompletionTextEdit::Edit(lsp::TextEdit::new(range, label.clone()))),
        sort_text: Some(format!("{rank}{label}")),
        label,
        kind: Some(kind),
        detail: Some(detail),
        documentation: Some(lsp::Documentation::String(about)),
        ..lsp::CompletionItem::default()
    }
}
