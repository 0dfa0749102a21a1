//! How fast the simulation is, for `--timings`: measured only when asked for, shown as medians.
use crate::clock::now;
use std::time::{Duration, Instant};
use units::Time;

/// Bins of the tick's histogram: 10 ns each, the last one for all that is longer.
const BINS: usize = 2000;
const BIN_NS: usize = 10;

/// How long ticks take, as a histogram.
pub struct TickTimes {
    ticks: Vec<u32>,
    worst: Duration,
}

impl TickTimes {
    /// Ready; `asked`: time each tick, which costs some time itself.
    pub fn new(asked: bool) -> Self {
        Self { ticks: vec![0; if asked { BINS } else { 0 }], worst: Duration::ZERO }
    }

    /// Time a tick.
    pub(super) fn time<T>(&mut self, tick: impl FnOnce() -> T) -> T {
        if self.ticks.is_empty() {
            return tick();
        }
        let began = now();
        let answer = tick();
        let took = now() - began;
        self.worst = self.worst.max(took);
        let bin = (took.as_nanos() as usize / BIN_NS).min(BINS - 1);
        self.ticks[bin] += 1;
        answer
    }

    /// Upper end of the bin below which this share of the ticks lies, ns.
    fn quantile(&self, share: f64) -> usize {
        let total: u64 = self.ticks.iter().map(|n| u64::from(*n)).sum();
        let mut rest = (total as f64 * share) as u64;
        for (bin, &count) in self.ticks.iter().enumerate() {
            if u64::from(count) > rest {
                return (bin + 1) * BIN_NS;
            }
            rest -= u64::from(count);
        }
        BINS * BIN_NS
    }
}

/// Measures a run.
pub struct Timings {
    asked: bool,
    began: Option<Instant>,
    took: Duration,
    periods: u64,
    simulated: Time,
    /// What the judge took, in all and for the longest step: there a feature is judged from all that was recorded of it.
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
        let median = ticks.quantile(0.5);
        let late = ticks.quantile(0.999);
        format!(
            "{} servo periods in {:.2} s: {:.0} periods/s, {:.0} times real time\n\
             kernel tick: median {median} ns, p99.9 {late} ns, worst {:.1} µs (the clock's own cost included)\n\
             judge: {:.3} s of it; the longest step, a polygon's envelope or another feature's grade: {:.1} ms",
            self.periods,
            self.took.as_secs_f64(),
            rate,
            self.ratio(),
            ticks.worst.as_secs_f64() * 1e6,
            self.judge.as_secs_f64(),
            self.longest.as_secs_f64() * 1e3,
        )
    }
}
