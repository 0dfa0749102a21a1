//! Stretches of the path that are short enough to be seen as simple: the grid that time is planned
//! on.
//!
//! ```text
//!   |q′·a + q″·b| ≤ A                      at both ends,  b = ṡ², a = s̈
//!   |q′·u + 3·q″·a + q‴·b|·√b ≤ J          in the middle, u = da/ds
//! ```
//!
//! A line is one cell, whatever its length: q″ = q‴ = 0, and one acceleration and one jerk hold all
//! along it. A curve has as many cells as keep q′ and q″ from changing much in any one.
pub(crate) mod parabola;

use crate::{AXES, Bounds, Derivatives, Entry, Limits, Piece, Shape};
use alloc::boxed::Box;
use alloc::vec::Vec;

/// Where nothing else limits it, ṡ stays under this, mm/s: faster than any machine, slow enough for
/// arithmetic.
pub(crate) const TOP_SPEED: f64 = 1e7;

/// How far the tangent may turn within a cell, as a share of its length.
const TURN_PER_CELL: f64 = 0.12;
/// The same on arcs, whose cells last half a servo period at least: an arc takes longer than it
/// must by about an eighth of it. With a limit of jerk twice as far.
const TURN_PER_CELL_OF_ARC: f64 = 0.0125;
const ARC_CELLS_PER_PERIOD: f64 = 2.0;

/// How far the share of the acceleration that the bend takes may change within a cell.
const LOAD_PER_CELL: f64 = 0.15;
/// The same on blends and fitted curves without a limit of jerk: bends change much there, and s̈
/// does not within a cell.
const LOAD_PER_BLEND: f64 = 0.06;
/// And with one: the law bounds both ends of what it lays there, and measures the motion.
const LOAD_WITH_JERK: f64 = 0.2;

/// So many cells are fine enough for one period, as fast as the bend allows: the control does a
/// number of them at once.
const CELLS_PER_PERIOD: f64 = 64.0;

/// By how much, as a share of its limit, an axis' acceleration may be higher between the places of
/// a cell than at them.
const BETWEEN: f64 = 0.005;

/// One axis' demands at one place, over its limits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LimitRow {
    /// q′ / A.
    pub(crate) a1: f64,
    /// q″ / A.
    pub(crate) a2: f64,
    /// q′ / J.
    pub(crate) j1: f64,
    /// q″ / J.
    pub(crate) j2: f64,
    /// q‴ / J.
    pub(crate) j3: f64,
}

impl LimitRow {
    /// Of an axis.
    fn of(d: &Derivatives, k: usize, bounds: &Bounds) -> Self {
        let (a, j) = (1.0 / bounds.accel[k], 1.0 / bounds.jerk[k]);
        let (a1, a2) = (d.q1[k] * a, d.q2[k] * a);
        let (j1, j2, j3) = (d.q1[k] * j, d.q2[k] * j, d.q3[k] * j);
        Self { a1, a2, j1, j2, j3 }
    }
}

/// Which axes move at any of three places.
fn moving(three: &[Derivatives; 3]) -> [bool; AXES] {
    core::array::from_fn(|k| three.iter().any(|d| d.q1[k] != 0.0 || d.q2[k] != 0.0))
}

/// All moving axes' demands at the three places of a cell: at its beginning, in its middle, at its
/// end; with a limit of jerk on blends at both quarters, too.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    three: Box<[LimitRow]>,
    quarters: Box<[LimitRow]>,
}

impl Rows {
    fn new(three: &[Derivatives; 3], bounds: &Bounds) -> Self {
        Self { three: rows_of(three, moving(three), bounds), quarters: Box::default() }
    }

    /// With those at both quarters.
    fn with_quarters(
        self,
        quarters: &[Derivatives; 2],
        axes: [bool; AXES],
        bounds: &Bounds,
    ) -> Self {
        Self { quarters: rows_of(quarters, axes, bounds), ..self }
    }

