//! The one place of the program that reads a clock: to measure ourselves, and to pace a machine
//! simulator in real time. Nothing that is simulated ever sees it.
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Now.
#[allow(clippy::disallowed_methods)] // see above
pub fn now() -> Instant {
    Instant::now()
}

/// Milliseconds since 1970, for what people read.
#[allow(clippy::disallowed_methods)] // see above
pub fn unix_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| u64::try_from(since.as_millis()).unwrap_or(u64::MAX))
}
