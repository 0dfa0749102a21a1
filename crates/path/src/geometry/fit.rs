//! One curve through many short moves.
//!
//! ```text
//!    ●╶╶╶●                 q(u) = Σ Nⱼ(u)·Pⱼ       a cubic spline: q, q′, q″ go on over its knots, q‴ is constant
//!   ╱ ~~~~ ╲ ~~                                    between them
//!  ●         ●──●          |q(u) − p(u)| ≤ P       at every programmed point, and between them
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | u | length along the programmed path |
//! | p | its places; beside a corner of lines those of `fillet`, with a smaller P |
//! | Nⱼ, Pⱼ | the spline's basis (de Boor) and its control points |
//!
//! Control points begin on the programmed path (which makes the spline smoother than the path,
//! whatever the way it was chopped). Each sample that is too far off moves the four control points
//! that have a say in it by the least that brings it back: projections onto convex sets, which end
//! in a point that is in all of them, if there is one. If there is none, knots are halved where it
//! fails; with knots close enough there always is one. Of all such curves, `tube` then finds the
//! one that bends least, and `fastest`, from there, the one that takes the least time. Position,
//! slope and bend at both ends are given, which fixes three control points each.
mod quicken;

use super::fastest::{Fastest, Rests};
use super::fillet::allowed;
use super::joint::{Segment, Waiting, distance};
use super::knots::{self, Way};
use super::load::LimitPoint;
use super::sample::{NEAR, Sample};
use super::spline::Knots;
use super::tube::Tube;
use alloc::vec::Vec;
use motion::{AXES, Derivatives, Limits, Point, Polynomial};

/// Share of it that midway between two samples is kept.
const BETWEEN: f64 = 0.998;
/// Sweeps over all samples before knots are halved.
const SWEEPS: usize = 24;
/// Sweeps to bring samples back after smoothing.
const BACK: usize = 32;
/// How often knots may be halved.
const HALVINGS: usize = 12;

/// Fits curves; keeps its memory from one to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fitter {
    starts: Vec<f64>,
    /// Without the repetition at the ends.
    knots: Vec<f64>,
    control: Vec<Point>,
    samples: Vec<Sample>,
    /// Midway between them.
    between: Vec<Sample>,
    /// By span: first sample of it.
    bad: Vec<usize>,
    /// Axes from this one on do not move.
    axes: usize,
    spare: Vec<Point>,
    /// For X Y Z alone, and with all others.
    linear: Tube<3>,
    all: Tube<AXES>,
    /// See `twist`.
    bends: Vec<([f64; 3], f64)>,
    total: f64,
    places: Vec<LimitPoint>,
    fastest_linear: Fastest<3, 4>,
    fastest_of_all: Fastest<AXES, { AXES + 1 }>,
    /// A slower curve, in case that the fastest one is not good.
    kept: (Vec<f64>, Vec<Point>),
}

impl Fitter {
    /// Fit: from `begun` mm into the first move to `end` mm into the last.
    pub(crate) fn fit(
        &mut self,
        moves: &[Waiting],
        begun: f64,
        end: f64,
        from: &Derivatives,
        to: &Derivatives,
        (limits, rests): (&Limits, Rests),
    ) {
        self.starts.clear();
        let mut u = -begun;
        for one in moves {
            self.starts.push(u);
            u += one.length();
        }
        self.total = self.starts[moves.len() - 1] + end;
        let moves_at_all =
            |i: usize| moves.iter().any(|one| one.start.q1[i] != 0.0 || one.start.q2[i] != 0.0);
        self.axes = (0..AXES).rev().find(|i| moves_at_all(*i)).map_or(0, |i| i + 1);
        let starts = core::mem::take(&mut self.starts);
        let way = Way { moves, starts: &starts, total: self.total };
        knots::choose(&way, &mut self.knots);
        for halvings in 0..=HALVINGS {
            self.begin(&way, from, to);
            if self.settle() || halvings == HALVINGS {
                break;
            }
            self.halve();
        }
        self.quicken(&way, limits, rests);
        self.starts = starts;
    }

    /// How many pieces there are.
    pub(crate) fn spans(&self) -> usize {
        self.knots.len() - 1
    }

    /// Length of the way.
    pub(crate) const fn total(&self) -> f64 {
        self.total
    }

    pub(crate) fn knot(&self, index: usize) -> f64 {
        self.knots[index]
    }

    /// Where a move begins.
    pub(crate) fn start_of(&self, index: usize) -> f64 {
        self.starts[index]
    }

    /// Move at a parameter, and how far into it.
    pub(crate) fn place(&self, u: f64) -> (usize, f64) {
        let i = self.starts.partition_point(|start| *start <= u).max(1) - 1;
        (i, u - self.starts[i])
    }

