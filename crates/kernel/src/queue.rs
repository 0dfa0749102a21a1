//! The steps that wait, and the one that is executed: a ring of small steps, and beside it a table
//! for each type of plan.
//!
//! ```text
//!   push ─► │ Move ● │ Tap ● │ Dwell │ Follow ● │ …        a step is removed, and the slot of its plan released: done, handed
//!                  ╰───╮ ╰──╮              ╰──╮             back, given up, or forgotten for a recovery
//!             moves [ ■ ■ □ □ ]  taps [ ■ □ ]  stretches [ ■ □ □ □ ]
//! ```
//!
//! Only here are slots taken and released, so a step in the ring always has its plan. Where ring or
//! table is full, the step is refused as a whole and can be pushed again after a tick. All memory
//! is taken in [`Queue::new`].
use crate::plans::{Handle, Plans};
use alloc::collections::VecDeque;
use core::convert::Infallible;
use motion::{
    Borrowed, ChipThrow, Follow, Move, Plan, Profile, Readable, Storage, TapPlan, Transfer,
};

/// Steps that may wait, with the one that is executed.
pub const QUEUE: usize = 64;
/// Moves from rest to rest that may be among them. Each takes many servo periods, and none needs to
/// see beyond its own end: so many are milliseconds enough for what feeds the kernel.
pub const MOVES: usize = 16;
/// Stretches of joined paths: as many as steps, since an override looks along all of them for a way
/// to end.
pub const STRETCHES: usize = QUEUE;
/// Taps: the one under way, whose successor must be known where a stroke goes on in the same hole,
/// and two holes ahead.
pub const TAPS: usize = 4;
/// Changes of a spindle's speed: at once, one or two for each hole.
pub const RAMPS: usize = 8;
/// Chip removals: one for each hole, as taps.
pub const CHIP_REMOVALS: usize = 4;

/// A step as it is executed.
pub(crate) type Step<'a> = motion::Step<Borrowed<'a>>;
/// What it does.
pub(crate) type StepKind<'a> = motion::StepKind<Borrowed<'a>>;
/// What a spindle does in it.
pub(crate) type SpindleStep<'a> = motion::SpindleStep<Borrowed<'a>>;

/// There is no room for a step: try again after the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Full {
    /// All places of the queue are taken.
    Steps,
    /// All [`MOVES`] are.
    Moves,
    /// All [`STRETCHES`] are.
    Stretches,
    /// All [`TAPS`] are.
    Taps,
    /// All [`RAMPS`] are.
    Ramps,
    /// All [`CHIP_REMOVALS`] are.
    ChipRemovals,
}

impl core::fmt::Display for Full {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (count, what) = match self {
            Self::Steps => (QUEUE, "steps"),
            Self::Moves => (MOVES, "moves from rest to rest"),
            Self::Stretches => (STRETCHES, "stretches of joined paths"),
            Self::Taps => (TAPS, "taps"),
            Self::Ramps => (RAMPS, "changes of spindle speed"),
            Self::ChipRemovals => (CHIP_REMOVALS, "chip removals"),
        };
        write!(f, "the kernel's queue has room for {count} {what}, and all of them are waiting")
    }
}

impl core::error::Error for Full {}

/// Plans in the queue's tables.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slots;

impl Storage for Slots {
    type Of<T: Plan> = Handle<T>;
}

/// Plans that are not wanted any more.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Released;

impl Storage for Released {
    type Of<T: Plan> = ();
}

const _: () = assert!(size_of::<motion::Step<Slots>>() <= motion::STEP_BYTES);

/// Bytes of a queue: its ring and its tables.
const QUEUE_BYTES: usize = QUEUE * size_of::<motion::Step<Slots>>()
    + Plans::<Move, MOVES>::BYTES
    + Plans::<Follow, STRETCHES>::BYTES
    + Plans::<TapPlan, TAPS>::BYTES
    + Plans::<Profile, RAMPS>::BYTES
    + Plans::<ChipThrow, CHIP_REMOVALS>::BYTES;

