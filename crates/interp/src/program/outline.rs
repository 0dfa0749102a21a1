//! Where the O-words of a file are, and which belong together.
//!
//! ```text
//!   o100 sub ────────┐           o2 if ──┐ next      o3 repeat ──┐
//!     …  return      │ end       o2 elseif ──┐         …  break  │ end
//!   o100 endsub ◄────┘           o2 else ────┤         …  continue
//!                                o2 endif ◄──┘       o3 endrepeat ◄┘
//! ```
//!
//! Made when a file's first O-word is executed, by one reading of the whole file: a program without
//! O-words costs nothing, and every word without its partner is reported at once.
use crate::fault::error;
use diag::{Diagnostic, Span};
use gcode::{Block, Keyword, Label, Parser};
use std::collections::HashMap;

/// `if`, `while`, `do`, `repeat` and `sub` that are open at once.
const MOST_NESTED: usize = 1000;

/// A place in a file: byte and line.
pub(crate) type At = (u32, u32);

/// One O-word.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mark {
    /// `100` or `<name>`; empty if it is computed.
    pub(crate) key: Box<str>,
    pub(crate) keyword: Keyword,
    pub(crate) span: Span,
    /// Its block.
    pub(crate) at: At,
    /// The block after it.
    pub(crate) after: At,
    /// Of a clause: the next one. Of a loop's begin: its end. Of an end: its begin. Of break and
    /// continue: their loop's begin.
    pub(crate) partner: usize,
    /// Of the clauses of an `if`: its `endif`.
    pub(crate) end: usize,
    /// A `while` that ends a `do`.
    pub(crate) closes_do: bool,
}

/// All O-words of a file, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Outline {
    pub(crate) marks: Vec<Mark>,
    /// The subprograms by key.
    subs: HashMap<Box<str>, usize>,
    /// Those whose label is a number, by rising number.
    numbered: Vec<(u32, usize)>,
}

/// How an O-word's label is written in the tables.
pub(crate) fn key(block: &Block, label: Label) -> Option<Box<str>> {
    match label {
        Label::Number(number) => Some(number.to_string().into()),
        Label::Name(name) => Some(format!("<{}>", block.text(name)).into()),
        Label::Computed(_) => None,
    }
}

impl Outline {
    /// Read a file's O-words. What does not fit together comes back beside it.
    pub(crate) fn of(source: &[u8], file: u16) -> (Self, Vec<Diagnostic>) {
        let (marks, mut faults) = read(source, file, (0, 1));
        let outline = Self::with(marks, &mut faults);
        (outline, faults)
    }

    fn with(marks: Vec<Mark>, faults: &mut Vec<Diagnostic>) -> Self {
        let mut outline = Self { marks, subs: HashMap::new(), numbered: Vec::new() };
        outline.join(faults);
        for (i, mark) in outline.marks.iter().enumerate() {
            if mark.keyword == Keyword::Sub {
                let first = *outline.subs.entry(mark.key.clone()).or_insert(i);
                if first != i {
                    let text = format!("o{} sub is here a second time", mark.key);
                    faults.push(
                        error("I0318", mark.span, text)
                            .with_label(outline.marks[first].span, "the first one")
                            .with_help("a call could mean either: give one of them another name"),
                    );
                }
            }
        }
        let numbers = outline.subs.iter().filter_map(|(key, i)| Some((key.parse().ok()?, *i)));
        outline.numbered = numbers.collect();
        outline.numbered.sort_unstable();
        outline
    }

    /// The mark of the block at this byte.
    pub(crate) fn at(&self, byte: u32) -> Option<usize> {
        self.marks.binary_search_by_key(&byte, |mark| mark.at.0).ok()
    }

    /// The begin of a subprogram (or of a numbered program, for M98).
    pub(crate) fn find(&self, key: &str, keyword: Keyword) -> Option<usize> {
        if keyword == Keyword::Sub {
            return self.subs.get(key).copied();
        }
        self.marks.iter().position(|mark| mark.keyword == keyword && &*mark.key == key)
    }

