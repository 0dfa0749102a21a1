//! What geometry hands to the law of time.
use super::{AXES, Derivatives, Line, Shape};

/// A curve of one of the kinds there are. Plain data, so that it can lie in a queue.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // it is moved into a queue once
pub enum Curve {
    /// A straight line.
    Line(Line),
}

impl Shape for Curve {
    fn length(&self) -> f64 {
        match self {
            Self::Line(line) => line.length(),
        }
    }

    fn at(&self, s: f64) -> Derivatives {
        match self {
            Self::Line(line) => line.at(s),
        }
    }
}

/// How a piece joins the piece before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// From rest (ṡ = s̈ = 0): the first piece, an exact stop, a corner that may not be cut.
    Rest,
    /// q, q′ and q″ go on where the piece before ends: ṡ and s̈ are continuous.
    Smooth,
    /// q and q′ go on, q″ jumps: ṡ is continuous; with a jerk limit on an axis whose q″ jumps, as slow as rest.
    Tangent,
}

/// A piece of the joined path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Where.
    pub curve: Curve,
    /// ṡ is never above this: the programmed feed; infinite for a rapid.
    pub feed: f64,
    /// Which of the two sets of [`Limits`] counts.
    pub rapid: bool,
    /// How it joins the piece before.
    pub entry: Entry,
    /// Index of the operation it serves, for whoever reports.
    pub op: u32,
    /// Line of the program.
    pub line: u32,
}

/// What the axes can do; infinity where there is no limit, and for axes that never move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Highest speed, mm/s or °/s.
    pub speed: [f64; AXES],
    /// Highest acceleration.
    pub accel: [f64; AXES],
    /// Highest jerk; infinity: not limited.
    pub jerk: [f64; AXES],
}

/// What the axes can do while cutting and in rapids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// While cutting.
    pub feed: Bounds,
    /// In rapids.
    pub rapid: Bounds,
}
