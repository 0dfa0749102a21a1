//! How paths are joined and timed: one test program, so that it is linked once.
#![allow(clippy::unwrap_used, dead_code)] // tests may panic, and what they share is not used by each

mod setpoints;

mod circles;
mod joining;
mod law;
