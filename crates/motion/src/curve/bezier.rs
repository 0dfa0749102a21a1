//! Bézier curves of the fifth degree, run through by their length.
//!
//! ```text
//!   q = B(t(s)),  0 ≤ t ≤ 1       q′ = B′·t′      q″ = B″·t′² + B′·t″      t′ = 1/|B′|
//! ```
//!
//! B is the programmed curve (one of the third degree is raised, which changes nothing of it). Its
//! own parameter t runs unevenly, so t is made a function of the length s: a polynomial that has
//! the true s, t′ and t″ at both ends. The maker of the curve cuts it so that |q′| is 1 to within
//! a percent or so.
use super::{AXES, Derivatives, Point, Shape};

/// A part of a Bézier curve.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bezier {
    /// Control points of the part.
    pub control: [Point; 6],
    /// t over s: c₀ … c₅.
    t: [f64; 6],
    /// Its length.
    length: f64,
}

/// Slowest |dB/dt| at the end of a part, relative to its length: below, the curve all but stands
/// still, as at a cusp, and t runs evenly there.
const STILL: f64 = 1e-6;

/// The same for a part that is shorter than a setpoint is fine, so that it does not matter how it
/// is run through.
const STILL_WITHIN: (f64, f64) = (0.1, 1e-8);

impl Bezier {
    /// A curve by its control points.
    pub fn new(control: [Point; 6]) -> Self {
        let slopes = Slopes::of(&control);
        let speed = |t: f64| slopes.speed(t);
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
        let mut bezier = Self { control, t: [0.0; 6], length };
        if length <= 0.0 {
            return bezier;
        }
        // t′ and t″ at an end, per unit of length
        let end = |at: usize, next: usize, bend: f64| {
            let slope = slopes.0[at];
            let v = norm(&slope);
            let (slow, short) = STILL_WITHIN;
            if v < STILL * length || (length < short && v < slow * length) {
                return (1.0 / length, 0.0);
            }
            let dot: f64 =
                (0..3).map(|i| slope[i] * bend * 4.0 * (slopes.0[next][i] - slope[i])).sum();
            (1.0 / v, -dot / (v * v * v * v))
        };
        let ((v0, a0), (v1, a1)) = (end(0, 1, 1.0), end(4, 3, -1.0));
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

    /// |q′| at three places between its ends is 1 to within `tolerance`.
    pub fn is_even(&self, tolerance: f64) -> bool {
        let slopes = Slopes::of(&self.control);
        [0.25, 0.5, 0.75].into_iter().all(|share| {
            let (t, t1) = self.parameter(share * self.length);
            (slopes.speed(t.clamp(0.0, 1.0)) * t1.abs() - 1.0).abs() < tolerance
        })
    }

    /// t and t′ at a length.
    fn parameter(&self, s: f64) -> (f64, f64) {
        let c = &self.t;
        let t = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
        let t1 = c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5])));
        (t, t1)
    }
}

/// B′ as a curve of the fourth degree, in the axes that count for the length.
struct Slopes([[f64; 3]; 5]);

impl Slopes {
    fn of(control: &[Point; 6]) -> Self {
        let change = |k: usize, i: usize| 5.0 * (control[k + 1][i] - control[k][i]);
        let moves = |axes: core::ops::Range<usize>| {
            (0..5).any(|k| axes.clone().any(|i| control[k + 1][i] != control[k][i]))
        };
        let first = if moves(0..3) {
            0
        } else if moves(6..9) {
            6
        } else {
            3
        };
        Self(core::array::from_fn(|k| core::array::from_fn(|i| change(k, first + i))))
    }

    /// |B′(t)|.
    fn speed(&self, t: f64) -> f64 {
        let u = 1.0 - t;
        let (uu, tt) = (u * u, t * t);
        let shares = [uu * uu, 4.0 * uu * u * t, 6.0 * uu * tt, 4.0 * u * tt * t, tt * tt];
        norm(&core::array::from_fn(|i| (0..5).map(|k| shares[k] * self.0[k][i]).sum()))
    }
}

fn norm(of: &[f64; 3]) -> f64 {
    let [x, y, z] = of;
    libm::sqrt(x * x + y * y + z * z)
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
pub fn measure(way: &Point) -> f64 {
    norm(&[0, 1, 2].map(|k| way[counted(way).start + k]))
}

/// B and its derivatives by t: by differences, so that of an axis that rests they are zero to the
/// last bit.
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
        let (t, t1) = self.parameter(s);
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
