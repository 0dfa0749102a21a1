//! A NURBS while its control points are written.

use crate::call::ControlPoint;
/// A NURBS being written, from G5.2 to G5.3.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Nurbs {
    pub(crate) order: usize,
    pub(crate) points: Vec<ControlPoint>,
    /// One of its blocks was refused: it will not be cut.
    pub(crate) faulty: bool,
}
