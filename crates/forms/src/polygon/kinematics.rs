//! Where a tip is, seen from the workpiece, and how far that is from the flat.
//!
//! With u the work's angle from the middle of a facet's cut, in the facet's own frame (x along its
//! normal):
//!
//! ```text
//!   x(u) = (l+dx)·cos u + dy·sin u − r·cos((R−1)u + ε)        flat: x = l − r
//!   y(u) = −(l+dx)·sin u + dy·cos u − r·sin((R−1)u + ε)
//! ```
//!
//! Symbols: u, ε rad; l, r, dx, dy mm; R dimensionless.
use super::series::Actuator;
use units::{Angle, Length};

/// A cutter in its working place, without its swings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutter {
    /// l: distance of the two spindles' axes.
    pub centres: Length,
    /// r: from the tool spindle's axis to an insert's tip.
    pub radius: Length,
    /// R: turns of the tool for one of the work, in the same sense.
    pub ratio: f64,
}

/// What swings at one instant, beyond the plain gearing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Swing {
    /// Along the line of centres, away from the work.
    pub dx: Length,
    /// Across it.
    pub dy: Length,
    /// Of the tool spindle's phase, ahead.
    pub phase: Angle,
}

/// A tip in a frame of the workpiece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// Along the facet's normal, or the work's own X.
    pub x: Length,
    /// Along the facet, or the work's own Y.
    pub y: Length,
}

impl Cutter {
    /// Tip of the insert at `insert` in the cutter, in the work's own frame, when the work stands
    /// at `work`.
    pub fn tip(&self, work: Angle, insert: Angle, swing: Swing) -> Tip {
        let phi = work.in_rad();
        let turned = (self.ratio - 1.0) * phi + insert.in_rad() + swing.phase.in_rad();
        let (l, r) = (self.centres.value() + swing.dx.value(), self.radius.value());
        let (sine, cosine) = phi.sin_cos();
        let dy = swing.dy.value();
        Tip {
            x: Length::mm(l * cosine + dy * sine - r * turned.cos()),
            y: Length::mm(-l * sine + dy * cosine - r * turned.sin()),
        }
    }

    /// Tip in the facet's frame, when the work stands at `from_middle` after the middle of that
    /// facet's cut.
    pub fn tip_at_facet(&self, from_middle: Angle, swing: Swing) -> Tip {
        self.tip(from_middle, Angle::ZERO, swing)
    }

    /// How far the tip moves along the facet's normal with a swing of one, mm or rev, about a swing
    /// that is there.
    pub(super) fn slope(&self, from_middle: Angle, about: Swing, actuator: Actuator) -> f64 {
        let (sine, cosine) = from_middle.in_rad().sin_cos();
        let turned = (self.ratio - 1.0) * from_middle.in_rad() + about.phase.in_rad();
        match actuator {
            Actuator::CentreLine => cosine,
            Actuator::Across => sine,
            Actuator::ToolPhase => core::f64::consts::TAU * self.radius.value() * turned.sin(),
        }
    }

    /// Distance of the flat from the work's axis: l − r.
    pub fn flat(&self) -> Length {
        self.centres - self.radius
    }

    /// The swing along the line of centres that cuts exactly flat: dx = (l−r+r·cos((R−1)u))/cos u −
    /// l, for R = 2 (l−r)(sec u − 1).
    pub fn flat_by_dx(&self, from_middle: Angle) -> Length {
        let (u, l, r) = self.in_rad_mm(from_middle);
        Length::mm((l - r + r * ((self.ratio - 1.0) * u).cos()) / u.cos() - l)
    }

    /// The swing across the line of centres that cuts exactly flat: dy = (l−r+r·cos((R−1)u) − l·cos
    /// u)/sin u, for R = 2 (l−r)·tan(u/2).
    pub fn flat_by_dy(&self, from_middle: Angle) -> Length {
        let (u, l, r) = self.in_rad_mm(from_middle);
        if u.abs() < 1e-6 {
            // the quotient's limit: second derivative of the numerator over that of u·sin u
            return Length::mm((l - r * (self.ratio - 1.0).powi(2)) * u / 2.0);
        }
        Length::mm((l - r + r * ((self.ratio - 1.0) * u).cos() - l * u.cos()) / u.sin())
    }

    /// The swing of the tool spindle's phase that cuts exactly flat: cos((R−1)u + ε) = (l·cos u −
    /// (l−r))/r. `None` beyond the angle up to which a tip can be on the flat at all.
    pub fn flat_by_phase(&self, from_middle: Angle) -> Option<Angle> {
        let (u, l, r) = self.in_rad_mm(from_middle);
        // 1 − cos is taken as 2·sin²(·/2) on both sides, or half the digits are lost near the
        // middle
        let half = (l / r).sqrt() * (u / 2.0).sin();
        (half.abs() <= 1.0).then(|| {
            let turned = 2.0 * half.asin();
            Angle::rev((turned - (self.ratio - 1.0) * u) / std::f64::consts::TAU)
        })
    }

    fn in_rad_mm(&self, angle: Angle) -> (f64, f64, f64) {
        (angle.in_rad(), self.centres.value(), self.radius.value())
    }
}

/// Angles of equally spaced inserts.
pub fn insert_phases(inserts: u32) -> Vec<Angle> {
    (0..inserts).map(|n| Angle::rev(f64::from(n) / f64::from(inserts))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEED: Cutter = Cutter { centres: Length::mm(10.0), radius: Length::mm(5.0), ratio: 2.0 };

    #[test]
    fn at_two_to_one_a_tip_runs_on_an_ellipse() {
        for step in 0..100 {
            let Tip { x, y } =
                SEED.tip_at_facet(Angle::rev(f64::from(step) / 100.0), Swing::default());
            let on = (x.value() / 5.0).powi(2) + (y.value() / 15.0).powi(2);
            assert!((on - 1.0).abs() < 1e-12, "step {step}: {on}");
        }
    }

    #[test]
    fn each_exact_swing_keeps_the_tip_on_the_flat() {
        for ratio in [1.5, 2.0, 2.5, 3.0] {
            let cutter = Cutter { centres: Length::mm(58.5), radius: Length::mm(50.0), ratio };
            for deg in [-20.0, -3.0, -1e-5, 0.0, 1e-5, 0.5, 3.0, 20.0] {
                let u = Angle::deg(deg);
                let zero = Swing::default();
                for swing in [
                    Swing { dx: cutter.flat_by_dx(u), ..zero },
                    Swing { dy: cutter.flat_by_dy(u), ..zero },
                    Swing { phase: cutter.flat_by_phase(u).expect("within reach"), ..zero },
                ] {
                    let off = cutter.tip_at_facet(u, swing).x - cutter.flat();
                    assert!(off.in_um().abs() < 1e-6, "R {ratio} at {deg}°: {swing:?} {off}");
                }
            }
        }
    }

    #[test]
    fn the_closed_forms_for_two_to_one_are_secant_and_tangent() {
        let u = Angle::deg(12.0);
        let rad = 12.0_f64.to_radians();
        assert!((SEED.flat_by_dx(u).value() - 5.0 * (1.0 / rad.cos() - 1.0)).abs() < 1e-12);
        assert!((SEED.flat_by_dy(u).value() - 5.0 * (rad / 2.0).tan()).abs() < 1e-12);
    }
}
