//! What a program orders of a turned thread: its passes, and where their tool came from.
//!
//! A stretch that goes back along Z over the passes so far, the spindle turning on, cuts a helix of
//! the other hand: it is another thread, and none where its tool is clear of the work.
use super::law::{Law, Stretch};
use canon::{Axis, OpKind, Position, SpindleOrder};
use units::{Length, Speed, Spin};

/// Shorter than this is no way in which a tool was fed in: the rounding of coordinates, and where
/// axes stand.
pub(super) const FED_IN_MM: f64 = 0.01;

/// The passes that a program orders over one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct OrderedThread {
    pub(super) passes: Vec<Vec<Stretch>>,
    chained: bool,
    /// It goes back over the thread before it, which its tool may be clear of.
    pub(super) goes_back: bool,
    /// Turns of the chain in which that turned back; `None`: it begins at its start angle.
    turns_before: Option<f64>,
}

/// Where each linear axis was before the last rapid that moved it, and which rapid that was; which
/// way the spindle turns.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CameFrom {
    axes: [Option<(u64, Length)>; 3],
    rapids: u64,
    /// The spindle was turned with M4 last.
    is_reversed: bool,
}

impl CameFrom {
    /// The spindle is ordered to do this.
    pub(crate) fn spindle(&mut self, order: &SpindleOrder) {
        match order {
            SpindleOrder::Turn(spin) => self.is_reversed = *spin < Spin::ZERO,
            SpindleOrder::ConstantSurfaceSpeed { speed, .. } => {
                self.is_reversed = *speed < Speed::ZERO;
            }
            SpindleOrder::Stop | SpindleOrder::Orient { .. } | SpindleOrder::ThrowChips(_) => {}
        }
    }

    /// A rapid of the program.
    pub(crate) fn rapid(&mut self, from: &Position, to: &Position) {
        self.rapids += 1;
        for (came, (from, to)) in self.axes.iter_mut().zip(from.linear.iter().zip(&to.linear)) {
            if (*from - *to).abs().value() > FED_IN_MM {
                *came = Some((self.rapids, *from));
            }
        }
    }

    /// Where the tool stood before the last rapid that fed it in to here, across a thread's axis.
    pub(super) fn before(&self, here: &Position, thread: Axis) -> Position {
        let mut stood = *here;
        let across = || (0..3).filter(|i| *i != thread.index());
        let last = across().filter_map(|i| self.axes[i]).map(|(rapid, _)| rapid).max();
        for i in across() {
            if let Some((_, from)) = self.axes[i].filter(|(rapid, _)| Some(*rapid) == last) {
                stood.linear[i] = from;
            }
        }
        stood
    }
}

impl OrderedThread {
    /// One that goes back over another.
    pub(crate) fn after(before: &Self, came: &CameFrom) -> Self {
        let chain = before.passes.last().filter(|_| before.chained);
        let turns = |pass: &Vec<Stretch>| pass.last().map(|last| last.before + last.turns);
        let turns_before = chain.and_then(turns);
        let last = before.passes.last().and_then(|pass| pass.last());
        // with the spindle reversed it would be a thread of its own
        let goes_back = last.is_some_and(|last| last.is_reversed == came.is_reversed);
        Self { goes_back, turns_before, ..Self::default() }
    }

    /// A stretch goes back over what is ordered so far, and cuts a helix of the other hand if it
    /// cuts.
    pub(crate) fn is_left_by(
        &self,
        op: u32,
        from: &Position,
        came: &CameFrom,
        kind: &OpKind,
    ) -> bool {
        let OpKind::Threading(order) = kind else { return false };
        let new = Stretch::new(op, from, order, *from).turned(came.is_reversed);
        self.passes
            .last()
            .is_some_and(|pass| pass.iter().any(|stretch| stretch.is_crossed_by(&new)))
    }

    /// An op from `from` on; whether it belongs to this thread.
    pub(crate) fn see(&mut self, op: u32, from: &Position, came: &CameFrom, kind: &OpKind) -> bool {
        let OpKind::Threading(order) = kind else {
            self.chained = false;
            return matches!(
                kind,
                OpKind::Rapid { .. }
                    | OpKind::Dwell { .. }
                    | OpKind::Spindle { .. }
                    | OpKind::Coolant { .. }
                    | OpKind::Overrides { .. }
                    | OpKind::PathMode(_)
                    | OpKind::Output(_)
                    | OpKind::Message(_)
            );
        };
        let stood = came.before(from, order.axis);
        let mut stretch = Stretch::new(op, from, order, stood).turned(came.is_reversed);
        if self.is_left_by(op, from, came, kind) {
            return false; // another thread
        }
        match self.passes.last_mut() {
            Some(pass) if self.chained => {
                let before = pass.last().map_or(0.0, |last| last.before + last.turns);
                // a chain that feeds the tool in by itself begins where it is clear
                let first = pass.first().map_or(*from, |first| first.from);
                let across = |i: usize| i != order.axis.index();
                let feeds_in = (0..3).any(|i| across(i) && first.linear[i] != from.linear[i]);
                let stood = if feeds_in { first } else { stood };
                pass.push(Stretch { stood, before, ..stretch });
            }
            last => {
                if last.and_then(|pass| pass.first()).is_some_and(|first| !first.is_under(&stretch))
                {
                    return false; // another thread
                }
                if let Some(turns) = self.turns_before.take() {
                    (stretch.before, stretch.turns_back) = (turns, true);
                }
                self.passes.push(vec![stretch]);
                self.chained = true;
            }
        }
        true
    }

    /// The pass that an op belongs to, its thread, and the turns from the thread's start to the
    /// chain's end.
    pub(super) fn find(&self, op: u32) -> Option<(usize, Law<'_>, f64)> {
        let (index, pass) = self
            .passes
            .iter()
            .enumerate()
            .rfind(|(_, pass)| pass.first().is_some_and(|s| s.op <= op))?;
        let thread = Law::of(pass)?;
        let whole = pass.last().map_or(0.0, |last| last.before + last.turns);
        (op >= thread.first().op).then_some((index, thread, whole - thread.first().before))
    }
}
