//! The optimisation inside the jerk-limited law: an interior-point method on a chain.
//!
//! ```text
//!   minimise  Σ wᵢ/√cᵢ      so that  cᵢ ≤ capᵢ,   |g·c| ≤ 1 (acceleration),   |g·c| ≤ v̂/√cᵢ (jerk)
//! ```
//!
//! c are the control values of b = ṡ² (see `smooth`); each g meets three neighbours, so that Newton's matrix is a band of
//! five. Primal-dual: each slack s has a price λ, λ·s is led to zero for all alike. The acceleration's bounds are
//! straight; v̂/√c is convex in c, so a step that keeps its tangent keeps it too. Boyd and Vandenberghe, *Convex
//! Optimization*, ch. 11; the jerk's bound is not convex as a set, so the optimum that is found may be a local one.
use super::band::Band;
use alloc::vec::Vec;

/// Newton steps at most.
const STEPS: usize = 60;

/// Part of the way to the nearest bound that a step may go.
const SHARE: f64 = 0.95;

/// Largest quotient between λ·s of a bound and what it is led to.
const KEEP: f64 = 20.0;

/// How far the time may still be above the optimum when the search ends.
const GAP: f64 = 0.003;

/// Two bounds around one sum: −r ≤ g·c ≤ r.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// First of the three unknowns.
    pub(crate) at: usize,
    pub(crate) g: [f64; 3],
    /// 0: r = 1; else r = scale/√c of the middle unknown.
    pub(crate) scale: f64,
    slack: [f64; 2],
    price: [f64; 2],
}

impl Pair {
    pub(crate) fn new(at: usize, g: [f64; 3], scale: f64) -> Self {
        Self { at, g, scale, slack: [0.0; 2], price: [0.0; 2] }
    }

    fn sum(&self, c: &[f64]) -> f64 {
        self.g[0] * c[self.at] + self.g[1] * c[self.at + 1] + self.g[2] * c[self.at + 2]
    }

    /// How that changes with the three unknowns, if r does by `dr` with the middle one.
    fn slope(&self, side: usize, dr: f64) -> [f64; 3] {
        let [a, b, c] = self.g;
        if side == 0 { [-a, dr - b, -c] } else { [a, dr + b, c] }
    }

    /// r, and how it changes with the middle unknown.
    fn room(&self, c: &[f64], root: &[f64]) -> (f64, f64) {
        if self.scale == 0.0 {
            return (1.0, 0.0);
        }
        let r = self.scale * root[self.at + 1];
        (r, -0.5 * r / c[self.at + 1])
    }
}

/// r ∓ g·c.
fn left(side: usize, r: f64, sum: f64) -> f64 {
    if side == 0 { r - sum } else { r + sum }
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
    cap_slack: Vec<f64>,
    cap_price: Vec<f64>,
    band: Band,
    step: Vec<f64>,
}

