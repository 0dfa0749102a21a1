//! What is left of bounds, and its price: four of them side by side.
//!
//! ```text
//!   s > 0, λ > 0      λ·s ─► μ      ds: by how much s changes along a whole step
//! ```
use wide::f64x4;

/// Part of the way to the nearest bound that a step may go.
const SHARE: f64 = 0.95;

/// Largest quotient between λ·s of a bound and what it is led to.
const KEEP: f64 = 20.0;

/// From such a share of its bound on a slack is free, and begins again as what it is.
const FREE: f64 = 0.1;

/// How far a step may go: the unknowns with their slacks, and the prices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub(super) primal: f64,
    pub(super) dual: f64,
}

impl Reach {
    pub(super) const fn all() -> Self {
        Self { primal: SHARE, dual: SHARE }
    }

    /// A full step is a full step.
    pub(super) fn whole(self) -> Self {
        let whole = |x: f64| if x >= SHARE { 1.0 } else { x };
        Self { primal: whole(self.primal), dual: whole(self.dual) }
    }
}

/// How far all four may go at most.
#[derive(Clone, Copy, Debug)]
pub(super) struct LongestStep {
    primal: f64x4,
    dual: f64x4,
}

impl LongestStep {
    pub(super) fn all() -> Self {
        Self { primal: f64x4::splat(SHARE), dual: f64x4::splat(SHARE) }
    }

    pub(super) fn reach(self) -> Reach {
        let least = |of: f64x4| of.to_array().into_iter().fold(SHARE, less);
        Reach { primal: least(self.primal), dual: least(self.dual) }
    }
}

/// The sum of λ·s, and by how much a slack is larger than its room at most.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Residual {
    gap: f64x4,
    miss: f64x4,
}

impl Residual {
    pub(super) fn gap(self) -> f64 {
        self.gap.reduce_add()
    }

    pub(super) fn miss(self) -> f64 {
        self.miss.to_array().into_iter().fold(0.0, more)
    }
}

/// Four slacks and their prices. A place that holds none has a slack of one at no price: it is led
/// to a μ of zero.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slacks {
    s: f64x4,
    pub(super) price: f64x4,
    /// 1/s.
    pub(super) over: f64x4,
}

impl Slacks {
    /// Of so much `room` of a bound `r`, with λ·s = `mu`.
    pub(super) fn new(room: f64x4, r: f64x4, mu: f64x4) -> Self {
        let s = room.fast_max(0.1 * r);
        let over = 1.0 / s;
        Self { s, price: mu * over, over }
    }

    /// The same at the prices that were paid in a problem like it.
    pub(super) fn again(room: f64x4, r: f64x4, price: f64x4, mu: f64x4) -> Self {
        let free = FREE * r;
        let paid = (mu / price.fast_max(f64x4::splat(f64::MIN_POSITIVE))).fast_max(room);
        let s = free.simd_lt(room).bitselect(room, paid.fast_min(free));
        let over = 1.0 / s;
        let even = mu * over;
        Self { s, price: price.fast_max(even).fast_min(KEEP * even), over }
    }

    /// λ/s.
    pub(super) fn stiffness(&self) -> f64x4 {
        self.price * self.over
    }

    /// What pulls the unknowns where there is so much `room`, but for μ/s.
    pub(super) fn pull(&self, room: f64x4) -> f64x4 {
        self.price * (self.s - room) * self.over
    }

    pub(super) fn count(&self, room: f64x4, left: &mut Residual) {
        left.gap += self.s * self.price;
        left.miss = left.miss.fast_max(self.s - room);
    }

    /// How the prices change with the slacks.
    fn dearer(&self, mu: f64x4, ds: f64x4) -> f64x4 {
        (mu - self.price * ds) * self.over - self.price
    }

    /// A step that leads to so much room by its tangent may go only so far.
    pub(super) fn limit(&self, mu: f64x4, to: f64x4, least: &mut LongestStep) {
        let ds = to - self.s;
        let dearer = self.dearer(mu, ds);
        let bound = |least: &mut f64x4, of: f64x4, change: f64x4| {
            let far = -SHARE * of;
            if (change * *least).simd_lt(far).any() {
                let down = change.simd_lt(f64x4::ZERO);
                *least = least.fast_min(down.bitselect(far / change, *least));
            }
        };
        bound(&mut least.primal, self.s, ds);
        bound(&mut least.dual, self.price, dearer);
    }

    /// Go along it; there is so much `room` then.
    pub(super) fn go(&mut self, mu: f64x4, to: f64x4, reach: Reach, room: f64x4) {
        let ds = to - self.s;
        let dearer = self.dearer(mu, ds);
        // the bound may have moved away further than its tangent: what is there may be used
        self.s = (self.s + reach.primal * ds).fast_max(room);
        self.over = 1.0 / self.s;
        // prices that lost touch with their slacks would block the way
        let even = mu * self.over;
        let price = self.price + reach.dual * dearer;
        self.price = price.fast_max(even * (1.0 / KEEP)).fast_min(KEEP * even);
    }
}

/// The smaller one.
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger one.
fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