    /// A piece, and what it serves.
    pub(crate) fn span(&self, span: usize, moves: &[Waiting]) -> (Segment, Polynomial) {
        let (a, b) = (self.knots[span], self.knots[span + 1]);
        let way = Way { moves, starts: &self.starts, total: self.total };
        (serves(&way, a, b), self.polynomial(span))
    }

    fn t(&self, index: usize) -> f64 {
        Knots(&self.knots).t(index)
    }

    fn begin(&mut self, way: &Way, from: &Derivatives, to: &Derivatives) {
        let count = self.knots.len() + 2;
        self.control.clear();
        for j in 0..count {
            let greville = (self.t(j + 1) + self.t(j + 2) + self.t(j + 3)) / 3.0;
            self.control.push(way.at(greville));
        }
        let ends = [(from, 0, 1, 2, 1.0, self.knots[1], self.knots[2]), {
            let n = self.knots.len();
            let back = |i: usize| self.knots[n - 1] - self.knots[n - 1 - i];
            (to, count - 1, count - 2, count - 3, -1.0, back(1), back(2))
        }];
        for (at, p0, p1, p2, sign, t1, t2) in ends {
            for i in 0..AXES {
                let (v, a) = (sign * at.q1[i], at.q2[i]);
                self.control[p0][i] = at.q[i];
                self.control[p1][i] = at.q[i] + v * t1 / 3.0;
                self.control[p2][i] = self.control[p1][i] + (v + a * t1 / 2.0) * t2 / 3.0;
            }
        }
        self.sample(way);
        self.twist();
    }

    fn sample(&mut self, way: &Way) {
        self.samples.clear();
        self.between.clear();
        let mut span = 0;
        for i in 0..way.moves.len() {
            let segment = &way.moves[i].segment;
            let (from, to) = (
                way.starts[i].max(0.0),
                way.starts.get(i + 1).copied().unwrap_or(way.total).min(way.total),
            );
            if i > 0 {
                let tolerance = segment.tolerance.min(way.moves[i - 1].segment.tolerance);
                let sample = self.look(way, i, from, tolerance, &mut span);
                self.samples.push(sample);
            }
            let mut before = from;
            let mut at = span;
            let mut add = |fitter: &mut Self, u: f64, within: &mut usize| {
                let tolerance = segment.tolerance;
                let midway = fitter.look(way, i, f64::midpoint(before, u), tolerance, &mut at);
                fitter.between.push(midway);
                before = u;
                let sample = fitter.look(way, i, u, tolerance, within);
                fitter.samples.push(sample);
            };
            let mut begin = from;
            while begin < to {
                while span + 2 < self.knots.len() && self.knots[span + 1] <= begin {
                    span += 1;
                }
                let last = span + 2 >= self.knots.len();
                let end = if last { to } else { self.knots[span + 1].min(to) };
                let (gap, h) = (end - begin, self.knots[span + 1] - self.knots[span]);
                let inner =
                    if gap < h / 12.0 { 0 } else { 1 + libm::floor(gap / h * 4.0) as usize };
                let mut within = span;
                for n in 1..=inner {
                    let u = begin + gap * n as f64 / (inner + 1) as f64;
                    add(self, u, &mut within);
                }
                if end < to {
                    add(self, end, &mut within);
                }
                begin = end;
            }
            let midway = f64::midpoint(before, to);
            let midway = self.look(way, i, midway, segment.tolerance, &mut at);
            self.between.push(midway);
        }
    }

    /// A place of a move; `span` is not behind it.
    fn look(&self, way: &Way, i: usize, u: f64, tolerance: f64, span: &mut usize) -> Sample {
        while *span + 2 < self.knots.len() && self.knots[*span + 1] <= u {
            *span += 1;
        }
        let basis = Knots(&self.knots).basis(*span, u, 3);
        let free = 3..self.control.len() - 3;
        let square: f64 =
            (0..4).filter(|j| free.contains(&(*span + j))).map(|j| basis[j] * basis[j]).sum();
        let per_square = if square > 1e-6 { 1.0 / square } else { 0.0 };
        let (p, tolerance) = allowed(way, i, u, tolerance);
        Sample { first: *span, basis, p, tolerance, per_square }
    }

    /// Bring samples back until all are near enough, then find the curve that bends least. `false`:
    /// some are not; their spans are in `bad`.
    fn settle(&mut self) -> bool {
        if !self.project(SWEEPS) {
            return false;
        }
        self.spare.clone_from(&self.control);
        let (control, samples, bends) = (&mut self.control, &self.samples, &self.bends);
        if self.axes <= 3 {
            self.linear.smooth(control, samples, bends);
        } else {
            self.all.smooth(control, samples, bends);
        }
        if !self.project(BACK) {
            core::mem::swap(&mut self.spare, &mut self.control);
        }
        self.keeps_between()
    }

