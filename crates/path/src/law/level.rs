//! Where a run holds its highest speed, and nothing happens: steps of the grid may be long there.
//!
//! ```text
//!   ṡ    ╭──────────────┬──────────────╮         │ between two runs of one speed: the level goes on
//!       ╱┆              │              ┆╲
//!      ╱ ┆··  ·   ·     │     ·   ·  ··┆ ╲       · knots: the farther from where the level is reached or left, the
//!        reached       run        left             farther apart
//! ```
use super::cell::{Cell, Demand, LimitRow};
use super::fine::jerk_along;
use super::runs::CellRun;
use alloc::vec::Vec;

/// A step is at most this share of the way to where the level is reached or left.
const STEP: f64 = 0.3;

/// Where the level goes on a little higher or lower, the first step is at least this share of the
/// run.
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
    /// ṡ.
    v: f64,
    /// ṡ^{3/2}.
    top: f64,
    accel: f64,
    jerk: f64,
}

/// What is before a run.
#[derive(Clone, Copy)]
enum Before<'a> {
    /// The window's end.
    Nothing,
    /// A run that bends too much.
    Bent,
    /// One that holds its highest speed from a place on, if that lies in it.
    Held(Held<'a>, f64),
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
                let most = |of: &dyn Fn(&LimitRow) -> f64| {
                    let all = rows.all().iter();
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

    /// How far it is surely reached after so much less.
    fn way(&self, change: f64) -> f64 {
        let Self { v, accel, jerk, .. } = *self;
        let time = if change * jerk < accel * accel {
            2.0 * libm::sqrt(change / jerk)
        } else {
            change / accel + accel / jerk
        };
        2.0 * v * time
    }

    /// Where its level begins, with ṡ^{3/2} = w at most at its own beginning, behind what comes
    /// before.
    fn begins(&self, before: Before<'_>, w: f64) -> f64 {
        let (beside, from) = match before {
            Before::Nothing if w >= self.top * (1.0 - SAME) => return 0.0,
            Before::Nothing | Before::Bent => return self.way(self.v),
            Before::Held(beside, from) => (beside, from - beside.h),
        };
        let change = self.v - beside.v;
        if w < beside.top.min(self.top) * (1.0 - SAME) {
            self.way(self.v)
        } else if change > SAME * self.v {
            self.way(if from < 0.0 { change } else { self.v })
        } else if change < -SAME * self.v {
            // a faster one need not reach its own level before
            from.min(self.way(self.v) - beside.h).max(0.0)
        } else {
            from
        }
    }

    /// Whether it takes little to change to the speed of a run beside it, over so long a way.
    fn is_slight(&self, beside: Option<&Cell>, h: f64) -> bool {
        let change = beside.map_or(0.0, |beside| (beside.cap - self.cell.cap).abs());
        let a = change / (2.0 * h);
        a <= SLIGHT * self.accel && a * self.v / h <= SLIGHT * self.jerk
    }
}

/// The runs' levels; `w` is the fastest ṡ^{3/2} at the cells' beginnings and at the end of the
/// last.
pub(super) fn levels(cells: &[&Cell], runs: &[CellRun], w: &[f64], levels: &mut Vec<Level>) {
    levels.clear();
    // forwards: where each begins
    let mut before = Before::Nothing;
    for run in runs {
        let [first, end] = run.cells;
        let held = Held::new(cells[first], run.h);
        let from = held.map_or(run.h, |held| held.begins(before, w[first]));
        let least = FIRST * run.h;
        let beside = [first.checked_sub(1).map(|i| cells[i]), cells.get(end).copied()];
        let slight = held.is_some_and(|held| beside.iter().all(|b| held.is_slight(*b, least)));
        levels.push(Level { from, to: 0.0, least: if slight { least } else { 0.0 } });
        before = held.map_or(Before::Bent, |held| Before::Held(held, from));
    }
    // backwards, as seen from the end: where each ends
    let mut after = Before::Nothing;
    for (run, level) in runs.iter().zip(levels).rev() {
        let [first, end] = run.cells;
        let held = Held::new(cells[first], run.h);
        let to = held.map_or(run.h, |held| held.begins(after, w[end]));
        level.to = run.h - to;
        after = held.map_or(Before::Bent, |held| Before::Held(held, to));
    }
}
