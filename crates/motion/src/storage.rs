//! Where the large parts of steps are: beside them.
//!
//! ```text
//!   planner  Step<Boxed>      a box each: the planner may take memory
//!      │ push: Transfer into tables of fixed size; a full table refuses the step
//!      ▼
//!   kernel   Step<Slots>      a handle each: which slot of the table, and the how manieth use of it
//!      │ read: Transfer by reference
//!      ▼
//!            Step<Borrowed>   a reference each: what the kernel executes
//!
//!   bytes ─► Step<Inline>     the plans themselves: what came from another process, on its way to push
//! ```
//!
//! A tap with both strokes of its spindle takes 5 kB, a dwell 8 bytes. A queue of steps that
//! contained their plans would have room for a tap in every place. So a [`Step`] is small whatever
//! it does, and the storage says what stands in it for a plan.
use crate::{ChipThrow, Follow, Move, Profile, SpindleStep, Step, StepKind, TapPlan};
use core::fmt::Debug;

/// A part of a step that is too large to be in it.
pub trait Plan: Copy + Debug + PartialEq + 'static {}

impl Plan for Move {}
impl Plan for Follow {}
impl Plan for TapPlan {}
impl Plan for Profile {}
impl Plan for ChipThrow {}

/// What stands in a step for each of its plans.
pub trait Storage: Debug + PartialEq {
    /// What stands for a plan of this type.
    type Of<T: Plan>: Clone + Debug + PartialEq;
}

/// A storage whose plans can be read without anything else.
pub trait Readable: Storage {
    /// The plan.
    fn plan<T: Plan>(held: &Self::Of<T>) -> &T;
}

/// Plans that are somewhere else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Borrowed<'a>(core::marker::PhantomData<&'a ()>);

impl<'a> Storage for Borrowed<'a> {
    type Of<T: Plan> = &'a T;
}

impl Readable for Borrowed<'_> {
    fn plan<T: Plan>(held: &Self::Of<T>) -> &T {
        held
    }
}

/// Plans within the step: as it comes out of bytes, where no memory may be taken for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inline;

impl Storage for Inline {
    type Of<T: Plan> = T;
}

impl Readable for Inline {
    fn plan<T: Plan>(held: &T) -> &T {
        held
    }
}

/// What takes the plans of a step from one storage into another.
pub trait Transfer<From: Storage, To: Storage> {
    /// Why it cannot.
    type Refused;

    /// A move from rest to rest.
    ///
    /// # Errors
    /// The other storage has no place for it, or this one does not have it.
    fn path_move(&mut self, plan: &From::Of<Move>) -> Result<To::Of<Move>, Self::Refused>;
    /// A stretch of a joined path.
    ///
    /// # Errors
    /// As for a move.
    fn follow(&mut self, plan: &From::Of<Follow>) -> Result<To::Of<Follow>, Self::Refused>;
    /// A tap.
    ///
    /// # Errors
    /// As for a move.
    fn tap(&mut self, plan: &From::Of<TapPlan>) -> Result<To::Of<TapPlan>, Self::Refused>;
    /// A spindle's change of speed.
    ///
    /// # Errors
    /// As for a move.
    fn ramp(&mut self, plan: &From::Of<Profile>) -> Result<To::Of<Profile>, Self::Refused>;
    /// A chip removal.
    ///
    /// # Errors
    /// As for a move.
    fn chip_removal(
        &mut self,
        plan: &From::Of<ChipThrow>,
    ) -> Result<To::Of<ChipThrow>, Self::Refused>;
}

impl<From: Storage> Step<From> {
    /// The same step with its plan in another storage.
    ///
    /// # Errors
    /// What the transfer refuses.
    pub fn transfer<To: Storage, By: Transfer<From, To>>(
        &self,
        by: &mut By,
    ) -> Result<Step<To>, By::Refused> {
        Ok(Step { op: self.op, line: self.line, kind: self.kind.transfer(by)? })
    }
}

impl<From: Storage> StepKind<From> {
    /// The same with its plan in another storage.
    ///
    /// # Errors
    /// What the transfer refuses.
    pub fn transfer<To: Storage, By: Transfer<From, To>>(
        &self,
        by: &mut By,
    ) -> Result<StepKind<To>, By::Refused> {
        Ok(match self {
            Self::Move(plan) => StepKind::Move(by.path_move(plan)?),
            Self::Follow(plan) => StepKind::Follow(by.follow(plan)?),
            Self::Tap(plan) => StepKind::Tap(by.tap(plan)?),
            Self::Spindle { spindle, order } => {
                StepKind::Spindle { spindle: *spindle, order: order.transfer(by)? }
            }
            Self::Dwell(time) => StepKind::Dwell(*time),
            Self::Thread(stretch) => StepKind::Thread(*stretch),
            Self::WayOut(way_out) => StepKind::WayOut(*way_out),
            Self::Engage(gear) => StepKind::Engage(*gear),
            Self::Release { follower } => StepKind::Release { follower: *follower },
            Self::Superpose(order) => StepKind::Superpose(*order),
            Self::AwaitFades => StepKind::AwaitFades,
            Self::Revolve { spindle, turns } => {
                StepKind::Revolve { spindle: *spindle, turns: *turns }
            }
            Self::Consult(what) => StepKind::Consult(*what),
            Self::ChangeTool { tool, by_hand } => {
                StepKind::ChangeTool { tool: *tool, by_hand: *by_hand }
            }
            Self::Coolant { mist, flood } => StepKind::Coolant { mist: *mist, flood: *flood },
            Self::FeedOverride(acts) => StepKind::FeedOverride(*acts),
            Self::SpindleOverride(acts) => StepKind::SpindleOverride(*acts),
            Self::Output(output) => StepKind::Output(*output),
            Self::Input(wait) => StepKind::Input(*wait),
            Self::Inputs(wait) => StepKind::Inputs(*wait),
            Self::Count(count) => StepKind::Count(*count),
            Self::Guard { on, off } => StepKind::Guard { on: *on, off: *off },
            Self::Probe { order, until } => {
                StepKind::Probe { order: by.path_move(order)?, until: *until }
            }
            Self::UserCode(number) => StepKind::UserCode(*number),
            Self::Pause { optional } => StepKind::Pause { optional: *optional },
            Self::End => StepKind::End,
        })
    }
}

impl<From: Storage> SpindleStep<From> {
    fn transfer<To: Storage, By: Transfer<From, To>>(
        &self,
        by: &mut By,
    ) -> Result<SpindleStep<To>, By::Refused> {
        Ok(match self {
            Self::Turn { spin, ramp } => SpindleStep::Turn { spin: *spin, ramp: by.ramp(ramp)? },
            Self::Surface { surface, ramp } => {
                SpindleStep::Surface { surface: *surface, ramp: by.ramp(ramp)? }
            }
            Self::AwaitSpeed => SpindleStep::AwaitSpeed,
            Self::Orient { to, longest } => SpindleStep::Orient { to: *to, longest: *longest },
            Self::Throw(plan) => SpindleStep::Throw(by.chip_removal(plan)?),
        })
    }
}
