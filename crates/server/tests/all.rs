//! What clients of the server see: one test program, so that it is linked once.
#![allow(
    clippy::disallowed_methods,
    clippy::needless_pass_by_value,
    clippy::unwrap_used,
    dead_code,
    unreachable_pub
)] // tests may panic, and what they share is not used by each

mod common;

mod api;
mod connections;
mod documented;
mod hostile;
mod intrusion;
mod language;
mod metrics;
mod mqtt;
mod mtconnect;
mod real_time;
mod recovery;
mod rights;
mod rotary;
mod runs;
mod tls;
mod types;
