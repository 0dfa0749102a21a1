//! What executing blocks changes, part by part.
//!
//! ```text
//!   executor   holds the parts together: modes, parameters, words, tools, settings
//!   tools      the tools that a program may call, and what the control believes about them
//! ```
pub(crate) mod executor;
pub(crate) mod tools;
