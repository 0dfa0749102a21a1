//! What tests and campaigns of several crates share, and no product contains.

mod dice;
mod relay;
pub mod requests;

pub use dice::Dice;
pub use relay::{Relay, Stop};
