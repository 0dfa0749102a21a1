//! The changer of a machine on which a sequence changes tools.
use canon::{Magazine, Sequence, SequenceStage};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The changer that a sequence works.
pub(super) struct Changer {
    pub(super) sequence: Arc<Sequence>,
    pub(super) magazine: Magazine,
    /// The step that was begun last; `None`: the sequence is at rest.
    pub(super) stage: Option<SequenceStage>,
    /// Set when the mark that the kernel waits at is on the disk.
    pub(super) written: Option<Arc<AtomicBool>>,
}
