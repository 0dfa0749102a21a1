//! Where the axes are along a path, by its length.
//!
//! ```text
//!                  to                  with f = s / L,  d = from − centre,  φ = sweep·f
//!      ╭───────●                       line:  p = from·(1 − f) + to·f
//!    ╱    ╲φ                           arc:   p = centre + R(φ)·d + f·e      in the plane
//!   ●──d──┼ centre                            p = from·(1 − f) + to·f        along all other axes
//!  from
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s, v, a | path parameter and its rates (from the profile) | mm, mm/s, mm/s² |
//! | L | length of the path | mm |
//! | R(φ) | rotation by φ, counter-clockwise seen against the plane's normal | |
//! | e | what the rotated start lacks to the programmed end: rounding of the program | mm |
//!
//! Spreading e over the path (instead of jumping at its end) keeps the motion smooth and its end
//! exact. Of a spline X and Y are its own polynomials of the length ([`Bezier`]). On a circle the
//! acceleration has a part towards the centre, v²/r, beside the part along the path.
//!
//! Length follows RS-274/NGC (NIST IR 6556, 2.1.2.5): along X Y Z if one of them moves, else along
//! U V W, else the turn of the rotary axes in degrees; all others arrive at the same time.
use crate::{Bezier, Curve, Instant, Line, Shape};
use units::{Arc, Axis, Coordinate, CoordinateAccel, CoordinateSpeed, Length, Position};

/// A path of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // it is moved into a queue once
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Path {
    /// A straight line.
    Line {
        /// Where it begins.
        from: Position,
        /// Where it ends.
        to: Position,
    },
    /// A circle or helix.
    Arc {
        /// Where it begins.
        from: Position,
        /// Where it ends.
        to: Position,
        /// Which circle.
        arc: Arc,
    },
    /// A part of a spline.
    Spline {
        /// Where it begins.
        from: Position,
        /// Where it ends.
        to: Position,
        /// The part.
        curve: Bezier,
    },
}

/// Where the axes shall be, and how they move, by [`Axis`] index.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Motion {
    /// Position.
    pub position: [Coordinate; 9],
    /// Speed.
    pub speed: [CoordinateSpeed; 9],
    /// Acceleration, with the centripetal part on arcs.
    pub accel: [CoordinateAccel; 9],
}

impl Path {
    /// Where it begins.
    pub const fn from(&self) -> &Position {
        match self {
            Self::Line { from, .. } | Self::Arc { from, .. } | Self::Spline { from, .. } => from,
        }
    }

    /// Where it ends.
    pub const fn to(&self) -> &Position {
        match self {
            Self::Line { to, .. } | Self::Arc { to, .. } | Self::Spline { to, .. } => to,
        }
    }

    /// Length of the path, mm: what its profile's parameter runs over. For a move of rotary axes
    /// alone it is the turn in degrees, as RS-274/NGC measures it.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => line_length(from, to),
            Self::Arc { from, to, arc } => {
                let [_, _, normal] = arc.plane.axes();
                let rise = to.along(normal).value() - from.along(normal).value();
                libm::hypot(radius(from, arc) * arc.sweep.in_rad(), rise)
            }
            Self::Spline { curve, .. } => curve.length(),
        }
    }

    /// As a [`Curve`] of all axes.
    pub fn curve(&self) -> Curve {
        let point = |position: &Position| Axis::ALL.map(|axis| coordinate(position, axis));
        let (from, to, length) = (point(self.from()), point(self.to()), self.length());
        match self {
            Self::Line { .. } => Curve::Line(Line { from, to, length }),
            Self::Arc { arc, .. } => {
                let [first, second, _] = arc.plane.axes().map(Axis::index);
                Curve::Arc(crate::Arc {
                    from,
                    to,
                    plane: [first, second],
                    centre: arc.centre.map(Length::value),
                    sweep: arc.sweep.in_rad(),
                    length,
                })
            }
            Self::Spline { curve, .. } => Curve::Bezier(*curve),
        }
    }

    /// Where the axes are when the path parameter is as given.
    pub fn motion(&self, at: Instant) -> Motion {
        let length = self.length();
        // a path without length is a point, and the profile of a point stays at 0
        let per_length = if length > 0.0 { 1.0 / length } else { 0.0 };
        let mut motion = linear(self.from(), self.to(), at, per_length);
        match self {
            Self::Line { .. } => {}
            Self::Arc { from, to, arc } => turn(&mut motion, from, to, arc, at, per_length),
            Self::Spline { curve, .. } => bend(&mut motion, curve, at),
        }
        motion
    }
}

