//! The master on emulated devices, in process and in virtual time.
mod cuts;
mod cyclic;
mod losses;
mod orders;
mod start;
mod states;
mod support;
mod traps;
