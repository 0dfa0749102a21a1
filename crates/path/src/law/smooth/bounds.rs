//! The bounds of acceleration and jerk at the knots of the grid; what no speed could reach is left
//! out.
use super::Smooth;
use crate::law::cell::parabola::between;
use crate::law::cell::{Cell, Demand, LimitRow, Start};
use crate::law::interior::Pair;

/// What differs by such a share is the same.
const SAME: f64 = 1e-7;

/// What may be of a bound at most, with the largest speeds, where it is left out.
const NEVER: f64 = 0.1;

impl Smooth {
    /// Write all bounds down, and forget the caps of speed that the axes keep anyhow.
    pub(super) fn bound(&mut self, cells: &[&Cell], shift: usize) {
        let free = self.chain.cap.iter_mut().skip(shift).zip(&self.most);
        free.filter(|(cap, most)| **most < NEVER * **cap).for_each(|(cap, _)| *cap = f64::INFINITY);
        for k in 0..self.grid.len() {
            self.bound_acceleration(cells, shift, k);
            self.bound_cap(k + shift);
            self.bound_jerk(cells, shift, k);
        }
    }

    fn bound_cap(&mut self, i: usize) {
        let cap = self.chain.cap[i];
        if self.chain.free().contains(&i) && cap.is_finite() {
            self.chain.push(&Pair::even(i - 1, [0.0, 1.0 / cap, 0.0]));
        }
    }

    /// At the knot before a cell of the grid.
    fn bound_acceleration(&mut self, cells: &[&Cell], shift: usize, k: usize) {
        let i = k + shift; // the knot lies between unknowns i−1 and i
        if k == 0 || i < self.chain.given[0] {
            return;
        }
        let (left, right) = (&self.grid[k - 1], &self.grid[k]);
        let both = self.width[i - 1] + self.width[i];
        let b = [self.width[i] / both, self.width[i - 1] / both];
        let a = [-1.0 / both, 1.0 / both];
        // three unknowns from where there are three
        let at = (i - 1).min(self.chain.c.len() - 3);
        let place = |p: f64, q: f64| if at == i - 1 { [p, q, 0.0] } else { [0.0, p, q] };
        let most = [self.most[k - 1], self.most[k]];
        let mut add = |a1: f64, a2: f64| {
            let g = [a1 * a[0] + a2 * b[0], a1 * a[1] + a2 * b[1]];
            if g[0].abs() * most[0] + g[1].abs() * most[1] > NEVER {
                self.chain.push(&Pair::even(at, place(g[0], g[1])));
            }
        };
        let joint = left.cell != right.cell;
        // what is between two knots counts at both
        let share = left.accel_share.min(right.accel_share);
        let level = |cell: &Cell| match &cell.demand {
            Demand::Line { accel, .. } => 1.0 / (share * accel),
            Demand::Curve(_) => 0.0,
        };
        let straight = level(cells[left.cell]).max(level(cells[right.cell]));
        if straight > 0.0 {
            add(straight, 0.0);
        }
        let mut here: &[LimitRow] = &[];
        if let Demand::Curve(rows) = &cells[right.cell].demand {
            let x = right.from / cells[right.cell].h;
            between(rows, x).for_each(|r| add(r.a1 / share, r.a2 / share));
            here = rows.at(0);
        }
        if joint
            && cells[left.cell].piece != cells[right.cell].piece
            && let Demand::Curve(rows) = &cells[left.cell].demand
        {
            let before = rows.at(2);
            for (k, r) in before.iter().enumerate() {
                // smooth paths have the same slope and bend on both sides
                let same =
                    |h: &LimitRow| before.len() == here.len() && is(h.a1, r.a1) && is(h.a2, r.a2);
                if !here.get(k).is_some_and(same) {
                    add(r.a1 / share, r.a2 / share);
                }
            }
        }
        if joint {
            let caps = [cells[left.cell].cap, cells[right.cell].cap];
            let own = match cells[right.cell].start {
                Start::On(cap) => cap,
                Start::Rest => 0.0,
            };
            let cap = caps[0].min(caps[1]).min(own);
            if cap < caps[0].max(caps[1]) && most[0].max(most[1]) > NEVER * cap {
                self.chain.push(&Pair::even(at, place(b[0] / cap, b[1] / cap)));
            }
        }
    }

    /// In a cell of the grid.
    fn bound_jerk(&mut self, cells: &[&Cell], shift: usize, k: usize) {
        let count = self.chain.c.len();
        let i = k + shift;
        if i == 0 || i == count - 1 || (i < self.chain.given[0] && shift == 0) {
            return;
        }
        let fine = &self.grid[k];
        let cell = cells[fine.cell];
        let (h0, h, h1) = (self.width[i - 1], self.width[i], self.width[i + 1]);
        let (p, q) = (1.0 / (h0 + h), 1.0 / (h + h1));
        // a and b at both ends, u between them
        let a0 = [-p, p, 0.0];
        let a1 = [0.0, -q, q];
        let u = [p / h, -(p + q) / h, q / h];
        let mean: [f64; 3] = core::array::from_fn(|k| f64::midpoint(a0[k], a1[k]));
        let near = |away: usize| (k + away).checked_sub(1).and_then(|k| self.most.get(k));
        let most = [0, 1, 2].map(|away| near(away).copied().unwrap_or(f64::MAX));
        let scale = 1.0 / libm::sqrt(1.0 / (0.01 + self.chain.c[i] / 0.3));
        let scale = if scale > 0.0 { scale } else { 1.0 };
        let (b0, b1) = ([h * p, h0 * p, 0.0], [0.0, h1 * q, h * q]);
        let mut add = |j: [f64; 3], a: [f64; 3], b: [f64; 3]| {
            let sum = |k: usize| j[0] * u[k] + 3.0 * j[1] * a[k] + j[2] * b[k];
            let g = core::array::from_fn(|k| scale * sum(k) / fine.share);
            let [x, y, z]: [f64; 3] = g;
            let load = x.abs() * most[0] + y.abs() * most[1] + z.abs() * most[2];
            if load > NEVER * scale / libm::sqrt(most[1]) {
                self.chain.push(&Pair::falling(i - 1, g, scale));
            }
        };
        match &cell.demand {
            Demand::Line { jerk, .. } => {
                if jerk.is_finite() {
                    add([1.0 / jerk, 0.0, 0.0], mean, [0.0, 1.0, 0.0]);
                }
            }
            Demand::Curve(rows) => {
                let ends = [(fine.from, a0, b0), (fine.from + fine.h, a1, b1)];
                for (x, a, b) in ends {
                    for r in between(rows, x / cell.h) {
                        if r.j1 != 0.0 || r.j2 != 0.0 || r.j3 != 0.0 {
                            add([r.j1, r.j2, r.j3], a, b);
                        }
                    }
                }
            }
        }
    }
}

/// Whether two numbers are the same but for rounding.
fn is(x: f64, y: f64) -> bool {
    (x - y).abs() <= SAME * (x.abs() + y.abs())
}
