//! Emulated devices, asked datagram by datagram.
#![allow(clippy::unwrap_used)] // in what tests share
mod al;
mod clock;
mod frames;
mod mailbox;
mod memory;
mod modes;
mod support;
