//! What a control does that stays on: one test program, so that it is linked once.
#![allow(clippy::unwrap_used)] // tests may panic, and what they share is not used by each

mod absolute_encoders;
mod axis_kinds;
mod broken_tools;
mod drives;
mod loads;
mod notices;
mod proving;
mod real_time;
mod recovery;
mod requests;
mod sequences;
mod state;
mod stated_stock;
mod stop_lane;
mod stop_sequences;
mod stops;
mod workpiece;
