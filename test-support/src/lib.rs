//! What tests and campaigns of several crates share, and no product contains.
//!
//! `size` and `Dice` depend on nothing, so that the tests of every crate can use them; the feature
//! `control` adds what drives a control.

mod dice;
#[cfg(feature = "control")]
pub mod drives;
#[cfg(feature = "control")]
mod relay;
#[cfg(feature = "control")]
pub mod requests;
pub mod size;

pub use dice::Dice;
#[cfg(feature = "control")]
pub use relay::{Relay, Stop};
