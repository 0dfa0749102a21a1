//! A spline's control points, turned into pieces of the fifth degree.
use crate::{
    call::ControlPoint,
    resolve::{Resolver, position},
};
use canon::{OpKind, Spline};
use diag::Span;
use units::Length;

/// How far a piece may be from the curve, mm: rounding, of what has no weights and a degree of five
/// or less.
const TOLERANCE_MM: f64 = 1e-6;
/// Halvings of one span of the curve at most.
const MAX_HALVINGS: u32 = 12;

/// Curves of the fifth degree, as the machine follows them.
pub(crate) fn operation(
    resolver: &mut Resolver,
    order: usize,
    points: &[ControlPoint],
    span: Span,
) {
    if order < 2 || points.len() < order {
        return; // the interpreter says no such thing
    }
    let tolerance = TOLERANCE_MM / resolver.mm();
    let mut rest = resolver.frame.to_program(&resolver.at);
    crate::geometry::frame::scale(&mut rest, 1.0 / resolver.mm());
    let mut parts = Vec::new();
    for piece in 0..=points.len() - order {
        let within = [piece as f64, piece as f64 + 1.0];
        halve(order, points, within, (tolerance, MAX_HALVINGS), &mut parts);
    }
    let from = resolver.at;
    let mut to = from;
    let mut pieces = Vec::with_capacity(parts.len());
    for [_, ahead @ ..] in parts {
        let mut piece = [[Length::ZERO; 2]; 5];
        for (point, control) in ahead.into_iter().zip(&mut piece) {
            (rest[0], rest[1]) = (point[0], point[1]);
            to = resolver.machine(&rest);
            if resolver.is_too_far(&to, span) {
                return;
            }
            *control = [to[0], to[1]].map(Length::mm);
        }
        pieces.push(piece);
    }
    if !resolver.arrives(&to, span) {
        resolver.say_path(span); // a closed curve ends where it began
    }
    let feed = resolver.feed(&from, &[1.0; 9], span);
    resolver.push(span, OpKind::Spline { to: position(&to), spline: Spline { pieces }, feed });
}

/// A place of the curve in homogeneous coordinates, by de Boor's rule with a parameter of its own
/// for each of its steps (the curve's blossom): with all of them at u, the curve's at u. They all
/// lie in the span `within` lies in.
fn blossom(
    order: usize,
    points: &[ControlPoint],
    within: f64,
    at: impl Fn(usize) -> f64,
) -> [f64; 3] {
    let degree = order - 1;
    let knot = |i: usize| (i.clamp(degree, points.len()) - degree) as f64;
    let last = points.len() - 1;
    let span = (degree + within as usize).clamp(degree, last);
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
            let t = (at(r) - low) / (high - low);
            let before = d[j - 1];
            for (here, before) in d[j].iter_mut().zip(before) {
                *here = before * (1.0 - t) + *here * t;
            }
        }
    }
    d[degree]
}

/// The curve's point at u.
fn point(order: usize, points: &[ControlPoint], u: f64) -> [f64; 2] {
    let [x, y, w] = blossom(order, points, u, |_| u);
    [x / w, y / w]
}

/// Point, first and second derivative at one end of a piece, of a parameter that runs from 0 there
/// to 1 at its other end.
fn derivatives(order: usize, points: &[ControlPoint], from: f64, to: f64) -> [[f64; 2]; 3] {
    let degree = (order - 1) as f64;
    let within = f64::midpoint(from, to);
    // the first three control points of the piece as a Bézier curve
    let control = |moved: usize| {
        let moved = moved.min(order - 1);
        blossom(order, points, within, |r| if r <= moved { to } else { from })
    };
    let [a, b, c] = [control(0), control(1), control(2)];
    let first: [f64; 3] = core::array::from_fn(|i| degree * (b[i] - a[i]));
    let second: [f64; 3] =
        core::array::from_fn(|i| degree * (degree - 1.0) * (c[i] - 2.0 * b[i] + a[i]));
    // p = A/w:  p′ = (A′ − w′·p)/w,  p″ = (A″ − 2·w′·p′ − w″·p)/w
    let w = a[2];
    let p: [f64; 2] = core::array::from_fn(|i| a[i] / w);
    let slope: [f64; 2] = core::array::from_fn(|i| (first[i] - first[2] * p[i]) / w);
    let bend =
        core::array::from_fn(|i| (second[i] - 2.0 * first[2] * slope[i] - second[2] * p[i]) / w);
    [p, slope, bend]
}

