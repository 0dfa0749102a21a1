//! What a program has executed since the machine has last moved or waited.
//!
//! A machine that executes such blocks without end stands still, and no one sees why. Where a
//! program leads back, both counts are bounded by [`Limits`].
use crate::{fault::error, setup::Limits};
use diag::{Diagnostic, Span};

/// What lets time pass in a loop that reads the machine.
pub(crate) const WAITING: &str = "M66 with L1 to L4 and Q waits for an input, as M66 P0 L3 Q10; G4 P0.1 in the loop lets time pass between two readings";
/// What ends a loop that counts.
pub(crate) const COUNTING: &str = "a loop ends by a condition that its rounds change, as #1=[#1+1] in it changes [#1 LT 10]; G4 P0.1 waits, M0 waits for the operator";

/// Work done since the last motion or wait.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Idle {
    /// Blocks, long ones counted as several.
    blocks: u64,
    /// Readings of the machine's inputs.
    reads: u64,
}

impl Idle {
    /// Adds a block that counts for so many.
    pub(crate) const fn executed(&mut self, blocks: u64) {
        self.blocks = self.blocks.saturating_add(blocks);
    }

    /// Adds readings of the machine.
    pub(crate) const fn read(&mut self, reads: u32) {
        self.reads = self.reads.saturating_add(reads as u64);
    }

    /// The machine has moved or waited.
    pub(crate) const fn end(&mut self) {
        *self = Self { blocks: 0, reads: 0 };
    }

    /// Refuses the block that leads back, where it has lasted for too long.
    pub(crate) fn refusal(&self, limits: &Limits, span: Span) -> Option<Diagnostic> {
        let (blocks, reads) = (limits.idle_blocks, limits.idle_reads);
        let (text, help) = if self.reads > reads {
            let text = format!(
                "this loop has read the machine {reads} times, and nothing has moved or waited: does it end?"
            );
            (text, WAITING)
        } else if self.blocks > blocks {
            let text = format!(
                "this loop has gone on for {blocks} blocks in which nothing moves or waits: does it end?"
            );
            (text, COUNTING)
        } else {
            return None;
        };
        Some(error("I0803", span, text).with_help(help))
    }
}
