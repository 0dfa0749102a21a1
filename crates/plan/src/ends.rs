//! Where the program's lines end on a joined path.
//!
//! ```text
//!   programmed   ──────┐ E        joined   ─────╮
//!                      │                        ● the place nearest to E: single block stops here
//!                      │                        │
//! ```
//!
//! One piece of a joined path may serve many lines: its own `op` is the first, and all that come
//! before the next piece's end on it. Where every line is to end at rest, such a piece is cut at
//! the places nearest to their ends.
use alloc::collections::VecDeque;
use motion::{AXES, Piece, Shape};

/// Ends that are kept: more lines than can be on their way. Of those before, a stop may come where
/// the next piece begins.
const KEPT: usize = 1 << 16;
/// Places of a piece that are looked at, to find the one nearest to an end.
const LOOKS: usize = 64;
/// Halvings of the interval around the best of them.
const HALVINGS: usize = 40;
/// Nothing shorter is cut off, mm.
const SHORTEST: f64 = 1e-6;

/// The end of a move.
#[derive(Clone, Copy, Debug)]
struct End {
    op: u32,
    line: u32,
    at: [f64; AXES],
    /// The path ends here as well: what follows is on another one.
    ends_path: bool,
}

/// The ends of the last moves, in their order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ends(VecDeque<End>);

impl Ends {
    /// A move ends here; of one that comes in parts, the last part counts.
    pub(crate) fn push(&mut self, op: u32, line: u32, at: [f64; AXES]) {
        if self.0.back().is_some_and(|last| last.op == op) {
            self.0.pop_back();
        }
        if self.0.len() == KEPT {
            self.0.pop_front();
        }
        self.0.push_back(End { op, line, at, ends_path: false });
    }

    /// The path ends with the last move.
    pub(crate) fn end_path(&mut self) {
        if let Some(last) = self.0.back_mut() {
            last.ends_path = true;
        }
    }

    /// The first move from this one on.
    fn first(&self, op: u32) -> usize {
        self.0.partition_point(|end| end.op < op)
    }
}

/// Cuts pieces where lines end, as they come.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cutter {
    /// Which lines end on it is known when the next one comes.
    held: Option<Piece>,
    /// Parameter of the first piece up to which it is done: what ended before has ended.
    done: f64,
}

impl Cutter {
    /// The first piece is under way.
    pub(crate) const fn from(done: f64) -> Self {
        Self { held: None, done }
    }

    /// The next piece.
    pub(crate) fn push(&mut self, piece: Piece, ends: &Ends, emit: &mut impl FnMut(Piece)) {
        if let Some(held) = self.held.replace(piece) {
            cut(&held, core::mem::take(&mut self.done), piece.op, ends, emit);
        }
    }

    /// The path comes to rest here; what follows begins with the move `next`, which may be of the
    /// same path.
    pub(crate) fn finish(&mut self, next: u32, ends: &Ends, emit: &mut impl FnMut(Piece)) {
        if let Some(held) = self.held.take() {
            cut(&held, core::mem::take(&mut self.done), next, ends, emit);
        }
    }

    /// What is held.
    pub(crate) const fn held(&self) -> Option<&Piece> {
        self.held.as_ref()
    }
}

/// Cut a piece, behind what is done of it, where the lines end whose moves come before `next`.
fn cut(piece: &Piece, done: f64, next: u32, ends: &Ends, emit: &mut impl FnMut(Piece)) {
    let (mut rest, mut begun, mut done) = (*piece, 0.0, done);
    let mut index = ends.first(piece.op);
    if ends.0.get(index).is_none_or(|end| end.op != piece.op) {
        return emit(rest); // a move by itself, of which no joined path knows
    }
    while let (Some(end), Some(after)) = (ends.0.get(index), ends.0.get(index + 1)) {
        index += 1;
        if end.op >= next || end.ends_path {
            break;
        }
        if end.line == after.line {
            continue;
        }
        let at = nearest(piece, done, &end.at);
        if at - done > SHORTEST && piece.length - at > SHORTEST {
            emit(Piece { length: at - begun, ..rest });
            rest = Piece { begin: piece.begin + at, length: piece.length - at, ..*piece };
            rest.entry = motion::Entry::Smooth;
            (begun, done) = (at, at);
        }
        if piece.length - at > SHORTEST {
            (rest.op, rest.line) = (after.op, after.line);
        }
    }
    emit(rest);
}

/// Parameter of the place of a piece, from one on, that is nearest to a point.
fn nearest(piece: &Piece, from: f64, point: &[f64; AXES]) -> f64 {
    let off = |s: f64| -> f64 {
        let q = piece.at(s).q;
        (0..AXES).map(|i| (q[i] - point[i]) * (q[i] - point[i])).sum()
    };
    let step = (piece.length - from) / LOOKS as f64;
    let place = |n: usize| from + step * n as f64;
    let best = (0..=LOOKS).min_by(|a, b| off(place(*a)).total_cmp(&off(place(*b)))).unwrap_or(0);
    let (mut low, mut high) = (place(best.saturating_sub(1)), place((best + 1).min(LOOKS)));
    for _ in 0..HALVINGS {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if off(a) <= off(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let middle = f64::midpoint(low, high);
    // at an end of the piece, exactly there
    [place(0), piece.length]
        .into_iter()
        .fold(middle, |best, end| if off(end) <= off(best) { end } else { best })
}
