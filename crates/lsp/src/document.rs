//! An open file: its text, its lines, and places as the editor counts them.
//!
//! Editors count lines from 0 and columns in UTF-16 units (or bytes, if both sides agree on UTF-8);
//! spans count bytes. This is the only place where the two meet.
use diag::Span;
use gcode::{Block, Control, Grammar, Keyword, Label, Parser};
use lsp_types::{Position, PositionEncodingKind, Range, TextDocumentContentChangeEvent};

/// A text and where its lines begin.
pub(crate) struct Document {
    pub(crate) text: Vec<u8>,
    starts: Vec<u32>,
    utf8: bool,
}

/// What an edit touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Edit {
    /// First byte that is not as it was.
    pub(crate) from: u32,
    /// One past the last byte of what is new.
    pub(crate) end: u32,
    /// Whether anything has come, gone or changed that jumps and calls lead to.
    pub(crate) jumps: bool,
    /// Whether those lines may begin or end a subprogram of O-words.
    pub(crate) subprograms: bool,
}

/// What O-words of a subprogram's begin and end have in them.
const SUBPROGRAMS: [&str; 1] = ["SUB"];

impl Document {
    pub(crate) fn new(text: String, encoding: &PositionEncodingKind) -> Self {
        let utf8 = *encoding == PositionEncodingKind::UTF8;
        let mut new = Self { text: Vec::new(), starts: vec![0], utf8 };
        let mut text = text.into_bytes();
        gcode::end_lines_with_lf(&mut text);
        new.move_lines(0, 0, &text);
        new.text = text;
        new
    }

    /// How many lines there are.
    pub(crate) fn lines(&self) -> usize {
        self.starts.len()
    }

    /// First byte of a line counted from 0, and one past its last, without the line's end.
    pub(crate) fn line(&self, line: usize) -> (usize, usize) {
        let at = |line: usize| self.starts.get(line).map_or(self.text.len(), |s| *s as usize);
        let (from, mut to) = (at(line), at(line.saturating_add(1)));
        while to > from && matches!(self.text[to - 1], b'\n' | b'\r') {
            to -= 1;
        }
        (from, to)
    }

    /// Take in one change.
    pub(crate) fn apply(
        &mut self,
        change: TextDocumentContentChangeEvent,
        grammar: Grammar,
    ) -> Edit {
        let (from, to) = match change.range {
            Some(range) => {
                let from = self.byte(range.start);
                (from, self.byte(range.end).max(from))
            }
            None => (0, self.text.len()),
        };
        let all = change.range.is_none();
        // of a line that is only moved nothing changes
        let begins_line = |at: usize| at == 0 || self.text[at - 1] == b'\n';
        let whole_lines = begins_line(from) && begins_line(to) && is_of_lines(&change.text);
        let subprograms = |document: &Self, to: usize| {
            let lines =
                if whole_lines { &document.text[from..to] } else { document.lines_of(from, to) };
            has(lines, &SUBPROGRAMS)
        };
        let (targets, had) = (targets(self.lines_of(from, to), grammar), subprograms(self, to));
        let end = from + change.text.len();
        self.move_lines(from, to, change.text.as_bytes());
        self.text.splice(from..to, change.text.into_bytes());
        let jumps = all || targets != self::targets(self.lines_of(from, end), grammar);
        let subprograms = all || had || subprograms(self, end);
        Edit { from: from as u32, end: end as u32, jumps, subprograms }
    }

    /// Where lines begin once these bytes are replaced by this text.
    fn move_lines(&mut self, from: usize, to: usize, text: &[u8]) {
        let behind = |byte: usize| self.starts.partition_point(|start| *start as usize <= byte);
        let (first, last) = (behind(from), behind(to));
        let grown = (text.len() as u32).wrapping_sub((to - from) as u32);
        for start in &mut self.starts[last..] {
            *start = start.wrapping_add(grown);
        }
        let new = memchr::memchr_iter(b'\n', text).map(|at| (from + at) as u32 + 1);
        self.starts.splice(first..last, new);
    }

    /// Whether a line that these bytes lie in may call a subprogram.
    pub(crate) fn may_call(&self, from: usize, to: usize, grammar: Grammar) -> bool {
        let calls: &[&str] = match grammar {
            Grammar::Rs274 | Grammar::Grbl => &["CALL"],
            Grammar::Fanuc => &["M98", "M198", "G65", "G66"],
        };
        self.has_near(from, to, calls)
    }

    /// Whether a line that these bytes lie in has one of these texts in it, blanks apart.
    fn has_near(&self, from: usize, to: usize, texts: &[&str]) -> bool {
        has(self.lines_of(from, to), texts)
    }

    /// The lines that these bytes lie in.
    pub(crate) fn lines_of(&self, from: usize, to: usize) -> &[u8] {
        let to = to.min(self.text.len());
        let first =
            self.text[..from.min(to)].iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
        let last = memchr::memchr(b'\n', &self.text[to..]).map_or(self.text.len(), |at| to + at);
        &self.text[first..last]
    }

    /// Line and byte of a place of the editor's; nothing behind the last line.
    pub(crate) fn at(&self, place: Position) -> Option<(usize, usize)> {
        let line = place.line as usize;
        (line < self.lines()).then(|| (line, self.byte(place)))
    }

