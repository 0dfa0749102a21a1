//! Where the programs, numbered blocks and loops of a tape are.
//!
//! ```text
//!   %
//!   O1000 ─┐  N10 …        GOTO10: from the block on to the program's end, then from its begin
//!          │  WHILE[..]DO1 ◄─┐
//!          │  END1 ──────────┘
//!   O2000 ─┘  … M99
//!   %
//! ```
//!
//! Made at the first jump or call, by one reading of the whole tape.
use crate::{fault::error, outline::At};
use diag::{Diagnostic, Span};
use gcode::{Block, Control, Grammar, Label, Parser};
use std::collections::HashMap;

/// A block: where it and the next one begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mark {
    pub(super) at: At,
    pub(super) after: At,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Program {
    number: Option<u32>,
    begin: Mark,
}

/// All of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Tape {
    /// In the order of the text; the first may have no number.
    programs: Vec<Program>,
    /// N words in the order of the text.
    numbers: Vec<(u32, At)>,
    /// By the first byte of a DO: its END; of an END: its DO.
    loops: HashMap<u32, Mark>,
}

impl Tape {
    pub(super) fn of(source: &[u8]) -> (Self, Vec<Diagnostic>) {
        let mut parser = Parser::with_grammar(source, 0, Grammar::Fanuc);
        let mut block = Block::new();
        let mut tape = Self::default();
        let begin = Mark { at: (0, 1), after: (0, 1) };
        tape.programs.push(Program { number: None, begin });
        let mut open: Vec<(u8, Mark, Span)> = Vec::new();
        let mut faults = Vec::new();
        while parser.next(&mut block) {
            if block.faulty {
                continue;
            }
            let mark = Mark { at: (block.span.start, block.span.line), after: parser.position() };
            if let Some(number) = block.number {
                tape.numbers.push((number as u32, mark.at));
            }
            if let Some(Label::Number(number)) = block.o.map(|o| o.label) {
                faults.extend(open.drain(..).map(|(level, _, span)| not_closed(level, span)));
                tape.programs.push(Program { number: Some(number), begin: mark });
            }
            match block.control {
                Some(Control::While { level, .. }) => {
                    if let Some((_, _, outer)) = open.iter().find(|o| o.0 == level) {
                        let text = format!(
                            "DO{level} is open already: a loop in a loop takes another number"
                        );
                        let fault = error("I1002", block.span, text);
                        faults.push(fault.with_label(*outer, "open since here"));
                    }
                    open.push((level, mark, block.span));
                }
                Some(Control::End(level)) => match open.pop() {
                    Some((begun, begin, _)) if begun == level => {
                        tape.loops.insert(begin.at.0, mark);
                        tape.loops.insert(mark.at.0, begin);
                    }
                    Some((begun, _, span)) => {
                        let text =
                            format!("expected END{begun}, found END{level}: loops may not cross");
                        faults.push(
                            error("I1003", block.span, text).with_label(span, "open since here"),
                        );
                    }
                    None => {
                        let text = format!("END{level} closes nothing: no DO{level} is open");
                        faults.push(error("I1003", block.span, text));
                    }
                },
                _ => {}
            }
        }
        faults.extend(open.into_iter().map(|(level, _, span)| not_closed(level, span)));
        (tape, faults)
    }

    /// The first block of O1234.
    pub(super) fn program(&self, number: u32) -> Option<At> {
        self.programs.iter().find(|p| p.number == Some(number)).map(|p| p.begin.after)
    }

    /// Numbers of the programs.
    pub(super) fn programs(&self) -> impl Iterator<Item = u32> {
        self.programs.iter().filter_map(|p| p.number)
    }

    /// The block N of the program in which byte `from` lies: behind it, else from the program's begin.
    pub(super) fn block(&self, number: u32, from: u32) -> Option<At> {
        let here = self.programs.iter().rposition(|p| p.begin.at.0 <= from)?;
        let begin = self.programs[here].begin.at.0;
        let end = self.programs.get(here + 1).map_or(u32::MAX, |p| p.begin.at.0);
        let mine =
            || self.numbers.iter().filter(|(n, at)| *n == number && (begin..end).contains(&at.0));
        mine().find(|(_, at)| at.0 > from).or_else(|| mine().next()).map(|(_, at)| *at)
    }

    /// The other end of the loop whose DO or END begins at this byte.
    pub(super) fn partner(&self, byte: u32) -> Option<Mark> {
        self.loops.get(&byte).copied()
    }
}

fn not_closed(level: u8, span: Span) -> Diagnostic {
    error("I1004", span, format!("DO{level} is never closed"))
        .with_help(format!("write END{level} after the loop's last block"))
}
