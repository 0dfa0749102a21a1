//! Circles and helices.
//!
//! ```text
//!                  to        f = s / L,  d = from − centre,  φ = sweep·f
//!      ╭───────●             q = centre + R(φ)·d + f·e       in the plane
//!    ╱    ╲φ                 q = from·(1 − f) + to·f         along all other axes
//!   ●──d──┼ centre
//!  from
//! ```
//!
//! e is what the rotated start lacks to the programmed end, rounding of the program; spread over
//! the way it makes no jump.
use super::{AXES, Derivatives, Point, Shape};

/// A circle or helix in the plane of two axes; all other axes go along in proportion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Arc {
    /// Where it begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// First and second axis of the plane.
    pub plane: [usize; 2],
    /// Along these two.
    pub centre: [f64; 2],
    /// Angle swept, rad, from the first axis to the second positive.
    pub sweep: f64,
    /// Its measure; above zero.
    pub length: f64,
}

fn rotated([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [cos * x - sin * y, sin * x + cos * y]
}

impl Shape for Arc {
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
        let start = [0, 1].map(|k| self.from[self.plane[k]] - self.centre[k]);
        let end = rotated(start, self.sweep);
        let [x, y] = rotated(start, self.sweep * fraction);
        let w = self.sweep / self.length; // rad/mm
        let turned = [[x, y], [-y, x]];
        for (k, &axis) in self.plane.iter().enumerate() {
            let missing = self.to[axis] - self.centre[k] - end[k];
            if fraction < 1.0 {
                d.q[axis] = self.centre[k] + turned[0][k] + missing * fraction;
            }
            d.q1[axis] = w * turned[1][k] + missing / self.length;
            d.q2[axis] = -w * w * turned[0][k];
            d.q3[axis] = -w * w * w * turned[1][k];
        }
        d
    }
}
