//! Where a run holds its highest speed, and nothing happens: steps of the grid may be long there.
//!
//! ```text
//!   ṡ    ╭──────────────┬──────────────╮         │ between two runs of one speed: the level goes on
//!       ╱┆              │              ┆╲
//!      ╱ ┆··  ·   ·     │     ·   ·  ··┆ ╲       · knots: the farther from where the level is reached or left, the
//!        reached       run        left             farther apart
//! ```
use super::cell::{Cell, Demand, Row, Rows};
use super::fine::{growth, jerk_along};
use super::runs::Run;
use alloc::vec::Vec;

/// A step is at most this share of the way to where the level is reached or left.
const STEP: f64 = 0.3;

/// Where the level goes on a little higher or lower, the first step is at least this share of the run.
const FIRST: f64 = 0.01;

/// The most that a curve may take of the acceleration and of the jerk at its highest speed.
const TAKEN: f64 = 0.25;

/// As slight is a change of speed that needs this share of what is left of them.
const SLIGHT: f64 = 0.05;

/// Speeds, and their squares, that differ by such a share are one.
const SAME: f64 = 1e-3;

/// A run's level, from the run's beginning on; it may begin before the run and end after it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    from: f64,
    to: f64,
    /// Shortest step within it.
    least: f64,
}

impl Level {
    /// How long a step from a place may be at least.
    pub(super) fn step(&self, x: f64) -> f64 {
        let inside = x >= self.from && x < self.to;
        let least = if inside { self.least } else { 0.0 };
        (STEP * (x - self.from).min(self.to - x)).max(least)
    }
}

/// A run at its highest speed, with the acceleration and the jerk along the path that this leaves.
#[derive(Clone, Copy)]
struct Held<'a> {
    cell: &'a Cell,
    h: f64,
    v: f64,
    /// ṡ^{3/2}.
    top: f64,
    accel: f64,
    jerk: f64,
}

impl<'a> Held<'a> {
    /// `None` where there is not much of them.
    fn new(cell: &'a Cell, h: f64) -> Option<Self> {
        let v = libm::sqrt(cell.cap);
        let top = v * libm::sqrt(v);
        match &cell.demand {
            Demand::Line { accel, jerk } => {
                Some(Self { cell, h, v, top, accel: *accel, jerk: *jerk })
            }
            Demand::Curve(rows) => {
                let most = |of: &dyn Fn(&Row) -> f64| {
                    let all = rows.iter().flat_map(Rows::all);
                    all.fold(0.0, |m: f64, row| m.max(of(row)))
                };
                let bend = most(&|row| row.a2.abs() * cell.cap);
                let twist = most(&|row| row.j3.abs() * cell.cap * v);
                let accel = (1.0 - TAKEN) / most(&|row| row.a1.abs());
                let jerk = (1.0 - TAKEN) * jerk_along(cell);
                (bend.max(twist) <= TAKEN).then_some(Self { cell, h, v, top, accel, jerk })
            }
        }
    }

    /// How far from a place with ṡ^{3/2} = w, or less, it is surely reached.
    fn reached(&self, w: f64) -> f64 {
        let k = growth(self.cell);
        if w >= self.top * (1.0 - SAME) || k.is_infinite() {
            return 0.0;
        }
        let Self { v, accel, jerk, .. } = *self;
        v * v / accel + 2.0 * v * accel / jerk + 4.0 * (self.top - w) / k
    }

    /// How far from the end of a run that held its own, at a place with ṡ^{3/2} = w at most, it is surely reached.
    fn reached_from(&self, beside: &Self, w: f64) -> f64 {
        if w < beside.top.min(self.top) * (1.0 - SAME) {
            return self.reached(w);
        }
        let change = self.v - beside.v;
        if change <= SAME * self.v || self.jerk.is_infinite() {
            return 0.0;
        }
        let Self { accel, jerk, .. } = *self;
        let time = if change * jerk < accel * accel {
            2.0 * libm::sqrt(change / jerk)
        } else {
            change / accel + accel / jerk
        };
        (2.0 * self.v * time).min(self.reached(w))
    }

    /// Where its level begins if the one of the run before it does at `from`, of that.
    fn goes_on(&self, beside: &Self, from: f64, w: f64) -> f64 {
        let own = self.reached_from(beside, w);
        let one = (beside.v - self.v).abs() <= SAME * self.v;
        if own == 0.0 && one { (from - beside.h).min(0.0) } else { own }
    }

    /// Whether it takes little to change to the speed of a run beside it, over so long a way.
    fn is_slight(&self, beside: Option<&Cell>, h: f64) -> bool {
        let change = beside.map_or(0.0, |beside| (beside.cap - self.cell.cap).abs());
        let a = change / (2.0 * h);
        a <= SLIGHT * self.accel && a * self.v / h <= SLIGHT * self.jerk
    }
}

/// The runs' levels; `w` is the fastest ṡ^{3/2} at the cells' beginnings and at the end of the last.
pub(super) fn levels(cells: &[&Cell], runs: &[Run], w: &[f64], levels: &mut Vec<Level>) {
    levels.clear();
    // forwards: where each begins
    let mut before: Option<(Held<'_>, f64)> = None;
    for run in runs {
        let [first, end] = run.cells;
        let held = Held::new(cells[first], run.h);
        let from = match (&held, &before) {
            (None, _) => run.h,
            (Some(held), Some((beside, from))) if *from < beside.h => {
                held.goes_on(beside, *from, w[first])
            }
            (Some(held), _) => held.reached(w[first]),
        };
        let least = FIRST * run.h;
        let beside = [first.checked_sub(1).map(|i| cells[i]), cells.get(end).copied()];
        let slight = held.is_some_and(|held| beside.iter().all(|b| held.is_slight(*b, least)));
        levels.push(Level { from, to: 0.0, least: if slight { least } else { 0.0 } });
        before = held.map(|held| (held, from));
    }
    // backwards, as seen from the end: where each ends
    let mut after: Option<(Held<'_>, f64)> = None;
    for (run, level) in runs.iter().zip(levels).rev() {
        let [first, end] = run.cells;
        let held = Held::new(cells[first], run.h);
        let to = match (&held, &after) {
            (None, _) => run.h,
            (Some(held), Some((beside, to))) if *to < beside.h => {
                held.goes_on(beside, *to, w[end])
            }
            (Some(held), _) => held.reached(w[end]),
        };
        level.to = run.h - to;
        after = held.map(|held| (held, to));
    }
}
