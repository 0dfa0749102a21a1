//! Time along the path: how fast, where.
//!
//! ```text
//!   pieces ─► cells ─► reach (speed, acceleration) ─► smooth (jerk) ─► phases of constant s⃛
//!             a window of them; what cannot change any more, whatever follows, is handed out
//! ```
//!
//! For every axis, with the derivatives of its position by the path's parameter (`geometry`):
//!
//! ```text
//!   |q′·ṡ| ≤ V      |q′·s̈ + q″·ṡ²| ≤ A      |q′·s⃛ + 3·q″·ṡ·s̈ + q‴·ṡ³| ≤ J      ṡ ≤ feed
//! ```
//!
//! The law is as fast as these leave room for, with as many pieces of look-ahead as the braking
//! distance needs. At any time it ends at rest within what is known of the path: when no more
//! pieces arrive, the motion that was planned stops. Nothing in here depends on a clock: the same
//! pieces give the same phases to the last bit, however they arrive.
mod cell;
mod fine;
mod guess;
mod interior;
mod level;
mod phase;
mod reach;
mod refusal;
mod runs;
mod smooth;

use crate::{AXES, Bounds, Derivatives, Limits, Phase, Piece};
use alloc::collections::VecDeque;
use alloc::vec::Vec;
pub(crate) use cell::TOP_SPEED;
use cell::{Cell, Demand, Sampler, Start};
pub use phase::{Timed, merged};
pub use refusal::LawRefusal;
use runs::PhaseCut;
use smooth::{From, Smooth};

/// Fewest cells that are planned together, unless the path ends.
const LEAST: usize = 1024;

/// Most cells that are planned together: braking takes less than these.
const MOST: usize = 1 << 16;

/// So many cells are planned together at least, where the search has failed with more.
const FEWEST: usize = 8;

/// Longest time between two knots of a jerk-limited plan, s, unless the servo period is longer.
const LONGEST_STEP: f64 = 0.02;

/// By how much, as a share, ṡ² may be above what can be kept: rounding.
const ROUNDING: f64 = 1e-6;

/// What the law needs to know beside the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// What the axes can do.
    pub limits: Limits,
    /// Servo period, s: a jump of q″ between two pieces is a jerk over this time.
    pub period: f64,
}

/// Where along a piece, and how fast, motion is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Parameter of the piece, mm.
    pub s: f64,
    /// ṡ, mm/s; not negative.
    pub v: f64,
    /// s̈, mm/s².
    pub a: f64,
}

/// Plans time along pieces that arrive one after another.
///
/// Push pieces, take phases with [`Law::next`]; [`Law::close`] when the path ends. Memory is
/// bounded by the window, not by the path.
#[derive(Clone, Debug)]
pub struct Law {
    config: Config,
    /// Pieces not yet cut into cells.
    pending: VecDeque<Piece>,
    /// The piece that is being cut.
    sampler: Option<Sampler>,
    /// Derivatives at the end of the piece before, and how many pieces were cut.
    before: Option<Derivatives>,
    count: u64,
    /// The window.
    cells: VecDeque<Cell>,
    /// How many cells to gather before planning.
    target: usize,
    /// Motion at the window's start.
    state: State,
    closed: bool,
    ready: VecDeque<Timed>,
    beta: Vec<f64>,
    fast: Vec<f64>,
    /// Memory of `reach`.
    bounds: reach::Bounds,
    /// Whether any axis has a limit of jerk.
    jerky: bool,
    /// Smallest acceleration and smallest jerk of all axes.
    slowest: (f64, f64),
    /// Time between two knots of the jerk-limited plan, s.
    tau: f64,
    /// Width of the plan's next cell, in motion.
    width: Option<f64>,
    smooth: Smooth,
}

/// Smallest acceleration and smallest jerk of all axes.
fn slowest(limits: &Limits) -> (f64, f64) {
    let least = |of: fn(&Bounds) -> &[f64; AXES]| {
        let all = [&limits.feed, &limits.rapid].into_iter().flat_map(of);
        all.filter(|x| **x > 0.0).fold(f64::INFINITY, |m, x| m.min(*x))
    };
    (least(|bounds| &bounds.accel), least(|bounds| &bounds.jerk))
}

