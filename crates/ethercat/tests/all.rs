//! The master on emulated devices, in process and in virtual time.
mod start;
mod support;
