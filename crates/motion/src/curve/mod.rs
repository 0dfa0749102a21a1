//! Where the axes are: curves, by their parameter.
//!
//! ```text
//!   q(s), 0 ≤ s ≤ L      q′ = dq/ds    q″ = d²q/ds²    q‴ = d³q/ds³       of every axis
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s | parameter: length of the *programmed* path (RS-274/NGC's measure: along X Y Z if one of them moves, else along U V W, else degrees) | mm, ° |
//! | q | axis positions | mm, ° |
//!
//! On a line and an arc |q′| is 1 over the axes that count. Where a corner is cut or a curve is
//! fitted it is near 1 and as a rule below; s is *not* arc length there, so who needs an axis'
//! speed, acceleration or jerk uses
//!
//! ```text
//!   v = q′·ṡ      a = q″·ṡ² + q′·s̈      j = q‴·ṡ³ + 3·q″·ṡ·s̈ + q′·s⃛
//! ```

mod arc;
mod bezier;
mod line;
mod piece;
mod polynomial;

pub use arc::Arc;
pub use bezier::{Bezier, measure};
pub use line::Line;
pub use piece::{Bounds, Curve, Entry, Limits, Piece};
pub use polynomial::Polynomial;

/// Axes, in the order X Y Z A B C U V W.
pub const AXES: usize = 9;

/// One value per axis.
pub type Point = [f64; AXES];

/// Position and its derivatives by the parameter, of every axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    /// Position, mm or °.
    pub q: Point,
    /// First derivative.
    pub q1: Point,
    /// Second derivative, per mm.
    pub q2: Point,
    /// Third derivative, per mm².
    pub q3: Point,
}

/// A curve of the axes, evaluated at bounded cost.
pub trait Shape {
    /// Where the parameter ends; it begins at zero.
    fn length(&self) -> f64;
    /// Position and derivatives at a parameter, which is clamped to the shape.
    fn at(&self, s: f64) -> Derivatives;
}
