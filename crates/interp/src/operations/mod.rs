//! A program as a stream of operations.
//!
//! ```text
//!   ops         interpreter and resolver in step: one operation after the other, findings
//!   calls       each call, and who makes operations of it
//!   orders      calls that move no axis, resolved
//!   pieces      programs that are too long to be held
//!   live        a program that asks the machine
//!   next_text   what is left in force for the text that follows
//!   lint        what is legal but hurts, read from the text alone
//! ```
pub(crate) mod calls;
pub(crate) mod lint;
pub(crate) mod live;
pub(crate) mod next_text;
pub(crate) mod ops;
pub(crate) mod orders;
pub(crate) mod pieces;
