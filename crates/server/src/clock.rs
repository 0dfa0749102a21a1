//! The clock by which sessions and tokens end.
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// The system's clock, and how far it has been advanced: a test that waits for the end of a token
/// advances it instead.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    /// Milliseconds ahead of the system's.
    ahead: Arc<AtomicU64>,
}

impl Clock {
    /// Advances this clock and its clones.
    pub fn advance(&self, by: Duration) {
        self.ahead.fetch_add(u64::try_from(by.as_millis()).unwrap_or(u64::MAX), Relaxed);
    }

    pub(crate) fn now(&self) -> Instant {
        control::clock::now() + Duration::from_millis(self.ahead.load(Relaxed))
    }

    /// Milliseconds since 1970.
    pub(crate) fn unix_ms(&self) -> u64 {
        control::clock::unix_ms().saturating_add(self.ahead.load(Relaxed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_is_advanced_is_ahead_for_all_who_have_it() {
        let clock = Clock::default();
        let other = clock.clone();
        let (now, unix_ms) = (other.now(), other.unix_ms());
        clock.advance(Duration::from_hours(1));
        assert!(other.now() - now >= Duration::from_hours(1));
        assert!(other.unix_ms() - unix_ms >= 3_600_000);
    }
}