    /// The begin of the subprogram of this number.
    pub(crate) fn numbered(&self, number: u32) -> Option<usize> {
        let place = self.numbered.binary_search_by_key(&number, |(number, _)| *number).ok()?;
        Some(self.numbered[place].1)
    }

    /// Find every word's partner.
    fn join(&mut self, faults: &mut Vec<Diagnostic>) {
        let mut open: Vec<usize> = Vec::new();
        for i in 0..self.marks.len() {
            if open.len() > MOST_NESTED {
                let text = format!("O-words stand within each other more than {MOST_NESTED} deep");
                faults.push(error("I0319", self.marks[i].span, text));
                return;
            }
            match self.marks[i].keyword {
                Keyword::Sub => {
                    if let Some(outer) =
                        open.iter().rev().find(|o| self.marks[**o].keyword == Keyword::Sub)
                    {
                        let text = "a subprogram cannot begin inside another one";
                        faults.push(
                            error("I0304", self.marks[i].span, text)
                                .with_label(self.marks[*outer].span, "still open here"),
                        );
                    }
                    open.push(i);
                }
                Keyword::If | Keyword::Do | Keyword::Repeat => open.push(i),
                Keyword::While => match open.last().copied() {
                    Some(top)
                        if self.marks[top].keyword == Keyword::Do
                            && self.marks[top].key == self.marks[i].key =>
                    {
                        self.marks[i].closes_do = true;
                        self.pair(top, i);
                        open.pop();
                    }
                    _ => open.push(i),
                },
                Keyword::EndSub => self.close(i, &[Keyword::Sub], &mut open, faults),
                Keyword::EndWhile => self.close(i, &[Keyword::While], &mut open, faults),
                Keyword::EndRepeat => self.close(i, &[Keyword::Repeat], &mut open, faults),
                Keyword::ElseIf | Keyword::Else | Keyword::EndIf => {
                    self.clause(i, &mut open, faults);
                }
                Keyword::Break | Keyword::Continue => self.leave(i, &open, faults),
                Keyword::Program | Keyword::Return | Keyword::Call => {}
            }
        }
        for left in open {
            let mark = &self.marks[left];
            let (word, end) = match mark.keyword {
                Keyword::Sub => ("sub", "endsub"),
                Keyword::While => ("while", "endwhile"),
                Keyword::Repeat => ("repeat", "endrepeat"),
                Keyword::Do => ("do", "while"),
                _ => ("if", "endif"),
            };
            let text =
                format!("o{} {word} is not closed: its o{} {end} is missing", mark.key, mark.key);
            faults.push(error("I0305", mark.span, text));
        }
        faults.sort_by_key(|fault| fault.span.start);
    }

    fn pair(&mut self, begin: usize, end: usize) {
        self.marks[begin].partner = end;
        self.marks[end].partner = begin;
    }

    fn close(
        &mut self,
        i: usize,
        begins: &[Keyword],
        open: &mut Vec<usize>,
        faults: &mut Vec<Diagnostic>,
    ) {
        match open.last().copied() {
            Some(top)
                if begins.contains(&self.marks[top].keyword)
                    && self.marks[top].key == self.marks[i].key =>
            {
                self.pair(top, i);
                open.pop();
            }
            top => faults.push(self.unexpected(i, top)),
        }
    }

    fn clause(&mut self, i: usize, open: &mut Vec<usize>, faults: &mut Vec<Diagnostic>) {
        let fits = |top: &usize| {
            matches!(self.marks[*top].keyword, Keyword::If | Keyword::ElseIf | Keyword::Else)
                && self.marks[*top].key == self.marks[i].key
        };
        let Some(top) = open.last().copied().filter(fits) else {
            faults.push(self.unexpected(i, open.last().copied()));
            return;
        };
        let keyword = self.marks[i].keyword;
        if self.marks[top].keyword == Keyword::Else && keyword != Keyword::EndIf {
            let text = "after else only endif can follow";
            faults.push(
                error("I0306", self.marks[i].span, text)
                    .with_label(self.marks[top].span, "the else"),
            );
        }
        // The stack holds the latest clause; `end` of a later clause leads back to the one before.
        self.marks[top].partner = i;
        open.pop();
        self.marks[i].end = top;
        if keyword != Keyword::EndIf {
            open.push(i);
            return;
        }
        let mut clause = i;
        loop {
            let before = self.marks[clause].end;
            self.marks[clause].end = i;
            if before == usize::MAX {
                break;
            }
            clause = before;
        }
    }

