//! The path of up to nine axes, and the time along it.
//!
//! ```text
//!   programmed lines, arcs, splines ─► geometry: one joined curve q(s), in pieces ─► law: s(t), in phases
//! ```
//!
//! The two halves meet in [`Piece`]: what is to be followed, how fast it may be at most, and how it joins the piece
//! before. Everything is in mm (degrees for rotary axes), s, and their quotients.
#![no_std]
extern crate alloc;

pub mod geometry;
pub mod law;

pub use geometry::{AXES, Bounds, Curve, Derivatives, Entry, Limits, Piece, Shape};
pub use law::Phase;