    /// At one of the places, by axis.
    pub(crate) fn at(&self, place: usize) -> &[LimitRow] {
        let count = self.three.len() / 3;
        &self.three[place * count..(place + 1) * count]
    }

    /// At both quarters, by axis, where they are known.
    fn quarters(&self) -> Option<[&[LimitRow]; 2]> {
        let (first, second) = self.quarters.split_at(self.quarters.len() / 2);
        (!first.is_empty()).then_some([first, second])
    }

    pub(crate) fn all(&self) -> &[LimitRow] {
        &self.three
    }
}

/// Demands of these axes, place by place.
fn rows_of(places: &[Derivatives], axes: [bool; AXES], bounds: &Bounds) -> Box<[LimitRow]> {
    let mut rows = Vec::with_capacity(places.len() * axes.iter().filter(|moves| **moves).count());
    for d in places {
        rows.extend((0..AXES).filter(|k| axes[*k]).map(|k| LimitRow::of(d, k, bounds)));
    }
    rows.into_boxed_slice()
}

/// ṡ at which the feed is reached. A blend's parameter is longer than its way; where only X, Y and
/// Z move, it is the way that F counts.
fn feed(piece: &Piece, d: &Derivatives) -> f64 {
    let [x, y, z, others @ ..] = &d.q1;
    if !is_blend(piece) || others.iter().any(|slope| *slope != 0.0) {
        return piece.feed;
    }
    piece.feed / libm::sqrt(x * x + y * y + z * z)
}

/// ṡ² that the feed and the axes' speeds leave.
fn speed_cap(d: &Derivatives, bounds: &Bounds, feed: f64) -> f64 {
    let mut v = feed.min(TOP_SPEED);
    for k in 0..AXES {
        let slope = d.q1[k].abs();
        if slope * v > bounds.speed[k] {
            v = bounds.speed[k] / slope;
        }
    }
    v * v
}

/// ṡ² that the axes' speeds leave where a slope is steepest, if that is between the places of a
/// cell.
fn cap_between([start, middle, end]: &[Derivatives; 3], bounds: &Bounds) -> f64 {
    let steepest = |k: usize| {
        // the parabola through the three, around the middle
        let rise = (end.q1[k] - start.q1[k]) / 2.0;
        let bend = f64::midpoint(start.q1[k], end.q1[k]) - middle.q1[k];
        let between = rise.abs() < 2.0 * bend.abs();
        if between { middle.q1[k] - rise * rise / (4.0 * bend) } else { middle.q1[k] }
    };
    let v = (0..AXES).map(|k| bounds.speed[k] / steepest(k).abs()).fold(f64::INFINITY, f64::min);
    v * v
}

/// What is demanded along a cell.
#[derive(Clone, Debug)]
pub(crate) enum Demand {
    /// A straight line: largest |s̈| and |s⃛|, either may be infinite.
    Line { accel: f64, jerk: f64 },
    /// A curve.
    Curve(Rows),
}

/// How a cell begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Start {
    /// Goes on from the cell before, with ṡ² at most this (infinite as a rule).
    On(f64),
    /// At rest.
    Rest,
}

/// A stretch of a piece.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    /// Number of the piece.
    pub(crate) piece: u64,
    /// Where in the piece it begins.
    pub(crate) from: f64,
    /// Its length; above zero.
    pub(crate) h: f64,
    /// ṡ² all along it is at most this.
    pub(crate) cap: f64,
    pub(crate) start: Start,
    pub(crate) demand: Demand,
}

/// Cuts a piece into cells, one at a time.
#[derive(Clone, Debug)]
pub(crate) struct Sampler {
    piece: Piece,
    number: u64,
    /// Where the first cell begins.
    from: f64,
    length: f64,
    start: Start,
    /// What is cut evenly, and which cell of it is next; then the other stretches of the piece, the
    /// last one first.
    even: Even,
    next: u64,
    more: Vec<Even>,
    last: Derivatives,
    /// Servo period, s.
    period: f64,
}

