//! From line to line: finds the lines, reads each into a block, keeps what was found wrong.
//!
//! ```text
//!   line  = [ "/" [ level ] ] [ "N" number ] ( o-line | { word | setting | comment } )  |  "%"
//!   word  = letter value              setting = "#" parameter "=" value
//! ```

use crate::Block;
use crate::block::{Assignment, Word};
use crate::expression::Value;
use crate::fanuc::{Grammar, is_for_people};
use crate::leader::{before_end_mark, leader};
use crate::line::{Line, Read};
use crate::number;
use crate::problem::{Fault, Problem};
use diag::{Diagnostic, Span};

/// Brackets inside brackets, and signs and `#` before a value, count as levels.
pub const MAX_NESTING: u32 = 64;
/// Operators, functions, signs and parameters in one expression.
pub const MAX_OPERATIONS: u32 = 256;
/// Longest line, in bytes.
pub const MAX_LINE_BYTES: usize = 64 * 1024;
/// Diagnostics kept of one file; the rest is counted.
pub const MAX_DIAGNOSTICS: usize = 100;

/// Reads the blocks of one file, from memory.
#[derive(Debug)]
pub struct Parser<'a> {
    source: &'a [u8],
    file: u16,
    grammar: Grammar,
    offset: usize,
    line: u32,
    diagnostics: Vec<Diagnostic>,
    /// First bytes of the lines already reported: a loop reads its lines many times.
    reported: Vec<u32>,
    /// How many findings were only counted, and up to which byte.
    more: usize,
    more_up_to: u32,
}

impl<'a> Parser<'a> {
    /// A reader at the beginning of `source`, which spans will call `file`.
    #[must_use]
    pub fn new(source: &'a [u8], file: u16) -> Self {
        Self::with_grammar(source, file, Grammar::Rs274)
    }

    /// The same, by other rules.
    #[must_use]
    pub fn with_grammar(source: &'a [u8], file: u16, grammar: Grammar) -> Self {
        let mut parser = Self::of_part(source, file, grammar);
        if u32::try_from(source.len()).is_err() {
            parser.report(Problem::FileTooLong, &[], 0, parser.place(0, 0));
            parser.source = &[];
        }
        parser.source = before_end_mark(parser.source);
        if parser.source.starts_with(b"\xEF\xBB\xBF") {
            parser.offset = 3; // the byte order mark some editors write
        }
        parser.skip_leader();
        parser
    }

    /// A reader of a text that has neither leader nor end mark.
    pub(crate) const fn of_part(source: &'a [u8], file: u16, grammar: Grammar) -> Self {
        Self {
            source,
            file,
            grammar,
            offset: 0,
            line: 1,
            diagnostics: Vec::new(),
            reported: Vec::new(),
            more: 0,
            more_up_to: 0,
        }
    }

    /// Goes past what stands on a tape before its program: blank tape, and to Fanuc's controls all
    /// text up to the first percent sign.
    fn skip_leader(&mut self) {
        let rest = self.source.get(self.offset..).unwrap_or_default();
        let blank =
            rest.iter().take_while(|byte| **byte == 0 || byte.is_ascii_whitespace()).count();
        let blank = memchr::memrchr(0, &rest[..blank]).map_or(0, |last| last + 1);
        self.line += memchr::memchr_iter(b'\n', &rest[..blank]).count() as u32;
        self.offset += blank;
        if self.grammar != Grammar::Fanuc {
            return;
        }
        let Some(leader) = leader(self.source, self.offset, is_leader) else { return };
        let text = &self.source[self.offset..leader.end];
        let first = text.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(0);
        let lines = |text: &[u8]| memchr::memchr_iter(b'\n', text).count() as u32;
        let start = self.offset + first;
        let length = memchr::memchr(b'\n', &self.source[start..]).unwrap_or(0);
        let length = self.source[start..start + length].trim_ascii_end().len();
        let span = Span { line: self.line + lines(&text[..first]), ..self.place(start, length) };
        self.line += lines(text);
        self.offset = leader.end;
        self.report(Problem::BeforePercent, &[], 0, span);
    }

    /// Reads the next line into `block`; false at the end of the file.
    pub fn next(&mut self, block: &mut Block) -> bool {
        self.next_line(block, false)
    }

