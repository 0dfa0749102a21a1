//! Jerk: the fastest law with a limit on s⃛ as well.
//!
//! ```text
//!   b = ṡ²        ●───────●                 c: control values; b is a curve of second degree in each cell, with
//!             ●───┈┈┈╮ ╭┈┈┈───●             b₍knot₎ between two c, a = ½·db/ds the slope of the line that joins them,
//!        ●──┈┈│      │ │          ●         u = da/ds constant in a cell
//!      knots  ┊  h   ┊ h ┊
//! ```
//!
//! With b as unknown, speed and acceleration are straight bounds and jerk is q′·u + 3·q″·a + q‴·b ≤
//! J/√b; the whole is a chain on which each bound meets three neighbours, and `interior` finds the
//! fastest.
//!
//! The grid has knots about τ apart in time, as fast as a jerk-limited motion may at most be: from
//! a place where it goes at v it can be at most at w = v^{3/2} + 2.12·√J·Δs later, since from rest
//! s = J·t³/6 and ṡ = J·t²/2; farther apart where a speed is held (`level`). At rest the first cell
//! is that motion itself: b ~ s^{4/3}, whose tangent at its end, d, meets zero at d/4: seen from
//! the next cell it is a cell of width 3d/2 with the value 0.
mod bounds;

use super::State;
use super::cell::{Cell, Demand, LimitRow};
use super::fine::{Fine, JERK_SHARE, growth, growth_in_steps, jerk_along};
use super::guess::Guess;
use super::interior::{Chain, FIRST, GAP};
use super::level::{Level, levels};
use super::runs::{CellRun, runs};
use alloc::vec::Vec;

/// From rest, b = this · J^{2/3} · s^{4/3}.
const FROM_REST: f64 = 2.725_681_118_082_556;

/// By how much the bounds may be exceeded where the search begins, and where it must begin within
/// them.
const START: f64 = f64::INFINITY;
const WITHIN: f64 = -0.02;

/// Where a search begins, and where it begins again when that has led nowhere: how far in time the
/// guess looks, as a share of the grid's step, and [`FIRST`].
const STARTS: [(f64, f64); 3] = [(1.0, FIRST), (4.0, 0.05), (16.0, 0.01)];

/// How near to the optimum a search comes before its plan is looked at the first time, and the next
/// one; after these [`GAP`].
const ROUGH: f64 = 25.0 * GAP;
const NEARER: f64 = 3.0 * GAP;

/// How often a plan is corrected, and from what share of the limits of acceleration and jerk on.
const REFINEMENTS: usize = 8;
const ACCEL_TOLERANCE: f64 = 1.005;
const TOLERANCE: f64 = 1.01;
const ENOUGH: f64 = 1.03;
/// What is over a limit of acceleration counts as so many times as much over that of jerk.
const STRICTER: f64 = 4.0;

/// Longest cell near rest, as a share of the distance from rest.
const NEAR_REST: f64 = 0.4;

/// Shortest step as a share of its run, and most knots of a grid; what needs more is planned in
/// halves, and at last with steps of this share.
const FINEST: f64 = 1e-7;
const MOST_KNOTS: usize = 1 << 17;
const COARSEST: f64 = 1.0 / 64.0;

/// Reusable memory of the planner.
#[derive(Clone, Debug, Default)]
pub(super) struct Smooth {
    pub(super) grid: Vec<Fine>,
    chain: Chain,
    /// Fastest ṡ^{3/2} at each cell's beginning.
    w: Vec<f64>,
    /// Widths of the chain's cells.
    width: Vec<f64>,
    /// What is left of the plan before, from where this window begins.
    pub(super) old: Vec<Fine>,
    /// Largest ṡ² of each cell of the grid, and where the search begins.
    most: Vec<f64>,
    first: Vec<f64>,
    guess: Guess,
    /// How far in time the guess looks, s.
    near: f64,
    spare: Vec<f64>,
    /// The window's cells, as the grid sees them.
    runs: Vec<CellRun>,
    levels: Vec<Level>,
}

/// How the window begins.
#[derive(Clone, Copy, Debug)]
pub(super) enum From {
    Rest,
    /// In motion; with the width of the first cell.
    Moving(State, f64),
}

