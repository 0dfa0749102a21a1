//! What tests and campaigns of several crates share, and no product contains.

mod relay;
pub mod requests;

pub use relay::Relay;
