//! The program that is loaded, proved again while nothing is asked for, when offsets, tools or
//! positions have changed: when it is started it begins to move at once.
//!
//! ```text
//!   nothing asked for half a second ─► renewal ─► kept │ another text is to be proved: broken off
//!                                         └─ start of the same ─► waits for it
//! ```
use super::lead::WaitingRequest;
use crate::job::Interruption;
use crate::operation::{ProofMark, Proving};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

/// So long nothing is asked for before.
pub(super) const AFTER: Duration = Duration::from_millis(500);

/// One that is on its way.
pub(super) struct Renewal {
    mark: ProofMark,
    is_stopped: Arc<AtomicBool>,
    /// Requests that need just what is proved.
    waiting: Vec<WaitingRequest>,
}

impl Renewal {
    /// Of this text, and the text that can be broken off.
    pub(super) fn of(proving: Proving) -> (Self, Proving) {
        let (mark, is_stopped) = (proving.mark(), Arc::new(AtomicBool::new(false)));
        let stopped = Arc::clone(&is_stopped);
        let proving = proving.unless(Interruption::by(move || stopped.load(Relaxed)));
        (Self { mark, is_stopped, waiting: Vec::new() }, proving)
    }

    /// Whether it proves what another one would.
    pub(super) fn is_of(&self, proving: &Proving) -> bool {
        !self.is_stopped() && self.mark == proving.mark()
    }

    /// A request that waits for it.
    pub(super) fn wait(&mut self, waiting: WaitingRequest) {
        self.waiting.push(waiting);
    }

    /// So many requests wait for it.
    pub(super) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Something else is to be proved.
    pub(super) fn stop(&self) {
        self.is_stopped.store(true, Relaxed);
    }

    pub(super) fn is_stopped(&self) -> bool {
        self.is_stopped.load(Relaxed)
    }

    /// What waits for it waits no longer: a stop or a reset has come.
    pub(super) fn take_waiting(&mut self) -> Vec<WaitingRequest> {
        std::mem::take(&mut self.waiting)
    }

    /// It is over: what has waited for it.
    pub(super) fn over(self) -> Vec<WaitingRequest> {
        self.waiting
    }
}