impl Smooth {
    /// Plan cells from `from` to rest; `fast` is ṡ² at the cells' beginnings and the last one's end
    /// without a limit of jerk.
    ///
    /// `false`: nothing within the limits was found; from rest [`Self::slow_down`] has a plan then.
    pub(super) fn plan(&mut self, cells: &[&Cell], fast: &[f64], from: From, tau: f64) -> bool {
        self.speeds(cells, fast, from);
        runs(cells, tau, &mut self.runs);
        if !self.lay(cells, from, tau, FINEST) {
            self.lay(cells, from, tau, COARSEST);
            return false;
        }
        STARTS.iter().any(|(near, first)| {
            self.near = near * tau;
            for fine in &mut self.grid {
                *fine = Fine::new(fine.cell, fine.from, fine.h);
            }
            self.pose(cells, from, START);
            if self.chain.solve(Some(*first), ROUGH).is_none() {
                return false;
            }
            self.read(from);
            self.refine(cells, from)
        })
    }

    /// The jerk of the motion at the knots may be a little more than it was in the equations, where
    /// the speed changes much within a cell: there, plan with less.
    fn refine(&mut self, cells: &[&Cell], from: From) -> bool {
        let mut close = ROUGH;
        for round in 0..REFINEMENTS {
            // a little is corrected twice near the optimum, much until it is gone
            let most = self.tighten(cells);
            if close == GAP && (most <= TOLERANCE || (round > 2 && most <= ENOUGH)) {
                return true;
            }
            close = if round == 0 && most > ENOUGH { NEARER } else { GAP };
            core::mem::swap(&mut self.spare, &mut self.chain.c);
            self.pose(cells, from, START);
            for i in self.chain.given[0]..self.chain.c.len() - 1 {
                self.chain.c[i] = self.spare[i];
            }
            if self.chain.solve(None, close).is_none() {
                return false;
            }
            self.read(from);
        }
        self.tighten(cells) <= ENOUGH
    }

    /// Slower all along, until the motion at the knots is within the limits of jerk; from rest to
    /// rest, of the cells that were planned last.
    pub(super) fn slow_down(&mut self, cells: &[&Cell]) {
        let from = From::Rest;
        for fine in &mut self.grid {
            fine.share = JERK_SHARE;
        }
        self.pose(cells, from, WITHIN);
        for _ in 0..20 {
            self.read(from);
            if self.tighten(cells) <= ENOUGH {
                return;
            }
            self.chain.c.iter_mut().for_each(|c| *c *= 0.7);
        }
    }

    /// Less of the acceleration and of the jerk for cells that have too much of it; the most that
    /// any has, over its limit.
    fn tighten(&mut self, cells: &[&Cell]) -> f64 {
        let mut all = 0.0_f64;
        for k in 0..self.grid.len() {
            let (accel, jerk) = self.grid[k].loads(cells[self.grid[k].cell]);
            all = all.max(jerk).max(TOLERANCE + STRICTER * (accel - ACCEL_TOLERANCE));
            if accel > ACCEL_TOLERANCE {
                let fine = &mut self.grid[k];
                fine.accel_share = (fine.accel_share / accel).max(0.05);
            }
            if jerk > TOLERANCE {
                for near in &mut self.grid[k.saturating_sub(1)..=k] {
                    near.share = near.share.min(near.share / jerk).max(0.05);
                }
            }
        }
        all
    }

    /// Upper bounds of speed.
    fn speeds(&mut self, cells: &[&Cell], fast: &[f64], from: From) {
        self.w.clear();
        self.w.extend(fast.iter().map(|b| three_quarters(*b)));
        let n = cells.len();
        for (i, cell) in cells.iter().enumerate() {
            // where q‴ takes all the jerk
            if let Demand::Curve(rows) = &cell.demand {
                let twist = |r: &[LimitRow]| r.iter().fold(0.0, |m: f64, row| m.max(row.j3.abs()));
                self.w[i] = self.w[i].min(libm::sqrt(1.5 / twist(rows.at(0)).max(1e-300)));
                self.w[i + 1] = self.w[i + 1].min(libm::sqrt(1.5 / twist(rows.at(2)).max(1e-300)));
            }
        }
        if let From::Moving(state, _) = from {
            self.w[0] = state.v * libm::sqrt(state.v);
        }
        for (i, cell) in cells.iter().enumerate() {
            self.w[i + 1] = self.w[i + 1].min(self.w[i] + growth(cell) * cell.h);
        }
        for i in (0..n).rev() {
            self.w[i] = self.w[i].min(self.w[i + 1] + growth(cells[i]) * cells[i].h);
        }
    }

