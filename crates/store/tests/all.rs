//! What outlives a run in files: one test program, so that it is linked once.
#![allow(clippy::unwrap_used)] // tests may panic, and what they share is not used by each

mod certificate;
mod key_pages;
mod machine;
mod state;
mod tools;
mod trace;
