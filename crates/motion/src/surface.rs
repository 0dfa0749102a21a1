//! Constant surface speed (G96): the work turns the faster, the nearer the tip of the tool is to
//! its axis.
//!
//! ```text
//!   n │ limit ────╮
//!     │            ╲            n = v / 2π·|x − axis|, never above the limit
//!     │              ╲──____
//!     └────────────────────────► x
//!     axis
//! ```
use core::f64::consts::TAU;
use units::{Length, Speed, Spin};

/// What a spindle is told that keeps the surface speed at the tool's tip.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SurfaceSpeed {
    /// Surface speed; negative turns counter-clockwise.
    pub speed: Speed,
    /// Never faster than this, without sign.
    pub limit: Spin,
    /// Coordinate of X at which the tip is on the axis of the work.
    pub axis: Length,
}

impl SurfaceSpeed {
    /// The speed for a place of X, with its sign.
    pub fn at(&self, x: Length) -> Spin {
        let around = TAU * (x - self.axis).abs().value();
        let (speed, limit) = (self.speed.value(), self.limit.abs().value());
        let turns = speed.abs();
        let spin = if turns < limit * around { turns / around } else { limit };
        Spin::rev_per_s(if speed < 0.0 { -spin } else { spin })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_is_that_of_the_surface_over_its_circumference_and_the_limit_at_the_axis() {
        let surface = SurfaceSpeed {
            speed: Speed::mm_per_min(-100_000.0),
            limit: Spin::rpm(3000.0),
            axis: Length::mm(-30.0),
        };
        // 100 m/min on a diameter of 20 mm: 1000·100/(π·20)
        for (x, rpm) in [(-20.0, -1591.549), (-40.0, -1591.549), (-29.0, -3000.0), (-30.0, -3000.0)]
        {
            let is = surface.at(Length::mm(x)).in_rpm();
            assert!((is - rpm).abs() < 1e-3, "X{x}: {is} rpm, {rpm} rpm");
        }
    }
}