/// All axes in proportion; exact at both ends.
#[inline]
fn linear(from: &Position, to: &Position, at: Instant, per_length: f64) -> Motion {
    let fraction = (at.s * per_length).clamp(0.0, 1.0);
    let mut motion = Motion::default();
    for (i, axis) in Axis::ALL.into_iter().enumerate() {
        let [a, b] = [from, to].map(|place| Coordinate::new(coordinate(place, axis)));
        let slope = (b - a).value() * per_length;
        motion.position[i] = a * (1.0 - fraction) + b * fraction;
        motion.speed[i] = CoordinateSpeed::new(slope * at.v);
        motion.accel[i] = CoordinateAccel::new(slope * at.a);
    }
    motion
}

/// Overwrite the plane's two axes with the circle.
fn turn(
    motion: &mut Motion,
    from: &Position,
    to: &Position,
    arc: &Arc,
    at: Instant,
    per_length: f64,
) {
    let fraction = at.s * per_length;
    if fraction >= 1.0 {
        return; // `linear` is exact there, and the profile stands still
    }
    let [first, second, _] = arc.plane.axes();
    let [c0, c1] = [arc.centre[0].value(), arc.centre[1].value()];
    let d = [from.along(first).value() - c0, from.along(second).value() - c1];
    let sweep = arc.sweep.in_rad();
    let end = rotated(d, sweep);
    let e = [to.along(first).value() - c0 - end[0], to.along(second).value() - c1 - end[1]];
    let p = rotated(d, sweep * fraction);
    let turn_rate = sweep * per_length; // rad/mm
    let slope = [-turn_rate * p[1] + e[0] * per_length, turn_rate * p[0] + e[1] * per_length];
    let bend = turn_rate * turn_rate * at.v * at.v;
    let centre = [c0, c1];
    for (k, axis) in [first, second].into_iter().enumerate() {
        let i = axis.index();
        motion.position[i] = Coordinate::new(centre[k] + p[k] + e[k] * fraction);
        motion.speed[i] = CoordinateSpeed::new(slope[k] * at.v);
        motion.accel[i] = CoordinateAccel::new(slope[k] * at.a - bend * p[k]);
    }
}

/// Overwrite X and Y with the spline.
fn bend(motion: &mut Motion, curve: &Bezier, at: Instant) {
    let d = curve.at(at.s);
    for i in [Axis::X, Axis::Y].map(Axis::index) {
        motion.position[i] = Coordinate::new(d.q[i]);
        motion.speed[i] = CoordinateSpeed::new(d.q1[i] * at.v);
        motion.accel[i] = CoordinateAccel::new(d.q1[i] * at.a + d.q2[i] * at.v * at.v);
    }
}

