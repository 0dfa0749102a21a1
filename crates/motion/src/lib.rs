//! What the kernel executes: steps, and what evaluates them, each at bounded cost.
//!
//! ```text
//!   plan ─► Step ─► kernel      q(s) of a path, s(t) of a profile, θ(t) of a spindle, z(θ) of a tap, X Z(θ) of a thread
//! ```
//!
//! A [`Step`] with its plan is complete: position, velocity and acceleration of every axis at every
//! instant follow from it alone. Nothing here allocates, optimises or knows a machine; all has a
//! fixed size.
//!
//! | file | answers |
//! |---|---|
//! | `step` | what there is to do, and in which order |
//! | `storage` | where the plans are that are too large to be in a step |
//! | `curve` | where the axes are along a joined path; what they can do |
//! | `path` | where they are along a move from rest to rest |
//! | `profile` | how far along it, when |
//! | `tap`, `thread` | an axis as a function of a spindle's turns |
//! | `coupled` | gears between spindles, and what is superposed on an axis |
//! | `surface` | a spindle's speed as a function of X |
//! | `way_out` | how a tool that is tied to a spindle comes out of the work |
//! | `online` | where an axis is whose target may change at any moment |
//! | `signal` | inputs and outputs |
#![no_std]
#[cfg(test)]
extern crate std;

mod coupled;
mod curve;
mod online;
mod path;
mod profile;
#[cfg(feature = "serde")]
mod profile_serde;
mod signal;
mod step;
mod storage;
mod surface;
mod tap;
mod thread;
mod way_out;

pub use coupled::{GearStep, Superpose, Superposed, TableId};
pub use curve::{
    AXES, Arc, Bezier, Bounds, Curve, Derivatives, Entry, Limits, Line, Piece, Point, Polynomial,
    Shape, measure,
};
pub use online::{Goal, OnlineLimits, OnlineState};
pub use path::{Motion, Path, coordinate, radius};
pub use profile::{Instant, MAX_PHASES, Phase, Profile};
pub use signal::{Await, EdgeCount, InputWait, InputsWait, Output, ProbeEnd, Signal};
pub use step::{
    ChipThrow, Follow, HandedBack, Move, PHASES, Pace, Programmed, SEQUENCE_MARKS, STEP_BYTES,
    SpindleStep, Step, StepKind, UnderWay,
};
pub use storage::{Borrowed, Inline, Plan, Readable, Storage, Transfer};
pub use surface::SurfaceSpeed;
pub use tap::{Limiting, TapLimiting, TapPlan};
pub use thread::{Corner, OnThread, THREADING_AXES, ThreadStretch, Vector};
pub use way_out::{Pass, TiedCut, WayOut};