    #[inline]
    fn next_line(&mut self, block: &mut Block, head_only: bool) -> bool {
        block.clear();
        let rest = self.source.get(self.offset..).unwrap_or_default();
        if rest.is_empty() {
            return false;
        }
        let (length, step) = match memchr::memchr(b'\n', rest) {
            Some(length) => (length, length + 1),
            None => (rest.len(), rest.len()),
        };
        let mut text = &rest[..length];
        while let [line @ .., b'\r'] = text {
            text = line; // CR LF, and CR CR LF of files that were sent through two systems
        }
        let mut step = step;
        while let [b'\r', line @ ..] = text {
            (text, step) = (line, step - 1); // LF CR and LF CR CR, as controls punch their tapes
            self.offset += 1;
        }
        let mut lines = 1;
        let mut comment = false;
        if let Some((end, next)) = self.grammar.end_of_block(text) {
            // what follows in the line is a block of its own, unless it is blank or for people
            let blank = text[next..].iter().all(|b| matches!(b, b' ' | b'\t'));
            comment = text[end] == b';' && is_for_people(&text[next..]);
            (step, lines) = if blank || comment { (step, 1) } else { (next, 0) };
            text = &text[..end];
        }
        let place = self.place(self.offset, text.len());
        self.offset += step;
        self.line += lines;
        if text.len() > MAX_LINE_BYTES {
            self.too_long(text, place, block);
            return true;
        }
        block.span = place;
        let mut line = Line {
            text,
            ahead: rest,
            at: 0,
            end: 0,
            place,
            block,
            grammar: self.grammar,
            nodes_before: 0,
            head_only,
            remark: None,
        };
        let result = line.read();
        let behind = Fault { problem: Problem::BehindSemicolon, from: 0, to: text.len() };
        let remark = line.remark.or(comment.then_some(behind));
        if let Err(fault) = result {
            block.faulty = true;
            self.fault(fault, text, place);
        } else if let Some(fault) = remark {
            self.fault(fault, text, place);
        }
        true
    }

    /// Reads on to the next line with an O-word; false if there is none. The lines between are only
    /// counted, and the arguments of calls and returns left out: what is wrong in them stays unsaid
    /// until they are read.
    pub fn next_o_word(&mut self, block: &mut Block) -> bool {
        loop {
            let rest = self.source.get(self.offset..).unwrap_or_default();
            let Some(at) = memchr::memchr2(b'o', b'O', rest) else {
                self.line += memchr::memchr_iter(b'\n', rest).count() as u32;
                self.offset = self.source.len();
                block.clear();
                return false;
            };
            let passed = &rest[..at];
            self.line += memchr::memchr_iter(b'\n', passed).count() as u32;
            let begin = memchr::memrchr(b'\n', passed).map_or(0, |newline| newline + 1);
            self.offset += begin;
            if begins_o_word(&passed[begin..]) {
                if self.next_line(block, true) && block.o.is_some() {
                    return true;
                }
            } else {
                // some other O: past its line
                let length = memchr::memchr(b'\n', &rest[at..]);
                self.line += u32::from(length.is_some());
                self.offset += length.map_or(rest.len(), |length| at + length + 1) - begin;
            }
        }
    }

    /// Goes to the line that begins at byte `offset` and has the number `line`: a block's
    /// `span.start` and `span.line`, or what [`Parser::position`] said.
    pub fn seek(&mut self, offset: u32, line: u32) {
        self.offset = (offset as usize).min(self.source.len());
        self.line = line;
    }

    /// Where the next block begins: byte and line.
    #[must_use]
    pub fn position(&self) -> (u32, u32) {
        (self.offset as u32, self.line)
    }

    /// What was found so far, in the order found; at most [`MAX_DIAGNOSTICS`] and, as the last
    /// one, how many more there were. A line is reported once, however often it is read.
    pub fn take_diagnostics(&mut self) -> Vec<Diagnostic> {
        if self.more > 0 {
            let place = Span { line: 0, ..self.place(self.source.len(), 0) };
            self.diagnostics.push(Problem::More(self.more).diagnostic(&[], 0, place));
            self.more = 0;
        }
        core::mem::take(&mut self.diagnostics)
    }

    fn place(&self, start: usize, length: usize) -> Span {
        Span { file: self.file, line: self.line, start: start as u32, end: (start + length) as u32 }
    }

    #[cold]
    fn too_long(&mut self, text: &[u8], place: Span, block: &mut Block) {
        block.span = place;
        block.faulty = true;
        let fault = Fault { problem: Problem::LineTooLong, from: 0, to: 1 };
        self.fault(fault, &text[..MAX_LINE_BYTES], place);
    }

