//! What a tool removes at one place: a body of revolution about its axis, open upwards.
//!
//! ```text
//!         │◄ R ►│             level(ρ): lowest coordinate at which the body is wider than ρ
//!     ────┐  │  ┌────            = tip + rise(ρ), none where ρ ≥ R
//!          ╲ │ ╱              a ring between radii i and o, d beside it, is cut where
//!      tip ─ ╲╱ ─                ρ > i − d  (the bore inside the ring is not wide enough)  and
//!                                ρ > d − o  (it reaches the ring at all)
//! ```
use crate::milling::Cutter;

/// A tool at one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToolCut {
    /// Across the tool, mm.
    pub(crate) at: [f64; 2],
    /// Coordinate of the tip, mm.
    pub(crate) tip_mm: f64,
    pub(crate) cutter: Cutter,
}

impl ToolCut {
    /// Lowest coordinate at which it is wider than a radius; `None`: it never is.
    pub(crate) fn level(&self, radius: f64) -> Option<f64> {
        let radius = radius.max(0.0);
        (radius < self.cutter.radius).then(|| self.tip_mm + self.cutter.rise(radius))
    }

    /// Lowest coordinate at which it takes something of a ring about a place.
    pub(crate) fn ring_level(&self, at: [f64; 2], [inner, outer]: [f64; 2]) -> Option<f64> {
        let apart = apart(self.at, at);
        self.level((inner - apart).max(apart - outer))
    }
}

/// Distance of two places.
pub(crate) fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::MillForm;
    use units::{Angle, Length};

    fn cut(x: f64, diameter: f64, form: MillForm) -> ToolCut {
        let cutter = Cutter::with(diameter / 2.0, form);
        ToolCut { at: [x, 0.0], tip_mm: -10.0, cutter }
    }

    #[test]
    fn a_drill_within_the_bore_takes_nothing_of_the_thread_and_one_beside_it_does() {
        let m8 = [3.456, 4.0];
        let flat = |x, d| cut(x, d, MillForm::FLAT).ring_level([0.0, 0.0], m8);
        assert_eq!(flat(0.0, 6.8), None, "its own hole");
        assert_eq!(flat(0.0, 8.5), Some(-10.0));
        assert_eq!(flat(1.5, 6.8), Some(-10.0));
        assert_eq!(flat(7.5, 6.8), None, "a wall of 0.1 mm is left");
        assert_eq!(flat(7.3, 6.8), Some(-10.0));
    }

    #[test]
    fn a_countersink_reaches_the_thread_as_deep_as_its_cone_is_wider_than_the_bore() {
        let cone = MillForm::Conical { angle: Angle::deg(90.0), tip: Length::ZERO };
        let level = cut(0.0, 20.0, cone).ring_level([0.0, 0.0], [3.0, 4.0]).unwrap();
        assert!((level + 7.0).abs() < 1e-9, "{level}");
    }
}
