//! Where the O-words or a tape's numbered blocks of a text are, handed on from one interpretation
//! of it to the next.
//!
//! A first jump costs one reading of the whole text. An editor executes a text in slices, each with
//! an [`Interpreter`] of its own: without this every slice would read it again. It holds for the
//! very text that it was taken from.
use crate::{Interpreter, front_end::Index};

/// Of each file, if it was needed.
#[derive(Clone, Debug, Default)]
pub struct Contents(Index);

impl Interpreter<'_> {
    /// Go by what was read before of this very text.
    #[must_use]
    pub fn with_contents(mut self, contents: Contents) -> Self {
        self.front_end.use_index(contents.0);
        self
    }

    /// What was read; nothing of a text whose O-words or loops do not fit together.
    pub fn take_contents(&mut self) -> Contents {
        if self.program.contents_are_faulty {
            return Contents::default();
        }
        Contents(self.front_end.take_index())
    }
}
