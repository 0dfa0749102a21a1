//! How long a long program takes, from a sample of it.
//!
//! ```text
//!   rough time of all C, of the stretches that take Δ or longer K, of the n others that were kept cᵢ
//!   planned time            of these                             k, of those                      tᵢ
//!
//!   T = k + r·(C − K),  r: of tᵢ/cᵢ, by [`regression`]         ± C − K times what r may be off
//! ```
//!
//! Stretches were kept every Δ of rough time, so each stands for as much of it ("probability
//! proportional to size"). Δ is halved, and more stretches are planned, until the error is small
//! enough.
mod regression;

use super::Shares;
use plan::{FeedAndRapid, MachineLimits, Sample, Stretch};
use regression::{Observed, Population};
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use units::Time;

/// Programs of fewer stretches are planned as a whole.
const FEWEST: usize = 32;
/// So many stretches are planned at least.
const FIRST: usize = 9;
/// What a stretch that is planned by itself may take more or less than in the whole path, on
/// average, as a share.
const ALONE: f64 = 0.002;

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
    if step > sample.step && on(step * 1.5).count() >= FIRST {
        step = step * 1.5;
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
            kept.into_iter().filter_map(|at| Some((&sample.kept[at], times[at]?))).collect();
        let (joined, error) = whole(&planned, step, sample);
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
        // what was kept lies on multiples of its step
        step = if step >= sample.step * 4.0 { step / 2.0 } else { sample.step };
    }
}

/// The time of everything, and how far its sum may be off: the equations of the module's header.
fn whole(
    planned: &[(&Stretch, FeedAndRapid)],
    step: Time,
    sample: &Sample,
) -> (FeedAndRapid, Time) {
    let mut joined = FeedAndRapid::default();
    let mut rest = sample.rough;
    let mut observed = Vec::new();
    for (stretch, time) in planned {
        if stretch.rough >= step {
            joined.feed += time.feed;
            joined.rapid += time.rapid;
            rest -= stretch.rough;
        } else {
            let [feed, rapid] = [time.feed, time.rapid].map(|time| time / stretch.rough);
            observed.push(Observed { moves: moves(stretch), rough: stretch.rough, feed, rapid });
        }
    }
    if observed.is_empty() || rest <= Time::ZERO {
        return (joined, rest.max(Time::ZERO)); // what is left is not known at all
    }
    let others = sample.kept.iter().filter(|stretch| stretch.rough < step);
    let each = others.map(|stretch| (moves(stretch), stretch.rough.max(sample.step)));
    let is_whole = sample.kept.len() == sample.stretches;
    let found = regression::find(&observed, &Population { each: each.collect(), rest, is_whole });
    joined.feed += rest * found.feed;
    joined.rapid += rest * found.rapid;
    (joined, rest * found.off)
}

/// Moves a second of rough time.
fn moves(stretch: &Stretch) -> f64 {
    stretch.moves as f64 / stretch.rough.value()
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
