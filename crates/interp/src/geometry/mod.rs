//! Plane geometry, and the frame between what a program writes and where the axes stand.
//!
//! ```text
//!   frame          offsets and rotation: program's coordinates to machine coordinates, and back
//!   offset_curve   lines and circles moved aside, and where two of them meet
//! ```
pub(crate) mod frame;
pub(crate) mod offset_curve;