/// A stretch with cells of one length.
#[derive(Clone, Copy, Debug)]
struct Even {
    from: f64,
    to: f64,
    count: u64,
}

impl Even {
    /// Of a piece: its cells, for a servo period.
    fn of(piece: &Piece, from: f64, to: f64, bounds: (&Bounds, f64)) -> Self {
        Self { from, to, count: cells_for(piece, from, to, bounds) }
    }

    fn halves(&self, piece: &Piece, bounds: (&Bounds, f64)) -> [Self; 2] {
        let middle = f64::midpoint(self.from, self.to);
        [Self::of(piece, self.from, middle, bounds), Self::of(piece, middle, self.to, bounds)]
    }
}

impl Sampler {
    /// `before`: derivatives at the end of the piece before, `period`: s between two setpoints.
    pub(crate) fn new(
        piece: &Piece,
        number: u64,
        from: f64,
        before: Option<&Derivatives>,
        limits: &Limits,
        period: f64,
    ) -> Self {
        let (length, last) = (piece.length(), piece.at(from));
        let start = match (piece.entry, before) {
            (Entry::Smooth, _) | (_, None) => Start::On(f64::INFINITY),
            (Entry::Rest, Some(_)) => Start::Rest,
            (Entry::Tangent, Some(before)) => {
                bend_cap(before, &last, bounds(piece, limits), period)
            }
        };
        let even = Even::of(piece, from, length, (bounds(piece, limits), period));
        let mut sampler = Self {
            piece: *piece,
            number,
            from,
            length,
            start,
            even,
            next: 0,
            more: Vec::new(),
            last,
            period,
        };
        // a spline may bend sharply in a small part of it
        if matches!(piece.curve, crate::Curve::Bezier(_)) {
            sampler.more.push(even);
            sampler.go_on(limits);
        }
        sampler
    }

    /// Go on with the next stretch, if there is one.
    fn go_on(&mut self, limits: &Limits) -> bool {
        let Some(mut even) = self.more.pop() else { return false };
        if is_blend(&self.piece) {
            (self.even, self.next) = (even, 0);
            return true;
        }
        let bounds = (bounds(&self.piece, limits), self.period);
        while even.count > MANY && even.to - even.from >= 2.0 * SHORTEST_STRETCH {
            let [first, second] = even.halves(&self.piece, bounds);
            self.more.push(second);
            even = first;
        }
        // in a cusp there is no end of bending: it is passed at rest, or nearly so
        let count = even.count.min(MANY);
        (self.even, self.next) = (Even { count, ..even }, 0);
        true
    }

    /// Derivatives at the end of the piece.
    pub(crate) fn end(&self) -> Derivatives {
        self.piece.at(self.length)
    }

    /// The next cell.
    pub(crate) fn next(&mut self, limits: &Limits) -> Option<Cell> {
        if self.next >= self.even.count && !self.go_on(limits) {
            return None;
        }
        let even = self.even;
        let step = (even.to - even.from) / even.count as f64;
        let at = |k: f64| even.from + step * k;
        let from = at(self.next as f64);
        let first = self.next == 0 && even.from == self.from;
        let start = if first { self.start } else { Start::On(f64::INFINITY) };
        let bounds = bounds(&self.piece, limits);
        let (demand, cap) = if self.is_line() {
            let cap = speed_cap(&self.last, bounds, self.piece.feed);
            let least = |limit: &[f64; AXES]| {
                let over = |k: usize| limit[k] / self.last.q1[k].abs();
                (0..AXES)
                    .filter(|k| self.last.q1[*k] != 0.0)
                    .map(over)
                    .fold(f64::INFINITY, f64::min)
            };
            (Demand::Line { accel: least(&bounds.accel), jerk: least(&bounds.jerk) }, cap)
        } else {
            let middle = self.piece.at(at(self.next as f64 + 0.5));
            let end = self.piece.at(at(self.next as f64 + 1.0));
            let three = [self.last, middle, end];
            let cap = |d: &Derivatives| speed_cap(d, bounds, feed(&self.piece, d));
            let mut least = three.iter().map(cap).fold(cap_between(&three, bounds), f64::min);
            let mut rows = Rows::new(&three, bounds);
            if is_blend(&self.piece) {
                let fits = if bounds.has_jerk() {
                    // cells are long there
                    let quarters = [0.25, 0.75].map(|x| self.piece.at(at(self.next as f64 + x)));
                    let [a, b] = quarters;
                    for half in [[self.last, a, middle], [middle, b, end]] {
                        least = least.min(cap(&half[1])).min(cap_between(&half, bounds));
                    }
                    rows = rows.with_quarters(&quarters, moving(&three), bounds);
                    parabola::fits(&rows, least)
                } else {
                    parabola::keeps_between(&three, bounds)
                };
                if !fits && step > 2.0 * SHORTEST_STRETCH {
                    self.halve();
                    return self.next(limits);
                }
            }
            let cap = least;
            self.last = end;
            (Demand::Curve(rows), cap)
        };
        self.next += 1;
        Some(Cell { piece: self.number, from, h: step, cap, start, demand })
    }

