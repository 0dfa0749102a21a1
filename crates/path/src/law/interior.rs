//! The optimisation inside the jerk-limited law: an interior-point method on a chain.
//!
//! ```text
//!   minimise  Σ wᵢ/√cᵢ      so that  cᵢ ≤ capᵢ,   |g·c| ≤ 1 (acceleration),   |g·c| ≤ v̂/√cᵢ (jerk)
//! ```
//!
//! c are the control values of b = ṡ² (see `smooth`); each g meets three neighbours, so that
//! Newton's matrix is a band of five. Primal-dual: each slack s has a price λ, λ·s is led to zero,
//! at each place in proportion to its part of the time. The acceleration's bounds are straight;
//! v̂/√c is convex in c, so a step that keeps its tangent keeps it too. Boyd and
//! Vandenberghe, *Convex Optimization*, ch. 11; the jerk's bound is not convex as a set, so the
//! optimum that is found may be a local one.
mod bundle;
mod slack;

use crate::banded::Banded;
use alloc::vec::Vec;
pub(super) use bundle::Pair;
use bundle::{Bundle, Contribution, Neighbours};
use slack::{LongestStep, Reach, Residual};

/// Newton steps at most.
const STEPS: usize = 200;

/// How far the time may still be above the optimum when the search ends.
pub(super) const GAP: f64 = 0.002;

/// How far a bound may still be exceeded then, as a share of it.
const MISS: f64 = 1e-4;

/// Where a search begins: so much of the time for λ·s of each unknown; again, where a problem like
/// it was solved, so much for all of them together.
pub(super) const FIRST: f64 = 0.2;
const AGAIN: f64 = 0.03;

/// A search whose unknowns go no further than this, in so many steps one after another, is over,
/// however its prices still change; and so much of a bound may be exceeded where it is as fast as
/// can be: the motion itself is measured, and its bounds are made tighter.
const STUCK: (f64, usize) = (0.01, 4);
const NEARLY: f64 = 0.01;

/// A search that has become slower than it began by such a factor has lost its way.
const SLOWER: f64 = 1e3;

/// An unknown's part of the time counts as at least so much of an even one, and at most as one over
/// it.
const PART: f64 = 1e-3;

/// An unknown falls by no more than this share of it in a step: 1/√c stays near its tangent.
const FALL: f64 = 0.8;

/// What follows from an unknown.
#[derive(Clone, Copy, Debug, Default)]
struct Unknown {
    /// 1/√c, and how it changes with c.
    root: f64,
    slope: f64,
}

impl Unknown {
    fn of(c: f64) -> Self {
        let root = 1.0 / libm::sqrt(if c > 1e-300 { c } else { 1e-300 });
        Self { root, slope: -0.5 * root * root * root }
    }
}

/// Of the equations, for an unknown: what does not depend on μ, and what goes with it; and by how
/// much bounds that fall with it bend.
#[derive(Clone, Copy, Debug, Default)]
struct RightSide {
    at_once: f64,
    by_mu: f64,
    bend: f64,
}

/// The problem and its solution.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chain {
    /// Unknowns; the first and last few are given.
    pub(crate) c: Vec<f64>,
    /// Weights in the time.
    pub(crate) weight: Vec<f64>,
    /// Largest values; infinite where there are none.
    pub(crate) cap: Vec<f64>,
    bundles: Vec<Bundle>,
    /// How many of the first, and of the last, are given.
    pub(crate) given: [usize; 2],
    unknowns: Vec<Unknown>,
    /// Where the step under way began.
    c_before: Vec<f64>,
    before: Vec<Unknown>,
    /// Each unknown's part of the time where the search begins, over an even one: what λ·s of its
    /// bounds is led by.
    part: Vec<f64>,
    /// Those of the problem before.
    known: Vec<Bundle>,
    band: Banded<1, 3>,
    right_side: Vec<RightSide>,
    step: Vec<f64>,
}

impl Chain {
    pub(crate) fn clear(&mut self) {
        self.c.clear();
        self.weight.clear();
        self.cap.clear();
        core::mem::swap(&mut self.bundles, &mut self.known);
        self.bundles.clear();
    }

