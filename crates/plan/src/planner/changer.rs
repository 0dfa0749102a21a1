//! A changer that a sequence works, as the planner has it.
use alloc::sync::Arc;
use alloc::vec::Vec;
use canon::{Magazine, Resume, Sequence, SequenceStage};

/// A changer that a sequence works.
#[derive(Clone, Debug)]
pub struct Changer {
    /// Its sequence.
    pub sequence: Arc<Sequence>,
    /// Where the tools are.
    pub magazine: Magazine,
    /// How the sequence that was left half way goes on: at the next tool change.
    pub resume: Option<Resume>,
}

/// What is recorded when the kernel has come to a mark.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceMark {
    /// Number of the consultation.
    pub number: u16,
    /// The step that begins; `None`: the sequence is over.
    pub stage: Option<SequenceStage>,
    /// Where the tools are then.
    pub magazine: Magazine,
}

/// A changer as the planner has it.
#[derive(Clone, Debug)]
pub(super) struct Changing {
    pub(super) changer: Changer,
    pub(super) marks: Vec<SequenceMark>,
    pub(super) next: u16,
    /// The kernel knows the tool in the spindle.
    pub(super) tool_said: bool,
}
