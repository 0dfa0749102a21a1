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
//! Other files of the search path are further pieces of the same tape. One that does not begin with
//! O1234 or `<NAME>` is the program that its own name says: O1234.nc, 1234.nc, NAME.nc. A program
//! that has a name instead of a number has a number here all the same, above all that can be
//! written.
//!
//! Made at the first jump or call, by one reading of the whole tape.
pub(crate) mod loops;

use crate::{
    front_end::fanuc::tape::loops::{Bound, Loops, Mark},
    program::outline::At,
};
use diag::Diagnostic;
use gcode::{Block, Grammar, Label, Parser};

#[derive(Clone, Debug, PartialEq, Eq)]
struct Program {
    number: Option<u32>,
    file: usize,
    begin: Mark,
}

/// A block of some file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TapePosition {
    pub(crate) file: usize,
    pub(crate) at: At,
}

/// The least number of a program with a name.
pub(crate) const NAMED: u32 = 1 << 31;

/// All of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tape {
    /// In the order of the text; the first may have no number.
    programs: Vec<Program>,
    /// N words in the order of the text.
    numbers: Vec<(u32, TapePosition)>,
    /// The same by number, and then in the order of the text.
    sorted: Vec<u32>,
    loops: Loops,
    /// Names of programs.
    names: Vec<String>,
}

impl Tape {
    /// Of the program and the files beside it, which have these names.
    pub(crate) fn of(sources: &[&[u8]], names: &[String]) -> (Self, Vec<Diagnostic>) {
        let (mut tape, mut faults) = (Self::default(), Vec::new());
        for (file, source) in sources.iter().enumerate() {
            let name = names.get(file).map_or("", String::as_str);
            tape.read(file, source, name);
        }
        tape.sorted = (0..tape.numbers.len() as u32).collect();
        tape.sorted.sort_by_key(|i| tape.numbers[*i as usize].0);
        let begins = tape.programs.iter().map(|program| (program.file, program.begin.at.0));
        tape.loops.join(&mut begins.clone(), &mut faults);
        (tape, faults)
    }

    fn read(&mut self, file: usize, source: &[u8], name: &str) {
        let mut parser = Parser::with_grammar(source, file as u16, Grammar::Fanuc);
        let mut block = Block::new();
        let begin = Mark { at: (0, 1), after: (0, 1) };
        let own = self.programs.len();
        let number = (file > 0).then(|| self.number_of_file(name));
        self.programs.push(Program { number, file, begin });
        let mut first = true;
        while parser.next(&mut block) {
            if block.faulty {
                continue;
            }
            let mark = Mark { at: (block.span.start, block.span.line), after: parser.position() };
            if first && !block.is_blank() && !block.percent {
                first = false;
                let after = if block.o.is_some() { mark.after } else { mark.at };
                self.programs[own].begin.after = after;
            }
            if let Some(number) = block.number {
                self.numbers.push((number as u32, TapePosition { file, at: mark.at }));
            }
            let number = match block.o.map(|o| o.label) {
                Some(Label::Number(number)) => Some(number),
                Some(Label::Name(name)) => Some(self.number_of(block.text(name))),
                _ => None,
            };
            if number.is_some() {
                self.programs.push(Program { number, file, begin: mark });
            }
            if let Some(bound) = Bound::of(&block, file, mark) {
                self.loops.push(bound);
            }
        }
    }

    /// The number of the program that a file is: what its name says.
    fn number_of_file(&mut self, name: &str) -> u32 {
        let digits = name.strip_prefix(['O', 'o']).unwrap_or(name);
        match digits.parse() {
            Ok(number) if number < NAMED => number,
            _ => self.number_of(name),
        }
    }

    /// The number of a program with a name.
    fn number_of(&mut self, name: &str) -> u32 {
        self.named(name).unwrap_or_else(|| {
            self.names.push(name.to_owned());
            NAMED + self.names.len() as u32 - 1
        })
    }

    /// The same of one that is there.
    pub(crate) fn named(&self, name: &str) -> Option<u32> {
        self.names.iter().position(|known| known == name).map(|at| NAMED + at as u32)
    }

    /// How a program is written.
    pub(crate) fn written(&self, number: u32) -> String {
        match number.checked_sub(NAMED).and_then(|at| self.names.get(at as usize)) {
            Some(name) => format!("<{name}>"),
            None => format!("O{number}"),
        }
    }

    /// The first block of O1234; its own O-word is looked for before a file's name.
    pub(crate) fn program(&self, number: u32) -> Option<TapePosition> {
        let with = |own: bool| {
            let is =
                |p: &&Program| p.number == Some(number) && (p.begin.at != p.begin.after) == own;
            self.programs.iter().find(is)
        };
        let found = with(true).or_else(|| with(false))?;
        Some(TapePosition { file: found.file, at: found.begin.after })
    }

    /// The first block of a program in a file of its own.
    pub(crate) fn file(&self, number: u32) -> Option<TapePosition> {
        let found = self.programs.iter().find(|p| p.file > 0 && p.number == Some(number))?;
        Some(TapePosition { file: found.file, at: found.begin.after })
    }

    /// Where the main program begins.
    pub(crate) fn main(&self, number: Option<u32>) -> TapePosition {
        let own = number.and_then(|number| self.program(number)).filter(|place| place.file == 0);
        let first = self.programs.first().map_or((0, 1), |p| p.begin.after);
        own.unwrap_or(TapePosition { file: 0, at: first })
    }

    /// Numbers of the programs.
    pub(crate) fn programs(&self) -> impl Iterator<Item = u32> {
        self.programs.iter().filter_map(|p| p.number)
    }

    /// The block N of the program in which byte `from` of a file lies: behind it, else from the
    /// program's begin.
    pub(crate) fn block(&self, number: u32, file: usize, from: u32) -> Option<TapePosition> {
        let here = self.programs.iter().rposition(|p| p.file == file && p.begin.at.0 <= from)?;
        let begin = self.programs[here].begin.at.0;
        let next = self.programs.get(here + 1).filter(|next| next.file == file);
        let end = next.map_or(u32::MAX, |p| p.begin.at.0);
        let key = |i: &u32| {
            let (number, place) = self.numbers[*i as usize];
            (number, place.file, place.at.0)
        };
        let behind = |byte: u32| {
            let at = self.sorted.partition_point(|i| key(i) < (number, file, byte));
            let found = self.sorted.get(at).map(|i| self.numbers[*i as usize])?;
            let own = (found.0, found.1.file) == (number, file) && found.1.at.0 < end;
            own.then_some(found.1)
        };
        behind(from.saturating_add(1)).or_else(|| behind(begin))
    }

    /// The other end of the loop whose DO or END begins at this byte of a file.
    pub(crate) fn partner(&self, file: usize, byte: u32) -> Option<Mark> {
        self.loops.partner(file, byte)
    }
}
