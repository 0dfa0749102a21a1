//! The outline of a program: its tools, in the order of their changes, and its subprograms.
use crate::document::Document;
use canon::ToolLibrary;
use diag::Span;
use gcode::{Block, Grammar, Keyword, Label, Parser, Value};
use interp::Setup;
use lsp_types::{DocumentSymbol, SymbolKind};

/// One entry before its end is known.
struct Entry {
    name: String,
    detail: Option<String>,
    kind: SymbolKind,
    at: Span,
}

/// All entries, in the order of the text.
pub(crate) fn symbols(document: &Document, setup: &Setup) -> Vec<DocumentSymbol> {
    let grammar = setup.dialect.grammar();
    let (mut parser, mut block) = (Parser::with_grammar(&document.text, 0, grammar), Block::new());
    let tools = &setup.tools;
    let turret = setup.dialect.has_turret();
    let mut found = Vec::new();
    let (mut sub, mut tool): (Option<Entry>, Option<Entry>) = (None, None);
    let mut selected = 0;
    let mut last = Span::default();
    while parser.next(&mut block) {
        let span = block.span;
        if let Some(entry) = subprogram(&block, grammar) {
            close(&mut found, document, tool.take(), last);
            close(&mut found, document, sub.replace(entry), last);
        }
        if let Some(number) = number_of(&block, b'T') {
            selected = number;
        }
        // T0101 of a lathe: tool and offset, changed at once
        let indexes = turret && selected >= 100 && block.word(b'T').is_some();
        if indexes {
            selected /= 100;
        }
        if changes_tool(&block) || indexes {
            close(&mut found, document, tool.replace(tool_entry(selected, tools, span)), last);
        }
        last = span;
        if ends_subprogram(&block) {
            close(&mut found, document, tool.take(), last);
            close(&mut found, document, sub.take(), last);
        }
    }
    close(&mut found, document, tool, last);
    close(&mut found, document, sub, last);
    found.sort_by_key(|symbol| symbol.range.start);
    found
}

fn close(found: &mut Vec<DocumentSymbol>, document: &Document, entry: Option<Entry>, last: Span) {
    let Some(entry) = entry else { return };
    #[allow(deprecated)] // the protocol's type has a field that may neither be left out nor used
    found.push(DocumentSymbol {
        name: entry.name,
        detail: entry.detail,
        kind: entry.kind,
        tags: None,
        deprecated: None,
        range: document.range(entry.at.to(last)),
        selection_range: document.range(entry.at),
        children: None,
    });
}

fn subprogram(block: &Block, grammar: Grammar) -> Option<Entry> {
    let o = block.o.filter(|o| matches!(o.keyword, Keyword::Sub | Keyword::Program))?;
    let name = match o.label {
        Label::Number(number) if grammar == Grammar::Fanuc => format!("O{number}"),
        Label::Number(number) => format!("o{number}"),
        Label::Name(name) => format!("o<{}>", block.text(name)),
        Label::Computed(_) => return None,
    };
    let detail = block.comments.first().map(|c| block.text(c.text).trim().to_owned());
    Some(Entry { name, detail, kind: SymbolKind::FUNCTION, at: block.span })
}

fn ends_subprogram(block: &Block) -> bool {
    matches!(block.o, Some(o) if o.keyword == Keyword::EndSub)
        || block.words.iter().any(|w| w.letter == b'M' && w.value == Value::Number(99.0))
}

fn changes_tool(block: &Block) -> bool {
    block.words.iter().any(|w| w.letter == b'M' && w.value == Value::Number(6.0))
}

fn number_of(block: &Block, letter: u8) -> Option<u32> {
    match block.word(letter)?.value {
        Value::Number(value) if value >= 0.0 && value.fract() == 0.0 => Some(value as u32),
        _ => None,
    }
}

fn tool_entry(number: u32, tools: &ToolLibrary, at: Span) -> Entry {
    let detail = match tools.get(number) {
        Some(tool) => tool.description.clone(),
        None => "not in the tool table".to_owned(),
    };
    Entry { name: format!("T{number}"), detail: Some(detail), kind: SymbolKind::OBJECT, at }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lsp_types::PositionEncodingKind;

    #[test]
    fn a_tape_shows_its_programs_and_the_tools_of_its_turret() {
        let text = "%\nO1234 (SHAFT)\nT0101\nG0 X10.\nIF [#1 GT 2] GOTO 9\nT0200\nN9 M30\nO2000\n#1=2\nM99\n%\n";
        let document = Document::new(text.to_owned(), &PositionEncodingKind::UTF16);
        let setup = Setup { dialect: interp::Dialect::FanucLatheA, ..Setup::default() };
        let shown = symbols(&document, &setup);
        let names: Vec<_> =
            shown.iter().map(|s| (s.name.as_str(), s.range.start.line, s.range.end.line)).collect();
        let wanted = [("O1234", 1, 6), ("T1", 2, 4), ("T2", 5, 6), ("O2000", 7, 9)];
        assert_eq!(names, wanted);
    }
}
