//! Where the axes are along a path, by its length.
use canon::{Arc, Position};
use units::{Accel, Length, Speed};

use crate::Instant;

/// A path of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

/// Where the linear axes shall be, and how they move: X, Y, Z, U, V, W by `canon::Axis` index; the
/// entries of rotary axes stay zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Position.
    pub position: [Length; 9],
    /// Speed.
    pub speed: [Speed; 9],
    /// Acceleration, with the centripetal part on arcs.
    pub accel: [Accel; 9],
}

impl Path {
    /// Length of the path, mm: what its profile's parameter runs over. For a move of rotary axes alone
    /// it is the largest turn in degrees, as RS-274/NGC measures it.
    pub fn length(&self) -> f64 {
        todo!()
    }

    /// Where the axes are when the path parameter is as given.
    pub fn motion(&self, _at: Instant) -> Motion {
        todo!()
    }
}
