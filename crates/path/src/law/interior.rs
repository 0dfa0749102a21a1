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
use crate::banded::Banded;
use alloc::vec::Vec;

/// Newton steps at most.
const STEPS: usize = 200;

/// Part of the way to the nearest bound that a step may go.
const SHARE: f64 = 0.95;

/// Largest quotient between λ·s of a bound and what it is led to.
const KEEP: f64 = 20.0;

/// How far the time may still be above the optimum when the search ends.
const GAP: f64 = 0.002;

/// How far a bound may still be exceeded then, as a share of it.
const MISS: f64 = 1e-4;

/// Where a search begins: so much of the time for λ·s of each unknown; again, where a problem like
/// it was solved, so much for all of them together.
pub(super) const FIRST: f64 = 0.2;
const AGAIN: f64 = 0.03;

/// A search that goes no further than this, in so many steps one after another, is over; and so
/// much of a bound may be exceeded where it is as fast as can be: the motion itself is measured,
/// and its bounds are made tighter.
const STUCK: (f64, usize) = (0.01, 6);
const NEARLY: f64 = 0.01;

/// A search that has become slower than it began by such a factor has lost its way.
const SLOWER: f64 = 1e3;

/// An unknown's part of the time counts as at least so much of an even one, and at most as one over
/// it.
const PART: f64 = 1e-3;

/// From such a share of its bound on a slack is free, and begins again as what it is.
const FREE: f64 = 0.1;

/// A slack and its price.
#[derive(Clone, Copy, Debug, Default)]
struct Slack {
    s: f64,
    price: f64,
    /// 1/s.
    over: f64,
    /// How it changes with the step under way.
    ds: f64,
}

impl Slack {
    fn new(s: f64, price: f64) -> Self {
        Self { s, price, over: 1.0 / s, ds: 0.0 }
    }

    /// Of what there `is` of a bound `r`, at the price that it had in a problem like it.
    fn again(is: f64, r: f64, price: f64, mu: f64) -> Self {
        let s = if is > FREE * r { is } else { is.max(mu / price).min(FREE * r) };
        Self::new(s, price.max(mu / s).min(KEEP * mu / s))
    }

    /// What pulls the unknowns, where there `is` room.
    fn pull(&self, mu: f64, is: f64) -> f64 {
        (mu - self.price * (is - self.s)) * self.over
    }

    /// Change of the price.
    fn dearer(&self, mu: f64) -> f64 {
        (mu - self.price * self.ds) * self.over - self.price
    }

    /// A step by `ds` may go only so far.
    fn limit(&mut self, mu: f64, ds: f64, (primal, dual): (&mut f64, &mut f64)) {
        self.ds = ds;
        if ds * *primal < -SHARE * self.s {
            *primal = -SHARE * self.s / ds;
        }
        let dl = self.dearer(mu);
        if dl * *dual < -SHARE * self.price {
            *dual = -SHARE * self.price / dl;
        }
    }

    /// Go; there `is` so much room now.
    fn go(&mut self, mu: f64, (primal, dual): (f64, f64), is: f64) {
        self.price += dual * self.dearer(mu);
        // the bound may have moved away further than its tangent: what is there may be used
        self.s = more(self.s + primal * self.ds, is);
        self.over = 1.0 / self.s;
        // prices that lost touch with their slacks would block the way
        let even = mu * self.over;
        self.price = less(more(self.price, even * (1.0 / KEEP)), KEEP * even);
    }
}

/// The smaller one; of numbers alone, which is faster than what knows of others.
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger one.
fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Two bounds around one sum: −r ≤ g·c ≤ r.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// First of the three unknowns.
    pub(crate) at: usize,
    pub(crate) g: [f64; 3],
    /// 0: r = 1; else r = scale/√c of the middle unknown.
    pub(crate) scale: f64,
    /// r − g·c and r + g·c.
    slack: [Slack; 2],
}

impl Pair {
    pub(crate) fn new(at: usize, g: [f64; 3], scale: f64) -> Self {
        Self { at, g, scale, slack: [Slack::default(); 2] }
    }

    fn sum(&self, c: &[f64]) -> f64 {
        let [x, y, z] = [c[self.at], c[self.at + 1], c[self.at + 2]];
        self.g[0] * x + self.g[1] * y + self.g[2] * z
    }

    /// r.
    fn bound(&self, root: &[f64]) -> f64 {
        if self.scale == 0.0 { 1.0 } else { self.scale * root[self.at + 1] }
    }

    /// How r changes with the middle unknown.
    fn slope(&self, root: &[f64]) -> f64 {
        let root = root[self.at + 1];
        -0.5 * self.scale * root * root * root
    }

    /// Both sides' room.
    fn room(&self, c: &[f64], root: &[f64]) -> [f64; 2] {
        let (r, sum) = (self.bound(root), self.sum(c));
        [r - sum, r + sum]
    }
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
    pub(crate) pairs: Vec<Pair>,
    /// How many of the first, and of the last, are given.
    pub(crate) given: [usize; 2],
    /// 1/√c.
    root: Vec<f64>,
    /// Each unknown's part of the time where the search begins, over an even one: what λ·s of its
    /// bounds is led by.
    part: Vec<f64>,
    /// 1 − c/cap.
    under: Vec<Slack>,
    /// The pairs of the problem before.
    known: Vec<Pair>,
    band: Banded<1, 3>,
    step: Vec<f64>,
}

