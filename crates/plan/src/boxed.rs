//! The planner's steps: each plan in a box of its own.
use alloc::boxed::Box;
use motion::{Plan, Readable, Storage};

/// A step as the planner makes it.
pub type Step = motion::Step<Boxed>;
/// What it does.
pub type StepKind = motion::StepKind<Boxed>;
/// What a spindle does in it.
pub type SpindleStep = motion::SpindleStep<Boxed>;

const _: () = assert!(size_of::<Step>() <= motion::STEP_BYTES);

/// Plans in boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boxed;

impl Storage for Boxed {
    type Of<T: Plan> = Box<T>;
}

impl Readable for Boxed {
    fn plan<T: Plan>(held: &Box<T>) -> &T {
        held
    }
}