/// An eighth of the time in which the acceleration is reached by axes with a limit of jerk, s:
/// within less, hardly any axis can do something else. Zero without a limit of jerk.
pub(crate) fn step(limits: &Limits) -> f64 {
    let all = [&limits.feed, &limits.rapid].into_iter();
    let axes = all.flat_map(|bounds| bounds.accel.iter().zip(&bounds.jerk));
    let jerky = axes.filter(|(accel, jerk)| **accel > 0.0 && **jerk > 0.0 && jerk.is_finite());
    let least = |m: (f64, f64), (accel, jerk): (&f64, &f64)| (m.0.min(*accel), m.1.min(*jerk));
    let (accel, jerk) = jerky.fold((f64::INFINITY, f64::INFINITY), least);
    if jerk.is_finite() { accel / jerk / 8.0 } else { 0.0 }
}

/// A quarter of the shortest oscillation from one side of a tolerance to the other, s (Favard:
/// within τ a jerk of J leads J·τ³/12 off at most). Zero without a limit of jerk.
pub(crate) fn shortest_oscillation(tolerance: f64, limits: &Limits) -> f64 {
    libm::cbrt(12.0 * 1.5 * tolerance / slowest(limits).1) / 4.0
}

impl Law {
    /// From rest.
    pub fn new(config: Config) -> Self {
        Self::resuming(config, State::default())
    }

    /// From motion that is under way: the first piece to be pushed is at `state.s`, and goes on
    /// from there. For changes of the feed, and for holding it, at any instant: push the rest of
    /// the path again, with another feed.
    pub fn resuming(config: Config, state: State) -> Self {
        let slowest = slowest(&config.limits);
        // over revolutions a period may be longer than the longest step
        let tau = step(&config.limits).min(LONGEST_STEP).max(config.period);
        Self {
            config,
            pending: VecDeque::new(),
            sampler: None,
            before: None,
            count: 0,
            cells: VecDeque::new(),
            target: LEAST,
            state,
            closed: false,
            ready: VecDeque::new(),
            beta: Vec::new(),
            fast: Vec::new(),
            bounds: reach::Bounds::default(),
            jerky: slowest.1.is_finite(),
            slowest,
            tau,
            width: (state.v > 0.0)
                .then_some((tau * state.v).min(0.5 * state.v * state.v / state.a.abs())),
            smooth: Smooth::default(),
        }
    }

    /// The next piece of the path.
    ///
    /// # Errors
    /// When no motion along it is possible: an axis that must move and may not, a length without
    /// meaning.
    pub fn push(&mut self, piece: Piece) -> Result<(), LawRefusal> {
        refusal::check(&piece, &self.config.limits)?;
        self.pending.push_back(piece);
        Ok(())
    }

    /// Have a way to rest within what is known, before motion that is under way goes on along it;
    /// `false`: there is none within all limits, and another law of time has to go on.
    pub fn prepare(&mut self) -> bool {
        let target = core::mem::replace(&mut self.target, MOST);
        self.gather();
        self.target = target;
        if self.cells.is_empty() {
            return true;
        }
        let count = self.until_rest().map_or(self.cells.len(), |k| k + 1);
        self.beta.resize(count + 1, 0.0);
        reach::backwards(self.cells.range(..count), &mut self.beta, &mut self.bounds);
        if self.state.v * self.state.v > self.beta[0] * (1.0 + ROUNDING) {
            return false;
        }
        let found = !self.jerky || self.find(count) || self.slow_down(count);
        if self.jerky && found {
            self.smooth.keep(0, 0);
        }
        found
    }

    /// The path ends with the last piece, at rest.
    pub fn close(&mut self) {
        self.closed = true;
    }

    /// The next phase; `None`: more pieces are needed, or the path has ended.
    #[allow(clippy::should_implement_trait)] // `None` is not the end
    pub fn next(&mut self) -> Option<Timed> {
        loop {
            if let Some(timed) = self.ready.pop_front() {
                return Some(timed);
            }
            self.gather();
            let enough = self.closed || self.cells.len() >= self.target;
            if !enough || self.cells.is_empty() {
                return None;
            }
            self.plan();
        }
    }

