//! Shape and time of a long path side by side: while moves are joined, the pieces that were joined
//! before them are timed.
//!
//! ```text
//!   moves   1 … n │ n+1 … 2n │ 2n+1 … 3n │           one turn: n moves
//!   Joiner  ▓▓▓▓▓▓│▓▓▓▓▓▓▓▓▓▓│▓▓▓▓▓▓▓▓▓▓▓│
//!   Timing        │▓▓▓▓▓▓    │▓▓▓▓▓▓▓▓▓▓ │▓▓▓▓▓
//! ```
//!
//! Both give the same to the last bit however what they take arrives, so the steps are those of
//! moves that are joined and timed one after another; they come later.
use crate::Step;
use crate::timing::Timing;
use alloc::vec::Vec;
use motion::{Curve, Piece};
use path::geometry::{Joiner, Segment};

/// Runs two pieces of work to their ends: side by side, where there are threads.
pub type SideBySide = fn(&mut (dyn FnMut() + Send), &mut (dyn FnMut() + Send));

/// Moves of a turn: many, so that both sides have about as much to do in each; a curve counts as so
/// many lines.
const TURN: usize = 1024;
const CURVE: usize = 8;

/// What waits for its turn.
#[derive(Clone, Debug)]
pub(crate) struct Beside {
    both: SideBySide,
    moves: Vec<Segment>,
    /// Of moves, what they count.
    count: usize,
    pieces: Vec<Piece>,
}

impl Beside {
    pub(crate) const fn new(both: SideBySide) -> Self {
        Self { both, moves: Vec::new(), count: 0, pieces: Vec::new() }
    }

    /// The operation of the first move that waits, or of the first piece.
    pub(crate) fn next_op(&self) -> Option<u32> {
        let piece = self.pieces.first().map(|piece| piece.op);
        piece.or_else(|| self.moves.first().map(|segment| segment.op))
    }

    /// One more move; whether they are enough for a turn.
    pub(crate) fn push(&mut self, segment: Segment) -> bool {
        self.count += if matches!(segment.curve, Curve::Line(_)) { 1 } else { CURVE };
        self.moves.push(segment);
        self.count >= TURN
    }

    /// Join the moves, and time the pieces of the turn before.
    pub(crate) fn turn(
        &mut self,
        joiner: &mut Joiner,
        timing: &mut Timing,
        emit: &mut dyn FnMut(Step),
    ) {
        let Self { both, moves, pieces, count } = self;
        let is_first = pieces.is_empty();
        let (mut joined, mut steps) = (Vec::new(), Vec::new());
        let mut join = || {
            for segment in moves.drain(..) {
                joiner.push(segment, &mut |piece| joined.push(piece));
            }
        };
        let mut time = || {
            for piece in pieces.drain(..) {
                timing.push(piece);
                timing.pump(&mut |step| steps.push(step));
            }
        };
        if is_first {
            join(); // there is nothing to time beside it: most paths are shorter than a turn
        } else {
            both(&mut join, &mut time);
        }
        (*pieces, *count) = (joined, 0);
        steps.into_iter().for_each(emit);
    }

    /// The path ends: join and time all that is left.
    pub(crate) fn finish(
        &mut self,
        joiner: &mut Joiner,
        timing: &mut Timing,
        emit: &mut dyn FnMut(Step),
    ) {
        self.turn(joiner, timing, emit);
        for piece in self.pieces.drain(..) {
            timing.push(piece);
            timing.pump(emit);
        }
        // the last ones together, so that the law knows with them that the path ends
        joiner.finish(&mut |piece| timing.push(piece));
    }
}
