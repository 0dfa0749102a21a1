//! From the form of a part to functions of the master's angle.
//!
//! A drawing says *hexagon, 17 across flats* or *this lift over that angle*; a control obeys z =
//! g(θ). Between the two lies geometry of the tool and, where a machine is too slow for the exact
//! function, the choice of the best one that it can follow. That is what this crate computes,
//! before anything moves:
//!
//! ```text
//!   form, tool ──► what the tool's edge must do ──► g(θ), exact
//!   limits of the axes ─────────────────────────►  g(θ), the best that they can follow
//! ```
//!
//! It knows no program text, no control and no files.
pub mod cam;
pub mod polygon;
