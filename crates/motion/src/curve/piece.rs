//! What geometry hands to the law of time.
use super::{AXES, Arc, Bezier, Derivatives, Line, Polynomial, Shape};

/// A curve of one of the kinds there are. Plain data, so that it can lie in a queue.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // it is moved into a queue once
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Curve {
    /// A straight line.
    Line(Line),
    /// A circle or helix.
    Arc(Arc),
    /// A programmed spline, or a part of one.
    Bezier(Bezier),
    /// A blend, or part of a fitted curve.
    Polynomial(Polynomial),
}

impl Shape for Curve {
    fn length(&self) -> f64 {
        match self {
            Self::Line(line) => line.length(),
            Self::Arc(arc) => arc.length(),
            Self::Bezier(bezier) => bezier.length(),
            Self::Polynomial(polynomial) => polynomial.length(),
        }
    }

    fn at(&self, s: f64) -> Derivatives {
        match self {
            Self::Line(line) => line.at(s),
            Self::Arc(arc) => arc.at(s),
            Self::Bezier(bezier) => bezier.at(s),
            Self::Polynomial(polynomial) => polynomial.at(s),
        }
    }
}

/// How a piece joins the piece before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Entry {
    /// From rest (ṡ = s̈ = 0): the first piece, an exact stop, a corner that may not be cut.
    Rest,
    /// q, q′ and q″ go on where the piece before ends: ṡ and s̈ are continuous.
    Smooth,
    /// q and q′ go on, q″ jumps: ṡ is continuous; with a jerk limit on an axis whose q″ jumps, as
    /// slow as rest.
    Tangent,
}

/// A piece of the joined path: as a [`Shape`] of its own it runs from 0 to its length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Piece {
    /// Where.
    pub curve: Curve,
    /// Parameter of the curve where the piece begins: what lies before has been blended away.
    pub begin: f64,
    /// How far it runs from there.
    pub length: f64,
    /// The programmed feed, which ṡ is never above, or along a blend of X, Y and Z the speed;
    /// infinite for a rapid.
    pub feed: f64,
    /// Which of the two sets of [`Limits`] counts.
    pub rapid: bool,
    /// How it joins the piece before.
    pub entry: Entry,
    /// Index of the operation it serves, for reports.
    pub op: u32,
    /// Line of the program.
    pub line: u32,
}

impl Shape for Piece {
    fn length(&self) -> f64 {
        self.length
    }

    fn at(&self, s: f64) -> Derivatives {
        self.curve.at(self.begin + s.clamp(0.0, self.length))
    }
}

/// What the axes can do; infinity where there is no limit, and for axes that never move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bounds {
    /// Highest speed, mm/s or °/s.
    pub speed: [f64; AXES],
    /// Highest acceleration.
    pub accel: [f64; AXES],
    /// Highest jerk; infinity: not limited.
    pub jerk: [f64; AXES],
}

impl Bounds {
    /// Whether any axis has a limit of jerk.
    pub fn has_jerk(&self) -> bool {
        self.jerk.iter().any(|jerk| jerk.is_finite())
    }
}

impl Default for Bounds {
    /// No limits.
    fn default() -> Self {
        let none = [f64::INFINITY; AXES];
        Self { speed: none, accel: none, jerk: none }
    }
}

/// What the axes can do while cutting and in rapids.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits {
    /// While cutting.
    pub feed: Bounds,
    /// In rapids.
    pub rapid: Bounds,
}

impl Limits {
    /// Whether any axis has a limit of jerk, while cutting or in rapids.
    pub fn has_jerk(&self) -> bool {
        self.feed.has_jerk() || self.rapid.has_jerk()
    }
}
