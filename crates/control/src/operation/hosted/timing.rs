//! The time of a long program, planned in a thread of its own until another program takes its
//! place.
//!
//! ```text
//!   fit, and its time is not known ─► thread ─► told │ another one, or the end: broken off
//! ```
use crate::job::{Interruption, Operations};
use crate::operation::{Control, Timed};
use crate::real_time::run_last;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::Builder;

/// A program whose time is being planned, or was; dropped, it is broken off.
pub(super) struct UnderTiming {
    operations: Arc<Operations>,
    is_stopped: Arc<AtomicBool>,
}

impl Drop for UnderTiming {
    fn drop(&mut self) {
        self.is_stopped.store(true, Relaxed);
    }
}

/// Begin with a program that is to be timed, and break off one that is not any more. What comes of
/// it is told in its thread.
pub(super) fn keep(
    under: &mut Option<UnderTiming>,
    control: &Control,
    tell: impl FnOnce(Timed) + Send + 'static,
) {
    let is_under_way = match (control.untimed(), &*under) {
        (None, None) => true,
        (Some(wanted), Some(under)) => Arc::ptr_eq(&under.operations, wanted),
        _ => false,
    };
    if !is_under_way {
        *under = begin(control, tell);
    }
}

fn begin(control: &Control, tell: impl FnOnce(Timed) + Send + 'static) -> Option<UnderTiming> {
    let operations = Arc::clone(control.untimed()?);
    let is_stopped = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&is_stopped);
    let timing = control.timing()?.unless(Interruption::by(move || stopped.load(Relaxed)));
    let thread = Builder::new().name("timing".into());
    // without a thread the time stays unknown; the program is executed all the same
    let _ = thread.spawn(move || {
        run_last();
        tell(timing.plan());
    });
    Some(UnderTiming { operations, is_stopped })
}
