//! Paths as CAM writes them: always the same ones.
use motion::{AXES, Arc, Curve, Line, Point};
use path::geometry::Segment;
use std::f64::consts::TAU;

/// A name, and what is programmed.
pub(crate) type Path = (&'static str, Vec<Segment>);

/// Feed, mm/s.
const FEED: f64 = 100.0;
/// How far a chord of the surface is from it at most, mm.
const CHORD_ERROR: f64 = 0.005;

/// A surface in rows, trochoids as chords and as arcs, and corners everywhere; lines of 0.05 mm on,
/// within `p` mm.
pub(crate) fn all(p: f64) -> Vec<Path> {
    vec![
        ("surface", lines(&surface(100_000), p)),
        ("trochoids, chords", lines(&trochoids(50_000), p)),
        ("trochoids, arcs", arcs(18_000, p)),
        ("corners", lines(&corners(20_000), p)),
    ]
}

fn segment(curve: &Curve, p: f64, line: u32) -> Segment {
    // as the interpreter has it where no Q is stated
    let (tolerance, merge) = (0.98 * p, 0.02 * p);
    Segment { curve: *curve, feed: FEED, rapid: false, tolerance, merge, op: line, line }
}

fn lines(points: &[Point], p: f64) -> Vec<Segment> {
    let line = |(k, pair): (u32, &[Point])| {
        let square = |axis: usize| (pair[1][axis] - pair[0][axis]).powi(2);
        let length = (0..AXES).map(square).sum::<f64>().sqrt();
        (length > 0.0)
            .then(|| segment(&Curve::Line(Line { from: pair[0], to: pair[1], length }), p, k))
    };
    (1..).zip(points.windows(2)).filter_map(line).collect()
}

/// As a post writes it: in micrometres.
fn point(x: f64, y: f64, z: f64) -> Point {
    let mut point = [0.0; AXES];
    for (axis, value) in [x, y, z].into_iter().enumerate() {
        point[axis] = (value * 1e3).round() / 1e3;
    }
    point
}

/// Rows of 100 mm over waves 0.3 mm apart, in chords of 0.05 to 0.5 mm, as long as their error
/// allows.
fn surface(count: usize) -> Vec<Point> {
    let height =
        |x: f64, y: f64| 4.0 * (x / 9.0).sin() * (y / 13.0).cos() + 0.8 * (x / 1.7 + y / 5.0).sin();
    let bend = |x: f64, y: f64| {
        let h = 1e-3;
        ((height(x - h, y) - 2.0 * height(x, y) + height(x + h, y)) / (h * h)).abs()
    };
    let (mut points, mut y, mut forwards) = (Vec::new(), 0.0, true);
    while points.len() < count {
        let mut way = 0.0;
        while way < 100.0 {
            let x = if forwards { way } else { 100.0 - way };
            points.push(point(x, y, height(x, y)));
            let chord = (8.0 * CHORD_ERROR / bend(x, y).max(1e-6)).sqrt();
            way += chord.clamp(0.05, 0.5);
        }
        (y, forwards) = (y + 0.3, !forwards);
    }
    points
}

/// Circles of 4 mm that advance by 0.8 mm each, in chords of 0.1 mm.
fn trochoids(count: usize) -> Vec<Point> {
    let angle = |k: usize| k as f64 * 0.05;
    let at = |a: f64| point(2.0 * a.cos() + 0.8 * a / TAU, 2.0 * a.sin(), -2.0);
    (0..count).map(|k| at(angle(k))).collect()
}

/// The same as half circles, each beginning where the one before ends: 2 mm and 2.2 mm.
fn arcs(count: u32, p: f64) -> Vec<Segment> {
    let (mut x, mut segments) = (0.0, Vec::new());
    for k in 0..count {
        let radius = if k % 2 == 0 { 2.0 } else { -2.2 };
        let (from, to) = (point(x, 0.0, -2.0), point(x + 2.0 * radius, 0.0, -2.0));
        let (sweep, length) = (TAU / 2.0, radius.abs() * TAU / 2.0);
        let arc = Arc { from, to, plane: [0, 1], centre: [x + radius, 0.0], sweep, length };
        segments.push(segment(&Curve::Arc(arc), p, k + 1));
        x += 2.0 * radius;
    }
    segments
}

/// Lines of 0.5 to 5 mm that turn by 20 to 160 degrees.
fn corners(count: u32) -> Vec<Point> {
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
    let mut points = vec![point(x, y, 0.0)];
    for k in 1..=count {
        // shares that are spread evenly
        let [length, turn] = [0.618_034, 0.414_214].map(|step| (f64::from(k) * step).fract());
        let (sin, cos) = heading.sin_cos();
        (x, y) = (x + (0.5 + 4.5 * length) * cos, y + (0.5 + 4.5 * length) * sin);
        points.push(point(x, y, 0.0));
        let sign = if (f64::from(k) * 0.732_051).fract() < 0.5 { -1.0 } else { 1.0 };
        heading += sign * (20.0 + 140.0 * turn).to_radians();
    }
    points
}