    /// Fastest ṡ^{3/2} within a run.
    fn w_at(&self, cells: &[&Cell], run: &CellRun, x: f64) -> f64 {
        let [i, end] = run.cells;
        let k = growth(cells[i]);
        let cap = three_quarters(cells[i].cap);
        (self.w[i] + k * x).min(self.w[end] + k * (run.h - x)).min(cap)
    }

    /// Lay the knots, with steps of this share of a run at least; `false`: these are too many.
    fn lay(&mut self, cells: &[&Cell], from: From, tau: f64, finest: f64) -> bool {
        self.grid.clear();
        levels(cells, &self.runs, &self.w, &mut self.levels);
        let last = self.runs.len() - 1;
        for (number, run) in self.runs.iter().enumerate() {
            let i = run.cells[0];
            let cell = cells[i];
            let (mut x, mut end) = (0.0, run.h);
            let mut push = |x: f64, h: f64| self.grid.push(Fine::new(i, x, h));
            let rest = || {
                let j = jerk_along(cell);
                let d = if j.is_finite() { j * tau * tau * tau / 6.0 } else { f64::INFINITY };
                d.min(0.2 * run.h)
            };
            if number == last {
                end -= rest();
            }
            match from {
                From::Rest if number == 0 => {
                    x = rest();
                    push(0.0, x);
                }
                From::Moving(_, h) if number == 0 => {
                    x = if 1.5 * h > end { end } else { h };
                    push(0.0, x);
                }
                From::Rest | From::Moving(..) => {}
            }
            let k = growth_in_steps(cell, tau);
            let level = self.levels[number];
            while x < end {
                if self.grid.len() > MOST_KNOTS {
                    return false;
                }
                let step = |w: f64| {
                    let v = libm::cbrt(w * w);
                    let near = if k.is_finite() { NEAR_REST * w / k } else { f64::INFINITY };
                    (tau * v).min(near).max(finest * run.h)
                };
                let w = self.w_at(cells, run, x);
                let mut h = step(w).min(end - x);
                for _ in 0..2 {
                    h = h.min(step(self.w_at(cells, run, x + h)) * 1.2);
                }
                // at the feed, far from where it is reached and left, nothing happens
                h = h.max(level.step(x)).min(end - x);
                // no crumbs
                if end - x < 1.5 * h {
                    h = end - x;
                }
                self.grid.push(Fine::new(i, x, h));
                x = if h >= end - x { end } else { x + h };
            }
            if number == last {
                self.grid.push(Fine::new(i, end, run.h - end));
            }
        }
        true
    }

    /// Write the problem down.
    fn pose(&mut self, cells: &[&Cell], from: From, enough: f64) {
        let n = self.grid.len();
        let chain = &mut self.chain;
        chain.clear();
        self.width.clear();
        let rest_left = matches!(from, From::Rest);
        // the chain's unknowns: one per cell of the grid, with a cell at rest seen as in the
        // header; in motion one before
        if let From::Moving(state, _) = from {
            let h = self.grid[0].h;
            chain.c.push(state.v * state.v - h * state.a);
            chain.weight.push(0.0);
            chain.cap.push(f64::INFINITY);
            self.width.push(h);
        }
        for (k, fine) in self.grid.iter().enumerate() {
            let at_rest = (k == 0 && rest_left) || k == n - 1;
            let cell = cells[fine.cell];
            if at_rest {
                chain.c.push(0.0);
                chain.weight.push(0.0);
                chain.cap.push(f64::INFINITY);
                self.width.push(1.5 * fine.h);
                continue;
            }
            chain.weight.push(fine.h);
            chain.cap.push(cell.cap);
            self.width.push(fine.h);
            chain.c.push(0.0);
        }
        chain.given = [if rest_left { 1 } else { 2 }, 1];
        let shift = usize::from(!rest_left);
        if let From::Moving(state, _) = from {
            chain.c[1] = state.v * state.v + self.grid[0].h * state.a;
        }
        // rest cells: their time, and what their jerk allows
        let mut at_rest = |rest: usize, next: usize, k: usize| {
            let d = self.grid[k].h;
            let share = self.width[rest] / (self.width[rest] + self.width[next]);
            let j = self.grid[k].share * jerk_along(cells[self.grid[k].cell]);
            chain.weight[next] += 3.0 * d / libm::sqrt(share);
            if j.is_finite() {
                let b = FROM_REST * libm::cbrt(j * d * d * j * d * d);
                chain.cap[next] = chain.cap[next].min(b / share);
            }
        };
        if rest_left {
            at_rest(0, 1, 0);
        }
        let m = self.width.len();
        at_rest(m - 1, m - 2, n - 1);
        self.guess(cells);
        self.begin(shift, 1.0);
        self.bound(cells, shift);
        self.calm(shift, enough);
    }

