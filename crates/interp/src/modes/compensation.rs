//! What is remembered while the tool is led beside the programmed way.

use crate::geometry::offset_curve::{Curve, Flat, left, plus, times};
/// What is remembered while G41 or G42 is in force.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Compensation {
    /// The code: 410, 411, 420, 421.
    pub(crate) code: u16,
    /// +1: the tool is on the left, −1: on the right.
    pub(crate) side: f64,
    /// Of the tool, in the program's unit.
    pub(crate) radius: f64,
    /// The offset whose radius a comment states.
    pub(crate) by_comment: Option<u32>,
    /// Orientation of a lathe tool as a shift along the plane's axes, program units.
    pub(crate) shift: Flat,
    /// Where the tool's centre will be (less the shift); none before the first move.
    pub(crate) at: Option<Flat>,
    /// The move whose end is not settled.
    pub(crate) last: Option<Curve>,
}

impl Compensation {
    /// Where the tool is led to, for `#5420` and its kin.
    pub(crate) fn place(&self) -> Option<Flat> {
        self.at.map(|at| plus(at, self.shift))
    }

    pub(crate) fn scale(&mut self, factor: f64) {
        self.radius *= factor;
        self.shift = times(self.shift, factor);
        self.at = self.at.map(|at| times(at, factor));
        match &mut self.last {
            Some(Curve::Line { from, through, .. }) => {
                *from = times(*from, factor);
                *through = times(*through, factor);
            }
            Some(Curve::Circle { from, centre, radius, .. }) => {
                *from = times(*from, factor);
                *centre = times(*centre, factor);
                *radius *= factor;
            }
            Some(Curve::StartUp { .. }) | None => {}
        }
    }

    /// How much a way curves away from the tool, one over its radius.
    pub(crate) fn bulge(&self, way: &Curve) -> f64 {
        match way {
            Curve::Line { .. } | Curve::StartUp { .. } => 0.0,
            Curve::Circle { radius, turns, .. } => -self.side * f64::from(turns.signum()) / radius,
        }
    }

    /// Beside a point at which the program goes into this direction.
    pub(crate) fn beside(&self, point: Flat, direction: Flat) -> Flat {
        plus(point, times(left(direction), self.side * self.radius))
    }
}
