//! What text becomes blocks, and blocks text: one test program, so that it is linked once.
#![allow(clippy::unwrap_used, clippy::format_collect, dead_code)] // tests may panic, and what they share is not used by each

mod common;

mod formatting;
mod language;
mod mistakes;
mod properties;