    /// Whether it is near enough between the samples, too; spans where it is not are in `bad`.
    fn keeps_between(&mut self) -> bool {
        self.bad.clear();
        for sample in &self.between {
            let far = distance(&self.at(sample), &sample.p) > sample.tolerance * BETWEEN;
            if far && self.bad.last() != Some(&sample.first) {
                self.bad.push(sample.first);
            }
        }
        self.bad.is_empty()
    }

    /// Where the curve is.
    fn at(&self, sample: &Sample) -> Point {
        let mut q = sample.p;
        q[..self.axes].fill(0.0);
        for (j, n) in sample.basis.iter().enumerate() {
            let p = &self.control[sample.first + j];
            for i in 0..self.axes {
                q[i] += n * p[i];
            }
        }
        q
    }

    fn project(&mut self, sweeps: usize) -> bool {
        let free = 3..self.control.len() - 3;
        for _ in 0..sweeps {
            self.bad.clear();
            for sample in &self.samples {
                let q = self.at(sample);
                let off = distance(&q, &sample.p);
                if off <= sample.tolerance * NEAR {
                    continue;
                }
                if self.bad.last() != Some(&sample.first) {
                    self.bad.push(sample.first);
                }
                let back = (1.0 - sample.tolerance * NEAR * 0.98 / off) * sample.per_square;
                for (j, n) in sample.basis.iter().enumerate() {
                    if free.contains(&(sample.first + j)) {
                        let p = &mut self.control[sample.first + j];
                        for i in 0..self.axes {
                            p[i] += back * n * (sample.p[i] - q[i]);
                        }
                    }
                }
            }
            if self.bad.is_empty() {
                return true;
            }
        }
        false
    }

    /// By knot: shares of its three control points in the second derivative there, and the length
    /// that it stands for.
    fn twist(&mut self) {
        self.bends.clear();
        for knot in 0..self.knots.len() {
            let i = knot + 3;
            let t = |k: usize| self.t(k);
            let mut shares = [0.0; 3];
            for (n, share) in shares.iter_mut().enumerate() {
                let p = |j: usize| f64::from(u8::from(j == n));
                let q = |j: usize| 3.0 * (p(j + 1) - p(j)) / (t(i + 1 + j) - t(i - 2 + j));
                *share = 2.0 * (q(1) - q(0)) / (t(i + 1) - t(i - 1));
            }
            self.bends.push((shares, (t(i + 1) - t(i - 1)) / 2.0));
        }
    }

    /// Halve the spans that failed, and their neighbours.
    fn halve(&mut self) {
        let spans = self.spans();
        let mut knots = Vec::with_capacity(self.knots.len() + 3 * self.bad.len());
        let mut bad = self.bad.iter().peekable();
        for span in 0..spans {
            knots.push(self.knots[span]);
            while bad.next_if(|b| **b + 1 < span).is_some() {}
            if bad.peek().is_some_and(|b| **b <= span + 1) {
                knots.push(f64::midpoint(self.knots[span], self.knots[span + 1]));
            }
        }
        knots.push(self.knots[spans]);
        self.knots = knots;
    }

    /// A span as a polynomial from its beginning.
    fn polynomial(&self, span: usize) -> Polynomial {
        let i = span + 3;
        let t = |k: usize| self.t(k);
        let (a, length) = (t(i), t(i + 1) - t(i));
        let basis = Knots(&self.knots).basis(span, a, 3);
        let mut c = [[0.0; AXES]; 6];
        let [c0, c1, c2, c3, ..] = &mut c;
        for axis in 0..AXES {
            let p = |j: usize| self.control[span + j][axis];
            // control points of the derivatives: Q of the first, R of the second
            let q = |j: usize| 3.0 * (p(j + 1) - p(j)) / (t(i + 1 + j) - t(i - 2 + j));
            let (q0, q1, q2) = (q(0), q(1), q(2));
            let r0 = 2.0 * (q1 - q0) / (t(i + 1) - t(i - 1));
            let r1 = 2.0 * (q2 - q1) / (t(i + 2) - t(i));
            c0[axis] = (0..4).map(|j| basis[j] * p(j)).sum();
            c1[axis] = ((t(i + 1) - t(i)) * q0 + (t(i) - t(i - 1)) * q1) / (t(i + 1) - t(i - 1));
            c2[axis] = r0 / 2.0;
            c3[axis] = (r1 - r0) / length / 6.0;
        }
        Polynomial { c, length }
    }
}

/// What a stretch serves: the slowest of its moves.
fn serves(way: &Way, a: f64, b: f64) -> Segment {
    let slack = (b - a) * 1e-6;
    let (first, last) = (way.index(a + slack), way.index(b - slack));
    let mut of = way.moves[first].segment;
    for one in &way.moves[first..=last] {
        of.feed = of.feed.min(one.segment.feed);
        of.rapid &= one.segment.rapid;
    }
    of
}