    /// Reports what is wrong with a line; if it is no text at all, says that and reads no further.
    #[cold]
    fn fault(&mut self, fault: Fault, text: &[u8], place: Span) {
        let found = text.get(fault.from).copied().unwrap_or(b' ');
        let odd = !(found.is_ascii_graphic() || found == b' ');
        let first = self.reported.is_empty();
        let nul = match memchr::memchr(0, text) {
            Some(at) => Some(place.start as usize + at),
            None if odd && first => memchr::memchr(0, self.source),
            None => None,
        };
        if let Some(at) = nul {
            self.offset = self.source.len();
            let span = Span { start: at as u32, end: at as u32 + 1, ..place };
            return self.report(Problem::Binary, &[], 0, span);
        }
        let problem = match fault.problem {
            Problem::WordExpected if found == b'\r' => Problem::LoneReturn,
            Problem::WordExpected if odd => Problem::NotText,
            problem => problem,
        };
        // whole characters: who draws the line cannot cut one
        let continued = |byte: &&u8| (0x80..0xC0).contains(*byte);
        let to = fault.to + text[fault.to..].iter().take(3).take_while(continued).count();
        let start = place.start + fault.from as u32;
        let span = Span { start, end: place.start + to as u32, ..place };
        self.report(problem, text, fault.from, span);
    }

    fn report(&mut self, problem: Problem, text: &[u8], from: usize, span: Span) {
        let line_start = span.start - from as u32;
        if self.reported.contains(&line_start) || line_start < self.more_up_to {
            return;
        }
        let once = matches!(
            problem,
            Problem::NotText
                | Problem::CommentNotUtf8
                | Problem::ForTheSender
                | Problem::BehindSemicolon
                | Problem::BehindPercent
                | Problem::BeforePercent
        );
        let again = once && self.diagnostics.iter().any(|d| d.code == problem.code());
        if self.reported.len() < MAX_DIAGNOSTICS && !again {
            self.reported.push(line_start);
            self.diagnostics.push(problem.diagnostic(text, from, span));
        } else if !matches!(
            problem,
            Problem::CommentNotUtf8
                | Problem::ForTheSender
                | Problem::BehindSemicolon
                | Problem::BehindPercent
                | Problem::BeforePercent
        ) {
            self.more += 1;
            self.more_up_to = span.end;
        }
    }
}

impl Line<'_, '_> {
    fn read(&mut self) -> Read<()> {
        self.delete();
        if self.peek() == b'N' {
            self.take();
            if !matches!(self.peek(), b'0'..=b'9' | b'.') {
                return self.fault_here(Problem::NumberAfter(b'N'));
            }
            self.block.number = Some(self.number()?);
        }
        if self.grammar == Grammar::Fanuc && self.block.delete.is_none() {
            self.delete(); // behind N too
        }
        if self.grammar == Grammar::Fanuc {
            return self.fanuc_block();
        }
        match self.peek() {
            b'$' | b'?' | b'!' | b'~' if self.grammar == Grammar::Grbl => {
                self.leave_out_rest(Problem::ForTheSender);
                Ok(())
            }
            b'%' if self.grammar == Grammar::Grbl => {
                self.at = self.text.len(); // streamed files may begin and end with it: it says nothing
                Ok(())
            }
            b'O' => {
                self.o_word()?;
                self.only_comments(Problem::EndAfterOWord)
            }
            b'%' => {
                self.take();
                self.block.percent = true;
                self.only_comments(Problem::PercentNotAlone)
            }
            _ => self.items(),
        }
    }

    /// The rest of the line is not read, and a remark says so.
    pub(crate) fn leave_out_rest(&mut self, why: Problem) {
        let from = self.at;
        self.at = self.text.len();
        self.end = self.text.trim_ascii_end().len();
        self.remark = Some(Fault { problem: why, from, to: self.end.max(from) });
    }

    /// `/` or `/3`, if it comes next.
    fn delete(&mut self) {
        if self.take_if(b'/') {
            self.block.delete = Some(1);
            if let level @ b'0'..=b'9' = self.peek() {
                self.block.delete = Some(level - b'0');
                self.take();
            }
        }
    }

    pub(crate) fn items(&mut self) -> Read<()> {
        let mut seen = 0u64;
        loop {
            self.plain_words(&mut seen);
            match self.peek() {
                b'N' => return self.fault_here(Problem::NumberNotFirst),
                b'O' => return self.fault_here(Problem::OWordNotFirst),
                letter @ (b'A'..=b'Z' | b'@' | b'^' | b'$') => self.word(letter, &mut seen)?,
                b'#' => self.setting()?,
                b',' if self.grammar == Grammar::Fanuc => self.comma_word(&mut seen)?,
                b'<' if self.grammar == Grammar::Fanuc => self.called()?,
                b'(' => self.bracket_comment()?,
                b';' => return self.line_comment(),
                0 if self.at >= self.text.len() => return Ok(()),
                b')' => return self.fault_here(Problem::CommentNotOpen),
                b'/' => return self.fault_here(Problem::DeleteNotFirst),
                b'%' => return self.fault_here(Problem::PercentNotAlone),
                _ => return self.fault_here(Problem::WordExpected),
            }
        }
    }