    /// Cut pieces into cells until the window is full.
    fn gather(&mut self) {
        while self.cells.len() < self.target {
            if let Some(sampler) = &mut self.sampler {
                if let Some(cell) = sampler.next(&self.config.limits) {
                    self.cells.push_back(cell);
                    continue;
                }
                self.before = Some(sampler.end());
                self.sampler = None;
            }
            let Some(piece) = self.pending.pop_front() else { return };
            let from = if self.count == 0 { self.state.s } else { 0.0 };
            let (limits, period) = (&self.config.limits, self.config.period);
            self.sampler =
                Some(Sampler::new(&piece, self.count, from, self.before.as_ref(), limits, period));
            self.count += 1;
        }
    }

    /// Plan the window and hand out what is settled.
    fn plan(&mut self) {
        // up to the next rest the path is on its own
        let rest = self.until_rest();
        let ends = rest.is_some() || (self.closed && self.exhausted());
        let count = rest.map_or(self.cells.len(), |k| k + 1);
        self.beta.resize(count + 1, 0.0);
        let settled = reach::backwards(self.cells.range(..count), &mut self.beta, &mut self.bounds);
        let commit = match (ends, self.jerky) {
            (true, _) => Some(count),
            (false, true) => self.foreseen(count),
            (false, false) => (settled > 0).then_some(settled),
        };
        let commit = match commit {
            Some(commit) => commit,
            // braking takes more than is known: look further, if that is allowed
            None if self.target < MOST => {
                self.target *= 2;
                return;
            }
            None => count / 2,
        };
        if self.jerky {
            if !(ends && self.line_alone(count)) {
                self.plan_smoothly(count, commit, ends);
            }
        } else {
            self.hand_out(commit);
        }
        if !ends {
            self.target = (4 * (count - commit)).clamp(LEAST, MOST);
        }
    }

    /// The last cell before the path's next rest.
    fn until_rest(&self) -> Option<usize> {
        self.cells.iter().skip(1).position(|cell| cell.start == Start::Rest)
    }

    /// How many cells of a window that does not end the path may be handed out: those that lie
    /// further from its end than braking takes; `None` when that is less than half of them.
    fn foreseen(&mut self, count: usize) -> Option<usize> {
        self.forwards(count);
        let mut left = 0.0;
        let top = self.fast.iter().fold(0.0, |m: f64, b| m.max(*b));
        let enough =
            2.0 * (libm::sqrt(top) / self.slowest.0 + 2.0 * self.slowest.0 / self.slowest.1);
        for i in (0..count).rev() {
            let sum = libm::sqrt(self.fast[i]) + libm::sqrt(self.fast[i + 1]);
            left += 2.0 * self.cells[i].h / sum.max(1e-9);
            if left >= enough {
                return (i > count / 2).then_some(i);
            }
        }
        None
    }

    /// ṡ² at the first cells' beginnings, and the last one's end, without a limit of jerk.
    fn forwards(&mut self, count: usize) {
        self.fast.clear();
        let mut b = self.state.v * self.state.v;
        self.fast.push(b);
        for (i, cell) in self.cells.range(..count).enumerate() {
            // a plan with a limit of jerk may be a little above what can be kept, from where there
            // is no way on
            b = reach::forwards(cell, b.min(self.beta[i]), self.beta[i + 1], &mut self.bounds);
            self.fast.push(b);
        }
    }

