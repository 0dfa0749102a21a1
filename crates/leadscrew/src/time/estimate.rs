//! How long a long program takes, from a sample of it.
//!
//! ```text
//!   rough time of all C, of the stretches that take Δ or longer K, of the n others that were kept cᵢ
//!   planned time            of these                             k, of those                      tᵢ
//!
//!   T = k + r·(C − K),  r: mean of tᵢ/cᵢ         ± q·(C − K)·√((1 − Σcᵢ/(C − K))·s²/n)
//! ```
//!
//! Stretches were kept every Δ of rough time, so each stands for as much of it ("probability
//! proportional to size"). `s²` is how tᵢ/cᵢ scatter and q Student's quantile for 99 %. Δ is
//! halved, and more stretches are planned, until the error is small enough.
use super::Shares;
use plan::{FeedAndRapid, MachineLimits, Sample, Stretch};
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use units::Time;

/// Programs of fewer stretches are planned as a whole.
const FEWEST: usize = 32;
/// So many stretches are planned at least.
const FIRST: usize = 9;
/// How fewer than these scatter is not known.
const SCATTER: usize = 8;
/// What a stretch that is planned by itself may take more or less than in the whole path, on
/// average, as a share.
const ALONE: f64 = 0.002;
/// Quantile of the normal distribution: 99 % lie within.
const NORMAL: f64 = 2.576;

/// A time that was found out from a sample.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// What the time is made of.
    pub shares: Shares,
    /// How far the total may be from that of the whole plan, as a share of it, in 99 of 100
    /// programs.
    pub within: f64,
    /// Stretches that were planned.
    pub planned: usize,
    /// Of so many.
    pub stretches: usize,
}

/// From a sample, with what else takes time; `None`: it is too short, or too uneven for `within`.
pub fn estimate(
    sample: &Sample,
    other: Shares,
    limits: &MachineLimits,
    within: f64,
) -> Option<Estimate> {
    if sample.stretches < FEWEST {
        return None;
    }
    let on = |step: Time| {
        let all = sample.kept.iter().enumerate();
        all.filter(move |(_, stretch)| stretch.lies_on(step)).map(|(index, _)| index)
    };
    let mut step = sample.step;
    while on(step * 2.0).count() >= FIRST {
        step = step * 2.0;
    }
    let mut times = vec![None; sample.kept.len()];
    loop {
        let (new, kept): (Vec<_>, Vec<_>) =
            (on(step).filter(|at| times[*at].is_none()).collect(), on(step).collect());
        let found = plan(&sample.kept, &new, limits);
        for (at, time) in new.into_iter().zip(found) {
            times[at] = Some(time);
        }
        let planned: Vec<_> =
            kept.into_iter().filter_map(|at| Some((sample.kept[at].rough, times[at]?))).collect();
        let (joined, error) = whole(&planned, step, sample.rough);
        let mut shares = other;
        shares.feed += joined.feed;
        shares.rapid += joined.rapid;
        let off = ALONE + error / shares.total();
        if off <= within {
            let (planned, stretches) = (planned.len(), sample.stretches);
            return Some(Estimate { shares, within: off, planned, stretches });
        }
        if step <= sample.step {
            return None;
        }
        step = step / 2.0;
    }
}

/// The time of everything, and how far its sum may be off: the equations of the module's header.
fn whole(planned: &[(Time, FeedAndRapid)], step: Time, all: Time) -> (FeedAndRapid, Time) {
    let (long, others): (Vec<_>, Vec<_>) =
        planned.iter().copied().partition(|(rough, _)| *rough >= step);
    let mut joined = FeedAndRapid::default();
    let mut rest = all;
    for (rough, time) in long {
        joined.feed += time.feed;
        joined.rapid += time.rapid;
        rest -= rough;
    }
    let n = others.len() as f64;
    if others.is_empty() || rest <= Time::ZERO {
        return (joined, rest.max(Time::ZERO)); // what is left is not known at all
    }
    let mean = |of: fn(&FeedAndRapid) -> Time| {
        others.iter().map(|(rough, time)| of(time) / *rough).sum::<f64>() / n
    };
    let (feed, rapid) = (mean(|time| time.feed), mean(|time| time.rapid));
    joined.feed += rest * feed;
    joined.rapid += rest * rapid;
    let off = |(rough, time): &(Time, FeedAndRapid)| (time.total() / *rough - feed - rapid).powi(2);
    if others.len() < SCATTER {
        return (joined, rest);
    }
    let free = n - 1.0;
    let variance = others.iter().map(off).sum::<f64>() / free;
    let seen: Time = others.iter().fold(Time::ZERO, |sum, (rough, _)| sum + *rough);
    let unseen = (1.0 - seen / rest).max(0.0);
    (joined, rest * (quantile(free) * (unseen * variance / n).sqrt()))
}

/// Student's quantile, from the normal one (Cornish and Fisher).
fn quantile(free: f64) -> f64 {
    let z = NORMAL;
    z + (z.powi(3) + z) / (4.0 * free)
        + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * free.powi(2))
        + (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z)
            / (384.0 * free.powi(3))
}

/// Plan each, on all cores.
fn plan(kept: &[Stretch], batch: &[usize], limits: &MachineLimits) -> Vec<FeedAndRapid> {
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get).min(batch.len());
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(stretch) = batch.get(at).and_then(|index| kept.get(*index)) else {
                return done;
            };
            done.push((at, stretch.plan(limits)));
        }
    };
    let mut times = vec![FeedAndRapid::default(); batch.len()];
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        for thread in threads {
            // a thread that panicked has reported it: the panic goes on here
            let done = thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            for (at, time) in done {
                times[at] = time;
            }
        }
    });
    times
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (free, table) in
            [(8.0, 3.355), (15.0, 2.947), (31.0, 2.744), (63.0, 2.656), (127.0, 2.615)]
        {
            let found = quantile(free);
            assert!((found - table).abs() < 0.004, "{free}: {found}");
        }
    }
}