    /// As many words of a letter and a plain number as follow: nearly all that a long program has.
    #[inline]
    fn plain_words(&mut self, seen: &mut u64) {
        let mut next = self.at;
        while let Some(byte) = self.text.get(next) {
            let letter = byte.to_ascii_uppercase();
            if !letter.is_ascii_uppercase() {
                if matches!(letter, b' ' | b'\t') {
                    next += 1;
                    continue;
                }
                break;
            }
            let bit = 1u64 << (letter & 63);
            let once = if matches!(letter, b'G' | b'M') { 0 } else { *seen & bit };
            if once != 0 || matches!(letter, b'N' | b'O') {
                break;
            }
            let Some((value, end)) = number::fast(self.ahead, next + 1) else { break };
            *seen |= bit;
            let start = self.place.start;
            let span = Span { start: start + next as u32, end: start + end as u32, ..self.place };
            self.block.words.push(Word { letter, value: Value::Number(value), span });
            (self.at, self.end, next) = (end, end, end);
        }
    }

    pub(crate) fn word(&mut self, letter: u8, seen: &mut u64) -> Read<()> {
        let from = self.at;
        self.take();
        let value = match self.peek() {
            b'0'..=b'9' | b'.' => Value::Number(self.number()?),
            b'-' | b'+' | b'[' | b'#' | b'A'..=b'Z' => match number::fast(self.ahead, self.at) {
                Some((value, end)) => {
                    (self.at, self.end) = (end, end);
                    Value::Number(value)
                }
                None => self.word_value(letter)?,
            },
            _ => return self.fault_here(Problem::NumberAfter(letter)),
        };
        let span = self.span(from);
        let bit = 1u64 << (letter & 63);
        if *seen & bit != 0 && letter != b'G' && letter != b'M' && !self.may_repeat(letter) {
            return self.fault_since(Problem::LetterTwice(letter), from);
        }
        *seen |= bit;
        self.block.words.push(Word { letter, value, span });
        Ok(())
    }

    /// I, J and K of G65.
    #[cold]
    fn may_repeat(&self, letter: u8) -> bool {
        self.grammar == Grammar::Fanuc && matches!(letter, b'I' | b'J' | b'K')
    }

    /// A value that is not a plain number; `G1 X Y2` is a missing number, not a function Y.
    fn word_value(&mut self, letter: u8) -> Read<Value> {
        let at = self.at;
        match self.whole_value() {
            Err(Fault { problem: Problem::UnknownFunction(_), from, .. }) if from == at => {
                self.at = at;
                self.fault_here(Problem::NumberAfter(letter))
            }
            result => result,
        }
    }

    fn setting(&mut self) -> Read<()> {
        let from = self.at;
        self.nodes_before = self.block.nodes.len();
        let target = self.parameter(0)?;
        if !self.take_if(b'=') {
            return self.fault_here(Problem::EqualsExpected);
        }
        let value = self.setting_value()?;
        self.block.assignments.push(Assignment { target, value, span: self.span(from) });
        Ok(())
    }

    /// Nothing but comments to the end of the line.
    pub(crate) fn only_comments(&mut self, otherwise: Problem) -> Read<()> {
        loop {
            match self.peek() {
                b'(' => self.bracket_comment()?,
                b';' => return self.line_comment(),
                0 if self.at >= self.text.len() => return Ok(()),
                _ => return self.fault_here(otherwise),
            }
        }
    }
}

/// Whether an O after this beginning of a line is an O-word: blanks, block delete and N before it.
fn begins_o_word(before: &[u8]) -> bool {
    let before = before.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(before);
    before
        .iter()
        .all(|b| matches!(b, b' ' | b'\t' | b'\r' | b'/' | b'n' | b'N' | b'.' | b'0'..=b'9'))
}

/// Whether a text before the percent sign is one for people: it is none where it can be a program,
/// a block without a numbered program behind the sign, a numbered program, or its end.
fn is_leader(before: &[u8], is_numbered: bool) -> bool {
    let mut parser = Parser::of_part(before, 0, Grammar::Fanuc);
    let (mut block, mut is_text) = (Block::new(), false);
    while parser.next(&mut block) {
        let ends = |word: &Word| {
            let code =
                matches!(word.value, Value::Number(n) if [2.0, 30.0, 98.0, 99.0].contains(&n));
            word.letter == b'M' && code
        };
        let is_program = block.o.is_some() || block.words.iter().any(ends);
        let is_block =
            !block.words.is_empty() || block.control.is_some() || !block.assignments.is_empty();
        if !block.faulty && (is_program || is_block && !is_numbered) {
            return false;
        }
        is_text |= block.faulty || is_block;
    }
    is_text
}
