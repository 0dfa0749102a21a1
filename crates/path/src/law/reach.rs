//! Speed and acceleration: the fastest law without a limit of jerk.
//!
//! ```text
//!   b = ṡ²   ╭───╮  cap                       backwards: from how fast can every later place still be kept?   β
//!      ╭─────╯   │╲   ╭──── cap               forwards:  as fast as the axes accelerate, and under β
//!     ╱          │ ╲_╱                        b′ = 2·s̈,  so that in a cell of constant s̈   b₁ = b₀ + 2·h·s̈
//!    ╱  forwards │ backwards
//! ```
//!
//! At both ends of a cell, and in its middle, every axis demands −1 ≤ (q′·a + q″·b)/A ≤ 1. With
//! b₁ = b₀ + 2ha all of these, and b₁ ≤ β₁, are bounds on a that are linear in b₀; the largest b₀
//! that leaves room between the highest lower bound and the lowest upper one is found with Newton's
//! method on a concave function of straight parts, in two or three steps, exactly. (Reachability
//! analysis: Pham and Pham, *A new approach to time-optimal path parameterization*, 2018. Demanding
//! it at several places of a cell is what keeps places with q′ ≈ 0 from oscillating.)
use super::cell::{Cell, Demand, Rows, Start};

/// A straight bound on a: `at + slope·b`.
#[derive(Clone, Copy, Debug)]
struct Bound {
    at: f64,
    slope: f64,
}

/// Largest number of bounds of one kind: three places of nine axes, and the neighbour's.
const MOST: usize = 3 * crate::AXES + 1;

/// What a cell demands; kept from one to the next, as it is large.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    upper: [Bound; MOST],
    lower: [Bound; MOST],
    uppers: usize,
    lowers: usize,
    /// Largest b that does not depend on a.
    cap: f64,
}

impl Default for Bounds {
    fn default() -> Self {
        let none = Bound { at: 0.0, slope: 0.0 };
        Self { upper: [none; MOST], lower: [none; MOST], uppers: 0, lowers: 0, cap: 0.0 }
    }
}

impl Bounds {
    fn upper(&mut self, at: f64, slope: f64) {
        self.upper[self.uppers] = Bound { at, slope };
        self.uppers += 1;
    }

    fn lower(&mut self, at: f64, slope: f64) {
        self.lower[self.lowers] = Bound { at, slope };
        self.lowers += 1;
    }

    /// −1 ≤ t·a + n·b ≤ 1.
    fn strip(&mut self, t: f64, n: f64) {
        if n.abs() * self.cap > 1e9 * t.abs() {
            // a would have to be enormous to matter
            self.cap = self.cap.min(1.0 / n.abs());
        } else if t != 0.0 {
            let (at, slope) = (1.0 / t.abs(), -n / t);
            self.upper(at, slope);
            self.lower(-at, slope);
        }
    }

    /// Those of a cell of length `h`, and no others.
    fn take(&mut self, rows: &Rows, h: f64, cap: f64) {
        (self.uppers, self.lowers, self.cap) = (0, 0, cap);
        for row in rows.at(0) {
            self.strip(row.a1, row.a2);
        }
        for row in rows.at(1) {
            self.strip(row.a1 + h * row.a2, row.a2);
        }
        for row in rows.at(2) {
            self.strip(row.a1 + 2.0 * h * row.a2, row.a2);
        }
    }

    fn highest(&self, b: f64) -> Bound {
        let value = |x: &Bound| x.at + x.slope * b;
        let least = |m: Bound, x: &Bound| if value(x) < value(&m) { *x } else { m };
        self.upper[..self.uppers].iter().fold(Bound { at: f64::INFINITY, slope: 0.0 }, least)
    }

    fn lowest(&self, b: f64) -> Bound {
        let value = |x: &Bound| x.at + x.slope * b;
        let most = |m: Bound, x: &Bound| if value(x) > value(&m) { *x } else { m };
        self.lower[..self.lowers].iter().fold(Bound { at: f64::NEG_INFINITY, slope: 0.0 }, most)
    }

    /// Largest b that leaves room for an a; b = 0 always does.
    fn largest(&self) -> f64 {
        let mut b = self.cap;
        for _ in 0..2 * MOST {
            let (high, low) = (self.highest(b), self.lowest(b));
            let room = (high.at - low.at) + (high.slope - low.slope) * b;
            if room.is_nan() || room >= -1e-12 * (low.at.abs() + 1.0) {
                return b;
            }
            let next = (high.at - low.at) / (low.slope - high.slope);
            if next.is_nan() || next >= b {
                return b;
            }
            b = next.max(0.0);
        }
        b
    }
}

/// Largest ṡ² at each knot from which all that follows can be kept, ending at rest. `beta` has one
/// entry more than there are cells.
///
/// Returns the last knot whose value does not depend on what comes after the last cell, or 0.
pub(crate) fn backwards<'a>(
    cells: impl ExactSizeIterator<Item = &'a Cell> + DoubleEndedIterator,
    beta: &mut [f64],
    bounds: &mut Bounds,
) -> usize {
    let last = cells.len();
    beta[last] = 0.0;
    let mut settled = 0;
    // the cap of a knot is that of both cells that meet there
    let mut cells = cells.enumerate().rev().peekable();
    while let Some((i, cell)) = cells.next() {
        let before = cells.peek().map_or(f64::INFINITY, |(_, cell)| cell.cap);
        let cap = match cell.start {
            Start::Rest => 0.0,
            Start::On(cap) => cap.min(cell.cap).min(before),
        };
        beta[i] = most_before(cell, cap, beta[i + 1], bounds);
        if settled == 0 && beta[i] >= cap {
            settled = i;
        }
    }
    settled
}

fn most_before(cell: &Cell, cap: f64, next: f64, bounds: &mut Bounds) -> f64 {
    match &cell.demand {
        Demand::Line { accel, .. } => cap.min(next + 2.0 * cell.h * accel),
        Demand::Curve(rows) => {
            bounds.take(rows, cell.h, cap);
            let per = 0.5 / cell.h;
            bounds.upper(next * per, -per);
            bounds.lower(0.0, -per);
            bounds.largest()
        }
    }
}

/// ṡ² at the end of a cell that is begun with `b` and may end with `beta` at most.
///
/// Faster than allowed (a feed that was lowered meanwhile): as slow as the axes brake.
pub(crate) fn forwards(cell: &Cell, b: f64, beta: f64, bounds: &mut Bounds) -> f64 {
    match &cell.demand {
        Demand::Line { accel, .. } => {
            let reach = 2.0 * cell.h * accel;
            beta.min(b + reach).max(b - reach).max(0.0)
        }
        Demand::Curve(rows) => {
            bounds.take(rows, cell.h, cell.cap.max(b));
            let (high, low) = (bounds.highest(b), bounds.lowest(b));
            let (high, low) = (high.at + high.slope * b, low.at + low.slope * b);
            let wanted = (beta - b) * 0.5 / cell.h;
            let a = wanted.min(high).max(low.min(high));
            (b + 2.0 * cell.h * a).max(0.0)
        }
    }
}
