//! From programmed lines, arcs and splines to one joined curve, in pieces: what can be cut at
//! corners, and what can be fitted.

mod bezier;
mod corner;
mod fastest;
mod fillet;
mod fit;
mod gathered;
mod join;
mod joint;
mod knots;
mod load;
mod quintic_blend;
mod sample;
mod spline;
mod tube;

pub use bezier::{cubic, quintic};
pub use join::Joiner;
pub use joint::Segment;
