//! An involute tooth in closed form: what a rack at a given distance from the work's axis leaves.
//!
//! ```text
//!            k teeth                      tan α_t = tan α / cos β        sin β_b = sin β · cos α
//!        ├─── W_k ───┤                    d = m·z / cos β                d_b = d · cos α_t
//!      ╱‾╲   ╱‾╲   ╱‾╲                    inv α = tan α − α
//!     ╱   ╲_╱   ╲_╱   ╲
//!                                         W_k = m·cos α·(π·(k − ½) + z·inv α_t + 2·x·tan α)
//!   M_dK over two balls of D_M:           inv α_K = D_M/(m·z·cos α) − (π/2 − 2·x·tan α)/z + inv α_t
//!                                         M_dK = d_b/cos α_K · (1, or cos 90°/z of an odd z) + D_M
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | m, α, β | module, pressure angle, helix angle, in the normal section of the rack | mm, rad, rad |
//! | z, x | teeth, coefficient of the profile shift | 1 |
//!
//! Source: ISO 21771, 5.5 (span, balls); DIN 3960.
use core::f64::consts::{FRAC_PI_2, PI};

/// Diameter of measuring balls over the module: Van Keuren's 1.728 (ANSI B92.1).
const BALL: f64 = 1.728;

/// A tooth of an involute gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tooth {
    pub(super) teeth: f64,
    pub(super) module_mm: f64,
    pub(super) pressure_rad: f64,
    pub(super) helix_rad: f64,
    /// Coefficient of the profile shift.
    pub(super) shift: f64,
}

impl Tooth {
    /// Diameter of the reference circle, mm.
    pub(super) fn reference_diameter(&self) -> f64 {
        self.module_mm * self.teeth / self.helix_rad.cos()
    }

    fn transverse_rad(&self) -> f64 {
        (self.pressure_rad.tan() / self.helix_rad.cos()).atan()
    }

    pub(super) fn base_diameter(&self) -> f64 {
        self.reference_diameter() * self.transverse_rad().cos()
    }

    /// Helix angle on the base cylinder, rad, without its hand.
    fn base_helix_rad(&self) -> f64 {
        (self.helix_rad.sin().abs() * self.pressure_rad.cos()).asin()
    }

    /// The same tooth of another shift.
    pub(super) const fn shifted(self, shift: f64) -> Self {
        Self { shift, ..self }
    }

    /// Normal distance over k teeth, mm.
    pub(super) fn span(&self, k: u32) -> f64 {
        let (sin, cos) = self.pressure_rad.sin_cos();
        let whole = PI * (f64::from(k) - 0.5) + self.teeth * involute(self.transverse_rad());
        self.module_mm * (cos * whole + 2.0 * self.shift * sin)
    }

    /// Diameter at which the span over k teeth touches the flanks, mm.
    pub(super) fn span_touches_at(&self, k: u32) -> f64 {
        self.base_diameter().hypot(self.span(k) * self.base_helix_rad().cos())
    }

    /// Teeth over which the span touches the flanks nearest to the middle of their height; at least
    /// two.
    pub(super) fn spanned(&self) -> u32 {
        let middle = self.reference_diameter() + 2.0 * self.shift * self.module_mm;
        let most = (self.teeth / 2.0).floor().max(2.0) as u32;
        let off = |k: &u32| (self.span_touches_at(*k) - middle).abs();
        (2..=most).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(2)
    }

    /// Diameter of the balls between teeth of this module, mm.
    pub(super) const fn ball(&self) -> f64 {
        BALL * self.module_mm
    }

    /// Dimension over two balls of this diameter, mm; `None`: they do not touch the involutes.
    pub(super) fn over_balls(&self, ball_mm: f64) -> Option<f64> {
        let across = ball_mm / (self.module_mm * self.teeth * self.pressure_rad.cos());
        let gap = (FRAC_PI_2 - 2.0 * self.shift * self.pressure_rad.tan()) / self.teeth;
        let wanted = across - gap + involute(self.transverse_rad());
        let at = angle_of_involute(wanted)?;
        let odd = self.teeth % 2.0 != 0.0;
        let opposite = if odd { (FRAC_PI_2 / self.teeth).cos() } else { 1.0 };
        Some(self.base_diameter() / at.cos() * opposite + ball_mm)
    }
}

/// inv α = tan α − α.
fn involute(angle_rad: f64) -> f64 {
    angle_rad.tan() - angle_rad
}

/// The angle of an involute, rad; `None` where it has none.
fn angle_of_involute(wanted: f64) -> Option<f64> {
    const STEPS: usize = 60;
    if !(0.0..1e3).contains(&wanted) {
        return None;
    }
    let (mut low, mut high) = (0.0, FRAC_PI_2 - 1e-9);
    for _ in 0..STEPS {
        let middle = f64::midpoint(low, high);
        if involute(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(f64::midpoint(low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tooth(teeth: f64, module_mm: f64, helix_deg: f64, shift: f64) -> Tooth {
        let [pressure_rad, helix_rad] = [20.0, helix_deg].map(f64::to_radians);
        Tooth { teeth, module_mm, pressure_rad, helix_rad, shift }
    }

    #[test]
    fn span_and_balls_are_those_of_the_handbooks() {
        // tables of spans, module 1: 40 teeth over 5, 20 over 3
        let plain = tooth(40.0, 1.0, 0.0, 0.0);
        assert_eq!(plain.spanned(), 5);
        assert!((plain.span(5) - 13.8448).abs() < 1e-4, "{}", plain.span(5));
        assert!((tooth(20.0, 1.0, 0.0, 0.0).span(3) - 7.6604).abs() < 1e-4);
        // Van Keuren's wires of 1.728, 20°: 20 and 21 teeth
        for (teeth, over) in [(20.0, 22.3900), (21.0, 23.3321)] {
            let wires = tooth(teeth, 1.0, 0.0, 0.0).over_balls(1.728).unwrap();
            assert!((wires - over).abs() < 1e-4, "{wires}");
        }
    }

    #[test]
    fn a_shift_moves_the_span_by_two_x_m_sine_of_the_pressure_angle() {
        let [plain, more] = [0.0, 0.5].map(|x| tooth(17.0, 3.0, 15.0, x).span(2));
        assert!((more - plain - 3.0 * f64::to_radians(20.0).sin()).abs() < 1e-12);
    }

    #[test]
    fn balls_that_fall_to_the_base_circle_measure_nothing() {
        assert_eq!(tooth(20.0, 2.0, 0.0, -2.0).over_balls(3.456), None);
    }
}