    /// One more pair of bounds: those of the same unknowns one after another.
    pub(crate) fn push(&mut self, pair: &Pair) {
        if !self.bundles.last_mut().is_some_and(|last| last.take(pair)) {
            let mut bundle = Bundle::new(pair.at);
            bundle.take(pair);
            self.bundles.push(bundle);
        }
    }

    pub(crate) fn free(&self) -> core::ops::Range<usize> {
        self.given[0]..self.c.len() - self.given[1]
    }

    /// Largest amount by which a bound is exceeded, as a share of it.
    pub(crate) fn excess(&mut self) -> f64 {
        self.look();
        let all = Unknowns { c: &self.c, one: &self.unknowns, part: &[] };
        self.bundles.iter().map(|one| one.excess(&all.neighbours(one.at))).fold(-1.0, f64::max)
    }

    /// Find the fastest; how many steps it took, or `None` when nothing within the bounds was
    /// found. `first`: so much of the time for λ·s of each unknown where the search begins; `None`:
    /// a problem of the same shape was solved before, and this one begins where that one ended.
    pub(crate) fn solve(&mut self, first: Option<f64>, close: f64) -> Option<usize> {
        if self.free().is_empty() {
            return (self.excess() < 1e-6).then_some(0);
        }
        self.look();
        let mut time = self.time();
        self.parts(time);
        let slowest = SLOWER * time;
        let count = 2.0 * self.bundles.iter().map(|one| one.pairs as f64).sum::<f64>();
        let is_same = self.known.len() == self.bundles.len();
        let mut mu = if first.is_none() && is_same {
            AGAIN * time / count
        } else {
            first.unwrap_or(FIRST) * time / self.free().len() as f64
        };
        if first.is_none() && is_same {
            self.resume(mu);
        } else {
            self.start(mu);
        }
        let (mut stuck, mut is_fast) = (0, false);
        self.gather::<false>(mu, Reach::all());
        for steps in 1..=STEPS {
            self.aim(mu);
            let reach = self.reach(mu);
            let (gap, miss) = self.advance(mu, reach);
            let before = core::mem::replace(&mut time, self.time());
            is_fast = gap < close * time && (before - time).abs() < close * time;
            if is_fast && miss < MISS * close / GAP {
                return Some(steps);
            }
            if !(gap.is_finite() && time < slowest) {
                return None;
            }
            stuck = if reach.primal < STUCK.0 { stuck + 1 } else { 0 };
            if stuck == STUCK.1 {
                break;
            }
            let least = reach.primal.min(reach.dual);
            let shrink = if least > 0.8 {
                0.1
            } else if least > 0.4 {
                0.3
            } else {
                0.8
            };
            mu = shrink * gap / count;
        }
        let excess = self.excess();
        (excess < 1e-6 || is_fast && excess < NEARLY).then_some(STEPS)
    }

    fn look(&mut self) {
        self.unknowns.clear();
        self.unknowns.extend(self.c.iter().map(|c| Unknown::of(*c)));
    }

    /// The time of all cells; after [`Self::look`].
    fn time(&self) -> f64 {
        self.free().map(|i| self.weight[i] * self.unknowns[i].root).sum()
    }

    /// After [`Self::look`].
    fn parts(&mut self, time: f64) {
        let over = self.free().len() as f64 / time;
        let parts = self.weight.iter().zip(&self.unknowns).map(|(w, one)| w * one.root * over);
        self.part.clear();
        self.part.extend(parts.map(|part| part.clamp(PART, 1.0 / PART)));
    }

    fn start(&mut self, mu: f64) {
        let all = Unknowns { c: &self.c, one: &self.unknowns, part: &self.part };
        self.bundles.iter_mut().for_each(|one| one.start(&all.neighbours(one.at), mu));
    }

    /// With the prices of the problem before.
    fn resume(&mut self, mu: f64) {
        let all = Unknowns { c: &self.c, one: &self.unknowns, part: &self.part };
        for (one, known) in self.bundles.iter_mut().zip(&self.known) {
            one.resume(known, &all.neighbours(one.at), mu);
        }
    }

