//! What the tolerance allows beside a corner of two lines.
//!
//! ```text
//!              X            all places that are within P of either line: they go as far in as X, which is P from both of them,
//!     ────╮    ·            P/cos(θ/2) from the corner C. Balls in all of it have their middles on a fillet; the deeper that is,
//!   ──╮   │ ╲              the smaller they are:  r² = P² − d²·cot²(θ/2) in its middle, d away from C, and P at its ends, as what
//!     ╰─╮ │   C             lies beside the corner's plane is near to neither line
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | θ, k | by how much the lines turn; sin θ/2 |
//! | d, r | how far the fillet's middle is from the corner; the radius of the ball there |
//!
//! Within P of the programmed places, one by one, the path would pass the corner at P. An acute one
//! is not passed farther away than a right angle is, at √2·P.
use super::corner::DEEPEST;
use super::joint::Waiting;
use super::knots::Way;
use motion::{Curve, Point};

/// Corners with a smaller k (= sin θ/2) keep their point: X is less than P/100 farther away than P.
const SHALLOW: f64 = 0.14;
/// d over what X is farther away than P: the larger, the more of the inner side is allowed, nearly
/// up to X, and the less of the outer one.
const DEPTH: f64 = 1.4;

/// At a parameter on a move: a place, and how near to it the path must be so that it is within `p`
/// of the programmed one.
pub(crate) fn allowed(way: &Way, i: usize, u: f64, p: f64) -> (Point, f64) {
    let (behind, ahead) = (u - way.starts[i], way.starts[i] + way.moves[i].length() - u);
    let (corner, x) = if behind < ahead { (i, behind) } else { (i + 1, -ahead) };
    rounded(way, corner, x, p).unwrap_or_else(|| (way.on(i, u), p))
}

/// `x` behind the corner at the beginning of a move; `None`: it is not on the fillet.
fn rounded(way: &Way, i: usize, x: f64, p: f64) -> Option<(Point, f64)> {
    let (before, after) = (way.moves.get(i.checked_sub(1)?)?, way.moves.get(i)?);
    let (t0, t1) = (&before.end.q1, &after.start.q1);
    let line = |of: &Waiting| matches!(of.segment.curve, Curve::Line(_));
    let linear = |t: &Point| t[..3].iter().any(|t| *t != 0.0) && t[3..].iter().all(|t| *t == 0.0);
    if !line(before) || !line(after) || !linear(t0) || !linear(t1) {
        return None;
    }
    let shorter = before.length().min(after.length());
    let fillet = Fillet::of(after.joint.k, shorter, p.min(after.joint.tolerance))?;
    let ([a, b], radius) = fillet.at(x)?;
    let middle = core::array::from_fn(|i| after.start.q[i] + a * t0[i] + b * t1[i]);
    Some((middle, radius))
}

#[derive(Clone, Copy, Debug)]
struct Fillet {
    k: f64,
    /// d.
    deep: f64,
    /// How far along both lines.
    reach: f64,
    /// P, and r in the middle.
    radii: [f64; 2],
}

impl Fillet {
    /// Between two lines whose slopes differ by 2·k, for a tolerance of `p`; `shorter` is the
    /// length of the shorter line.
    fn of(k: f64, shorter: f64, p: f64) -> Option<Self> {
        if k < SHALLOW {
            return None;
        }
        let cosine = cosine(k);
        let deepest = DEPTH * p * ((1.0 / cosine).min(DEEPEST) - 1.0);
        let whole = deepest * k / (1.0 - cosine);
        // the balls are near to the lines, not to what comes before and after them
        let reach = whole.min(shorter / 2.0).min(shorter - p);
        let deep = deepest * reach / whole;
        let beside = deep * cosine / k;
        let radius = libm::sqrt(p * p - beside * beside).min(DEEPEST * p - deep);
        (reach > 0.0).then_some(Self { k, deep, reach, radii: [p, radius] })
    }

    /// Its place at the parameter `x`, zero in its middle: from the corner, shares of both slopes;
    /// and r there.
    fn at(&self, x: f64) -> Option<([f64; 2], f64)> {
        if x.abs() >= self.reach {
            return None;
        }
        let cosine = cosine(self.k);
        let (sin, cos) = libm::sincos(libm::asin(self.k.min(1.0)) * x / self.reach);
        let size = self.deep / (1.0 - cosine) / 2.0;
        let (inward, along) = (size * (1.0 - cosine * cos) / self.k, size * sin);
        let ([edge, middle], share) = (self.radii, x * x / (self.reach * self.reach));
        Some(([along - inward, along + inward], middle + share * (edge - middle)))
    }
}

/// cos(θ/2).
fn cosine(k: f64) -> f64 {
    libm::sqrt((1.0 - k * k).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const P: f64 = 0.01;

    /// From a line that ends at the origin, or begins there.
    fn from_line(q: [f64; 3], slope: [f64; 3], length: f64) -> f64 {
        let along: f64 = (0..3).map(|i| q[i] * slope[i]).sum();
        let along = along.clamp(length.min(0.0), length.max(0.0));
        libm::sqrt((0..3).map(|i| (q[i] - along * slope[i]).powi(2)).sum())
    }

    proptest! {
        #[test]
        fn what_is_near_the_fillet_is_within_p_of_the_lines(
            turn in 0.3..core::f64::consts::PI,
            length in 1.0..10.0_f64,
            share in -1.0..1.0_f64,
        ) {
            let length = length * P;
            let (sin, cos) = turn.sin_cos();
            let slopes = [[1.0, 0.0, 0.0], [cos, sin, 0.0]];
            let Some(fillet) = Fillet::of((turn / 2.0).sin(), length, P) else { return Ok(()) };
            let Some(([a, b], radius)) = fillet.at(share * fillet.reach) else { return Ok(()) };
            for step in 0..64 * 16 {
                let (heading, climb) = (f64::from(step / 16) / 10.0, f64::from(step % 16) / 15.0);
                let flat = (1.0 - climb * climb).sqrt();
                let aside = [flat * heading.cos(), flat * heading.sin(), climb];
                let place = |i: usize| a * slopes[0][i] + b * slopes[1][i] + radius * aside[i];
                let q: [f64; 3] = core::array::from_fn(place);
                let near = from_line(q, slopes[0], -length).min(from_line(q, slopes[1], length));
                prop_assert!(near < P * (1.0 + 1e-9), "{near} from the lines");
            }
        }
    }

    #[test]
    fn a_right_angle_is_passed_nearly_as_far_away_as_both_lines_allow() {
        let fillet = Fillet::of(core::f64::consts::FRAC_1_SQRT_2, 1.0, P).expect("a corner");
        let ([a, b], radius) = fillet.at(0.0).expect("its middle");
        assert!((a + b).abs() < 1e-12 && (libm::hypot(a, b) - fillet.deep).abs() < 1e-12);
        let away = fillet.deep + radius;
        assert!(away > 1.39 * P && away <= DEEPEST * P, "{away}");
    }
}
