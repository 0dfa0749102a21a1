//! How the simulated machine moves: one test program, so that it is linked once.
#![allow(clippy::unwrap_used, dead_code, unreachable_pub)] // tests may panic, and what they share is not used by each

mod fixtures;

mod machine;
mod run_down;
mod tapping;
