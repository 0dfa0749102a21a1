//! What the tree is held to: one test program, so that it is linked once.
#![allow(clippy::unwrap_used, dead_code, unreachable_pub)] // tests may panic, and what they share is not used by each

mod tree;

mod circles;
mod columns;
mod layout;
mod one_word;
mod tidy;
mod words;
