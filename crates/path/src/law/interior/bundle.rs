//! Bounds of the same three unknowns, four pairs side by side: −r ≤ g·c ≤ r.
use super::slack::{LongestStep, Reach, Residual, Slacks};
use super::{RightSide, Unknown};
use wide::f64x4;

const FOUR: usize = 4;

/// Two bounds around one sum: r = level + scale/√c of the middle unknown; one of them is zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// First of the three unknowns.
    pub(super) at: usize,
    g: [f64; 3],
    level: f64,
    scale: f64,
}

impl Pair {
    /// |g·c| ≤ 1
    pub(crate) const fn even(at: usize, g: [f64; 3]) -> Self {
        Self { at, g, level: 1.0, scale: 0.0 }
    }

    /// |g·c| ≤ scale/√c
    pub(crate) const fn falling(at: usize, g: [f64; 3], scale: f64) -> Self {
        Self { at, g, level: 0.0, scale }
    }
}

/// Up to four pairs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bundle {
    pub(super) at: usize,
    pub(super) pairs: usize,
    g: [f64x4; 3],
    level: f64x4,
    scale: f64x4,
    /// 1, and 0 in places that hold no pair.
    held: f64x4,
    /// r − g·c and r + g·c.
    low: Slacks,
    high: Slacks,
}

/// The three unknowns of a bundle: where they are, what follows from the middle one, and its part
/// of the time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbours<'a> {
    pub(super) c: &'a [f64; 3],
    pub(super) middle: Unknown,
    pub(super) part: f64,
}

/// The rooms of both sides.
type Rooms = [f64x4; 2];

/// What a bundle adds to the equations of its unknowns: the matrix from its diagonal on, and what
/// draws them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    /// 00, 01, 02, 11, 12, 22
    pub(super) matrix: [f64; 6],
    pub(super) right_side: [RightSide; 3],
}

impl Bundle {
    pub(super) fn new(at: usize) -> Self {
        let none = f64x4::ZERO;
        let one = f64x4::splat(1.0);
        let [low, high] = [Slacks::default(); 2];
        Self { at, pairs: 0, g: [none; 3], level: one, scale: none, held: none, low, high }
    }

    /// `false`: it has no place for this pair.
    pub(super) fn take(&mut self, pair: &Pair) -> bool {
        let free = self.pairs < FOUR && pair.at == self.at;
        if free {
            let place = |of: &mut f64x4, value: f64| of.as_mut_array()[self.pairs] = value;
            self.g.iter_mut().zip(pair.g).for_each(|(g, value)| place(g, value));
            place(&mut self.level, pair.level);
            place(&mut self.scale, pair.scale);
            place(&mut self.held, 1.0);
            self.pairs += 1;
        }
        free
    }

    fn sum(&self, c: &[f64; 3]) -> f64x4 {
        self.g[0] * c[0] + self.g[1] * c[1] + self.g[2] * c[2]
    }

    /// r.
    fn bound(&self, middle: Unknown) -> f64x4 {
        self.level + self.scale * middle.root
    }

    fn rooms(&self, near: &Neighbours) -> Rooms {
        let (r, sum) = (self.bound(near.middle), self.sum(near.c));
        [r - sum, r + sum]
    }

    /// The same along a whole step, by its tangent.
    fn leads(&self, near: &Neighbours, step: &[f64; 3]) -> Rooms {
        let r = self.bound(near.middle) + self.scale * (near.middle.slope * step[1]);
        let sum = self.sum(near.c) + self.sum(step);
        [r - sum, r + sum]
    }

    /// By how much a bound is exceeded at most, as a share of it.
    pub(super) fn excess(&self, near: &Neighbours) -> f64 {
        let over = self.sum(near.c).abs() / self.bound(near.middle) - 1.0;
        over.to_array()[..self.pairs].iter().fold(-1.0, |m: f64, x| m.max(*x))
    }

    /// Begin with λ·s = `mu`, times the part.
    pub(super) fn start(&mut self, near: &Neighbours, mu: f64) {
        let (r, [low, high]) = (self.bound(near.middle), self.rooms(near));
        let mu = self.held * (mu * near.part);
        (self.low, self.high) = (Slacks::new(low, r, mu), Slacks::new(high, r, mu));
    }

    /// Begin with the prices of one like it.
    pub(super) fn resume(&mut self, known: &Self, near: &Neighbours, mu: f64) {
        // of each pair one of the two is zero
        let scale = (known.scale + known.level) / (self.scale + self.level);
        let (r, [low, high]) = (self.bound(near.middle), self.rooms(near));
        let mu = self.held * (mu * near.part);
        self.low = Slacks::again(low, r, scale * known.low.price, mu);
        self.high = Slacks::again(high, r, scale * known.high.price, mu);
    }

    /// Go along a step to `here`.
    pub(super) fn go(
        &mut self,
        (before, step): (&Neighbours, &[f64; 3]),
        here: &Neighbours,
        (mu, reach): (f64, Reach),
        left: &mut Residual,
    ) {
        let mu = self.held * (mu * before.part);
        let ([low, high], to) = (self.rooms(here), self.leads(before, step));
        self.low.go(mu, to[0], reach, low);
        self.high.go(mu, to[1], reach, high);
        self.low.count(low, left);
        self.high.count(high, left);
    }

    /// How far a step may go.
    pub(super) fn limit(
        &self,
        near: &Neighbours,
        step: &[f64; 3],
        mu: f64,
        least: &mut LongestStep,
    ) {
        let mu = self.held * (mu * near.part);
        let to = self.leads(near, step);
        self.low.limit(mu, to[0], least);
        self.high.limit(mu, to[1], least);
    }

    pub(super) fn added(&self, near: &Neighbours) -> Contribution {
        let Self { g, scale, low, high, held, .. } = self;
        let (w0, w1) = (low.stiffness(), high.stiffness());
        // both sides' slopes are (−g₀, r′ − g₁, −g₂) and (g₀, r′ + g₁, g₂)
        let dr = *scale * near.middle.slope;
        let w = w0 + w1;
        let middle = w * g[1] + (w1 - w0) * dr;
        let (m0, m1) = (dr - g[1], dr + g[1]);
        let (g0, g2) = (w * g[0], w * g[2]);
        let own = w0 * m0 * m0 + w1 * m1 * m1;
        let matrix = [g0 * g[0], g[0] * middle, g0 * g[2], own, g[2] * middle, g2 * g[2]];
        let rooms = self.rooms(near);
        let (pulled, pushed) = (low.pull(rooms[0]), high.pull(rooms[1]));
        let (low_mu, high_mu) = (*held * low.over, *held * high.over);
        let (at_once, by_mu) = (pushed - pulled, high_mu - low_mu);
        let both = dr * (pulled + pushed);
        let both_mu = dr * (low_mu + high_mu);
        let right_side = |at_once: f64x4, by_mu: f64x4| RightSide {
            at_once: at_once.reduce_add(),
            by_mu: near.part * by_mu.reduce_add(),
            bend: 0.0,
        };
        let bend = (*scale * (low.price + high.price)).reduce_add();
        Contribution {
            matrix: matrix.map(f64x4::reduce_add),
            right_side: [
                right_side(g[0] * at_once, g[0] * by_mu),
                RightSide { bend, ..right_side(g[1] * at_once + both, g[1] * by_mu + both_mu) },
                right_side(g[2] * at_once, g[2] * by_mu),
            ],
        }
    }
}
