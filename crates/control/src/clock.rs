//! The one place of the program that reads a clock: to measure ourselves, and to pace a machine
//! simulator in real time. Nothing that is simulated ever sees it.
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

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

/// A servo thread that is further behind than this gives up the rest: a debugger, a computer that
/// has slept.
const MOST_BEHIND: Duration = Duration::from_millis(100);

/// Periods by the clock.
pub struct PeriodClock {
    period: Duration,
    due: Instant,
}

/// How a period has begun.
pub struct Begun {
    /// Lateness.
    pub late: Duration,
    /// It was so late that the clock was set anew.
    pub is_set_anew: bool,
}

impl PeriodClock {
    /// A clock whose first period is due now.
    pub fn new(period: Duration) -> Self {
        Self { period, due: now() }
    }

    /// Waits for the next one.
    pub fn wait(&mut self) -> Begun {
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
