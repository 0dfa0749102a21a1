//! From operations to motion: paths with time along them, spindle profiles, and the refusal of what a
//! machine cannot do, before it moves.
//!
//! ```text
//!   canon::Op ─► Planner (limits of the machine) ─► Step ─► kernel (evaluates, bounded cost)
//! ```
//!
//! A [`Step`] is plain data, `Copy`, and complete: whoever has it can say where every axis shall be at
//! every instant of it, with velocity and acceleration, without asking anybody.
#![no_std]
extern crate alloc;

mod path;
mod profile;
mod ramp;
mod step;

pub use path::{Motion, Path};
pub use profile::{Instant, MAX_PIECES, Piece, Profile};
pub use step::{Limiting, Move, SpindleStep, Step, StepKind, TapLimiting, TapPlan};