    /// Where the search begins.
    fn guess(&mut self, cells: &[&Cell]) {
        self.most.clear();
        let mut fines = self.grid.iter().peekable();
        for run in &self.runs {
            while let Some(fine) = fines.next_if(|fine| fine.cell == run.cells[0]) {
                let w = self.w_at(cells, run, fine.from + fine.h / 2.0);
                self.most.push(w * libm::cbrt(w));
            }
        }
        self.first.clone_from(&self.most);
        self.guess.below(&mut self.first, self.grid.iter().map(|fine| fine.h), self.near);
        self.as_before();
    }

    /// What is under way is a motion that can be: begin with it, as long as it is not slower.
    fn as_before(&mut self) {
        let mut old = self.old.iter().peekable();
        let all = self.grid.iter().zip(&self.most).zip(&mut self.first);
        for ((fine, most), first) in all {
            let begins = (fine.cell, fine.from);
            while old.next_if(|o| (o.cell, o.from + o.h) <= begins).is_some() {}
            let Some(o) = old.peek().filter(|o| (o.cell, o.from) <= begins) else { continue };
            let (x, u) = (fine.from - o.from, (o.a1 - o.a) / o.h);
            let c = o.v * o.v + x * (2.0 * o.a + u * x) + fine.h * (o.a + u * x);
            if c > *first {
                *first = c.min(*most);
            }
        }
    }

    /// Begin the search with the guess, made slower.
    fn begin(&mut self, shift: usize, scale: f64) {
        for k in 0..self.grid.len() {
            let i = k + shift;
            if i >= self.chain.given[0] && i + 1 < self.chain.c.len() {
                self.chain.c[i] = scale * self.first[k];
            }
        }
    }

    /// Slower, until it is within the limits; in motion at least nearly.
    fn calm(&mut self, shift: usize, enough: f64) {
        let mut scale = 1.0;
        for _ in 0..20 {
            let excess = self.chain.excess();
            if excess <= enough || scale < 1e-9 {
                return;
            }
            scale *= 0.9 * libm::pow((1.0 + excess).clamp(0.9, 30.0), -2.0 / 3.0);
            self.begin(shift, scale);
        }
    }

    /// How many cells of the grid, and how many of the path, end with the run before cell `commit`;
    /// where more motion is to follow, there is a run left for it.
    pub(super) fn until(&self, commit: usize, more: bool) -> (usize, usize) {
        let from = |cell: usize| self.grid.iter().position(|fine| fine.cell >= cell);
        let first = match (from(commit), more) {
            (Some(first), _) => first,
            (None, false) => return (self.grid.len(), commit),
            (None, true) => self.grid.last().and_then(|last| from(last.cell)).unwrap_or(0),
        };
        (first, self.grid[first].cell)
    }

    /// Keep what is left of the plan from cell `commit` on, for the next.
    pub(super) fn keep(&mut self, first: usize, commit: usize) {
        self.old.clear();
        self.old.extend(
            self.grid[first..].iter().map(|fine| Fine { cell: fine.cell - commit, ..*fine }),
        );
    }

    /// Motion at the knots.
    fn read(&mut self, from: From) {
        let n = self.grid.len();
        let shift = usize::from(matches!(from, From::Moving(..)));
        let (c, width) = (&self.chain.c, &self.width);
        let mut before = match from {
            From::Rest => (0.0, 0.0),
            From::Moving(state, _) => (state.v, state.a),
        };
        for k in 0..n {
            let after = if k == n - 1 {
                (0.0, 0.0)
            } else {
                let i = k + shift;
                let both = width[i] + width[i + 1];
                let b = (c[i] * width[i + 1] + c[i + 1] * width[i]) / both;
                (libm::sqrt(b.max(0.0)), (c[i + 1] - c[i]) / both)
            };
            let fine = &mut self.grid[k];
            (fine.v, fine.a) = before;
            (fine.v1, fine.a1) = after;
            before = after;
        }
    }
}

/// b^¾.
fn three_quarters(b: f64) -> f64 {
    let root = libm::sqrt(b);
    root * libm::sqrt(root)
}
