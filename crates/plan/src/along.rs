//! How fast a path may be run: the limits of each axis, turned into limits along the path.
//!
//! On a line each axis takes a fixed share uᵢ of the motion, so `v ≤ vᵢ/uᵢ`, likewise for a and j.
//! On a circle of radius r (k: share of the path's speed that lies in the plane; 1 without a helix)
//! the direction turns:
//!
//! ```text
//!        j_t − v³/r²                          a = a_t·T + v²/r·N
//!   T ◄───────┐                               j = (j_t − v³/r²)·T + 3·v·a_t/r·N
//!             │ N: v²/r, 3·v·a_t/r
//!             ▼                               T along the path, N towards the centre
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `v`, `a_t`, `j_t` | speed along the path and its rates | mm/s… |
//! | A, J | lowest acceleration and jerk limit of the plane's two axes | mm/s², mm/s³ |
//!
//! The vectors a and j are kept shorter than A and J, so no axis sees more, whichever way the path
//! points. The speed is lowered first, until v²/r ≤ 0.8·A and v³/r² ≤ 0.4·J; then what is left goes
//! to `a_t` and `j_t`:
//!
//! ```text
//!   a_t = min(√(A² − v⁴/r²), 0.2·J·r/v)        j_t = √(J² − (3·v·a_t/r)²) − v³/r²
//! ```
use crate::limits::{AxisLimits, MachineLimits};
use crate::ramp::rest_to_rest;
use canon::{Arc, Axis, Plane, Position};
use motion::{Path, Profile, coordinate, radius};

/// Limits along a path, in the units of its parameter (mm, or degrees for rotary axes) and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Along {
    /// What the axes allow, and on an arc also the way the path bends.
    pub(crate) speed: f64,
    /// What the axes' highest speeds alone allow.
    pub(crate) axis_speed: f64,
    pub(crate) accel: f64,
    pub(crate) jerk: f64,
}

/// Limits of one axis for one kind of move.
#[derive(Clone, Copy)]
struct OfAxis {
    speed: f64,
    accel: f64,
    jerk: f64,
}

impl OfAxis {
    fn of(axis: &AxisLimits, rapid: bool) -> Self {
        let (speed, jerk) = if rapid {
            (axis.rapid_speed, axis.rapid_jerk)
        } else {
            (axis.feed_speed, axis.feed_jerk)
        };
        Self { speed: speed.value(), accel: axis.accel.value(), jerk: jerk.value() }
    }

    /// The lower of each.
    fn min(self, other: Self) -> Self {
        Self {
            speed: self.speed.min(other.speed),
            accel: self.accel.min(other.accel),
            jerk: self.jerk.min(other.jerk),
        }
    }
}

/// Limits along a path of positive length; `wanted` is the speed it shall have, which on an arc
/// decides how much acceleration is left along it. `Err` names an axis that the machine lacks.
pub(crate) fn along(
    path: &Path,
    limits: &MachineLimits,
    rapid: bool,
    wanted: f64,
) -> Result<Along, Axis> {
    let length = path.length();
    let plane = match path {
        Path::Line { .. } => None,
        Path::Arc { arc, .. } => Some(arc.plane.axes()),
        Path::Spline { .. } => Some(Plane::XY.axes()),
    };
    let in_plane = |axis: Axis| plane.is_some_and(|[a, b, _]| axis == a || axis == b);
    let none = f64::INFINITY;
    let mut bound = Along { speed: none, axis_speed: none, accel: none, jerk: none };
    for axis in Axis::ALL {
        let share = change(path.from(), path.to(), axis).abs() / length;
        if share > 0.0 && !in_plane(axis) {
            let of = OfAxis::of(limits.axes[axis.index()].as_ref().ok_or(axis)?, rapid);
            bound.axis_speed = bound.axis_speed.min(of.speed / share);
            bound.accel = bound.accel.min(of.accel / share);
            bound.jerk = bound.jerk.min(of.jerk / share);
        }
    }
    if let Some([first, second, _]) = plane {
        let of = |axis: Axis| {
            limits.axes[axis.index()].as_ref().map(|a| OfAxis::of(a, rapid)).ok_or(axis)
        };
        let plane = of(first)?.min(of(second)?);
        bound = match path {
            Path::Line { .. } => bound,
            Path::Arc { from, arc, .. } => on_circle(bound, plane, from, arc, length, wanted),
            // it is planned as a path in any case: what the axes can do at all
            Path::Spline { .. } => {
                let OfAxis { speed, accel, jerk } = plane;
                Along { speed, axis_speed: speed, accel, jerk }
            }
        };
    }
    bound.speed = bound.speed.min(bound.axis_speed);
    Ok(bound)
}