impl Chain {
    pub(crate) fn clear(&mut self) {
        self.c.clear();
        self.weight.clear();
        self.cap.clear();
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

    /// Find the fastest; how many steps it took, or `None` when nothing within the bounds was found.
    pub(crate) fn solve(&mut self) -> Option<usize> {
        if self.free().is_empty() {
            return (self.excess() < 1e-6).then_some(0);
        }
        self.roots();
        let mut time = self.time();
        let first = 0.3 * time / self.free().len() as f64;
        self.start(first);
        let count = (2 * self.pairs.len()
            + self.free().filter(|i| self.cap[*i].is_finite()).count()) as f64;
        let (mut gap, mut shrink) = (0.0, 0.1);
        for steps in 1..=STEPS {
            self.assemble();
            self.band.factor();
            let mu = if steps == 1 { first } else { shrink * gap / count };
            self.aim(mu);
            let (primal, dual) = self.reach(mu);
            let (new, miss) = self.advance(mu, primal, dual);
            self.roots();
            let before = core::mem::replace(&mut time, self.time());
            gap = new;
            let least = primal.min(dual);
            shrink = if least > 0.8 {
                0.1
            } else if least > 0.4 {
                0.3
            } else {
                0.8
            };
            if gap < GAP * time && miss < 1e-7 && (before - time).abs() < GAP * time {
                return Some(steps);
            }
            if !(time.is_finite() && gap.is_finite()) {
                return None;
            }
        }
        (self.excess() < 1e-6).then_some(STEPS)
    }

    fn roots(&mut self) {
        self.root.clear();
        self.root.extend(self.c.iter().map(|c| 1.0 / libm::sqrt(c.max(1e-300))));
    }

    pub(crate) fn time(&self) -> f64 {
        self.free().map(|i| self.weight[i] / libm::sqrt(self.c[i])).sum()
    }

    fn start(&mut self, mu: f64) {
        let n = self.c.len();
        self.cap_slack.clear();
        self.cap_price.clear();
        for i in 0..n {
            let s = (1.0 - self.c[i] / self.cap[i]).max(0.1);
            self.cap_slack.push(s);
            self.cap_price.push(mu / s);
        }
        for k in 0..self.pairs.len() {
            let p = &self.pairs[k];
            let (sum, (r, _)) = (p.sum(&self.c), p.room(&self.c, &self.root));
            let slack = [(r - sum).max(0.1 * r), (r + sum).max(0.1 * r)];
            let p = &mut self.pairs[k];
            p.slack = slack;
            p.price = slack.map(|s| mu / s);
        }
    }

    /// Newton's matrix.
    fn assemble(&mut self) {
        let n = self.c.len();
        self.band.clear(n);
        self.step.clear();
        self.step.resize(n, 0.0);
        for p in &self.pairs {
            self.step[p.at + 1] += p.scale * (p.price[0] + p.price[1]);
        }
        let rows = &mut self.band.rows;
        let free = rows.iter_mut().enumerate().take(n - self.given[1]).skip(self.given[0]);
        for (i, row) in free {
            let y = self.root[i] * self.root[i];
            let weight = (self.weight[i] - self.step[i]).max(0.1 * self.weight[i]);
            row[0] += 0.75 * weight * self.root[i] * y * y;
            if self.cap[i].is_finite() {
                row[0] += self.cap_price[i] / (self.cap_slack[i] * self.cap[i] * self.cap[i]);
            }
        }
        for p in &self.pairs {
            let (_, dr) = p.room(&self.c, &self.root);
            let i = p.at;
            for side in 0..2 {
                let g = p.slope(side, dr);
                let w = p.price[side] / p.slack[side];
                let wg = [w * g[0], w * g[1], w * g[2]];
                rows[i][0] += wg[0] * g[0];
                rows[i + 1][0] += wg[1] * g[1];
                rows[i + 2][0] += wg[2] * g[2];
                rows[i + 1][1] += wg[1] * g[0];
                rows[i + 2][1] += wg[2] * g[1];
                rows[i + 2][2] += wg[2] * g[0];
            }
        }
        for i in (0..self.given[0]).chain(n - self.given[1]..n) {
            self.band.pin(i);
        }
    }

    /// The step towards λ·s = μ, in `step`.
    fn aim(&mut self, mu: f64) {
        let n = self.c.len();
        self.step.clear();
        self.step.resize(n, 0.0);
        let free = self.given[0]..n - self.given[1];
        for i in free {
            let y = self.root[i] * self.root[i];
            self.step[i] += 0.5 * self.weight[i] * self.root[i] * y;
            if self.cap[i].is_finite() {
                let (s, l, g) = (self.cap_slack[i], self.cap_price[i], 1.0 / self.cap[i]);
                let miss = (1.0 - self.c[i] * g) - s;
                self.step[i] -= g * (mu - l * miss) / s;
            }
        }
        for p in &self.pairs {
            let sum = p.sum(&self.c);
            let (r, dr) = p.room(&self.c, &self.root);
            for side in 0..2 {
                let g = p.slope(side, dr);
                let (s, l) = (p.slack[side], p.price[side]);
                let miss = left(side, r, sum) - s;
                let pull = (mu - l * miss) / s;
                for (step, g) in self.step[p.at..].iter_mut().zip(g) {
                    *step += g * pull;
                }
            }
        }
        for i in (0..self.given[0]).chain(n - self.given[1]..n) {
            self.step[i] = 0.0;
        }
        self.band.solve(&mut self.step);
    }

    /// How far the unknowns with their slacks, and the prices, may go.
    fn reach(&self, mu: f64) -> (f64, f64) {
        let (mut primal, mut dual) = (SHARE, SHARE);
        let mut limit = |s: f64, l: f64, ds: f64| {
            if ds * primal < -SHARE * s {
                primal = -SHARE * s / ds;
            }
            let dl = (mu - l * ds) / s - l;
            if dl * dual < -SHARE * l {
                dual = -SHARE * l / dl;
            }
        };
        for i in self.free() {
            if self.cap[i].is_finite() {
                let g = 1.0 / self.cap[i];
                let ds = -g * self.step[i] + (1.0 - self.c[i] * g) - self.cap_slack[i];
                limit(self.cap_slack[i], self.cap_price[i], ds);
            }
        }
        for p in &self.pairs {
            let (sum, turn) = (p.sum(&self.c), p.sum(&self.step));
            let (r, dr) = p.room(&self.c, &self.root);
            let d = dr * self.step[p.at + 1];
            for side in 0..2 {
                let ds = left(side, d, turn) + left(side, r, sum) - p.slack[side];
                limit(p.slack[side], p.price[side], ds);
            }
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
    fn advance(&mut self, mu: f64, primal: f64, dual: f64) -> (f64, f64) {
        let (mut gap, mut worst) = (0.0, 0.0_f64);
        let mut go = |s: &mut f64, l: &mut f64, ds: f64, now: f64| {
            *l += dual * ((mu - *l * ds) / *s - *l);
            *s += primal * ds;
            // the bound may have moved away further than its tangent: what is there may be used
            if now > *s {
                *s = now;
            }
            // prices that lost touch with their slacks would block the way
            *l = l.max(mu / (KEEP * *s)).min(KEEP * mu / *s);
            worst = worst.max(*s - now);
            gap += *s * *l;
        };
        let free = self.given[0]..self.c.len() - self.given[1];
        for i in free.clone() {
            if self.cap[i].is_finite() {
                let g = 1.0 / self.cap[i];
                let ds = -g * self.step[i] + (1.0 - self.c[i] * g) - self.cap_slack[i];
                let now = 1.0 - (self.c[i] + primal * self.step[i]) * g;
                go(&mut self.cap_slack[i], &mut self.cap_price[i], ds, now);
            }
        }
        for p in &mut self.pairs {
            let (sum, turn) = (p.sum(&self.c), p.sum(&self.step));
            let (r, dr) = p.room(&self.c, &self.root);
            let m = p.at + 1;
            let d = dr * self.step[m];
            let new = if p.scale == 0.0 {
                r
            } else {
                p.scale / libm::sqrt(self.c[m] + primal * self.step[m])
            };
            let sum_new = sum + primal * turn;
            for side in 0..2 {
                let ds = left(side, d, turn) + left(side, r, sum) - p.slack[side];
                let now = left(side, new, sum_new);
                go(&mut p.slack[side], &mut p.price[side], ds, now);
            }
        }
        for i in free {
            self.c[i] += primal * self.step[i];
        }
        (gap, worst)
    }
}