    /// Cut the next cell in two.
    fn halve(&mut self) {
        let Even { from, to, count } = self.even;
        let at = |k: u64| from + (to - from) / count as f64 * k as f64;
        let (left, right) = (at(self.next), at(self.next + 1));
        if self.next + 1 < count {
            self.more.push(Even { from: right, to, count: count - self.next - 1 });
        }
        (self.even, self.next) = (Even { from: left, to: right, count: 2 }, 0);
    }

    fn is_line(&self) -> bool {
        is_line(&self.piece)
    }
}

fn is_line(piece: &Piece) -> bool {
    matches!(piece.curve, crate::Curve::Line(_))
}

/// A blend, or a part of a fitted curve.
fn is_blend(piece: &Piece) -> bool {
    matches!(piece.curve, crate::Curve::Polynomial(_))
}

pub(crate) fn bounds<'a>(piece: &Piece, limits: &'a Limits) -> &'a Bounds {
    if piece.rapid { &limits.rapid } else { &limits.feed }
}

/// Where q″ jumps the acceleration does; within a period that is a jerk, and it shall be within the
/// limit too.
fn bend_cap(before: &Derivatives, after: &Derivatives, bounds: &Bounds, period: f64) -> Start {
    let cap = |k: usize| bounds.jerk[k] * period / (after.q2[k] - before.q2[k]).abs();
    let jumps = (0..AXES).filter(|k| after.q2[*k] != before.q2[*k]);
    Start::On(jumps.map(cap).fold(f64::INFINITY, f64::min))
}

/// A stretch of a spline with more cells is halved, unless it is shorter than this, mm.
const MANY: u64 = 16;
const SHORTEST_STRETCH: f64 = 1e-5;

/// Places at which a piece is looked at to know how many cells it needs.
const LOOKS: usize = 9;

/// How many cells keep the tangent's turn, and the change of the share of the acceleration that the
/// bend takes, small.
fn cells_for(piece: &Piece, from: f64, length: f64, bounds: (&Bounds, f64)) -> u64 {
    if is_line(piece) {
        return u64::from(length > from);
    }
    // what was programmed as a spline may bend sharply in a small part of it
    match piece.curve {
        crate::Curve::Bezier(_) => {
            cells_for_looks::<{ 4 * (LOOKS - 1) + 1 }>(piece, from, length, bounds)
        }
        _ => cells_for_looks::<LOOKS>(piece, from, length, bounds),
    }
}

