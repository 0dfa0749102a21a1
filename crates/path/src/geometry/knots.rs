//! Where the pieces of a fitted curve begin.
//!
//! A piece may be long where the path bends little. Measured over arms of length h to both sides,
//!
//! ```text
//!       p(u−h) ●─────●─────● p(u+h)        D(u, h) = |p(u−h) − 2·p(u) + p(u+h)| / 6
//!                   p(u)
//! ```
//!
//! D is how far a cubic spline with knots h apart, its control points on the path, is from it. D
//! does not care how finely the path is chopped. Knots are set so that D is a few tolerances, which
//! the fit then makes good; where a corner is sharp, they stand h before it, in it, and h after it,
//! with D one tolerance, so that the path does not swing out.
use super::joint::{SHARE, Waiting, distance};
use alloc::vec::Vec;
use motion::{Point, Shape};

/// Corners with a larger k (= sin θ/2) are sharp: 20°.
const SHARP: f64 = 0.17;
/// How many tolerances D may be before the fit makes it good.
const AHEAD: f64 = 0.6;

/// A row of moves as one way.
pub(crate) struct Way<'a> {
    pub(crate) moves: &'a [Waiting],
    /// Where each begins; the first one before zero if its beginning is gone.
    pub(crate) starts: &'a [f64],
    /// Its length.
    pub(crate) total: f64,
}

impl Way<'_> {
    /// Which move is at a parameter.
    pub(crate) fn index(&self, u: f64) -> usize {
        self.starts.partition_point(|start| *start <= u).clamp(1, self.moves.len()) - 1
    }

    pub(crate) fn at(&self, u: f64) -> Point {
        let i = self.index(u);
        self.on(i, u)
    }

    /// At a parameter on a move that is known.
    pub(crate) fn on(&self, i: usize, u: f64) -> Point {
        self.moves[i].segment.curve.at(u - self.starts[i]).q
    }

    /// D of the module's header over the tolerance there.
    fn bend(&self, u: f64, h: f64) -> f64 {
        let h = h.min(u).min(self.total - u);
        if h <= 0.0 {
            return 0.0;
        }
        let (a, b, c) = (self.at(u - h), self.at(u), self.at(u + h));
        let middle: Point = core::array::from_fn(|i| f64::midpoint(a[i], c[i]));
        distance(&middle, &b) / 3.0 / self.moves[self.index(u)].segment.tolerance
    }

    /// How far apart knots may be behind a place, as far as `end`: longer and longer ways are
    /// tried, as a way over waves may look straight.
    fn gap(&self, u: f64, end: f64) -> f64 {
        let moves = self.moves[self.index(u)..].iter().map(Waiting::length);
        let mut h = moves.fold(0.0, |h, length| if h > 0.0 { h } else { length });
        while h > 0.0 && u + 2.0 * h < end && self.bend(u + h, h) <= AHEAD {
            h *= 2.0;
        }
        if h > 0.0 { h } else { end - u }
    }
}

/// An anchor: a place where there must be a knot, and how far apart knots may be near it.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    u: f64,
    near: f64,
}

/// Knots from zero to the end, both included.
pub(crate) fn choose(way: &Way, knots: &mut Vec<f64>) {
    knots.clear();
    knots.push(0.0);
    let mut last = Anchor { u: 0.0, near: f64::INFINITY };
    let mut previous_sharp = 0.0;
    for i in 1..way.moves.len() {
        let (joint, u) = (way.moves[i].joint, way.starts[i]);
        if joint.k <= SHARP {
            let (a, b) = (&way.moves[i - 1].segment, &way.moves[i].segment);
            // right after a sharp corner the piece there serves both feeds
            if (a.feed != b.feed || a.rapid != b.rapid) && u > last.u {
                let anchor = Anchor { u, near: f64::INFINITY };
                march(way, last, anchor, knots);
                last = anchor;
            }
            continue;
        }
        let next_sharp = (i + 1..way.moves.len())
            .find(|&j| way.moves[j].joint.k > SHARP)
            .map_or(way.total, |j| way.starts[j]);
        let share = |gap: f64, to_end: bool| if to_end { gap * 0.6 } else { gap * 0.49 };
        let h = (3.0 * SHARE * joint.tolerance / joint.k)
            .min(share(u - previous_sharp, previous_sharp == 0.0))
            .min(share(next_sharp - u, next_sharp == way.total));
        for (at, near) in [(u - h, h), (u, h), (u + h, h)] {
            let anchor = Anchor { u: at, near };
            if at > last.u + h * 0.5 {
                march(way, last, anchor, knots);
                last = anchor;
            }
        }
        previous_sharp = u;
    }
    march(way, last, Anchor { u: way.total, near: f64::INFINITY }, knots);
    // the ends' positions, slopes and bends need two knots between them
    while knots.len() < 4 {
        let (at, _) = (1..knots.len())
            .map(|i| (i, knots[i] - knots[i - 1]))
            .fold((1, 0.0), |best, gap| if gap.1 > best.1 { gap } else { best });
        knots.insert(at, f64::midpoint(knots[at - 1], knots[at]));
    }
}

/// Knots after `from` up to `to`.
fn march(way: &Way, from: Anchor, to: Anchor, knots: &mut Vec<f64>) {
    let mut u = from.u;
    let mut before = if from.near.is_finite() { from.near } else { way.gap(u, to.u) };
    loop {
        let left = to.u - u;
        let mut h = (before * 2.0).min(left).min(to.near + left / 2.0);
        for _ in 0..80 {
            if way.bend(u + h, h) <= AHEAD && way.bend(u, h) <= AHEAD {
                break;
            }
            h *= 0.8;
        }
        if h >= left * 0.75 {
            if h < left {
                knots.push(u + left / 2.0);
            }
            knots.push(to.u);
            return;
        }
        u += h;
        before = h;
        knots.push(u);
    }
}
