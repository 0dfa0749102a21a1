//! Straight lines.
use super::{AXES, Derivatives, Point, Shape};

/// A straight line; exact at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Line {
    /// Where it begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// Its measure; above zero.
    pub length: f64,
}

impl Shape for Line {
    fn length(&self) -> f64 {
        self.length
    }

    fn at(&self, s: f64) -> Derivatives {
        let fraction = (s / self.length).clamp(0.0, 1.0);
        let mut d = Derivatives::default();
        for i in 0..AXES {
            d.q[i] = self.from[i] * (1.0 - fraction) + self.to[i] * fraction;
            d.q1[i] = (self.to[i] - self.from[i]) / self.length;
        }
        d
    }
}
