//! Bézier curves of the fifth degree, run through by their length.
//!
//! ```text
//!   q = B(t(s)),  0 ≤ t ≤ 1       q′ = B′·t′      q″ = B″·t′² + B′·t″      t′ = 1/|B′|
//! ```
//!
//! B is the programmed curve (one of the third degree is raised, which changes nothing of it). Its own parameter t runs
//! unevenly, so t is made a function of the length s: a polynomial that has the true s, t′ and t″ at both ends. A curve
//! that bends much is cut into parts first, each with a t(s) of its own, so that |q′| is 1 to within a percent or so.
use super::{AXES, Derivatives, Point, Shape};
use alloc::vec::Vec;

/// A part of a Bézier curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bezier {
    /// Control points of the part.
    pub control: [Point; 6],
    /// t over s: c₀ … c₅.
    t: [f64; 6],
    /// Its length.
    length: f64,
}

/// Slowest |dB/dt| at the end of a part, relative to its length: below, the curve all but stands still, as at a cusp, and t
/// runs evenly there.
const STILL: f64 = 1e-6;

/// The same for a part that is shorter than a setpoint is fine, so that it does not matter how it is run through.
const STILL_WITHIN: (f64, f64) = (0.1, 1e-8);

/// How often a curve may be halved to make its parts even.
const HALVINGS: u32 = 18;

impl Bezier {
    /// A curve of the third degree, in parts.
    pub fn cubic(control: [Point; 4], parts: &mut Vec<Self>) {
        let [p, q, r, s] = control;
        let mix = |terms: &[(&Point, f64)]| -> Point {
            core::array::from_fn(|i| terms.iter().map(|(p, w)| p[i] * w / 10.0).sum())
        };
        let raised = [
            p,
            mix(&[(&p, 4.0), (&q, 6.0)]),
            mix(&[(&p, 1.0), (&q, 6.0), (&r, 3.0)]),
            mix(&[(&q, 3.0), (&r, 6.0), (&s, 1.0)]),
            mix(&[(&r, 6.0), (&s, 4.0)]),
            s,
        ];
        Self::parts(raised, parts);
    }

    /// A curve of the fifth degree, in parts; more of them where it bends sharply.
    pub fn parts(control: [Point; 6], parts: &mut Vec<Self>) {
        Self::cut(&control, HALVINGS, parts);
    }

    fn cut(control: &[Point; 6], depth: u32, parts: &mut Vec<Self>) {
        let whole = Self::with_length(control);
        let even = [0.25, 0.5, 0.75].iter().all(|f| {
            let slope = whole.at(f * whole.length).q1;
            (measure(&slope) - 1.0).abs() < 0.01
        });
        if even || depth == 0 {
            if whole.length > 0.0 {
                parts.push(whole);
            }
            return;
        }
        let (left, right) = halves(control);
        Self::cut(&left, depth - 1, parts);
        Self::cut(&right, depth - 1, parts);
    }

    fn with_length(control: &[Point; 6]) -> Self {
        let speed = |t: f64| measure(&derivatives(control, t).q1);
        // Gauss' rule with five points on both halves
        let nodes = [
            (0.0, 128.0 / 225.0),
            (0.538_469_310_105_683, 0.478_628_670_499_366),
            (0.906_179_845_938_664, 0.236_926_885_056_189),
        ];
        let half = |mid: f64| -> f64 {
            nodes
                .iter()
                .map(|&(x, w)| {
                    let both = speed(mid + x * 0.25) + speed(mid - x * 0.25);
                    w * both * if x == 0.0 { 0.5 } else { 1.0 }
                })
                .sum::<f64>()
                * 0.25
        };
        let length = half(0.25) + half(0.75);
        let mut bezier = Self { control: *control, t: [0.0; 6], length };
        if length <= 0.0 {
            return bezier;
        }
        // t′ and t″ at an end, per unit of length
        let end = |t: f64| {
            let d = derivatives(control, t);
            let v = measure(&d.q1);
            let (slow, short) = STILL_WITHIN;
            if v < STILL * length || (length < short && v < slow * length) {
                return (1.0 / length, 0.0);
            }
            let [group, _] = [counted(&d.q1), 0..0];
            let dot: f64 = group.map(|i| d.q1[i] * d.q2[i]).sum();
            (1.0 / v, -dot / (v * v * v * v))
        };
        let ((v0, a0), (v1, a1)) = (end(0.0), end(1.0));
        let l = length;
        let dp = 1.0 - l * (v0 + l * a0 / 2.0);
        let (dv, da) = (v1 - v0 - l * a0, a1 - a0);
        bezier.t = [
            0.0,
            v0,
            a0 / 2.0,
            (10.0 * dp - l * (4.0 * dv - l * da / 2.0)) / (l * l * l),
            (-15.0 * dp + l * (7.0 * dv - l * da)) / (l * l * l * l),
            (6.0 * dp - l * (3.0 * dv - l * da / 2.0)) / (l * l * l * l * l),
        ];
        bezier
    }
}

