//! How fast the simulation is, for `--timings`: measured only when asked for, shown as medians.
use crate::clock::now;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};
use units::Time;

/// Bins of the tick's histogram: 10 ns each, the last one for all that is longer.
const BINS: usize = 20_000;
const BIN_NS: usize = 10;

/// How long ticks take, as a histogram that any thread may look at while one counts.
#[derive(Clone, Debug)]
pub struct TickTimes(Arc<Histogram>);

#[derive(Debug)]
struct Histogram {
    ticks: Vec<AtomicU32>,
    worst_ns: AtomicU64,
}

impl TickTimes {
    /// Ready; `asked`: time each tick, which costs some time itself.
    pub fn new(asked: bool) -> Self {
        let bins = if asked { BINS } else { 0 };
        let ticks = (0..bins).map(|_| AtomicU32::new(0)).collect();
        Self(Arc::new(Histogram { ticks, worst_ns: AtomicU64::new(0) }))
    }

    /// Time a tick.
    pub(super) fn time<T>(&self, tick: impl FnOnce() -> T) -> T {
        if self.0.ticks.is_empty() {
            return tick();
        }
        let began = now();
        let answer = tick();
        let took = (now() - began).as_nanos() as u64;
        self.0.worst_ns.fetch_max(took, Relaxed);
        let bin = (took as usize / BIN_NS).min(BINS - 1);
        self.0.ticks[bin].fetch_add(1, Relaxed);
        answer
    }

    /// Upper end of the bin below which this share of the ticks lies; the last bin has no end but
    /// the longest tick.
    pub fn quantile(&self, share: f64) -> Duration {
        let count = |bin: &AtomicU32| u64::from(bin.load(Relaxed));
        let total: u64 = self.0.ticks.iter().map(count).sum();
        let mut rest = (total as f64 * share) as u64;
        for (bin, ticks) in self.0.ticks.iter().enumerate().take(BINS - 1) {
            let ticks = count(ticks);
            if ticks > rest {
                return Duration::from_nanos(((bin + 1) * BIN_NS) as u64);
            }
            rest -= ticks;
        }
        self.worst()
    }

    /// The longest one.
    pub fn worst(&self) -> Duration {
        Duration::from_nanos(self.0.worst_ns.load(Relaxed))
    }
}

/// Measures a run.
pub struct Timings {
    asked: bool,
    began: Option<Instant>,
    took: Duration,
    periods: u64,
    simulated: Time,
    /// What the judge took, in all and for the longest step: there a feature is judged from all
    /// that was recorded of it.
    judge: Duration,
    longest: Duration,
}

impl Timings {
    /// Ready; `asked`: also time the judge.
    pub fn new(asked: bool) -> Self {
        Self {
            asked,
            began: None,
            took: Duration::ZERO,
            periods: 0,
            simulated: Time::ZERO,
            judge: Duration::ZERO,
            longest: Duration::ZERO,
        }
    }

    /// The run begins.
    pub fn start(&mut self) {
        self.began = Some(now());
    }

    /// The run has ended.
    pub fn stop(&mut self, periods: u64, simulated: Time) {
        self.took = self.began.map_or(Duration::ZERO, |began| now() - began);
        (self.periods, self.simulated) = (periods, simulated);
    }

    /// A step of the judge.
    pub fn judging<T>(&mut self, step: impl FnOnce() -> T) -> T {
        let began = self.asked.then(now);
        let found = step();
        if let Some(began) = began {
            let took = now() - began;
            self.judge += took;
            self.longest = self.longest.max(took);
        }
        found
    }

    /// Simulated time over time.
    pub fn ratio(&self) -> f64 {
        self.simulated.value() / self.took.as_secs_f64().max(1e-9)
    }

    /// For people.
    pub fn text(&self, ticks: &TickTimes) -> String {
        let rate = self.periods as f64 / self.took.as_secs_f64().max(1e-9);
        let median = ticks.quantile(0.5).as_nanos();
        let late = ticks.quantile(0.999).as_nanos();
        format!(
            "{} servo periods in {:.2} s: {:.0} periods/s, {:.0} times real time\n\
             kernel tick: median {median} ns, p99.9 {late} ns, worst {:.1} µs (the clock's own cost included)\n\
             judge: {:.3} s of it; the longest step, a polygon's envelope or another feature's grade: {:.1} ms",
            self.periods,
            self.took.as_secs_f64(),
            rate,
            self.ratio(),
            ticks.worst().as_secs_f64() * 1e6,
            self.judge.as_secs_f64(),
            self.longest.as_secs_f64() * 1e3,
        )
    }
}
