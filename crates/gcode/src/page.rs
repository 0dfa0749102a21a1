//! A stretch of a text's blocks as they were read: to have them again, and again, without reading them.
//!
//! ```text
//!   lines    G1 X1 Y2     X3     o1 if [#1 GT 2]              entry   where it begins, which words are its own
//!   entries  ├────────────┼──────┼──────────────┤             words   of all blocks, one behind the other
//!   words    G1 X1 Y2     X3                                  rest    what few blocks have: O-words, settings, …
//! ```
//!
//! Places are counted from the page's own begin. So a page stays as it is while its lines are moved by an edit before
//! them. A line that cannot be read, or of which there is something to say, is read again by whoever comes to it.

use crate::block::{Assignment, Block, Comment, OWord, Text, Word};
use crate::expression::{Node, Value};
use crate::fanuc::{Control, Grammar, Output, Piece};
use crate::parser::Parser;
use diag::Span;

/// Blocks that were read, by their order in the text.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// The last one is the page's end.
    entries: Vec<Entry>,
    words: Vec<KeptWord>,
    /// The last one is the end of all.
    rests: Vec<Rest>,
    nodes: Vec<Node>,
    assignments: Vec<Assignment>,
    comments: Vec<Comment>,
    arguments: Vec<Value>,
    pieces: Vec<Piece>,
    texts: String,
}

/// One block.
#[derive(Clone, Copy, Debug)]
struct Entry {
    start: u32,
    line: u32,
    length: u32,
    /// Where its words begin.
    words: u32,
    kind: Kind,
    number: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Words alone.
    Plain,
    /// The number of its rest.
    More(u32),
    /// It is to be read where it stands.
    Unread,
}

/// A word in less room than where it is used.
#[derive(Clone, Copy, Debug)]
struct KeptWord {
    value: Value,
    start: u32,
    /// Its length, and its letter in the lowest byte.
    tail: u32,
}

/// What a block has besides words, and where that which it has many of begins.
#[derive(Clone, Copy, Debug, Default)]
struct Rest {
    delete: Option<u8>,
    percent: bool,
    o: Option<OWord>,
    control: Option<Control>,
    output: Option<Output>,
    called: Option<Text>,
    nodes: usize,
    assignments: usize,
    comments: usize,
    arguments: usize,
    pieces: usize,
    texts: usize,
}

impl Page {
    /// Read the first file's blocks from a place (byte and line) on: so many lines, but none that begins at byte
    /// `end` or behind it. A page ends where a line does.
    #[must_use]
    pub fn read(source: &[u8], grammar: Grammar, from: (u32, u32), end: u32, lines: u32) -> Self {
        let mut parser = Parser::with_grammar(source, 0, grammar);
        parser.seek(from.0, from.1);
        let (mut new, mut block) = (Self::default(), Block::new());
        loop {
            let (byte, line) = parser.position();
            let start = (byte - from.0, line - from.1);
            let begins_line = block.span.line != line;
            let enough = begins_line && (start.1 >= lines || byte >= end);
            if enough || !parser.next(&mut block) {
                new.push_entry(start, 0, Kind::Unread, None);
                new.push_rest(Rest::default());
                return new;
            }
            let silent = parser.take_diagnostics().is_empty();
            new.keep(&block, from, start, silent && !block.faulty);
        }
    }

