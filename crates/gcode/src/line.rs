//! One line and the reader's place in it: the lexer.
//!
//! Blanks (space, tab) and case mean nothing outside comments, so there are no tokens: the reader
//! looks at the next byte that is not blank, in upper case, and every rule of the grammar is
//! written in terms of [`Line::peek`] and [`Line::take`]. `M O D` is `MOD`, and `X 1 . 5` is
//! `X1.5`, without either having to be said again. Fanuc's `IF`, `GOTO` and `:1234` are another set
//! of rules over these same few functions.

use crate::Block;
use crate::block::Text;
use crate::expression::{Expr, ExprId, Node, Value};
use crate::fanuc::Grammar;
use crate::problem::{Fault, Problem};
use crate::{MAX_OPERATIONS, number};
use diag::Span;

/// A rule's result: what was read, or what is wrong with the line.
pub(crate) type Read<T> = Result<T, Fault>;

/// A line being read into a block.
pub(crate) struct Line<'a, 'b> {
    /// The line without its end.
    pub(crate) text: &'a [u8],
    /// The file from the line's begin on: its numbers are read here, where the next line lies
    /// behind the last digit.
    pub(crate) ahead: &'a [u8],
    /// The next byte to look at.
    pub(crate) at: usize,
    /// One past the last byte taken: where a span ends (`at` may have passed blanks since).
    pub(crate) end: usize,
    /// Where the line stands in its file.
    pub(crate) place: Span,
    /// What is being filled.
    pub(crate) block: &'b mut Block,
    /// Whose rules.
    pub(crate) grammar: Grammar,
    /// Number of nodes before the value being read: bounds the operations in it.
    pub(crate) nodes_before: usize,
    /// Of a call or return nothing is read but its label and keyword.
    pub(crate) head_only: bool,
    /// A finding that does not spoil the block.
    pub(crate) remark: Option<Fault>,
}

impl Line<'_, '_> {
    /// The next byte that is not blank, in upper case; 0 at the end of the line.
    pub(crate) fn peek(&mut self) -> u8 {
        while let Some(&byte) = self.text.get(self.at) {
            if byte != b' ' && byte != b'\t' {
                return byte.to_ascii_uppercase();
            }
            self.at += 1;
        }
        0
    }

    /// Takes the byte that [`Line::peek`] saw.
    pub(crate) fn take(&mut self) {
        self.at += 1;
        self.end = self.at;
    }

    /// Takes the next byte if it is this one.
    pub(crate) fn take_if(&mut self, byte: u8) -> bool {
        let here = self.peek() == byte;
        if here {
            self.take();
        }
        here
    }

    /// The place of the next byte that is not blank.
    pub(crate) fn start(&mut self) -> usize {
        self.peek();
        self.at
    }

    /// The span from `from` to the last byte taken.
    pub(crate) fn span(&self, from: usize) -> Span {
        let start = self.place.start;
        Span { start: start + from as u32, end: start + self.end.max(from) as u32, ..self.place }
    }

    /// This is wrong with the next byte.
    pub(crate) fn fault_here<T>(&mut self, problem: Problem) -> Read<T> {
        let from = self.start();
        Err(Fault { problem, from, to: (from + 1).min(self.text.len()) })
    }

    /// This is wrong with what was taken since `from`.
    pub(crate) fn fault_since<T>(&self, problem: Problem, from: usize) -> Read<T> {
        Err(Fault { problem, from, to: self.end.max(from) })
    }

    /// A number, with its sign.
    pub(crate) fn number(&mut self) -> Read<f64> {
        let from = self.start();
        if let Some((value, end)) = number::fast(self.ahead, from) {
            (self.at, self.end) = (end, end);
            return Ok(value);
        }
        let (result, end) = number::slow(self.text, from);
        (self.at, self.end) = (end, end);
        result.or_else(|problem| self.fault_since(problem, from))
    }

    /// Letters up to the next byte that is none, in upper case; at most 15.
    pub(crate) fn letters(&mut self, buffer: &mut [u8; 16]) -> usize {
        let mut count = 0;
        while count < 15 && self.peek().is_ascii_uppercase() {
            buffer[count] = self.peek();
            self.take();
            count += 1;
        }
        count
    }

    /// `<name>`: the `<` comes next.
    pub(crate) fn name(&mut self) -> Read<Text> {
        let open = self.start();
        self.take();
        let start = self.block.texts.len() as u32;
        let Some(length) = memchr::memchr(b'>', &self.text[self.at..]) else {
            self.end = self.text.len();
            return self.fault_since(Problem::NameNotClosed, open);
        };
        let close = self.at + length;
        while self.start() < close {
            let rest = &self.text[self.at..close];
            let run = rest.iter().take_while(|b| name_byte(**b)).count();
            let Ok(run) = core::str::from_utf8(&rest[..run]) else {
                return self.fault_here(Problem::NameCharacter);
            };
            if run.is_empty() {
                return self.fault_here(Problem::NameCharacter);
            }
            let keeps = self.grammar == Grammar::Fanuc; // there A and a are two names
            let kept = |c: char| if keeps { c } else { c.to_ascii_lowercase() };
            self.block.texts.extend(run.chars().map(kept));
            self.at += run.len();
        }
        self.take();
        let end = self.block.texts.len() as u32;
        if start == end {
            return self.fault_since(Problem::NameEmpty, open);
        }
        Ok(Text { start, end })
    }

    /// Keeps an expression that began at `from` and ends with the last byte taken.
    pub(crate) fn keep(&mut self, expr: Expr, from: usize) -> Read<Value> {
        if self.block.nodes.len() - self.nodes_before >= MAX_OPERATIONS as usize {
            return self.fault_since(Problem::TooManyOperations, from);
        }
        let id = ExprId(self.block.nodes.len() as u32);
        let span = self.span(from);
        self.block.nodes.push(Node { expr, span });
        Ok(Value::Expression(id))
    }
}

/// What may stand in a name, besides blanks.
fn name_byte(byte: u8) -> bool {
    byte > b' ' && byte != 0x7f && !matches!(byte, b'(' | b')' | b'<' | b'>' | b';')
}

/// Line ends of a text that has CR alone, as old systems and some controls write them, become LF,
/// byte for byte. A text with any LF stays as it is.
pub fn end_lines_with_lf(text: &mut [u8]) {
    if memchr::memchr(b'\r', text).is_none() || memchr::memchr(b'\n', text).is_some() {
        return;
    }
    text.iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
}