const _: () = assert!(QUEUE_BYTES <= 192 * 1024);

/// See the module's header.
#[derive(Clone, Debug)]
pub(crate) struct Queue {
    steps: VecDeque<motion::Step<Slots>>,
    tables: Tables,
}

/// A table for each type of plan.
#[derive(Clone, Debug)]
struct Tables {
    moves: Plans<Move, MOVES>,
    stretches: Plans<Follow, STRETCHES>,
    taps: Plans<TapPlan, TAPS>,
    ramps: Plans<Profile, RAMPS>,
    chip_removals: Plans<ChipThrow, CHIP_REMOVALS>,
}

impl Queue {
    /// With room for all that may ever wait.
    pub(crate) fn new() -> Self {
        let tables = Tables {
            moves: Plans::new(),
            stretches: Plans::new(),
            taps: Plans::new(),
            ramps: Plans::new(),
            chip_removals: Plans::new(),
        };
        Self { steps: VecDeque::with_capacity(QUEUE), tables }
    }

    /// Append a step; its plan is copied into a free slot.
    pub(crate) fn push<S: Readable>(&mut self, step: &motion::Step<S>) -> Result<(), Full> {
        if self.is_full() {
            return Err(Full::Steps);
        }
        let step = step.transfer(&mut Keep(&mut self.tables))?;
        self.steps.push_back(step);
        Ok(())
    }

    pub(crate) fn is_full(&self) -> bool {
        self.steps.len() == QUEUE
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    pub(crate) fn len(&self) -> usize {
        self.steps.len()
    }

    /// The step at a place, counted from the front.
    #[inline]
    pub(crate) fn get(&self, index: usize) -> Option<Step<'_>> {
        self.steps.get(index)?.transfer(&mut Read(&self.tables)).ok()
    }

    /// The program line of the step at a place: without its plan, which is not looked up.
    pub(crate) fn line(&self, index: usize) -> Option<u32> {
        Some(self.steps.get(index)?.line)
    }

    /// The tap at a place, if one is there.
    pub(crate) fn tap(&self, index: usize) -> Option<&TapPlan> {
        match self.steps.get(index)?.kind {
            motion::StepKind::Tap(plan) => self.tables.taps.get(plan),
            _ => None,
        }
    }

    /// Whether the step at a place follows a path by the turns of a spindle.
    pub(crate) fn is_per_revolution(&self, index: usize) -> bool {
        let Tables { moves, stretches, .. } = &self.tables;
        match self.steps.get(index).map(|step| &step.kind) {
            Some(motion::StepKind::Move(plan) | motion::StepKind::Probe { order: plan, .. }) => {
                moves.get(*plan).is_some_and(|plan| plan.per_revolution)
            }
            Some(motion::StepKind::Follow(plan)) => {
                stretches.get(*plan).is_some_and(|plan| plan.per_revolution)
            }
            _ => false,
        }
    }

    /// What the front step consults, if it does.
    pub(crate) fn consults(&self) -> Option<u16> {
        match self.steps.front()?.kind {
            motion::StepKind::Consult(what) => Some(what),
            _ => None,
        }
    }

    pub(crate) fn front(&self) -> Option<Step<'_>> {
        self.get(0)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = Step<'_>> {
        (0..self.len()).map_while(|index| self.get(index))
    }

    /// The first steps are done.
    pub(crate) fn remove_first(&mut self, count: usize) {
        for _ in 0..count {
            let Some(step) = self.steps.pop_front() else { return };
            self.tables.release(&step);
        }
    }

    /// All but the first steps are taken back.
    pub(crate) fn truncate(&mut self, stays: usize) {
        while self.steps.len() > stays {
            let Some(step) = self.steps.pop_back() else { return };
            self.tables.release(&step);
        }
    }

    /// The step at a place ends at this planned time of it, in motion; whether it is one that
    /// moves, and long enough.
    pub(crate) fn cut(&mut self, index: usize, time: f64) -> bool {
        let Tables { moves, stretches, .. } = &mut self.tables;
        match self.steps.get(index).map(|step| &step.kind) {
            Some(motion::StepKind::Move(plan)) => {
                moves.get_mut(*plan).is_some_and(|plan| plan.cut(time))
            }
            Some(motion::StepKind::Follow(plan)) => {
                stretches.get_mut(*plan).is_some_and(|plan| plan.cut(time))
            }
            _ => false,
        }
    }

    /// Nothing is to be done any more.
    pub(crate) fn clear(&mut self) {
        self.truncate(0);
    }
}

