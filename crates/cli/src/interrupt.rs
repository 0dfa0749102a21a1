//! Ctrl-C while report files are being written: the run stops, and its half-written folder is
//! removed.
//!
//! A process that is simply ended leaves the hidden folder in which its report files were in the
//! making ([`store::output`]). Only a run that has one watches for the signal; anything else ends
//! at once.
use control::Refused;
use std::sync::atomic::{AtomicBool, Ordering};

static CAME: AtomicBool = AtomicBool::new(false);

/// From now on the signal is only noted.
pub(crate) fn watch() -> Result<(), Refused> {
    ctrlc::set_handler(|| CAME.store(true, Ordering::Relaxed))
        .map_err(|e| Refused::because(format!("cannot watch for Ctrl-C: {e}")))
}

/// Set once it came.
pub(crate) fn flag() -> &'static AtomicBool {
    &CAME
}

/// Whether it came.
pub(crate) fn came() -> bool {
    CAME.load(Ordering::Relaxed)
}

/// An error if it came.
pub(crate) fn refuse() -> Result<(), Refused> {
    if came() { Err(Refused::because("interrupted: nothing was written")) } else { Ok(()) }
}
