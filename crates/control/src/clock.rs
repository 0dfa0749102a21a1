//! The one place of the program that reads a clock: to measure ourselves, and to pace a machine simulator in real time. Nothing
//! that is simulated ever sees it.
use std::time::Instant;

/// Now.
#[allow(clippy::disallowed_methods)] // see above
pub fn now() -> Instant {
    Instant::now()
}
