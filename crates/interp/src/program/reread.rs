//! Blocks of loops and subprograms, kept as they were read.
//!
//! ```text
//!   place in the text ─► slot ─┬─ holds this very block: exchanged for the one at hand, nothing is read
//!                              └─ holds another one: the block is read, and the slot is its from now on
//! ```
//!
//! A loop reads its lines again and again, and reading a line costs several times as much as
//! executing it. Blocks are exchanged, not copied: the one at hand goes back to its slot when the
//! next is asked for. What is read for the first time is not kept, for most of a program is read
//! once.
use crate::program::outline::At;
use gcode::{Block, Parser};

/// How many blocks are kept: a power of two.
const SLOTS: usize = 1024;

/// The blocks kept.
#[derive(Default)]
pub(crate) struct Reread {
    slots: Vec<Slot>,
    /// Of each file: how far it has been read.
    furthest: Vec<u32>,
    /// The slot whose block is at hand.
    out: Option<usize>,
}

#[derive(Default)]
struct Slot {
    /// File and first byte of the block.
    key: Option<(usize, u32)>,
    /// Where the next one begins.
    after: At,
    block: Block,
}

impl Reread {
    /// As [`Parser::next`], for a text of which this file's lines are read more than once.
    pub(crate) fn next(&mut self, file: usize, parser: &mut Parser<'_>, block: &mut Block) -> bool {
        if let Some(out) = self.out.take() {
            core::mem::swap(block, &mut self.slots[out].block);
        }
        if self.furthest.len() <= file {
            self.furthest.resize(file + 1, 0);
        }
        let (byte, _) = parser.position();
        if byte >= self.furthest[file] {
            let more = parser.next(block);
            self.furthest[file] = parser.position().0;
            return more;
        }
        if self.slots.is_empty() {
            self.slots.resize_with(SLOTS, Slot::default);
        }
        // Fibonacci hashing: neighbouring lines come to different slots
        let i = (byte ^ (file as u32) << 7).wrapping_mul(0x9E37_79B1) as usize >> 22 & (SLOTS - 1);
        let slot = &mut self.slots[i];
        self.out = Some(i);
        if slot.key == Some((file, byte)) {
            core::mem::swap(block, &mut slot.block);
            parser.seek(slot.after.0, slot.after.1);
            return true;
        }
        slot.key = None;
        if !parser.next(block) {
            return false;
        }
        slot.key = Some((file, byte));
        slot.after = parser.position();
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_read_again_is_the_same_block() {
        let blocks = (0..3000).map(|i| format!("G1 X{i} Y[#1+{i}] (c{i})\n"));
        let text = blocks.collect::<Vec<_>>().concat();
        let mut reread = Reread::default();
        let mut parser = Parser::new(text.as_bytes(), 0);
        let mut block = Block::new();
        for round in 0..3 {
            parser.seek(0, 1);
            let mut lines = 0;
            while reread.next(0, &mut parser, &mut block) {
                assert_eq!(block.to_string(), format!("G1 X{lines} Y[#1+{lines}] (c{lines})"));
                lines += 1;
                assert_eq!(block.span.line, lines, "round {round}");
            }
            assert_eq!(lines, 3000);
        }
    }
}