fn cells_for_looks<const N: usize>(
    piece: &Piece,
    from: f64,
    length: f64,
    (bounds, period): (&Bounds, f64),
) -> u64 {
    let look = |k: usize| piece.at(from + (length - from) * k as f64 / (N - 1) as f64);
    let all: [Derivatives; N] = core::array::from_fn(look);
    // as fast as the feed, and the bend where it is least, allow
    let cap = |d: &Derivatives| speed_cap(d, bounds, feed(piece, d));
    let cap = all.iter().map(cap).fold(f64::INFINITY, f64::min);
    let (mut turn, mut change, mut twist, mut slowest) = (0.0_f64, 0.0_f64, 0.0_f64, cap);
    let slope = all.iter().flat_map(|d| d.q1).fold(0.0, |m: f64, x| m.max(x.abs()));
    for k in 0..AXES {
        let bend = all.iter().fold(0.0, |m: f64, d| m.max(d.q2[k].abs()));
        let fastest = cap.min(bounds.accel[k] / bend);
        slowest = slowest.min(fastest);
        let (mut turned, mut changed, mut twisted) = (0.0, 0.0, 0.0);
        for pair in all.windows(2) {
            turned += (pair[1].q1[k] - pair[0].q1[k]).abs();
            changed += (pair[1].q2[k] - pair[0].q2[k]).abs();
            twisted += (pair[1].q3[k] - pair[0].q3[k]).abs();
        }
        // an arc of many turns comes back to where it was: what its bend says counts too
        turned = turned.max((length - from) * bend);
        if slope > 0.0 {
            turn = turn.max(turned / slope);
        }
        if changed > 0.0 {
            change = change.max(changed * fastest / bounds.accel[k]);
        }
        if twisted > 0.0 && bounds.jerk[k].is_finite() {
            let most = all.iter().fold(0.0, |m: f64, d| m.max(d.q3[k].abs()));
            let v3 = (fastest * libm::sqrt(fastest)).min(bounds.jerk[k] / most);
            twist = twist.max(twisted * v3 / bounds.jerk[k]);
        }
    }
    let least = if piece.entry == Entry::Rest { 2.0 } else { 1.0 };
    let blend = is_blend(piece);
    let share = if blend && bounds.has_jerk() { LOAD_WITH_JERK } else { LOAD_PER_CELL };
    let mut count = (turn / TURN_PER_CELL).max(change / share).max(twist / LOAD_PER_CELL);
    let periods = (length - from) / (libm::sqrt(slowest) * period);
    if blend && !bounds.has_jerk() {
        count = count.max((change / LOAD_PER_BLEND).min(periods * CELLS_PER_PERIOD));
    } else if matches!(piece.curve, crate::Curve::Arc(_)) {
        let per_cell = TURN_PER_CELL_OF_ARC * if bounds.has_jerk() { 2.0 } else { 1.0 };
        count = count.max((turn / per_cell).min(periods * ARC_CELLS_PER_PERIOD));
    }
    libm::ceil(count.max(cells_for_sag(&all, bounds))).clamp(least, 1e15) as u64
}

/// How many cells keep each axis' acceleration q′·s̈ + q″·ṡ² between two places near the straight
/// line that joins it at both.
///
/// Where an axis is much slower than others, these allow an s̈ at which the turn of its slope is
/// many times its limit, held by its bend. Over half a cell the second difference of the sum is
/// that of q′ times 5·s̈ (two by two from q″ and ṡ², which both change); D over looks becomes
/// D·(8/2n)², and the curve is an eighth of that from its chord.
fn cells_for_sag(all: &[Derivatives], bounds: &Bounds) -> f64 {
    let mut most = 0.0_f64;
    for near in all.windows(3) {
        let slope = |k: usize| near.iter().fold(0.0, |m: f64, d| m.max(d.q1[k].abs()));
        let fastest = (0..AXES).map(|k| 2.0 * bounds.accel[k] / slope(k));
        let fastest = fastest.fold(f64::INFINITY, f64::min);
        for k in 0..AXES {
            let second = near[0].q1[k] - 2.0 * near[1].q1[k] + near[2].q1[k];
            if second != 0.0 {
                most = most.max(5.0 * second.abs() * fastest / bounds.accel[k]);
            }
        }
    }
    let looks = (all.len() - 1) as f64;
    libm::sqrt(most * looks * looks / 32.0 / BETWEEN)
}