    /// The byte at a place of the editor's; a place behind the line's end is its end.
    pub(crate) fn byte(&self, place: Position) -> usize {
        let (from, to) = self.line(place.line as usize);
        if self.utf8 {
            return from.saturating_add(place.character as usize).min(to);
        }
        let line = String::from_utf8_lossy(&self.text[from..to]);
        let mut units = place.character as usize;
        let mut bytes = 0;
        for c in line.chars() {
            if units < c.len_utf16() {
                break;
            }
            units -= c.len_utf16();
            bytes += c.len_utf8();
        }
        (from + bytes).min(to)
    }

    /// The editor's place for a byte.
    pub(crate) fn place(&self, byte: usize) -> Position {
        let byte = byte.min(self.text.len());
        let line = self.starts.partition_point(|start| *start as usize <= byte).saturating_sub(1);
        let from = self.starts[line] as usize;
        let column = if self.utf8 {
            byte - from
        } else {
            let before = String::from_utf8_lossy(&self.text[from..byte]);
            before.chars().map(char::len_utf16).sum()
        };
        Position { line: line as u32, character: column as u32 }
    }

    /// The editor's range for a span.
    pub(crate) fn range(&self, span: Span) -> Range {
        Range {
            start: self.place(span.start as usize),
            end: self.place((span.end as usize).max(span.start as usize)),
        }
    }
}

/// What jumps and calls lead to in these lines, in their order: O-words, numbered blocks, begins
/// and ends of loops; and what ends a text, so that none of it is behind that.
fn targets(lines: &[u8], grammar: Grammar) -> Vec<String> {
    let (mut parser, mut block) = (Parser::with_grammar(lines, 0, grammar), Block::new());
    parser.seek(0, 2); // what only a program's first line can be, these are not
    let mut targets = Vec::new();
    while parser.next(&mut block) {
        if block.faulty {
            continue;
        }
        if block.percent {
            targets.push("%".to_owned());
        }
        if let Some(number) = block.number.filter(|_| grammar == Grammar::Fanuc) {
            targets.push(format!("N{number}"));
        }
        match block.o {
            Some(o) if grammar != Grammar::Fanuc && o.keyword == Keyword::Call => {}
            Some(o) => targets.push(match o.label {
                Label::Number(number) => format!("{number} {:?}", o.keyword),
                Label::Name(name) => format!("<{}> {:?}", block.text(name), o.keyword),
                Label::Computed(_) => format!("{block}"),
            }),
            None => {}
        }
        match block.control {
            Some(Control::While { level, .. }) => targets.push(format!("DO{level}")),
            Some(Control::End(level)) => targets.push(format!("END{level}")),
            Some(Control::GoTo(_) | Control::IfGoTo { .. } | Control::IfThen(_)) | None => {}
        }
    }
    targets
}

/// Whether a text is nothing but whole lines.
fn is_of_lines(text: &str) -> bool {
    text.is_empty() || text.ends_with('\n')
}

/// Whether one of these texts is in it, blanks apart.
fn has(text: &[u8], texts: &[&str]) -> bool {
    let solid = text.iter().filter(|b| !matches!(b, b' ' | b'\t'));
    let dense: Vec<u8> = solid.map(u8::to_ascii_uppercase).collect();
    texts.iter().any(|text| memchr::memmem::find(&dense, text.as_bytes()).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(text: &str) -> Document {
        Document::new(text.to_owned(), &PositionEncodingKind::UTF16)
    }

    fn change(from: (u32, u32), to: (u32, u32), text: &str) -> TextDocumentContentChangeEvent {
        let range = Range { start: Position::new(from.0, from.1), end: Position::new(to.0, to.1) };
        TextDocumentContentChangeEvent { range: Some(range), range_length: None, text: text.into() }
    }

    #[test]
    fn columns_count_utf16_units() {
        let document = open("(𝛼é) G1\n");
        let byte = document.byte(Position::new(0, 6));
        assert_eq!(&document.text[byte..byte + 2], b"G1");
        assert_eq!(document.place(byte), Position::new(0, 6));
    }

    #[test]
    fn an_edit_says_from_where_the_text_is_new() {
        let mut document = open("G21\nX1\nX2\n");
        let edit = document.apply(change((1, 1), (1, 2), "77"), Grammar::Rs274);
        assert_eq!(document.text, b"G21\nX77\nX2\n");
        assert_eq!(edit, Edit { from: 5, end: 7, jumps: false, subprograms: false });
        let edit = document.apply(change((2, 0), (2, 0), "o1 sub\n"), Grammar::Rs274);
        assert!(edit.jumps && edit.subprograms);
        let edit = document.apply(change((2, 0), (2, 0), "o2 if [1]\n"), Grammar::Rs274);
        assert!(edit.jumps && !edit.subprograms);
        let edit = document.apply(change((2, 4), (2, 5), "call"), Grammar::Rs274);
        let (from, to) = (edit.from as usize, edit.end as usize);
        assert!(!edit.subprograms && document.may_call(from, to, Grammar::Rs274));
        assert_eq!(document.lines(), 6);
    }

    #[test]
    fn places_outside_the_text_do_not_panic() {
        let mut document = open("G1");
        assert_eq!(document.byte(Position::new(9, 9)), 2);
        assert_eq!(document.at(Position::new(u32::MAX, u32::MAX)), None);
        assert_eq!(document.byte(Position::new(u32::MAX, u32::MAX)), 2);
        assert_eq!(document.at(Position::new(0, u32::MAX)), Some((0, 2)));
        document.apply(change((5, 5), (1, 0), "X"), Grammar::Rs274);
        assert_eq!(document.place(1000).line, 0);
    }
}
