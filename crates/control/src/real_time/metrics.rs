//! How well the servo thread keeps its time; read by any thread, written by it alone.
use crate::timings::TickTimes;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

/// Counters of a servo thread.
#[derive(Debug, Default)]
pub(crate) struct ServoMetrics {
    periods: AtomicU64,
    late: AtomicU64,
    worst_ns: AtomicU64,
    set_anew: AtomicU64,
    unobserved: AtomicU64,
}

/// How well the servo thread has kept its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct RealTimeFigures {
    /// Servo periods so far.
    pub periods: u64,
    /// Of these, begun later than a whole period after they were due.
    pub late: u64,
    /// The latest, µs after it was due.
    pub worst_late_us: f64,
    /// So late that the clock was set anew.
    pub set_anew: u64,
    /// Periods that no observer has seen, because the observers did not keep up.
    pub unobserved: u64,
    /// Median of the kernel's tick, µs.
    pub tick_median_us: f64,
    /// 99.9 of 100 ticks are shorter, µs.
    pub tick_p999_us: f64,
    /// The longest tick, µs.
    pub tick_worst_us: f64,
}

impl fmt::Display for RealTimeFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { periods, late, worst_late_us, set_anew, unobserved, .. } = self;
        write!(
            f,
            "servo thread: {periods} periods by the clock, {late} begun more than a period late, the latest {worst_late_us:.0} µs; \
             the clock set anew {set_anew} times; {unobserved} periods not observed"
        )
    }
}

impl ServoMetrics {
    pub(super) fn period(&self) {
        self.periods.fetch_add(1, Relaxed);
    }

    pub(super) fn begun(&self, late: Duration, period: Duration, is_set_anew: bool) {
        if late > period {
            self.late.fetch_add(1, Relaxed);
        }
        self.worst_ns.fetch_max(late.as_nanos() as u64, Relaxed);
        self.set_anew.fetch_add(u64::from(is_set_anew), Relaxed);
    }

    pub(super) fn unobserved(&self) {
        self.unobserved.fetch_add(1, Relaxed);
    }

    /// All of them, with those of the ticks.
    pub(crate) fn figures(&self, ticks: &TickTimes) -> RealTimeFigures {
        let us = |time: Duration| time.as_secs_f64() * 1e6;
        RealTimeFigures {
            periods: self.periods.load(Relaxed),
            late: self.late.load(Relaxed),
            worst_late_us: self.worst_ns.load(Relaxed) as f64 / 1e3,
            set_anew: self.set_anew.load(Relaxed),
            unobserved: self.unobserved.load(Relaxed),
            tick_median_us: us(ticks.quantile(0.5)),
            tick_p999_us: us(ticks.quantile(0.999)),
            tick_worst_us: us(ticks.worst()),
        }
    }
}
