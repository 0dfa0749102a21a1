//! Emulated devices, asked datagram by datagram.
mod al;
mod clock;
mod frames;
mod mailbox;
mod memory;
mod modes;
mod support;
