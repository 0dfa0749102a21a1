//! The outline of a program: its tools, in the order of their changes, and its subprograms.
use crate::document::Document;
use canon::ToolLibrary;
use diag::Span;
use gcode::{Block, Keyword, Label, Parser, Value};
use lsp_types::{DocumentSymbol, SymbolKind};

/// One entry before its end is known.
struct Entry {
    name: String,
    detail: Option<String>,
    kind: SymbolKind,
    at: Span,
}

/// All entries, in the order of the text.
pub(crate) fn symbols(document: &Document, tools: &ToolLibrary) -> Vec<DocumentSymbol> {
    let (mut parser, mut block) = (Parser::new(&document.text, 0), Block::new());
    let mut found = Vec::new();
    let (mut sub, mut tool): (Option<Entry>, Option<Entry>) = (None, None);
    let mut selected = 0;
    let mut last = Span::default();
    while parser.next(&mut block) {
        let span = block.span;
        if let Some(entry) = subprogram(&block) {
            close(&mut found, document, tool.take(), last);
            close(&mut found, document, sub.replace(entry), last);
        }
        if let Some(number) = number_of(&block, b'T') {
            selected = number;
        }
        if changes_tool(&block) {
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
    #[allow(deprecated)] // the protocol's type has a field that nobody may leave out or use
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

fn subprogram(block: &Block) -> Option<Entry> {
    let o = block.o.filter(|o| matches!(o.keyword, Keyword::Sub | Keyword::Program))?;
    let name = match o.label {
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
