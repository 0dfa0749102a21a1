//! How workpieces are judged: one test program, so that it is linked once.
#![allow(clippy::unwrap_used, dead_code, unreachable_pub)] // tests may panic, and what they share is not used by each

mod common;
mod lathe;

mod contact;
mod cut_again;
mod gear;
mod hole;
mod polygon;
mod summary;
mod thread;
mod turned;
mod turned_work;
