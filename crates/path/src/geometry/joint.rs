//! Moves, and how two of them meet.
use super::corner::{Bend, Corner, ROOM, off};
use super::quintic_blend::{INNER, QuinticBlend};
use motion::{AXES, Curve, Derivatives, Entry, Point, Shape};

/// A programmed move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Where, from beginning to end.
    pub curve: Curve,
    /// Programmed feed; infinite for a rapid.
    pub feed: f64,
    /// Not cutting.
    pub rapid: bool,
    /// How far the path may be from it (P without Q); zero: not at all.
    pub tolerance: f64,
    /// How far points between collinear moves may be from the line that replaces them (Q); what of
    /// it is not used is P's.
    pub merge: f64,
    /// Index of the operation.
    pub op: u32,
    /// Line of the program.
    pub line: u32,
}

/// Share of the tolerance that blends use; the rest is for what their distance is not sampled at.
pub(crate) const SHARE: f64 = 0.97;
/// The same where it is known exactly.
const EXACT: f64 = 0.999;
/// A fitted curve leaves a long move, and comes to it, so many reaches of the corner away, if there
/// is room.
const ASIDE: f64 = 2.0;
/// A move is long, and no curve is fitted through it, if so many narrow blends fit into it at each
/// end, and wide ones at all.
const FITTED: f64 = 3.0;
/// Slopes that differ by less are one slope.
const SAME_SLOPE: f64 = 1e-7;
/// Bends that differ by less are one bend, 1/mm.
const SAME_BEND: f64 = 1e-6;

/// A move in waiting.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waiting {
    pub(crate) segment: Segment,
    /// Where it begins and ends.
    pub(crate) start: Derivatives,
    pub(crate) end: Derivatives,
    /// The joint with the move before.
    pub(crate) joint: Joint,
    /// How far it is to its end from where all began.
    pub(crate) way: f64,
}

/// How two moves meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint {
    /// Half the difference of the slopes.
    pub(crate) k: f64,
    /// How far its blend would reach if there were room; zero: there is none.
    pub(crate) reach: f64,
    /// How far one would on the inner side alone: a fitted curve turns within it.
    pub(crate) narrow: f64,
    /// Shape of its blend, if it joins two lines.
    pub(crate) corner: Option<Corner>,
    /// Length of its blend as one polynomial, over its reach.
    pub(crate) ratio: f64,
    /// What there is instead.
    pub(crate) entry: Entry,
    /// P there.
    pub(crate) tolerance: f64,
}

impl Joint {
    /// Without a blend.
    pub(crate) fn none(entry: Entry) -> Self {
        let [k, reach, narrow, tolerance] = [0.0; 4];
        Self { k, reach, narrow, corner: None, ratio: INNER, entry, tolerance }
    }

    /// So much of a move must be there on this side, for the move to be long.
    pub(crate) fn claim(&self) -> f64 {
        self.reach.max(FITTED * self.narrow)
    }

    /// How far from it a fitted curve leaves a move with so much `room`, or comes to it: its knots
    /// need room.
    pub(crate) fn aside(&self, room: f64) -> f64 {
        f64::midpoint(self.reach, room).min(ASIDE * self.reach)
    }
}

impl Waiting {
    pub(crate) fn length(&self) -> f64 {
        self.segment.curve.length()
    }
}

/// The joint of a move with the one before.
pub(crate) fn joint(before: &Waiting, segment: &Segment, start: &Derivatives, bend: Bend) -> Joint {
    let k = norm(&difference(&start.q1, &before.end.q1)) / 2.0;
    let jump = norm(&difference(&start.q2, &before.end.q2));
    let tolerance = before.segment.tolerance.min(segment.tolerance);
    let entry = match (2.0 * k < SAME_SLOPE, jump < SAME_BEND) {
        (true, true) => Entry::Smooth,
        (true, false) => Entry::Tangent,
        (false, _) => Entry::Rest,
    };
    let joint = Joint { k, tolerance, ..Joint::none(entry) };
    if tolerance <= 0.0 {
        return joint;
    }
    if let (Entry::Smooth, Curve::Arc(_), Curve::Arc(_)) =
        (entry, &before.segment.curve, &segment.curve)
    {
        return joint; // one circle or helix, however it is cut
    }
    if entry == Entry::Smooth {
        // nothing to blend, but on a chopped curve two slopes may be the same by rounding
        let [reach, narrow] = [f64::INFINITY; 2];
        return Joint { reach, narrow, ..joint };
    }
    if let (Curve::Line(a), Curve::Line(b)) = (&before.segment.curve, &segment.curve) {
        let shorter = a.length.min(b.length);
        let p = tolerance * EXACT;
        let side = side(k, &before.end.q1, &start.q1);
        let narrow = QuinticBlend::narrow(off(k, side), p);
        if let Some(corner) = Corner::of(k, side, p, shorter, bend) {
            let reach = corner.reach();
            return Joint { reach, narrow, corner: Some(corner), ..joint };
        }
        let QuinticBlend { reach, ratio } = QuinticBlend::of(k, side, p, shorter / ROOM);
        return Joint { reach, narrow, ratio, ..joint };
    }
    // ⅜·k·h + Δ·h²/17 = P
    let p = tolerance * SHARE;
    let (slope, square) = (0.375 * k, jump / 17.0);
    let reach = 2.0 * p / (slope + libm::sqrt(slope * slope + 4.0 * square * p));
    Joint { reach, narrow: reach, ..joint }
}

/// How far from a line a step of one along the other one leads at most: sin θ, if both slopes are
/// of length one.
fn side(k: f64, t0: &Point, t1: &Point) -> f64 {
    let one = |t: &Point| (norm(t) - 1.0).abs() < SAME_SLOPE;
    let cosine = if one(t0) && one(t1) { libm::sqrt((1.0 - k * k).max(0.0)) } else { 1.0 };
    2.0 * k * cosine
}

pub(crate) fn difference(a: &Point, b: &Point) -> Point {
    core::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn norm(a: &Point) -> f64 {
    libm::sqrt(a.iter().map(|x| x * x).sum())
}

/// How far apart: in X Y Z, in U V W, or in degrees, whichever is most.
pub(crate) fn distance(a: &Point, b: &Point) -> f64 {
    let d = difference(a, b);
    let square = |at: usize| d[at] * d[at] + d[at + 1] * d[at + 1] + d[at + 2] * d[at + 2];
    libm::sqrt(square(0).max(square(3)).max(square(6)))
}

const _: () = assert!(AXES == 9);
