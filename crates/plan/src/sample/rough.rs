//! How long moves take, roughly: each is run by a constant acceleration between the speeds at its
//! ends.
//!
//! ```text
//!            θ                         R = P·c/(1 − c), c = cos(θ/2), and no longer than half a move
//!   ──────╮                            v² ≤ a·R,  v³ ≤ j·R²
//!       R  ╲                           acceleration in place of a and j: v over the time that
//!           ╲                          reaching v from rest takes
//! ```
//!
//! It knows neither fitted curves nor what one axis leaves to the others: it is no time to tell
//! anyone, but it goes up and down with the planned one, which is what a sample needs.
use crate::run::OrderedMove;
use alloc::vec::Vec;
use motion::{AXES, Path, Point, Shape, coordinate};
use units::Time;

/// Directions that differ by less go straight on: 1 − cos.
const STRAIGHT: f64 = 1e-12;

/// One move, as it is looked at here.
#[derive(Clone, Copy, Debug)]
struct RoughMove {
    length: f64,
    speed: f64,
    accel: f64,
    /// Speed at its beginning, at most.
    enter: f64,
}

/// The last move: where it goes at its end, how long it is, how fast it may be.
#[derive(Clone, Copy, Debug)]
struct Last {
    toward: Point,
    length: f64,
    speed: f64,
}

/// See the module's header.
#[derive(Clone, Debug, Default)]
pub(super) struct Rough {
    rows: Vec<RoughMove>,
    last: Option<Last>,
}

impl Rough {
    /// Moves so far.
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The next move.
    pub(super) fn push(&mut self, order: &OrderedMove) {
        let (length, speed) = (order.length(), order.speed());
        let (from, toward) = directions(order);
        let (accel, jerk) = (order.bound.accel, order.bound.jerk);
        let enter = self.last.map_or(0.0, |last| {
            let room = length.min(last.length) / 2.0;
            let radius = radius(&last.toward, &from, order.segment.tolerance, room);
            let bend = libm::sqrt(accel * radius).min(libm::cbrt(jerk * radius * radius));
            bend.min(speed).min(last.speed)
        });
        let accel = speed / from_rest(speed, accel, jerk);
        self.rows.push(RoughMove { length, speed, accel, enter });
        self.last = Some(Last { toward, length, speed });
    }

    /// The path comes to rest.
    pub(super) const fn rest(&mut self) {
        self.last = None;
    }

    /// How long the moves so far take; more moves begin anew, in the motion that there is.
    pub(super) fn take(&mut self) -> Time {
        let reached = |v: f64, row: &RoughMove| libm::sqrt(v * v + 2.0 * row.accel * row.length);
        let mut v = self.rows.first().map_or(0.0, |row| row.enter);
        for row in &mut self.rows {
            row.enter = row.enter.min(v);
            v = reached(row.enter, row);
        }
        let mut exit = self.last.map_or(0.0, |last| last.speed);
        let mut all = 0.0;
        for row in self.rows.iter().rev() {
            let enter = row.enter.min(reached(exit, row));
            all += lasts(row, enter, exit.min(reached(enter, row)));
            exit = enter;
        }
        self.rows.clear();
        Time::s(all)
    }
}

/// Seconds of a move, from one speed to another.
fn lasts(row: &RoughMove, enter: f64, exit: f64) -> f64 {
    let RoughMove { length, speed, accel, .. } = *row;
    let mean = f64::midpoint(enter * enter, exit * exit);
    let peak = libm::sqrt(mean + accel * length).min(speed);
    let ramps = (2.0 * peak - enter - exit) / accel;
    let way = (peak * peak - mean) / accel;
    ramps + (length - way).max(0.0) / peak
}

/// Seconds from rest to a speed.
fn from_rest(v: f64, accel: f64, jerk: f64) -> f64 {
    if v * jerk > accel * accel { v / accel + accel / jerk } else { 2.0 * libm::sqrt(v / jerk) }
}

/// Radius of the arc that a corner leaves room for.
fn radius(before: &Point, after: &Point, tolerance: f64, room: f64) -> f64 {
    let cos: f64 = before.iter().zip(after).map(|(a, b)| a * b).sum();
    if cos > 1.0 - STRAIGHT {
        return f64::INFINITY;
    }
    let half = libm::sqrt(f64::midpoint(1.0, cos).max(0.0)); // cos(θ/2)
    let sin = libm::sqrt(f64::midpoint(1.0, -cos).max(0.0));
    (tolerance * half / (1.0 - half)).min(room * half / sin)
}

/// Directions at the beginning and at the end.
fn directions(order: &OrderedMove) -> (Point, Point) {
    if let Path::Line { from, to } = &order.path {
        let mut way = [0.0; AXES];
        for (way, axis) in way.iter_mut().zip(canon::Axis::ALL) {
            *way = (coordinate(to, axis) - coordinate(from, axis)) / order.length();
        }
        return (way, way);
    }
    let curve = &order.segment.curve;
    (curve.at(0.0).q1, curve.at(curve.length()).q1)
}