/// The axes that count for the length: X Y Z if one of them moves, else U V W, else A B C.
fn counted(slope: &Point) -> core::ops::Range<usize> {
    let moves = |range: core::ops::Range<usize>| slope[range].iter().any(|x| *x != 0.0);
    if moves(0..3) {
        0..3
    } else if moves(6..9) {
        6..9
    } else {
        3..6
    }
}

/// RS-274/NGC's measure of a way.
pub(crate) fn measure(way: &Point) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|k| way[counted(way).start + k]);
    libm::sqrt(x * x + y * y + z * z)
}

fn halves(control: &[Point; 6]) -> ([Point; 6], [Point; 6]) {
    let (mut row, mut left, mut right) = (*control, *control, *control);
    for level in 0..6 {
        left[level] = row[0];
        right[5 - level] = row[5 - level];
        for j in 0..5 - level {
            row[j] = core::array::from_fn(|i| f64::midpoint(row[j][i], row[j + 1][i]));
        }
    }
    (left, right)
}

/// B and its derivatives by t: by differences, so that of an axis that rests they are zero to the last bit.
fn derivatives(control: &[Point; 6], t: f64) -> Derivatives {
    // de Casteljau's rows; the last three give the derivatives
    let mut row = *control;
    let mut d = Derivatives::default();
    for level in 0..5 {
        let left = 6 - level;
        let change = |i: usize, k: usize| row[k + 1][i] - row[k][i];
        match left {
            4 => {
                let third = |i: usize| change(i, 2) - 2.0 * change(i, 1) + change(i, 0);
                d.q3 = core::array::from_fn(|i| 60.0 * third(i));
            }
            3 => d.q2 = core::array::from_fn(|i| 20.0 * (change(i, 1) - change(i, 0))),
            2 => d.q1 = core::array::from_fn(|i| 5.0 * change(i, 0)),
            _ => {}
        }
        for j in 0..left - 1 {
            row[j] = core::array::from_fn(|i| row[j][i] + t * (row[j + 1][i] - row[j][i]));
        }
    }
    d.q = row[0];
    d
}

impl Shape for Bezier {
    fn length(&self) -> f64 {
        self.length
    }

    fn at(&self, s: f64) -> Derivatives {
        let s = s.clamp(0.0, self.length);
        let c = &self.t;
        let t = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
        let t1 = c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5])));
        let t2 = 2.0 * c[2] + s * (6.0 * c[3] + s * (12.0 * c[4] + s * 20.0 * c[5]));
        let t3 = 6.0 * c[3] + s * (24.0 * c[4] + s * 60.0 * c[5]);
        let b = derivatives(&self.control, t.clamp(0.0, 1.0));
        let mut d = Derivatives { q: b.q, ..Derivatives::default() };
        for i in 0..AXES {
            d.q1[i] = b.q1[i] * t1;
            d.q2[i] = b.q2[i] * t1 * t1 + b.q1[i] * t2;
            d.q3[i] = b.q3[i] * t1 * t1 * t1 + 3.0 * b.q2[i] * t1 * t2 + b.q1[i] * t3;
        }
        d
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// However short the parts are: a rounding over the third power of a part's length is no jerk.
        #[test]
        fn an_axis_that_rests_rests_to_the_last_bit(
            rest in -1000.0..1000.0_f64,
            bulge in prop::array::uniform6(prop::array::uniform2(-1.0..1.0_f64)),
            place in 0.0..1.0_f64,
        ) {
            let point = |k: usize| {
                let mut point = [rest; AXES];
                [point[0], point[1]] = [k as f64 / 5.0 + bulge[k][0], bulge[k][1]];
                point
            };
            let mut parts = Vec::new();
            Bezier::parts(core::array::from_fn(point), &mut parts);
            for part in parts {
                let d = part.at(place * part.length());
                for axis in 2..AXES {
                    let still = [d.q[axis], d.q1[axis], d.q2[axis], d.q3[axis]];
                    prop_assert_eq!(still, [rest, 0.0, 0.0, 0.0]);
                }
            }
        }
    }
}