    /// With a limit of jerk: plan `count` cells to rest, and hand out the first `commit` of them.
    ///
    /// Where the search fails from rest, less of the path is planned, to a stop within it: that
    /// takes a part of a second, and to be slow all along would take many.
    fn plan_smoothly(&mut self, mut count: usize, mut commit: usize, mut ends: bool) {
        while !self.find(count) {
            if self.width.is_some() {
                self.finish_old(count);
                return;
            }
            if count <= FEWEST {
                self.slow_down(count);
                break;
            }
            count /= 2;
            (commit, ends) = (count, true);
            self.beta.truncate(count + 1);
            reach::backwards(self.cells.range(..count), &mut self.beta, &mut self.bounds);
        }
        let (first, commit) = self.smooth.until(commit, !(ends && commit == count));
        for fine in &self.smooth.grid[..first] {
            runs::hand_out(&self.cells, fine, &mut self.ready);
        }
        self.cells.drain(..commit);
        if let Some(fine) = self.smooth.grid.get(first) {
            self.state = State { s: 0.0, v: fine.v, a: fine.a };
            self.width = Some(fine.h);
            self.smooth.keep(first, commit);
        } else {
            self.state = State::default();
            self.width = None;
            self.smooth.keep(first, 0);
        }
    }

    /// With a limit of jerk: a plan over `count` cells to rest; whether there is one.
    fn find(&mut self, count: usize) -> bool {
        self.forwards(count);
        let from = match self.width {
            None => From::Rest,
            Some(h) => From::Moving(self.state, h),
        };
        let cells: Vec<&Cell> = self.cells.range(..count).collect();
        self.smooth.plan(&cells, &self.fast, from, self.tau)
    }

    /// The same from rest, where the search has failed: slower all along; `false`: it is not from
    /// rest.
    fn slow_down(&mut self, count: usize) -> bool {
        let is_from_rest = self.width.is_none();
        if is_from_rest {
            let cells: Vec<&Cell> = self.cells.range(..count).collect();
            self.smooth.slow_down(&cells);
        }
        is_from_rest
    }

    /// With a limit of jerk: hand out the first cells in closed form, if they are one line, from
    /// rest; it is to end at rest.
    fn line_alone(&mut self, count: usize) -> bool {
        let Some(Cell { cap, demand: Demand::Line { accel, jerk }, .. }) =
            self.cells.front().cloned()
        else {
            return false;
        };
        let bounded = accel.is_finite() && jerk.is_finite();
        if self.width.is_some() || !bounded || !runs::one_line(self.cells.range(..count)) {
            return false;
        }
        let length = self.cells.range(..count).map(|cell| cell.h).sum();
        let mut cut = PhaseCut::new(&self.cells, 0, 0.0, length, &mut self.ready);
        phase::from_rest_to_rest(length, accel, jerk, cap, |phase| cut.give(phase));
        self.cells.drain(..count);
        self.state = State::default();
        true
    }

    /// No better plan was found: go on with the one before, which ends at rest within what was
    /// known then.
    fn finish_old(&mut self, count: usize) {
        if self.smooth.old.is_empty() {
            // there is none: motion was under way when planning began. Brake as the accelerations
            // allow
            self.hand_out(count);
            self.width = None;
            return;
        }
        let mut last = 0;
        for fine in &self.smooth.old {
            last = runs::hand_out(&self.cells, fine, &mut self.ready);
        }
        self.cells.drain(..=last);
        self.smooth.old.clear();
        self.state = State::default();
        self.width = None;
    }

    /// Whether all pieces are in the window.
    fn exhausted(&self) -> bool {
        self.pending.is_empty() && self.sampler.is_none()
    }

    /// Without a limit of jerk: the first cells of the window, as fast as β allows.
    fn hand_out(&mut self, commit: usize) {
        let mut b = self.state.v * self.state.v;
        for (i, cell) in self.cells.drain(..commit).enumerate() {
            let end = reach::forwards(&cell, b, self.beta[i + 1], &mut self.bounds);
            let ready = &mut self.ready;
            let give = |phase: Phase| {
                let phase = Phase { s: phase.s + cell.from, ..phase };
                ready.push_back(Timed { piece: cell.piece, phase });
            };
            match cell.demand {
                Demand::Line { accel, .. } => {
                    phase::over_line(cell.h, accel, cell.cap, b, end, give);
                }
                Demand::Curve(rows) => phase::over_curve(&rows, cell.h, cell.cap, (b, end), give),
            }
            b = end;
        }
        self.state = State { s: 0.0, v: libm::sqrt(b), a: 0.0 };
    }
}
