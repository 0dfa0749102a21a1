//! Where the loops of a tape begin and end.
//!
//! ```text
//!   WHILE[#1 LT 3]DO1 ─┐        bounds in the order of the text; each knows its partner
//!     DO2 ─┐           │
//!     END2 ┘           │
//!   END1 ──────────────┘
//! ```
use crate::{fault::error, program::outline::At};
use diag::{Diagnostic, Span};
use gcode::{Block, Control};

/// A block: where it and the next one begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Mark {
    pub(crate) at: At,
    pub(crate) after: At,
}

/// A DO or an END.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bound {
    file: usize,
    mark: Mark,
    level: u8,
    ends: bool,
    span: Span,
}

impl Bound {
    /// That of a block, if it is one.
    pub(crate) fn of(block: &Block, file: usize, mark: Mark) -> Option<Self> {
        let (level, ends) = match block.control? {
            Control::While { level, .. } => (level, false),
            Control::End(level) => (level, true),
            _ => return None,
        };
        Some(Self { file, mark, level, ends, span: block.span })
    }

    const fn at(&self) -> (usize, u32) {
        (self.file, self.mark.at.0)
    }
}

/// All of a tape's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Loops {
    bounds: Vec<Bound>,
    /// For each its other end.
    partners: Vec<u32>,
}

/// Where the programs of a tape begin, file and byte, in their order.
pub(crate) type Begins<'a> = &'a mut dyn Iterator<Item = (usize, u32)>;

impl Loops {
    pub(crate) fn push(&mut self, bound: Bound) {
        self.bounds.push(bound);
    }

    /// The other end of the loop whose DO or END begins at this byte of a file.
    pub(crate) fn partner(&self, file: usize, byte: u32) -> Option<Mark> {
        let i = self.bounds.binary_search_by_key(&(file, byte), Bound::at).ok()?;
        Some(self.bounds.get(*self.partners.get(i)? as usize)?.mark)
    }

    /// Find out what belongs together; no loop goes on into the next program.
    pub(crate) fn join(&mut self, begins: Begins<'_>, faults: &mut Vec<Diagnostic>) {
        let mut begins = begins.peekable();
        let mut open: Vec<usize> = Vec::new();
        self.partners = vec![u32::MAX; self.bounds.len()];
        for (i, bound) in self.bounds.iter().enumerate() {
            while begins.next_if(|begin| *begin <= bound.at()).is_some() {
                faults.extend(open.drain(..).map(|open| not_closed(&self.bounds[open])));
            }
            if !bound.ends {
                let same = |open: &&usize| self.bounds[**open].level == bound.level;
                if let Some(outer) = open.iter().find(same) {
                    faults.push(opened_twice(bound, &self.bounds[*outer]));
                }
                open.push(i);
                continue;
            }
            match open.pop() {
                Some(begin) if self.bounds[begin].level == bound.level => {
                    (self.partners[begin], self.partners[i]) = (i as u32, begin as u32);
                }
                other => faults.push(crossed(bound, other.map(|begin| &self.bounds[begin]))),
            }
        }
        faults.extend(open.into_iter().map(|open| not_closed(&self.bounds[open])));
    }
}

fn not_closed(open: &Bound) -> Diagnostic {
    let level = open.level;
    error("I1004", open.span, format!("DO{level} is never closed"))
        .with_help(format!("write END{level} after the loop's last block"))
}

fn opened_twice(bound: &Bound, outer: &Bound) -> Diagnostic {
    let level = bound.level;
    let text = format!("DO{level} is open already: a loop in a loop takes another number");
    error("I1002", bound.span, text).with_label(outer.span, "open since here")
}

fn crossed(end: &Bound, begin: Option<&Bound>) -> Diagnostic {
    let level = end.level;
    match begin {
        Some(begin) => {
            let text =
                format!("expected END{}, found END{level}: loops may not cross", begin.level);
            error("I1003", end.span, text).with_label(begin.span, "open since here")
        }
        None => {
            error("I1003", end.span, format!("END{level} closes nothing: no DO{level} is open"))
        }
    }
}
