//! The language server: what an editor shows of a program while it is being written.
//!
//! ```text
//!   editor ══ JSON-RPC ══► server ──► Document   text, lines, edits
//!                            │           │
//!                            │           ▼
//!                            │        Analysis   snapshots of the interpretation, every so many blocks
//!                            ▼           │
//!      requests: hover, outline, names, completion, fixes ◄── findings, positions before and after a block
//! ```
//!
//! One thread, no locks: between two messages the server interprets on, a slice at a time. After an
//! edit it goes on from the last snapshot before the edited text. A hover runs from the nearest
//! snapshot to the block under the pointer. This crate knows programs, not machines: what a program
//! meets (tools, offsets, subprogram files) comes from a [`Host`], and so does what is wrong with
//! it there ([`Preflight`]): what an editor shows is what `leadscrew check` says, in the same
//! order.
//!
//! Source: Language Server Protocol 3.17, Microsoft.

mod analysis;
mod called;
mod completion;
mod document;
mod fixes;
mod host;
mod hover;
mod jumps;
mod names;
mod open;
mod outline;
mod requests;
mod roles;
mod server;
mod slice;

pub use host::{Host, Preflight};
pub use server::serve;
