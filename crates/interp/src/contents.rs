//! Where the O-words or a tape's numbered blocks of a text are, handed on from one interpretation of it to the next.
//!
//! A first jump costs one reading of the whole text. An editor executes a text in slices, each with an [`Interpreter`]
//! of its own: without this every slice would read it again. It holds for the very text that it was taken from.
use crate::{Interpreter, dialect::fanuc::Tape, outline::Outline};

/// Of each file, if it was needed.
#[derive(Clone, Debug, Default)]
pub struct Contents {
    outlines: Vec<Option<Outline>>,
    tape: Option<Tape>,
}

impl Interpreter<'_> {
    /// Go by what was read before of this very text.
    #[must_use]
    pub fn with_contents(mut self, contents: Contents) -> Self {
        for (own, known) in self.outlines.iter_mut().zip(contents.outlines) {
            *own = known;
        }
        if let Some(fanuc) = &mut self.fanuc {
            fanuc.tape = contents.tape;
        }
        self
    }

    /// What was read; nothing of a text whose O-words or loops do not fit together.
    pub fn take_contents(&mut self) -> Contents {
        if self.contents_are_faulty {
            return Contents::default();
        }
        let tape = self.fanuc.as_mut().and_then(|fanuc| fanuc.tape.take());
        Contents { outlines: core::mem::take(&mut self.outlines), tape }
    }
}
