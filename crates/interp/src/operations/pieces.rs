//! Programs that are too long to be held: executed piece by piece.
//!
//! ```text
//!   file   ├── piece ──┼── piece ──┼── piece ──┤        a piece is so many whole lines
//!               └► Ops ─► Rest ─┘└► Ops ─► Rest ─┘       what is known goes on to the next
//! ```
//!
//! Only a program without O-words can be read so, because they lead back
//! ([`can_be_read_in_pieces`]). Lines are counted through the program; bytes are those of the
//! piece.
use crate::{
    interpreter::{Interpreter, snapshot::Snapshot},
    operations::{lint::Reader, ops::Ops},
    resolve::Resolver,
    setup::Setup,
};
use diag::Diagnostic;
use gcode::{Block, Grammar, Parser};

/// Whether a piece of a program needs nothing but the piece before it.
pub fn can_be_read_in_pieces(piece: &[u8], setup: &Setup) -> bool {
    setup.dialect.grammar() == Grammar::Rs274
        && !Parser::new(piece, 0).next_o_word(&mut Block::new())
}

/// What an interpreter knows at the end of a piece.
#[derive(Clone)]
pub struct Rest {
    pub(crate) snapshot: Snapshot,
    pub(crate) line: u32,
}

impl<'s> Interpreter<'s> {
    /// On with the next piece of a program; `rest` is what was known at the end of the one before,
    /// if there was one.
    pub fn of_piece(
        piece: &'s [u8],
        setup: &'s Setup,
        rest: Option<&Rest>,
        more_follows: bool,
    ) -> Self {
        let mut new = match rest {
            None => Self::new(piece, setup),
            Some(rest) => {
                let mut new = Self::resume(piece, setup, &rest.snapshot);
                new.program.parsers[0].seek(0, rest.line);
                new
            }
        };
        new.program.more_follows = more_follows;
        new
    }

    /// What it knows at the end of its piece, without what was found so far: that is the caller's
    /// to keep.
    pub fn rest(&mut self) -> Rest {
        let snapshot = self.snapshot().without_findings();
        Rest { snapshot, line: self.program.parsers[0].position().1 }
    }
}

/// The state of [`Ops`] at the end of a piece.
#[derive(Clone)]
pub struct OpsRest {
    pub(crate) rest: Rest,
    pub(crate) resolver: Resolver,
}

impl<'s> Ops<'s> {
    /// On with the next piece of a program.
    pub fn of_piece(
        piece: &'s [u8],
        setup: &'s Setup,
        rest: Option<OpsRest>,
        more_follows: bool,
    ) -> Self {
        let first = rest.is_none();
        let (rest, resolver) = match rest {
            None => (None, Resolver::new(setup)),
            Some(OpsRest { rest, resolver }) => (Some(rest), resolver),
        };
        let interpreter = Interpreter::of_piece(piece, setup, rest.as_ref(), more_follows);
        let new = Self::with(interpreter, resolver);
        if first { new.suspecting(piece, setup) } else { new }
    }

    /// What is known at the end of the piece, without what was found so far.
    pub fn rest(self) -> OpsRest {
        let (mut interpreter, mut resolver) = self.parts();
        drop(resolver.take_findings());
        OpsRest { rest: interpreter.rest(), resolver }
    }
}

/// [`lint`](crate::lint()), piece by piece.
pub struct Linter<'s> {
    setup: &'s Setup,
    reader: Reader,
    line: u32,
}

impl<'s> Linter<'s> {
    /// At the beginning of a program.
    pub fn new(setup: &'s Setup) -> Self {
        Self { setup, reader: Reader::new(setup), line: 1 }
    }

    /// What is found in the next piece.
    pub fn piece(&mut self, piece: &[u8]) -> Vec<Diagnostic> {
        let (mut parser, mut block) = (Parser::new(piece, 0), Block::new());
        parser.seek(parser.position().0, self.line);
        while parser.next(&mut block) {
            if !block.faulty {
                self.reader.block(&block);
            }
        }
        self.line = parser.position().1;
        let mut found = parser.take_diagnostics();
        found.extend(self.reader.take());
        found
    }

    /// What only the end of the program shows. Of these only the line is known.
    pub fn finish(self) -> Vec<Diagnostic> {
        let mut found = self.reader.finish(self.setup);
        for finding in &mut found {
            finding.labels.clear();
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Listing, Progress};

    fn whole(text: &[u8], setup: &Setup) -> (String, Vec<Diagnostic>) {
        let mut interpreter = Interpreter::new(text, setup);
        let mut listing = Listing::new(Vec::new());
        interpreter.run(&mut listing);
        let listed = String::from_utf8(listing.finish().unwrap()).unwrap();
        (listed, interpreter.diagnostics().to_vec())
    }

    fn in_pieces(text: &[u8], setup: &Setup, lines: usize) -> (String, Vec<Diagnostic>) {
        let mut listing = Listing::new(Vec::new());
        let (mut rest, mut found) = (None, Vec::new());
        let all: Vec<&[u8]> = text.split_inclusive(|byte| *byte == b'\n').collect();
        let count = all.chunks(lines).count();
        for (i, chunk) in all.chunks(lines).enumerate() {
            let piece = chunk.concat();
            let mut interpreter =
                Interpreter::of_piece(&piece, setup, rest.as_ref(), i + 1 < count);
            while interpreter.step(&mut listing) == Progress::More {}
            found.extend(interpreter.diagnostics().iter().cloned());
            rest = Some(interpreter.rest());
        }
        (String::from_utf8(listing.finish().unwrap()).unwrap(), found)
    }

    #[test]
    fn a_program_in_pieces_means_what_it_means_whole() {
        let setup = Setup::default();
        let text = b"G21 F100\nG0 X1\nG41.1 D1\nG1 X5\nY5\nX0\n#3=7\nG40\nG0 X#3\nG81 Z-1 R2 X2\nX3\nQ9\nM2\n";
        let (listed, found) = whole(text, &setup);
        for lines in 1..=13 {
            let (pieces, found_in_pieces) = in_pieces(text, &setup, lines);
            assert_eq!(pieces, listed, "{lines} lines a piece");
            let places = |found: &[Diagnostic]| -> Vec<_> {
                found.iter().map(|finding| (finding.code, finding.span.line)).collect()
            };
            assert_eq!(places(&found_in_pieces), places(&found), "{lines} lines a piece");
        }
    }

    #[test]
    fn a_program_that_is_cut_off_is_noticed_at_the_end_of_its_last_piece_only() {
        let (_, found) = in_pieces(b"G0 X1\nG0 X2\nG0 X3\n", &Setup::default(), 1);
        let codes: Vec<_> = found.iter().map(|finding| (finding.code, finding.span.line)).collect();
        assert_eq!(codes, [("I0301", 3)]);
    }

    #[test]
    fn only_a_program_without_o_words_can_be_read_in_pieces() {
        assert!(can_be_read_in_pieces(b"G0 X1 (o100 call)\n", &Setup::default()));
        assert!(!can_be_read_in_pieces(b"G0 X1\no100 call\n", &Setup::default()));
    }
}
