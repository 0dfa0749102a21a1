//! From what the program writes to where the axes stand: the offsets, in one place.
//!
//! ```text
//!   machine = R(rotation) · (program + added) + origin + tool
//!
//!   program    coordinates as written, in the program's units     (G90)
//!   added      G92, G52
//!   R          rotation of X and Y about Z, of the work offset    (G10 L2 R)
//!   origin     work offset G54 … G59.3
//!   tool       tool length offset                                 (G43)
//! ```
//!
//! Source: LinuxCNC 2.9 manual, "Coordinate systems"; the order of rotation and G92 was measured on
//! its stand-alone interpreter (G92 X3 under a rotation of 30° sets an offset *inside* the
//! rotation).

/// Coordinates of the nine axes in the order of [`canon::Axis`]: lengths in the program's units
/// (or in mm, where said so), angles in degrees.
pub type Point = [f64; 9];

/// The offsets in force, all in one unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Work offset.
    pub origin: Point,
    /// G92 and G52.
    pub added: Point,
    /// Tool length offset.
    pub tool: Point,
    rotation_deg: f64,
    sin: f64,
    cos: f64,
}

impl Default for Frame {
    fn default() -> Self {
        Self {
            origin: [0.0; 9],
            added: [0.0; 9],
            tool: [0.0; 9],
            rotation_deg: 0.0,
            sin: 0.0,
            cos: 1.0,
        }
    }
}

impl Frame {
    /// Rotation of X and Y about Z, degrees, counter-clockwise.
    pub const fn rotation(&self) -> f64 {
        self.rotation_deg
    }

    /// Set the rotation of X and Y about Z, degrees.
    pub fn rotate(&mut self, degrees: f64) {
        self.rotation_deg = degrees;
        (self.sin, self.cos) = degrees.to_radians().sin_cos();
    }

    /// Where the axes stand for a point of the program.
    #[inline]
    pub fn to_machine(&self, program: &Point) -> Point {
        let mut at = *program;
        for (a, added) in at.iter_mut().zip(&self.added) {
            *a += added;
        }
        if self.rotation_deg != 0.0 {
            let [x, y] = [at[0], at[1]];
            at[0] = x * self.cos - y * self.sin;
            at[1] = x * self.sin + y * self.cos;
        }
        for (a, (origin, tool)) in at.iter_mut().zip(self.origin.iter().zip(&self.tool)) {
            *a += origin + tool;
        }
        at
    }

    /// What the program calls the point where the axes stand.
    #[inline]
    pub fn to_program(&self, machine: &Point) -> Point {
        let mut at = *machine;
        for (a, (origin, tool)) in at.iter_mut().zip(self.origin.iter().zip(&self.tool)) {
            *a -= origin + tool;
        }
        if self.rotation_deg != 0.0 {
            let [x, y] = [at[0], at[1]];
            at[0] = x * self.cos + y * self.sin;
            at[1] = y * self.cos - x * self.sin;
        }
        for (a, added) in at.iter_mut().zip(&self.added) {
            *a -= added;
        }
        at
    }

    /// The same offsets in another unit of length.
    pub fn scale(&mut self, factor: f64) {
        for point in [&mut self.origin, &mut self.added, &mut self.tool] {
            scale(point, factor);
        }
    }
}

/// The lengths of a point in another unit; the angles stay.
pub(crate) fn scale(point: &mut Point, factor: f64) {
    for i in [0, 1, 2, 6, 7, 8] {
        point[i] *= factor;
    }
}

/// All coordinates of a position as a point in mm and degrees.
pub(crate) fn machine_point(position: &canon::Position) -> Point {
    let mut point = [0.0; 9];
    for i in 0..3 {
        point[i] = position.linear[i].value();
        point[i + 3] = position.rotary[i].in_deg();
        point[i + 6] = position.parallel[i].value();
    }
    point
}

/// Whether two points are one for a move.
pub(crate) fn same(a: &Point, b: &Point) -> bool {
    a.iter().zip(b).all(|(x, y)| (x - y).abs() < SAME_POINT)
}

/// Two points nearer than this are one.
pub(crate) const SAME_POINT: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_puts_the_programs_x_along_the_machines_y() {
        let mut frame =
            Frame { origin: [10.0, 20.0, 30.0, 0., 0., 0., 0., 0., 0.], ..Frame::default() };
        frame.rotate(90.0);
        frame.tool[2] = 5.0;
        let at = frame.to_machine(&[1.0, 0.0, 2.0, 0., 0., 0., 0., 0., 0.]);
        for (found, wanted) in at.iter().zip([10.0, 21.0, 37.0]) {
            assert!((found - wanted).abs() < 1e-12, "{at:?}");
        }
    }

    #[test]
    fn going_to_the_machine_and_back_changes_nothing() {
        let mut frame =
            Frame { origin: [1.5, -2.0, 3.0, 4., 5., 6., 7., 8., 9.], ..Frame::default() };
        frame.added = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
        frame.rotate(33.0);
        let point = [1., 2., 3., 4., 5., 6., 7., 8., 9.];
        let back = frame.to_program(&frame.to_machine(&point));
        for (found, wanted) in back.iter().zip(point) {
            assert!((found - wanted).abs() < 1e-12, "{back:?}");
        }
    }
}
