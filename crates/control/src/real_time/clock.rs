//! When the next servo period is due.
use crate::clock::now;
use std::time::{Duration, Instant};

/// A servo thread that is further behind than this gives up the rest: a debugger, a computer that
/// has slept.
const MOST_BEHIND: Duration = Duration::from_millis(100);

/// Periods by the clock.
pub(super) struct PeriodClock {
    period: Duration,
    due: Instant,
}

/// How a period has begun.
pub(super) struct Begun {
    /// So much after it was due.
    pub(super) late: Duration,
    /// It was so late that the clock was set anew.
    pub(super) is_set_anew: bool,
}

impl PeriodClock {
    /// The first one is due now.
    pub(super) fn new(period: Duration) -> Self {
        Self { period, due: now() }
    }

    /// Wait for the next one.
    pub(super) fn wait(&mut self) -> Begun {
        self.due += self.period;
        let left = self.due.saturating_duration_since(now());
        if !left.is_zero() {
            std::thread::sleep(left);
        }
        let late = now().saturating_duration_since(self.due);
        let is_set_anew = late > MOST_BEHIND;
        if is_set_anew {
            self.due += late;
        }
        Begun { late, is_set_anew }
    }
}
