//! What the library does: one test program, so that it is linked once.
#![allow(clippy::unwrap_used)] // tests may panic, and what they share is not used by each

mod attacks;
mod commissioned;
mod compensated;
mod doctor;
mod ethercat_drives;
mod feedback_faults;
mod held;
mod inches;
mod library;
mod never_slower;
mod one_workpiece;
mod polygon_phase;
mod probing;
mod process_drives;
mod rounded_feeds;
mod simulator_drives;
mod single_block;
mod spindle_starts;
mod state_kills;
mod tool_life;
