//! Places where a curve's distance from the programmed path is looked at.
use motion::Point;

/// Share of the tolerance that samples keep: between them there is a little more.
pub(crate) const NEAR: f64 = 0.99;

/// A place where the distance is looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// First of its four control points.
    pub(crate) first: usize,
    pub(crate) basis: [f64; 4],
    /// The place to be near to, and how near.
    pub(crate) p: Point,
    pub(crate) tolerance: f64,
    /// One over the sum of squares of the basis over free control points; zero: none is free.
    pub(crate) per_square: f64,
}