    fn leave(&mut self, i: usize, open: &[usize], faults: &mut Vec<Diagnostic>) {
        let is_loop = |o: &&usize| {
            let mark = &self.marks[**o];
            matches!(mark.keyword, Keyword::While | Keyword::Do | Keyword::Repeat)
                && mark.key == self.marks[i].key
        };
        let inside = open.iter().rev().take_while(|o| self.marks[**o].keyword != Keyword::Sub);
        if let Some(begin) = inside.copied().find(|o| is_loop(&o)) {
            self.marks[i].partner = begin;
        } else {
            let text = format!("no loop o{} is open here", self.marks[i].key);
            faults.push(error("I0307", self.marks[i].span, text));
        }
    }

    fn unexpected(&self, i: usize, top: Option<usize>) -> Diagnostic {
        let mark = &self.marks[i];
        let text = format!("this O-word closes nothing: no matching o{} is open", mark.key);
        let fault = error("I0308", mark.span, text);
        match top {
            Some(top) => {
                fault.with_label(self.marks[top].span, "this one is open and must be closed first")
            }
            None => fault,
        }
    }
}

/// Where the `%` that ends a text stands, or the text itself ends: what comes behind is not the
/// program's.
fn end_of_tape(source: &[u8]) -> usize {
    let mut has_begun = false;
    for at in memchr::memchr_iter(b'%', source) {
        let from = memchr::memrchr(b'\n', &source[..at]).map_or(0, |end| end + 1);
        let to = memchr::memchr(b'\n', &source[at..]).map_or(source.len(), |length| at + length);
        if source[from..to].trim_ascii() != b"%" {
            continue;
        }
        if has_begun || !source[..from].split(|byte| *byte == b'\n').all(says_nothing) {
            return from;
        }
        has_begun = true;
    }
    source.len()
}

/// A blank line, or a comment alone.
fn says_nothing(line: &[u8]) -> bool {
    let line = line.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(line).trim_ascii();
    let is_comment = || line[0] == b'(' && memchr::memchr(b')', line) == Some(line.len() - 1);
    line.is_empty() || line[0] == b';' || is_comment()
}

/// The O-words of a text from a line on (byte and number), which are not joined yet.
fn read(source: &[u8], file: u16, from: At) -> (Vec<Mark>, Vec<Diagnostic>) {
    let (mut parser, mut block) = (Parser::new(source, file), Block::new());
    parser.seek(from.0, from.1);
    let mut marks = Vec::new();
    let mut faults = Vec::new();
    let end = end_of_tape(source);
    while parser.next_o_word(&mut block) && (block.span.start as usize) < end {
        let Some(word) = block.o.filter(|_| !block.faulty) else { continue };
        let key = key(&block, word.label).unwrap_or_default();
        if key.is_empty() && word.keyword != Keyword::Call {
            let fault = error("I0303", word.span, "a computed O number is good for call only");
            faults.push(fault.with_help("write the number itself"));
            continue;
        }
        if matches!(word.keyword, Keyword::Call | Keyword::Return) {
            continue; // there may be millions, and nothing belongs to them
        }
        let at = (block.span.start, block.span.line);
        let (partner, end) = (usize::MAX, usize::MAX);
        let after = parser.position();
        marks.push(Mark {
            key,
            keyword: word.keyword,
            span: word.span,
            at,
            after,
            partner,
            end,
            closes_do: false,
        });
    }
    (marks, faults)
}
