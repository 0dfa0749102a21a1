//! Splines: G5 (cubic), G5.1 (quadratic), G5.2 … G5.3 (NURBS), all in G17.
//!
//! ```text
//!   G5 I J P Q     ●╌╌○ first control point: start + (I, J)        G5.1 I J  ○  start + (I, J)
//!                 start      ○╌╌● end                                       ╱ ╲
//!                            └ second: end + (P, Q)                        ●   ●
//!
//!   C(u) = Σ Nᵢ(u) wᵢ Pᵢ / Σ Nᵢ(u) wᵢ     Nᵢ B-splines of order L on a clamped uniform knot vector
//! ```
//!
//! All three are NURBS: G5 of order 4 with four points, G5.1 of order 3 with three. The machine gets
//! straight moves that stay within 1 µm of the curve ([`Resolver`]).
//!
//! Source: LinuxCNC 2.9 manual, "G5", "G5.1", "G5.2 G5.3"; L. Piegl, W. Tiller, "The NURBS Book", 2.2 and 4.2.
use crate::{
    call::{Call, Sink},
    codes,
    execute::Executor,
    fault::{Outcome, error, refuse},
    frame::Point,
    resolve::Resolver,
    state::{FeedMode, Motion},
};
use canon::Plane;
use diag::Span;

/// How far a straight piece may be from the curve, mm.
const TOLERANCE_MM: f64 = 0.001;
/// Halvings of one span of the curve at most.
const MAX_HALVINGS: u32 = 12;
/// Control points of one NURBS.
const MAX_POINTS: usize = 10_000;

/// A control point in X and Y, program units, and its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlPoint {
    /// X and Y.
    pub at: [f64; 2],
    /// Weight, above 0.
    pub weight: f64,
}

/// A NURBS being written, from G5.2 to G5.3.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Nurbs {
    order: usize,
    points: Vec<ControlPoint>,
}

impl Executor {
    /// G5 and G5.1.
    pub(crate) fn spline<S: Sink>(&mut self, motion: Motion, sink: &mut S) -> Outcome {
        let span = self.words.place.span;
        let to = self.spline_end()?;
        self.check_spline_feed(sink)?;
        let (start, end) = ([self.state.at[0], self.state.at[1]], [to[0], to[1]]);
        let plain = |at| ControlPoint { at, weight: 1.0 };
        let offset = |from: [f64; 2], by: [f64; 2]| [from[0] + by[0], from[1] + by[1]];
        let [i, j, p, q] = [b'I', b'J', b'P', b'Q'].map(|letter| self.words.get(letter));
        let first = match (i, j, self.state.spline_leaves) {
            (Some(i), Some(j), _) => [i, j],
            (None, None, Some(before)) if motion == Motion::CubicSpline => before,
            _ => {
                let text = "a spline needs I and J, from its start to the first control point (G5 may leave both out after another G5)";
                return refuse("I0551", span, text);
            }
        };
        if motion == Motion::QuadraticSpline {
            let points = [plain(start), plain(offset(start, first)), plain(end)];
            self.state.at = to;
            self.say(sink, &Call::Spline { order: 3, points: &points });
            return Ok(());
        }
        let (Some(p), Some(q)) = (p, q) else {
            return refuse(
                "I0552",
                span,
                "G5 needs P and Q, from its end to the second control point",
            );
        };
        let points =
            [plain(start), plain(offset(start, first)), plain(offset(end, [p, q])), plain(end)];
        self.state.spline_leaves = Some([-p, -q]);
        self.state.at = to;
        self.say(sink, &Call::Spline { order: 4, points: &points });
        Ok(())
    }

    /// G5.2 and the blocks after it: one control point each.
    pub(crate) fn nurbs_point<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let span = self.words.place.span;
        let to = self.spline_end()?;
        let Some(weight) = self.words.get(b'P').filter(|p| *p > 0.0) else {
            return refuse(
                "I0553",
                span,
                "every control point of a NURBS needs P above 0, its weight",
            );
        };
        self.check_spline_feed(sink)?;
        let order = self.words.whole(b'L', 20)?;
        let start = [self.state.at[0], self.state.at[1]];
        let nurbs = self.state.nurbs.get_or_insert_with(|| Nurbs {
            order: 3,
            points: vec![ControlPoint { at: start, weight }],
        });
        if let Some(order) = order {
            if order < 2 {
                return refuse(
                    "I0554",
                    self.words.span(b'L'),
                    "L is the order of the curve: 2 or more, 3 if left out",
                );
            }
            nurbs.order = order as usize;
        }
        if nurbs.points.len() >= MAX_POINTS {
            return refuse(
                "I0555",
                span,
                format!("a NURBS has at most {MAX_POINTS} control points"),
            );
        }
        if self.words.any(codes::set("XY")) {
            nurbs.points.push(ControlPoint { at: [to[0], to[1]], weight });
        }
        self.state.at = to;
        Ok(())
    }

    /// G5.3.
    pub(crate) fn nurbs_end<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let span = self.words.place.span;
        let Some(nurbs) = self.state.nurbs.take() else {
            return refuse("I0556", span, "G5.3 ends a NURBS, but none was begun by G5.2");
        };
        if nurbs.points.len() < nurbs.order {
            let text = format!(
                "a NURBS of order {} needs as many control points, found {}",
                nurbs.order,
                nurbs.points.len()
            );
            return refuse("I0557", span, text);
        }
        self.say(sink, &Call::Spline { order: nurbs.order, points: &nurbs.points });
        self.state.motion = Motion::None;
        Ok(())
    }

    /// A NURBS that is not ended would not be cut at all.
    pub(crate) fn check_nurbs_ended(&mut self) -> Outcome {
        if self.state.nurbs.take().is_some() {
            let fault =
                error("I0558", self.words.place.span, "the NURBS begun by G5.2 is not ended");
            return Err(fault.with_help("write G5.3 after its last control point").into());
        }
        Ok(())
    }

    fn spline_end(&self) -> Outcome<Point> {
        let span = self.words.place.span;
        if self.state.plane != Plane::XY {
            return refuse("I0559", span, "splines lie in the XY plane: write G17 before");
        }
        let to = self.destination(false)?;
        if to[2..] != self.state.at[2..] {
            return refuse("I0560", span, "a spline moves X and Y alone");
        }
        Ok(to)
    }

    fn check_spline_feed<S: Sink>(&self, sink: &mut S) -> Outcome {
        if self.state.feed_mode == FeedMode::InverseTime {
            return refuse(
                "I0561",
                self.words.place.span,
                "splines need G94 or G95: G93 is in force",
            );
        }
        self.say_feed("a spline", || 0.0, sink)
    }
}