fn rotated([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [cos * x - sin * y, sin * x + cos * y]
}

/// Coordinate of any axis, in mm or degrees.
#[inline]
pub fn coordinate(position: &Position, axis: Axis) -> f64 {
    position.along(axis).value()
}

/// Radius at the start of an arc, mm.
pub fn radius(from: &Position, arc: &Arc) -> f64 {
    let [first, second, _] = arc.plane.axes();
    libm::hypot(
        from.along(first).value() - arc.centre[0].value(),
        from.along(second).value() - arc.centre[1].value(),
    )
}

fn line_length(from: &Position, to: &Position) -> f64 {
    let norm = |d: [f64; 3]| libm::hypot(libm::hypot(d[0], d[1]), d[2]);
    let of = |a: [Length; 3], b: [Length; 3]| norm([0, 1, 2].map(|i| (b[i] - a[i]).value()));
    let linear = of(from.linear, to.linear);
    if linear > 0.0 {
        return linear;
    }
    let parallel = of(from.parallel, to.parallel);
    if parallel > 0.0 {
        return parallel;
    }
    norm([0, 1, 2].map(|i| (to.rotary[i] - from.rotary[i]).in_deg()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::{Angle, Plane};

    fn at(s: f64, v: f64, a: f64) -> Instant {
        Instant { s, v, a }
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12, "{a} is not {b}");
    }

    #[test]
    fn a_line_shares_its_speed_between_the_axes() {
        let line =
            Path::Line { from: Position::xyz(1.0, 2.0, 0.0), to: Position::xyz(4.0, 6.0, 0.0) };
        near(line.length(), 5.0);
        let m = line.motion(at(2.5, 10.0, 100.0));
        near(m.position[0].value(), 2.5);
        near(m.position[1].value(), 4.0);
        near(m.speed[0].value(), 6.0);
        near(m.speed[1].value(), 8.0);
        near(m.accel[1].value(), 80.0);
    }

    #[test]
    fn a_line_ends_on_the_programmed_numbers_to_the_last_bit() {
        let (from, to) = (Position::xyz(0.1, 1e7, -3.3), Position::xyz(0.3, 0.7, 1e-9));
        let line = Path::Line { from, to };
        let m = line.motion(at(line.length(), 0.0, 0.0));
        assert_eq!([0, 1, 2].map(|i| m.position[i].of_linear()), to.linear);
    }

    /// Quarter circle of radius 10 about the origin, from (10, 0): at half way the speed points
    /// along (−1, 1)/√2, and v²/r points to the centre.
    #[test]
    fn on_an_arc_the_acceleration_points_to_the_centre_with_v_squared_over_r() {
        let arc = Arc { plane: Plane::XY, centre: [Length::ZERO; 2], sweep: Angle::rev(0.25) };
        let path = Path::Arc {
            from: Position::xyz(10.0, 0.0, 0.0),
            to: Position::xyz(0.0, 10.0, 0.0),
            arc,
        };
        near(path.length(), 5.0 * core::f64::consts::PI);
        let m = path.motion(at(path.length() / 2.0, 20.0, 0.0));
        let half = core::f64::consts::FRAC_1_SQRT_2;
        near(m.position[0].value(), 10.0 * half);
        near(m.speed[0].value(), -20.0 * half);
        near(m.speed[1].value(), 20.0 * half);
        near(m.accel[0].value(), -40.0 * half);
        near(m.accel[1].value(), -40.0 * half);
    }

    #[test]
    fn a_helix_of_three_turns_in_each_plane_rises_along_the_normal() {
        for plane in [Plane::XY, Plane::ZX, Plane::YZ] {
            let [first, _, normal] = plane.axes();
            let from = Position::default().with(first, Coordinate::new(4.0));
            let to = from.with(normal, Coordinate::new(6.0));
            let arc = Arc { plane, centre: [Length::ZERO; 2], sweep: Angle::rev(-3.0) };
            let path = Path::Arc { from, to, arc };
            near(path.length(), libm::hypot(24.0 * core::f64::consts::PI, 6.0));
            let half = path.motion(at(path.length() / 2.0, 1.0, 0.0));
            near(half.position[normal.index()].value(), 3.0);
            near(half.position[first.index()].value(), -4.0);
            let speed2: f64 = half.speed.iter().map(|v| v.value() * v.value()).sum();
            near(speed2, 1.0);
        }
    }

    #[test]
    fn an_end_that_misses_the_circle_by_a_rounding_is_reached_without_a_jump() {
        let arc = Arc { plane: Plane::XY, centre: [Length::ZERO; 2], sweep: Angle::rev(0.25) };
        let (from, to) = (Position::xyz(10.0, 0.0, 0.0), Position::xyz(0.0, 10.002, 0.0));
        let path = Path::Arc { from, to, arc };
        let almost = path.motion(at(path.length() * (1.0 - 1e-9), 0.0, 0.0));
        assert!((almost.position[1].of_linear() - to.linear[1]).abs().value() < 1e-7);
        assert_eq!(path.motion(at(path.length(), 0.0, 0.0)).position[1].of_linear(), to.linear[1]);
    }

    #[test]
    fn a_path_without_length_stays_where_it_is() {
        let here = Position::xyz(1.0, 2.0, 3.0);
        let m = Path::Line { from: here, to: here }.motion(Instant::default());
        assert_eq!([0, 1, 2].map(|i| m.position[i].of_linear()), here.linear);
        assert_eq!(m.speed, [CoordinateSpeed::ZERO; 9]);
    }

    #[test]
    fn parallel_axes_count_when_x_y_z_rest_and_degrees_when_only_rotary_axes_turn() {
        let home = Position::default();
        let w = home.with(Axis::W, Coordinate::new(7.0));
        near(Path::Line { from: home, to: w }.length(), 7.0);
        let mut a = home;
        a.rotary[0] = Angle::deg(90.0);
        near(Path::Line { from: home, to: a }.length(), 90.0);
    }
}
