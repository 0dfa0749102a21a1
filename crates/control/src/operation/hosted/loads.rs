//! Texts that are being proved for a request: how far each is, and what breaks it off.
//!
//! ```text
//!   load, start, MDI ─► being proved ─► answered
//!                          ├─ reset, stop ──────────────────► refused: broken off
//!                          ├─ a newer load, where it loads ─► refused: broken off
//!                          └─ the client is gone: broken off
//! ```
use crate::job::{Interruption, ReadProgress};
use crate::operation::{LoadingStatus, Request};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

/// Why a text is not proved to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BrokenOff {
    /// By a reset.
    Reset = 1,
    /// By a stop.
    Stop,
    /// By another program that is loaded.
    NewerLoad,
    /// Who asked for it is gone.
    Unwanted,
}

impl BrokenOff {
    /// What broke it off, as a part of a sentence.
    pub(super) const fn by(self) -> &'static str {
        match self {
            Self::Reset => "a reset",
            Self::Stop => "a stop",
            Self::NewerLoad => "a newer load",
            Self::Unwanted => "the end of the connection that asked for it",
        }
    }
}

/// A text that is being proved.
pub(super) struct Load {
    name: String,
    loads: bool,
    broken_off: Arc<AtomicU8>,
    progress: Arc<ReadProgress>,
    wanted: Interruption,
}

/// What the text's answer needs to know of it.
pub(super) type LoadMark = Arc<AtomicU8>;

/// See the module's header.
#[derive(Default)]
pub(super) struct Loads(Vec<Load>);

impl Loads {
    /// A text is to be proved: its mark, and what interrupts it.
    pub(super) fn begin(
        &mut self,
        (request, name): (&Request, &str),
        wanted: Interruption,
    ) -> (LoadMark, Interruption) {
        let loads = matches!(request, Request::Load(_) | Request::LoadAs(..));
        if loads {
            let earlier = self.0.iter().filter(|load| load.loads);
            earlier.for_each(|load| load.break_off(BrokenOff::NewerLoad));
        }
        let (broken_off, progress) = (LoadMark::default(), Arc::<ReadProgress>::default());
        let (mark, unwanted) = (Arc::clone(&broken_off), wanted.clone());
        let came = move || mark.load(Relaxed) != 0 || unwanted.came();
        let interruption = Interruption::by(came).showing(Arc::clone(&progress));
        let mark = Arc::clone(&broken_off);
        self.0.push(Load { name: name.to_owned(), loads, broken_off, progress, wanted });
        (mark, interruption)
    }

    /// Whether there was anything to break off.
    pub(super) fn break_off(&self, why: BrokenOff) -> bool {
        self.0.iter().for_each(|load| load.break_off(why));
        !self.0.is_empty()
    }

    /// A text is proved, or broken off and why.
    pub(super) fn end(&mut self, mark: &LoadMark) -> Option<BrokenOff> {
        let at = self.0.iter().position(|load| Arc::ptr_eq(&load.broken_off, mark))?;
        let load = self.0.remove(at);
        let why = [BrokenOff::Reset, BrokenOff::Stop, BrokenOff::NewerLoad]
            .into_iter()
            .find(|why| *why as u8 == load.broken_off.load(Relaxed));
        why.or_else(|| load.wanted.came().then_some(BrokenOff::Unwanted))
    }

    /// The text that is being proved now.
    pub(super) fn status(&self) -> Option<LoadingStatus> {
        let load = self.0.first()?;
        Some(LoadingStatus { name: load.name.clone(), percent: load.progress.percent() })
    }
}

impl Load {
    /// The first reason stays.
    fn break_off(&self, why: BrokenOff) {
        let _ = self.broken_off.compare_exchange(0, why as u8, Relaxed, Relaxed);
    }
}