impl Chain {
    pub(crate) fn clear(&mut self) {
        self.c.clear();
        self.weight.clear();
        self.cap.clear();
        core::mem::swap(&mut self.pairs, &mut self.known);
        self.pairs.clear();
    }

    fn free(&self) -> core::ops::Range<usize> {
        self.given[0]..self.c.len() - self.given[1]
    }

    /// Largest amount by which a bound is exceeded, as a share of it.
    pub(crate) fn excess(&self) -> f64 {
        let mut most = -1.0_f64;
        for i in self.free() {
            most = most.max(self.c[i] / self.cap[i] - 1.0);
        }
        for p in &self.pairs {
            let r = if p.scale == 0.0 { 1.0 } else { p.scale / libm::sqrt(self.c[p.at + 1]) };
            most = most.max(p.sum(&self.c).abs() / r - 1.0);
        }
        most
    }

    /// Find the fastest; how many steps it took, or `None` when nothing within the bounds was
    /// found. `first`: so much of the time for λ·s of each unknown where the search begins; `None`:
    /// a problem of the same shape was solved before, and this one begins where that one ended.
    pub(crate) fn solve(&mut self, first: Option<f64>) -> Option<usize> {
        if self.free().is_empty() {
            return (self.excess() < 1e-6).then_some(0);
        }
        self.roots();
        let mut time = self.time();
        self.parts(time);
        let slowest = SLOWER * time;
        let capped = self.free().filter(|i| self.cap[*i].is_finite()).count();
        let count = (2 * self.pairs.len() + capped) as f64;
        let is_same = self.known.len() == self.pairs.len() && self.under.len() == self.c.len();
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
        for steps in 1..=STEPS {
            self.assemble();
            self.band.factor();
            self.aim(mu);
            let (primal, dual) = self.reach(mu);
            let (gap, miss) = self.advance(mu, (primal, dual));
            let before = core::mem::replace(&mut time, self.time());
            is_fast = gap < GAP * time && (before - time).abs() < GAP * time;
            if is_fast && miss < MISS {
                return Some(steps);
            }
            if !(gap.is_finite() && time < slowest) {
                return None;
            }
            stuck = if primal.max(dual) < STUCK.0 { stuck + 1 } else { 0 };
            if stuck == STUCK.1 {
                break;
            }
            let least = primal.min(dual);
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

    fn roots(&mut self) {
        self.root.clear();
        self.root.extend(self.c.iter().map(|c| 1.0 / libm::sqrt(c.max(1e-300))));
    }

    /// The time of all cells; after [`Self::roots`].
    fn time(&self) -> f64 {
        self.free().map(|i| self.weight[i] * self.root[i]).sum()
    }

    /// After [`Self::roots`].
    fn parts(&mut self, time: f64) {
        let over = self.free().len() as f64 / time;
        let parts = self.weight.iter().zip(&self.root).map(|(w, root)| w * root * over);
        self.part.clear();
        self.part.extend(parts.map(|part| part.clamp(PART, 1.0 / PART)));
    }

    fn start(&mut self, mu: f64) {
        let new = |room: f64, r: f64, part: f64| {
            let s = room.max(0.1 * r);
            Slack::new(s, mu * part / s)
        };
        self.under.clear();
        let all = self.c.iter().zip(&self.cap).zip(&self.part);
        self.under.extend(all.map(|((c, cap), part)| new(1.0 - c / cap, 1.0, *part)));
        for p in &mut self.pairs {
            let (r, part) = (p.bound(&self.root), self.part[p.at + 1]);
            p.slack = p.room(&self.c, &self.root).map(|room| new(room, r, part));
        }
    }

    /// With the prices of the problem before.
    fn resume(&mut self, mu: f64) {
        let all = self.c.iter().zip(&self.cap).zip(&self.part);
        for (slack, ((c, cap), part)) in self.under.iter_mut().zip(all) {
            *slack = Slack::again(1.0 - c / cap, 1.0, slack.price, mu * part);
        }
        for (p, known) in self.pairs.iter_mut().zip(&self.known) {
            let scale = if p.scale == 0.0 { 1.0 } else { known.scale / p.scale };
            let (r, room) = (p.bound(&self.root), p.room(&self.c, &self.root));
            let mu = mu * self.part[p.at + 1];
            p.slack = core::array::from_fn(|k| {
                Slack::again(room[k], r, scale * known.slack[k].price, mu)
            });
        }
    }

    /// Newton's matrix.
    fn assemble(&mut self) {
        let n = self.c.len();
        self.band.clear(n);
        self.step.clear();
        self.step.resize(n, 0.0);
        let band = &mut self.band;
        for p in &self.pairs {
            let i = p.at;
            let [a, b, c] = p.g;
            let dr = p.slope(&self.root);
            let [low, high] = p.slack;
            self.step[i + 1] += p.scale * (low.price + high.price);
            // both sides' slopes are (−a, r′ − b, −c) and (a, r′ + b, c)
            let (w0, w1) = (low.price * low.over, high.price * high.over);
            let (w, d) = (w0 + w1, (w1 - w0) * dr);
            let middle = w * b + d;
            *band.entry(i, 0) += w * a * a;
            let (m0, m1) = (dr - b, dr + b);
            *band.entry(i + 1, 0) += w0 * m0 * m0 + w1 * m1 * m1;
            *band.entry(i, 1) += a * middle;
            *band.entry(i + 2, 0) += w * c * c;
            *band.entry(i + 1, 1) += c * middle;
            *band.entry(i, 2) += w * a * c;
        }
        for i in self.given[0]..n - self.given[1] {
            let y = self.root[i] * self.root[i];
            let weight = more(self.weight[i] - self.step[i], 0.1 * self.weight[i]);
            let mut own = 0.75 * weight * self.root[i] * y * y;
            if self.cap[i].is_finite() {
                let slack = &self.under[i];
                own += slack.price * slack.over / (self.cap[i] * self.cap[i]);
            }
            *band.entry(i, 0) += own;
        }
        for i in (0..self.given[0]).chain(n - self.given[1]..n) {
            band.fix(i, 0);
        }
    }

    /// The step towards λ·s = μ, in `step`.
    fn aim(&mut self, mu: f64) {
        let n = self.c.len();
        self.step.clear();
        self.step.resize(n, 0.0);
        for i in self.given[0]..n - self.given[1] {
            let y = self.root[i] * self.root[i];
            self.step[i] = 0.5 * self.weight[i] * self.root[i] * y;
            if self.cap[i].is_finite() {
                let over = 1.0 / self.cap[i];
                self.step[i] -=
                    over * self.under[i].pull(mu * self.part[i], 1.0 - self.c[i] * over);
            }
        }
        for p in &self.pairs {
            let (room, mu) = (p.room(&self.c, &self.root), mu * self.part[p.at + 1]);
            let (low, high) = (p.slack[0].pull(mu, room[0]), p.slack[1].pull(mu, room[1]));
            let (d, dr) = (high - low, p.slope(&self.root));
            let step = &mut self.step[p.at..p.at + 3];
            step[0] += p.g[0] * d;
            step[1] += p.g[1] * d + dr * (low + high);
            step[2] += p.g[2] * d;
        }
        for i in (0..self.given[0]).chain(n - self.given[1]..n) {
            self.step[i] = 0.0;
        }
        self.band.solve_one(self.step.as_chunks_mut::<1>().0);
    }

    /// How far the unknowns with their slacks, and the prices, may go.
    fn reach(&mut self, mu: f64) -> (f64, f64) {
        let (mut primal, mut dual) = (SHARE, SHARE);
        for i in self.free() {
            if self.cap[i].is_finite() {
                let over = 1.0 / self.cap[i];
                let slack = &mut self.under[i];
                let ds = 1.0 - (self.c[i] + self.step[i]) * over - slack.s;
                slack.limit(mu * self.part[i], ds, (&mut primal, &mut dual));
            }
        }
        for p in &mut self.pairs {
            let (room, mu) = (p.room(&self.c, &self.root), mu * self.part[p.at + 1]);
            let (turn, dr) = (p.sum(&self.step), p.slope(&self.root) * self.step[p.at + 1]);
            let [low, high] = &mut p.slack;
            low.limit(mu, dr - turn + room[0] - low.s, (&mut primal, &mut dual));
            high.limit(mu, dr + turn + room[1] - high.s, (&mut primal, &mut dual));
        }
        for i in self.free() {
            // c stays positive, and 1/√c near its tangent
            if self.step[i] * primal < -0.8 * self.c[i] {
                primal = -0.8 * self.c[i] / self.step[i];
            }
        }
        // a full step is a full step
        let whole = |x: f64| if x >= SHARE { 1.0 } else { x };
        (whole(primal), whole(dual))
    }

    /// Go; the sum of λ·s after it, and the largest miss.
    fn advance(&mut self, mu: f64, so_far: (f64, f64)) -> (f64, f64) {
        let free = self.free();
        for i in free.clone() {
            self.c[i] += so_far.0 * self.step[i];
        }
        self.roots();
        let (mut gap, mut worst) = (0.0, 0.0);
        let mut count = |slack: &Slack, is: f64| {
            worst = more(worst, slack.s - is);
            gap += slack.s * slack.price;
        };
        for i in free {
            if self.cap[i].is_finite() {
                let is = 1.0 - self.c[i] / self.cap[i];
                self.under[i].go(mu * self.part[i], so_far, is);
                count(&self.under[i], is);
            }
        }
        for p in &mut self.pairs {
            let (room, mu) = (p.room(&self.c, &self.root), mu * self.part[p.at + 1]);
            for (slack, is) in p.slack.iter_mut().zip(room) {
                slack.go(mu, so_far, is);
                count(slack, is);
            }
        }
        (gap, worst)
    }
}
