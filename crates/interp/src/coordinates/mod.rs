//! Where coordinates lead: how they are meant, which offsets lie under them.
//!
//! ```text
//!   distances    G17 to G19, G7 and G8, G90 and G91, G98 and G99
//!   offsets      G10, G43, G49, G52, G54 … G59.3, G92
//!   tool_table   G10 L1, L10, L11
//!   target       where the axis words of a block lead
//! ```
pub(crate) mod distances;
pub(crate) mod offsets;
pub(crate) mod target;
pub(crate) mod tool_table;
