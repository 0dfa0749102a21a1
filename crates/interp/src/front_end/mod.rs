//! Which front end reads a program: the one place that chooses.
//!
//! ```text
//!   rs274   O-words, words as they are
//!   fanuc   tapes, custom macros
//! ```
pub(crate) mod fanuc;
pub(crate) mod rs274;

use crate::{
    call::{Sink, out::Out},
    dialect::rules::FrontEndKind,
    fault::Outcome,
    front_end::{
        fanuc::{Tape, state::Fanuc},
        rs274::Rs274,
    },
    program::{Program, outline::Outline},
    setup::Setup,
    state::executor::Executor,
    words::names,
};

/// What decides which block comes next, and what its words mean.
#[derive(Clone, PartialEq)]
pub(crate) enum FrontEnd {
    /// O-words, and the words of the shared language.
    Rs274(Rs274),
    /// Tapes and custom macros.
    Fanuc(Box<Fanuc>),
}

/// What front ends have read of a whole text, by file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Index {
    outlines: Vec<Option<Outline>>,
    tape: Option<Tape>,
}

impl FrontEnd {
    /// That of the dialect.
    pub(crate) fn new(setup: &Setup, files: usize) -> Self {
        match setup.dialect.rules().front_end {
            FrontEndKind::Rs274 => Self::Rs274(Rs274::new(setup.block_delete, files)),
            FrontEndKind::Fanuc(kind) => Self::Fanuc(Box::new(Fanuc::new(kind, setup))),
        }
    }

    /// Before the first block.
    pub(crate) fn begin<S: Sink>(&self, ex: &mut Executor, out: &mut Out<'_, S>) {
        match self {
            Self::Rs274(_) => {}
            Self::Fanuc(fanuc) => fanuc::cycles::lathe::begin(fanuc, ex, out),
        }
    }

    /// Execute the block that was read.
    #[inline]
    pub(crate) fn block<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        match self {
            Self::Rs274(rs274) => rs274.block(it, out),
            Self::Fanuc(fanuc) => fanuc::block(fanuc, it, out),
        }
    }

    /// Value of a parameter, written `#5` or `#<name>`, if it has one.
    pub(crate) fn parameter(&self, ex: &Executor, written: &str) -> Option<f64> {
        let inner = written.strip_prefix('#')?;
        match self {
            Self::Rs274(_) => names::written(&ex.modes, &ex.store, inner),
            Self::Fanuc(fanuc) => {
                fanuc::variables::values::variable_now(fanuc, ex, inner.parse().ok()?)
            }
        }
    }

    /// Whether the place of a block that was not executed yet is known: where a tape's profile
    /// ends.
    pub(crate) fn looks_ahead(&self) -> bool {
        match self {
            Self::Rs274(_) => false,
            Self::Fanuc(fanuc) => fanuc.takes_down_profile(),
        }
    }

    /// A copy that reads the whole text again when it needs it.
    pub(crate) fn without_index(&mut self) -> Self {
        match self {
            Self::Rs274(rs274) => Self::Rs274(rs274.without_outlines()),
            Self::Fanuc(fanuc) => Self::Fanuc(Box::new(fanuc.without_tape())),
        }
    }

    /// Go by what was read before of this very text.
    pub(crate) fn use_index(&mut self, index: Index) {
        match self {
            Self::Rs274(rs274) => {
                for (own, known) in rs274.flow.outlines.iter_mut().zip(index.outlines) {
                    *own = known;
                }
            }
            Self::Fanuc(fanuc) => fanuc.tape = index.tape,
        }
    }

    /// What was read, which it forgets.
    pub(crate) fn take_index(&mut self) -> Index {
        match self {
            Self::Rs274(rs274) => {
                Index { outlines: core::mem::take(&mut rs274.flow.outlines), tape: None }
            }
            Self::Fanuc(fanuc) => Index { outlines: Vec::new(), tape: fanuc.tape.take() },
        }
    }
}
