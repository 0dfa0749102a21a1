//! What forms become functions of the angle: one test program, so that it is linked once.
#![allow(clippy::unwrap_used, dead_code)] // tests may panic, and what they share is not used by each

mod fine;

mod polygon;
mod together;
