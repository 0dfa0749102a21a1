//! The path of up to nine axes, and the time along it.
//!
//! ```text
//!   programmed lines, arcs, splines ─► geometry: one joined curve q(s), in pieces ─► law: s(t), in phases
//! ```
//!
//! The two halves meet in [`motion::Piece`]: what is to be followed, how fast it may be at most,
//! and how it joins the piece before. Everything is in mm (degrees for rotary axes), s, and their
//! quotients.
#![no_std]
extern crate alloc;

mod banded;
pub mod geometry;
pub mod law;

use motion::{AXES, Bounds, Curve, Derivatives, Entry, Instant, Limits, Phase, Piece, Shape};
