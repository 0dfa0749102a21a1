//! The master on emulated devices, in process and in virtual time.
#![allow(clippy::unwrap_used)] // in what tests share
mod cuts;
mod cyclic;
mod losses;
mod machine;
mod orders;
mod start;
mod states;
mod support;
mod traps;
