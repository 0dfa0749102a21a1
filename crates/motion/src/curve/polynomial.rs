//! Polynomials of the fifth degree: blends at corners, and pieces of fitted curves.
//!
//! ```text
//!   q(s) = c₀ + c₁·s + c₂·s² + … + c₅·s⁵
//! ```
use super::{AXES, Derivatives, Point, Shape};

/// A polynomial in the parameter, for every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Polynomial {
    /// c₀ … c₅.
    pub c: [Point; 6],
    /// Where the parameter ends; above zero.
    pub length: f64,
}

impl Polynomial {
    /// The one that begins and ends with given position, slope and bend (Hermite's problem of the
    /// fifth degree).
    pub fn between(from: &Derivatives, to: &Derivatives, length: f64) -> Self {
        let l = length;
        let mut c = [[0.0; AXES]; 6];
        let [c0, c1, c2, c3, c4, c5] = &mut c;
        for i in 0..AXES {
            let (p, v, a) = (from.q[i], from.q1[i], from.q2[i]);
            // what position, slope and bend at the end still lack
            let dp = to.q[i] - (p + l * (v + l * a / 2.0));
            let dv = to.q1[i] - (v + l * a);
            let da = to.q2[i] - a;
            c0[i] = p;
            c1[i] = v;
            c2[i] = a / 2.0;
            c3[i] = (10.0 * dp - l * (4.0 * dv - l * da / 2.0)) / (l * l * l);
            c4[i] = (-15.0 * dp + l * (7.0 * dv - l * da)) / (l * l * l * l);
            c5[i] = (6.0 * dp - l * (3.0 * dv - l * da / 2.0)) / (l * l * l * l * l);
        }
        Self { c, length }
    }

    /// Position alone.
    pub fn position(&self, s: f64) -> Point {
        let [c0, c1, c2, c3, c4, c5] = &self.c;
        core::array::from_fn(|i| {
            c0[i] + s * (c1[i] + s * (c2[i] + s * (c3[i] + s * (c4[i] + s * c5[i]))))
        })
    }
}

impl Shape for Polynomial {
    fn length(&self) -> f64 {
        self.length
    }

    fn at(&self, s: f64) -> Derivatives {
        let s = s.clamp(0.0, self.length);
        let [_, c1, c2, c3, c4, c5] = &self.c;
        let mut d = Derivatives { q: self.position(s), ..Derivatives::default() };
        for i in 0..AXES {
            d.q1[i] =
                c1[i] + s * (2.0 * c2[i] + s * (3.0 * c3[i] + s * (4.0 * c4[i] + s * 5.0 * c5[i])));
            d.q2[i] = 2.0 * c2[i] + s * (6.0 * c3[i] + s * (12.0 * c4[i] + s * 20.0 * c5[i]));
            d.q3[i] = 6.0 * c3[i] + s * (24.0 * c4[i] + s * 60.0 * c5[i]);
        }
        d
    }
}