/// Halve a piece of the curve until a polynomial of the fifth degree is near enough. Of a curve
/// that is one itself, every piece is.
fn halve(
    order: usize,
    points: &[ControlPoint],
    u: [f64; 2],
    (tolerance, left): (f64, u32),
    parts: &mut Vec<[[f64; 2]; 6]>,
) {
    let part = quintic(order, points, u);
    let near = |k: f64| {
        let on_curve = point(order, points, u[0] + k * (u[1] - u[0]));
        let [x, y] = bezier(&part, k);
        (x - on_curve[0]).hypot(y - on_curve[1]) <= tolerance
    };
    if left == 0 || [0.25, 0.5, 0.75].into_iter().all(near) {
        parts.push(part);
        return;
    }
    let middle = f64::midpoint(u[0], u[1]);
    halve(order, points, [u[0], middle], (tolerance, left - 1), parts);
    halve(order, points, [middle, u[1]], (tolerance, left - 1), parts);
}

/// The Bézier curve of the fifth degree that begins and ends on a piece, with its slopes and bends.
fn quintic(order: usize, points: &[ControlPoint], u: [f64; 2]) -> [[f64; 2]; 6] {
    let h = u[1] - u[0];
    let end = |from: f64, to: f64| {
        let [p, slope, bend] = derivatives(order, points, from, to);
        // B′ = 5·(P₁ − P₀), B″ = 20·(P₂ − 2·P₁ + P₀), of a parameter that runs from this end to
        // the other
        let near: [f64; 2] = core::array::from_fn(|i| p[i] + slope[i] / 5.0);
        let next = core::array::from_fn(|i| 2.0 * near[i] - p[i] + bend[i] / 20.0);
        [p, near, next]
    };
    debug_assert!(h > 0.0, "a piece of the curve has a length");
    let [p0, p1, p2] = end(u[0], u[1]);
    let [p5, p4, p3] = end(u[1], u[0]);
    [p0, p1, p2, p3, p4, p5]
}

/// Where a Bézier curve is.
fn bezier(control: &[[f64; 2]; 6], t: f64) -> [f64; 2] {
    let mut row = *control;
    for level in (1..6).rev() {
        for k in 0..level {
            row[k] = core::array::from_fn(|i| (1.0 - t) * row[k][i] + t * row[k + 1][i]);
        }
    }
    row[0]
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

    /// Half a circle of weights, a curve of order 7, one of order 4 over five spans: each near a
    /// polynomial all along.
    #[test]
    fn pieces_of_the_fifth_degree_follow_the_curve() {
        let at = |x: f64, y: f64, weight: f64| ControlPoint { at: [x, y], weight };
        let wave = |weight: fn(usize) -> f64| -> Vec<ControlPoint> {
            (0..8).map(|k| at(k as f64, [0.0, 3.0, -2.0][k % 3], weight(k))).collect()
        };
        let circle = vec![at(1.0, 0.0, 1.0), at(1.0, 1.0, 0.5f64.sqrt()), at(0.0, 1.0, 1.0)];
        for (order, points, exact) in [
            (3, circle, false),
            (7, wave(|_| 1.0), false),
            (4, wave(|_| 1.0), true),
            (4, wave(|k| 1.0 + (k % 2) as f64), false),
            (2, wave(|_| 1.0), true),
        ] {
            let mut parts = Vec::new();
            let spans = points.len() - order + 1;
            for piece in 0..spans {
                let within = [piece as f64, piece as f64 + 1.0];
                halve(order, &points, within, (1e-6, MAX_HALVINGS), &mut parts);
            }
            assert_eq!(parts.len() == spans, exact, "order {order}: {} parts", parts.len());
            assert!(parts.len() < 40 * spans, "order {order}: {} parts", parts.len());
            for pair in parts.windows(2) {
                let ([.., a, b], [c, d, ..]) = (pair[0], pair[1]);
                assert!((b[0] - c[0]).hypot(b[1] - c[1]) < 1e-12);
                let turn = (b[0] - a[0]) * (d[1] - c[1]) - (b[1] - a[1]) * (d[0] - c[0]);
                assert!(order == 2 || turn.abs() < 1e-9, "order {order}: a corner");
            }
            // all of the curve is near some part
            for n in 0..=200 {
                let u = f64::from(n) / 200.0 * spans as f64;
                let p = point(order, &points, u.min(spans as f64 - 1e-12));
                let near = |part: &[[f64; 2]; 6]| {
                    let off = |t: f64| {
                        let q = bezier(part, t);
                        (q[0] - p[0]).hypot(q[1] - p[1])
                    };
                    let [mut low, mut high] = [0.0, 1.0];
                    let best = (0..=50).map(|k| f64::from(k) / 50.0);
                    let best = best.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap();
                    (low, high) = (f64::max(low, best - 0.02), f64::min(high, best + 0.02));
                    for _ in 0..60 {
                        let third = (high - low) / 3.0;
                        if off(low + third) < off(high - third) {
                            high -= third;
                        } else {
                            low += third;
                        }
                    }
                    off(f64::midpoint(low, high))
                };
                let off = parts.iter().map(near).fold(f64::INFINITY, f64::min);
                assert!(off < 3e-6, "order {order} at {u}: {off}");
            }
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