/// The equations of the module's header.
fn on_circle(
    bound: Along,
    plane: OfAxis,
    from: &Position,
    arc: &Arc,
    length: f64,
    wanted: f64,
) -> Along {
    let r = radius(from, arc);
    let k = r * arc.sweep.in_rad().abs() / length;
    if k <= 0.0 {
        return bound;
    }
    let (big_a, big_j) = (plane.accel, plane.jerk);
    let axis_speed = bound.axis_speed.min(plane.speed / k);
    let v = (wanted.min(axis_speed) * k)
        .min(libm::sqrt(0.8 * big_a * r))
        .min(libm::cbrt(0.4 * big_j * r * r));
    let centripetal = v * v / r;
    let mut a_t = libm::sqrt(big_a * big_a - centripetal * centripetal);
    let mut j_t = f64::INFINITY;
    if big_j.is_finite() {
        a_t = a_t.min(0.2 * big_j * r / v);
        let across = 3.0 * v * a_t / r;
        j_t = libm::sqrt(big_j * big_j - across * across) - v * v * v / (r * r);
    }
    Along {
        speed: v / k,
        axis_speed,
        accel: bound.accel.min(a_t / k),
        jerk: bound.jerk.min(j_t / k),
    }
}

/// How far an axis goes, in mm or degrees.
pub(crate) fn change(from: &Position, to: &Position, axis: Axis) -> f64 {
    coordinate(to, axis) - coordinate(from, axis)
}

impl Along {
    /// From rest to rest at a speed (or the highest allowed).
    pub(crate) fn profile(&self, length: f64, speed: f64) -> Profile {
        rest_to_rest(length, speed.min(self.speed), self.accel, self.jerk)
    }

    /// From rest to rest at a feed per revolution of a spindle that turns at `n` rev/s: the
    /// profile's time is revolutions, in which speed is v/n, acceleration a/n², jerk j/n³.
    pub(crate) fn profile_over_revolutions(&self, length: f64, feed: f64, n: f64) -> Profile {
        let speed = feed.min(self.speed / n);
        rest_to_rest(length, speed, self.accel / (n * n), self.jerk / (n * n * n))
    }

    /// From rest to rest in a given time, or as fast as allowed.
    ///
    /// With cruising speed v the time is length/v + v/a + a/j (…+ 2·√(v/j) if a is never reached),
    /// which falls with v: v is found by halving.
    pub(crate) fn profile_lasting(&self, length: f64, time: f64) -> Profile {
        let fastest = self.profile(length, self.speed);
        if fastest.duration() >= time {
            return fastest;
        }
        let ramp = |v: f64| {
            if v * self.jerk >= self.accel * self.accel {
                v / self.accel + self.accel / self.jerk
            } else {
                2.0 * libm::sqrt(v / self.jerk)
            }
        };
        let (mut low, mut high) = (length / time, fastest.peak());
        for _ in 0..53 {
            let middle = f64::midpoint(low, high);
            if length / middle + ramp(middle) > time { low = middle } else { high = middle }
        }
        self.profile(length, high)
    }
}
