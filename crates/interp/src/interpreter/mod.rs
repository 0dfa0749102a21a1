//! The program, block by block: reads, follows its front end, collects what was found.
//!
//! ```text
//!   rounds     loops that never end
//!   snapshot   stops an interpretation, and goes on later
//!   contents   what was read of a text, handed on
//! ```
pub(crate) mod codes_in_force;
pub(crate) mod contents;
pub(crate) mod rounds;
pub(crate) mod snapshot;

use crate::{
    call::{Sink, out::Out},
    execute::{begin, refused},
    fault::unknown::Unknown,
    front_end::FrontEnd,
    interpreter::rounds::Rounds,
    program::Program,
    setup::{Parameters, Setup},
};
use diag::{Diagnostic, Span};

/// Whether there is more to execute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Call [`Interpreter::step`] again.
    More,
    /// The program is over: it ended, or nothing after its last error could be executed.
    Ended,
}

/// Executes a program's blocks and says, call by call, what they order.
///
/// A block with an error is not executed, the error is kept, and the next block follows: so all
/// errors of a program come at once. What moves a machine asks [`Interpreter::has_errors`]
/// first.
pub struct Interpreter<'s> {
    pub(crate) program: Program<'s>,
    pub(crate) front_end: FrontEnd,
    pub(crate) rounds: Rounds,
}

impl<'s> Interpreter<'s> {
    /// At the beginning of a program.
    pub fn new(source: &'s [u8], setup: &'s Setup) -> Self {
        let program = Program::new(source, setup);
        let front_end = FrontEnd::new(setup, program.sources.len());
        Self { program, front_end, rounds: Rounds::default() }
    }

    /// Execute one block.
    #[inline]
    pub fn step<S: Sink>(&mut self, sink: &mut S) -> Progress {
        let it = &mut self.program;
        let mut held = core::mem::take(&mut it.executor.held);
        let mut remarks = Vec::new();
        let place = it.executor.words.place;
        let mut out = Out { sink, held: &mut held, remarks: &mut remarks, place };
        if !it.begun {
            it.begun = true;
            begin::begin(&it.executor.modes, &mut out);
            self.front_end.begin(&mut it.executor, &mut out);
        }
        if !(it.ended || it.piece_over) {
            self.block(&mut out);
        }
        let it = &mut self.program;
        it.executor.held = held;
        if !(remarks.is_empty() && it.executor.remarks.is_empty()) {
            let of_words = core::mem::take(&mut it.executor.remarks);
            it.report_all(of_words.into_iter().chain(remarks));
        }
        if it.ended || it.piece_over {
            it.finish();
            return Progress::Ended;
        }
        Progress::More
    }

    #[inline]
    fn block<S: Sink>(&mut self, out: &mut Out<'_, S>) {
        let it = &mut self.program;
        let (before, asked) = (it.executor.modes.unknown, it.executor.store.asked);
        let result = match it.read_block(out) {
            Ok(true) => self.front_end.block(it, out),
            Ok(false) => Ok(()),
            Err(fault) => Err(fault),
        };
        match result {
            Err(fault) => it.refuse(*fault, before, out),
            Ok(()) if it.executor.modes.unknown != Unknown::default() && !it.block.faulty => {
                let ex = &mut it.executor;
                refused::settle_unknown(&ex.words, &mut ex.modes, &it.block, out);
            }
            Ok(()) => {}
        }
        let asked = it.executor.store.asked.wrapping_sub(asked);
        it.idle.read(asked);
        if out.sink.take_time_passed() {
            it.idle.end();
            self.rounds.time_passes();
        }
        if core::mem::take(&mut it.jumped_back) {
            let repetition = self.rounds.repeats(it, &self.front_end);
            let repetition = repetition.map(|repetition| repetition.said(it.block.span));
            if let Some(found) = repetition.or_else(|| it.idles()) {
                it.ended = true;
                if it.errors == 0 {
                    it.report(found); // else its counting has failed, which was said
                }
            }
        }
    }

    /// Execute to the end.
    pub fn run<S: Sink>(&mut self, sink: &mut S) {
        while self.step(sink) == Progress::More {}
    }

    /// What was found so far.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.program.diagnostics
    }

    /// Whether the program is refused, as far as it was executed.
    pub const fn has_errors(&self) -> bool {
        self.program.errors > 0
    }

    /// The numbered parameters as the program has set them.
    pub const fn parameters(&self) -> &Parameters {
        &self.program.executor.store.numbered
    }

    /// The block executed last.
    pub const fn place(&self) -> Span {
        self.program.block.span
    }

    /// The byte of its file up to which the block executed last has read: its own end, or that of a
    /// block behind it for which a corner was cut.
    pub fn read_up_to(&self) -> u32 {
        self.program.block.span.end.max(self.program.ahead)
    }

    /// File and byte where the next block begins.
    #[inline]
    pub fn position(&self) -> (usize, u32) {
        (self.program.file, self.program.parsers[self.program.file].position().0)
    }
}
