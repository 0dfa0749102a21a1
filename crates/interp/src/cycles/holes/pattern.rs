//! A cycle with its words read and checked, ready for its holes.
use crate::{
    call::CycleHole,
    geometry::frame::Point,
    modes::{
        Cycle,
        tapping::{Shift, TapWords},
    },
};

/// A cycle with its words read and checked.
pub(crate) struct Pattern {
    pub(crate) cycle: Cycle,
    pub(crate) r: f64,
    pub(crate) bottom: f64,
    pub(crate) clear: f64,
    pub(crate) dwell: f64,
    pub(crate) peck: f64,
    pub(crate) tap: TapWords,
    pub(crate) shift: Option<Shift>,
    pub(crate) counterbore: f64,
}

/// A place of a hole at another level of its axis.
pub(crate) fn at_level(hole: &CycleHole, level: f64) -> Point {
    let mut point = hole.at;
    point[hole.plane.normal().index()] = level;
    point
}