    /// How many blocks there are.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.entries.len().saturating_sub(1)
    }

    /// Where a block begins, byte and line from the page's begin; where the page ends, if it is the one behind the last.
    #[must_use]
    #[inline]
    pub fn begin(&self, block: usize) -> (u32, u32) {
        self.entries.get(block).map_or((0, 0), |entry| (entry.start, entry.line))
    }

    /// Which block begins at this byte of the page.
    #[must_use]
    pub fn at(&self, byte: u32) -> Option<usize> {
        let place = self.entries.binary_search_by_key(&byte, |entry| entry.start).ok()?;
        (place < self.blocks()).then_some(place)
    }

    /// The block as reading it would give it, of a page that begins at `from`; false if it must be read.
    #[must_use]
    pub fn load(&self, place: usize, from: (u32, u32), block: &mut Block) -> bool {
        let [entry, next] = match self.entries.get(place..place + 2) {
            Some([entry, next]) if entry.kind != Kind::Unread => [entry, next],
            _ => return false,
        };
        block.clear();
        let (start, line) = (entry.start + from.0, entry.line + from.1);
        block.span = Span { file: 0, line, start, end: start + entry.length };
        block.number = entry.number;
        let words = &self.words[entry.words as usize..next.words as usize];
        block.words.extend(words.iter().map(|word| {
            let start = word.start + from.0;
            let span = Span { file: 0, line, start, end: start + (word.tail >> 8) };
            Word { letter: word.tail as u8, value: word.value, span }
        }));
        if let Kind::More(rest) = entry.kind {
            self.load_rest(rest as usize, from, block);
        }
        true
    }

    fn load_rest(&self, place: usize, from: (u32, u32), block: &mut Block) {
        let [rest, next] = &self.rests[place..place + 2] else { return };
        let here = |span: Span| moved(span, from);
        (block.delete, block.percent) = (rest.delete, rest.percent);
        block.o = rest.o.map(|o| OWord { span: here(o.span), ..o });
        (block.control, block.output, block.called) = (rest.control, rest.output, rest.called);
        let nodes = &self.nodes[rest.nodes..next.nodes];
        block.nodes.extend(nodes.iter().map(|node| Node { span: here(node.span), ..*node }));
        let assignments = &self.assignments[rest.assignments..next.assignments];
        let assignments = assignments.iter().map(|a| Assignment { span: here(a.span), ..*a });
        block.assignments.extend(assignments);
        let comments = &self.comments[rest.comments..next.comments];
        block.comments.extend(comments.iter().map(|c| Comment { span: here(c.span), ..*c }));
        block.arguments.extend_from_slice(&self.arguments[rest.arguments..next.arguments]);
        block.pieces.extend_from_slice(&self.pieces[rest.pieces..next.pieces]);
        block.texts.push_str(&self.texts[rest.texts..next.texts]);
    }

    fn keep(&mut self, block: &Block, from: (u32, u32), start: (u32, u32), whole: bool) {
        let length = block.span.end - block.span.start;
        if !whole {
            return self.push_entry(start, length, Kind::Unread, None);
        }
        let kind = if block.has_words_alone() { Kind::Plain } else { self.keep_rest(block, from) };
        self.push_entry(start, length, kind, block.number);
        self.words.extend(block.words.iter().map(|word| KeptWord {
            value: word.value,
            start: word.span.start - from.0,
            tail: (word.span.end - word.span.start) << 8 | u32::from(word.letter),
        }));
    }

    fn keep_rest(&mut self, block: &Block, from: (u32, u32)) -> Kind {
        let back = (from.0.wrapping_neg(), from.1.wrapping_neg());
        let here = |span: Span| moved(span, back);
        let place = self.rests.len() as u32;
        self.push_rest(Rest {
            delete: block.delete,
            percent: block.percent,
            o: block.o.map(|o| OWord { span: here(o.span), ..o }),
            control: block.control,
            output: block.output,
            called: block.called,
            ..Rest::default()
        });
        self.nodes.extend(block.nodes.iter().map(|node| Node { span: here(node.span), ..*node }));
        let assignments = block.assignments.iter().map(|a| Assignment { span: here(a.span), ..*a });
        self.assignments.extend(assignments);
        self.comments.extend(block.comments.iter().map(|c| Comment { span: here(c.span), ..*c }));
        self.arguments.extend_from_slice(&block.arguments);
        self.pieces.extend_from_slice(&block.pieces);
        self.texts.push_str(&block.texts);
        Kind::More(place)
    }

    fn push_entry(
        &mut self,
        (start, line): (u32, u32),
        length: u32,
        kind: Kind,
        number: Option<f64>,
    ) {
        let words = self.words.len() as u32;
        self.entries.push(Entry { start, line, length, words, kind, number });
    }

    /// A rest whose parts begin where those kept so far end.
    fn push_rest(&mut self, rest: Rest) {
        self.rests.push(Rest {
            nodes: self.nodes.len(),
            assignments: self.assignments.len(),
            comments: self.comments.len(),
            arguments: self.arguments.len(),
            pieces: self.pieces.len(),
            texts: self.texts.len(),
            ..rest
        });
    }
}

impl Block {
    fn has_words_alone(&self) -> bool {
        self.delete.is_none()
            && !self.percent
            && self.o.is_none()
            && self.control.is_none()
            && self.output.is_none()
            && self.called.is_none()
            && self.nodes.is_empty()
            && self.assignments.is_empty()
            && self.comments.is_empty()
            && self.arguments.is_empty()
            && self.pieces.is_empty()
            && self.texts.is_empty()
    }
}

/// A stretch so many bytes and lines farther on.
fn moved(span: Span, (bytes, lines): (u32, u32)) -> Span {
    Span {
        line: span.line.wrapping_add(lines),
        start: span.start.wrapping_add(bytes),
        end: span.end.wrapping_add(bytes),
        ..span
    }
}