/// The curve's point at u, by de Boor's rule in homogeneous coordinates.
fn point(order: usize, points: &[ControlPoint], u: f64) -> [f64; 2] {
    let degree = order - 1;
    let knot = |i: usize| (i.clamp(degree, points.len()) - degree) as f64;
    let last = points.len() - 1;
    let span = (degree + u as usize).clamp(degree, last);
    let mut d: Vec<[f64; 3]> = (span - degree..=span)
        .map(|i| {
            let p = points[i];
            [p.at[0] * p.weight, p.at[1] * p.weight, p.weight]
        })
        .collect();
    for r in 1..=degree {
        for j in (r..=degree).rev() {
            let i = span - degree + j;
            let (low, high) = (knot(i), knot(i + degree + 1 - r));
            let t = (u - low) / (high - low);
            let before = d[j - 1];
            for (here, before) in d[j].iter_mut().zip(before) {
                *here = before * (1.0 - t) + *here * t;
            }
        }
    }
    let [x, y, w] = d[degree];
    [x / w, y / w]
}

impl Resolver {
    /// Straight moves along the curve.
    pub(crate) fn spline(&mut self, order: usize, points: &[ControlPoint], span: Span) {
        if order < 2 || points.len() < order {
            return; // the interpreter says no such thing
        }
        let tolerance = TOLERANCE_MM / self.mm();
        let mut rest = self.frame.to_program(&self.at);
        crate::frame::scale(&mut rest, 1.0 / self.mm());
        let mut ends = Vec::new();
        for piece in 0..=points.len() - order {
            let (from, to) = (piece as f64, piece as f64 + 1.0);
            halve(order, points, [from, to], tolerance, MAX_HALVINGS, &mut ends);
        }
        for end in ends {
            (rest[0], rest[1]) = (end[0], end[1]);
            self.line(&rest, span);
        }
    }
}

/// Halve a piece of the curve until its chord is near enough.
fn halve(
    order: usize,
    points: &[ControlPoint],
    u: [f64; 2],
    tolerance: f64,
    left: u32,
    ends: &mut Vec<[f64; 2]>,
) {
    let [a, b] = u.map(|u| point(order, points, u));
    let middle = f64::midpoint(u[0], u[1]);
    let off = [0.25, 0.5, 0.75].map(|k| {
        let p = point(order, points, u[0] + k * (u[1] - u[0]));
        distance_to_chord(p, a, b)
    });
    if left > 0 && (left > MAX_HALVINGS - 2 || off.iter().any(|d| *d > tolerance * 0.8)) {
        halve(order, points, [u[0], middle], tolerance, left - 1, ends);
        halve(order, points, [middle, u[1]], tolerance, left - 1, ends);
    } else {
        ends.push(b);
    }
}

fn distance_to_chord(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = along[0] * along[0] + along[1] * along[1];
    let t = if squared > 0.0 {
        ((to[0] * along[0] + to[1] * along[1]) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (to[0] - t * along[0]).hypot(to[1] - t * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weighted_quadratic_is_a_circle() {
        // A quarter of the unit circle: middle weight √½.
        let at = |x, y, weight| ControlPoint { at: [x, y], weight };
        let points = [at(1.0, 0.0, 1.0), at(1.0, 1.0, 0.5f64.sqrt()), at(0.0, 1.0, 1.0)];
        for i in 0..=10 {
            let [x, y] = point(3, &points, f64::from(i) / 10.0);
            assert!((x.hypot(y) - 1.0).abs() < 1e-12, "{x} {y}");
        }
    }

    #[test]
    fn a_cubic_of_four_points_is_a_bezier_curve() {
        let points = [[0.0, 0.0], [0.0, 3.0], [1.0, -2.0], [1.0, 1.0]]
            .map(|at| ControlPoint { at, weight: 1.0 });
        // (1 − u)³ P0 + 3u(1 − u)² P1 + 3u²(1 − u) P2 + u³ P3 at u = ½: x = ½, y = (9 − 6 + 1)/8.
        assert_eq!(point(4, &points, 0.5), [0.5, 0.5]);
        assert_eq!(point(4, &points, 1.0), [1.0, 1.0]);
    }
}