    /// Newton's matrix, and what draws the unknowns. `GO`: along the step to here first, with all
    /// slacks and prices.
    fn gather<const GO: bool>(&mut self, mu: f64, reach: Reach) -> Residual {
        let n = self.c.len();
        self.band.clear(n);
        self.right_side.clear();
        self.right_side.resize(n, RightSide::default());
        let here = Unknowns { c: &self.c, one: &self.unknowns, part: &self.part };
        let before = Unknowns { c: &self.c_before, one: &self.before, part: &self.part };
        let mut left = Residual::default();
        for one in &mut self.bundles {
            let (at, near) = (one.at, here.neighbours(one.at));
            if GO {
                let from = (&before.neighbours(at), window(&self.step, at));
                one.go(from, &near, (mu, reach), &mut left);
            }
            let Contribution { matrix, right_side } = one.added(&near);
            let [first, second, third] = window_mut(&mut self.band.rows, at);
            first[0][0][0] += matrix[0];
            first[1][0][0] += matrix[1];
            first[2][0][0] += matrix[2];
            second[0][0][0] += matrix[3];
            second[1][0][0] += matrix[4];
            third[0][0][0] += matrix[5];
            for (all, right_side) in window_mut(&mut self.right_side, at).iter_mut().zip(right_side)
            {
                all.at_once += right_side.at_once;
                all.by_mu += right_side.by_mu;
                all.bend += right_side.bend;
            }
        }
        for i in self.free() {
            let (Unknown { root, .. }, weight) = (self.unknowns[i], self.weight[i]);
            let (right_side, y) = (&mut self.right_side[i], root * root);
            right_side.at_once += 0.5 * weight * root * y;
            let bend = (weight - right_side.bend).max(0.1 * weight);
            *self.band.entry(i, 0) += 0.75 * bend * root * y * y;
        }
        for i in (0..self.given[0]).chain(n - self.given[1]..n) {
            self.band.fix(i, 0);
            self.right_side[i] = RightSide::default();
        }
        left
    }

    /// The step towards λ·s = μ.
    fn aim(&mut self, mu: f64) {
        self.band.factor();
        self.step.clear();
        self.step.extend(
            self.right_side.iter().map(|right_side| right_side.at_once + mu * right_side.by_mu),
        );
        self.band.solve_one(self.step.as_chunks_mut::<1>().0);
    }

    /// How far the unknowns with their slacks, and the prices, may go.
    fn reach(&self, mu: f64) -> Reach {
        let all = Unknowns { c: &self.c, one: &self.unknowns, part: &self.part };
        let mut least = LongestStep::all();
        for one in &self.bundles {
            one.limit(&all.neighbours(one.at), window(&self.step, one.at), mu, &mut least);
        }
        let mut reach = least.reach();
        for i in self.free() {
            if self.step[i] * reach.primal < -FALL * self.c[i] {
                reach.primal = -FALL * self.c[i] / self.step[i];
            }
        }
        reach.whole()
    }

    /// Go; the sum of λ·s after it, and the largest miss.
    fn advance(&mut self, mu: f64, reach: Reach) -> (f64, f64) {
        self.c_before.clone_from(&self.c);
        core::mem::swap(&mut self.before, &mut self.unknowns);
        for i in self.free() {
            self.c[i] += reach.primal * self.step[i];
        }
        self.look();
        let left = self.gather::<true>(mu, reach);
        (left.gap(), left.miss())
    }
}

/// All unknowns, and what follows from them.
#[derive(Clone, Copy)]
struct Unknowns<'a> {
    c: &'a [f64],
    one: &'a [Unknown],
    part: &'a [f64],
}

impl Unknowns<'_> {
    fn neighbours(&self, at: usize) -> Neighbours<'_> {
        let part = self.part.get(at + 1).copied().unwrap_or(1.0);
        Neighbours { c: window(self.c, at), middle: self.one[at + 1], part }
    }
}

/// The three from one on.
fn window<T>(of: &[T], at: usize) -> &[T; 3] {
    &of[at..].as_chunks::<3>().0[0]
}

fn window_mut<T>(of: &mut [T], at: usize) -> &mut [T; 3] {
    &mut of[at..].as_chunks_mut::<3>().0[0]
}