impl Tables {
    fn release(&mut self, step: &motion::Step<Slots>) {
        let Ok(_) = step.transfer::<Released, _>(&mut Release(self));
    }
}

/// Plans into the tables.
struct Keep<'a>(&'a mut Tables);

impl<S: Readable> Transfer<S, Slots> for Keep<'_> {
    type Refused = Full;

    fn path_move(&mut self, plan: &S::Of<Move>) -> Result<Handle<Move>, Full> {
        self.0.moves.put(S::plan(plan)).ok_or(Full::Moves)
    }
    fn follow(&mut self, plan: &S::Of<Follow>) -> Result<Handle<Follow>, Full> {
        self.0.stretches.put(S::plan(plan)).ok_or(Full::Stretches)
    }
    fn tap(&mut self, plan: &S::Of<TapPlan>) -> Result<Handle<TapPlan>, Full> {
        self.0.taps.put(S::plan(plan)).ok_or(Full::Taps)
    }
    fn ramp(&mut self, plan: &S::Of<Profile>) -> Result<Handle<Profile>, Full> {
        self.0.ramps.put(S::plan(plan)).ok_or(Full::Ramps)
    }
    fn chip_removal(&mut self, plan: &S::Of<ChipThrow>) -> Result<Handle<ChipThrow>, Full> {
        self.0.chip_removals.put(S::plan(plan)).ok_or(Full::ChipRemovals)
    }
}

/// Plans by reference.
struct Read<'a>(&'a Tables);

/// A handle names nothing: never of a step in the ring.
struct Gone;

impl<'a> Transfer<Slots, Borrowed<'a>> for Read<'a> {
    type Refused = Gone;

    fn path_move(&mut self, plan: &Handle<Move>) -> Result<&'a Move, Gone> {
        self.0.moves.get(*plan).ok_or(Gone)
    }
    fn follow(&mut self, plan: &Handle<Follow>) -> Result<&'a Follow, Gone> {
        self.0.stretches.get(*plan).ok_or(Gone)
    }
    fn tap(&mut self, plan: &Handle<TapPlan>) -> Result<&'a TapPlan, Gone> {
        self.0.taps.get(*plan).ok_or(Gone)
    }
    fn ramp(&mut self, plan: &Handle<Profile>) -> Result<&'a Profile, Gone> {
        self.0.ramps.get(*plan).ok_or(Gone)
    }
    fn chip_removal(&mut self, plan: &Handle<ChipThrow>) -> Result<&'a ChipThrow, Gone> {
        self.0.chip_removals.get(*plan).ok_or(Gone)
    }
}

/// Plans out of the tables.
struct Release<'a>(&'a mut Tables);

impl Transfer<Slots, Released> for Release<'_> {
    type Refused = Infallible;

    fn path_move(&mut self, plan: &Handle<Move>) -> Result<(), Infallible> {
        self.0.moves.release(*plan);
        Ok(())
    }
    fn follow(&mut self, plan: &Handle<Follow>) -> Result<(), Infallible> {
        self.0.stretches.release(*plan);
        Ok(())
    }
    fn tap(&mut self, plan: &Handle<TapPlan>) -> Result<(), Infallible> {
        self.0.taps.release(*plan);
        Ok(())
    }
    fn ramp(&mut self, plan: &Handle<Profile>) -> Result<(), Infallible> {
        self.0.ramps.release(*plan);
        Ok(())
    }
    fn chip_removal(&mut self, plan: &Handle<ChipThrow>) -> Result<(), Infallible> {
        self.0.chip_removals.release(*plan);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
