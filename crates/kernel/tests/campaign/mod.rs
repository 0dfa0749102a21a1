//! The campaign of stops: whatever ends a tap, wherever it comes, the tap leaves along its own
//! helix.
//!
//! ```text
//!   one run into the tap ──┬── t₁: clone, strike, run down, mend, recover, measure
//!                          ├── t₂: clone, …
//!                          └── …              the machine, its control and the judge are copied at each instant
//! ```
//!
//! Measured by the machine's truth: the distance of the axis from the coupling's line while the
//! recovery takes the tap out through the work, whether the tap broke, and the class of what was
//! cut, at the stop and after the recovery.
#![allow(clippy::unwrap_used)] // a test may panic
mod bench;
mod draw;
mod fate;
mod work;

pub use bench::{Bench, Stop};
pub use draw::{Dice, name, random, sweep, whole};
pub use fate::{Tally, sum};
pub use work::{M8, Work, unload};

/// A tap may stand this far from its helix on the way out, µm.
pub const HELIX_UM: f64 = 20.0;
/// And this far while it is stopped with the drives alive.
pub const COUPLED_UM: f64 = 10.0;
