//! Supervision of a tap by the torque that its spindle's drive measures.
//!
//! ```text
//!    cutting torque      ╭──╮   upper bound ─ ─ ─ ─ ─    above it: a retract along the thread
//!         = measured    ╱    ╲_____________________
//!         − J·α        ╱  ░░░░ band of good holes ░    in, over depth
//!         − friction  ╱  ╱
//!                    └──┴──────────────────────────► depth
//! ```
//!
//! [`own`] takes the spindle's own torque out, [`depth`] has the torque over depth of one stroke,
//! [`detector`] finds a change of it period by period, [`band`] is what good holes have been like,
//! [`diagnosis`] says what a hole was.
pub mod band;
pub mod depth;
pub mod detector;
pub mod diagnosis;
pub mod own;
