//! What a drill bears: the stress that a chip puts on its core, before motion.
//!
//! ```text
//!   F = ½·kc·f·(De − d)/2·sin κ          thrust, N
//!   M = kc·f·(De² − d²)/8000             torque, N·m
//!   √(τ² + σ²/3) ≤ 1000 N/mm² in a core of 0.6·D
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | kc | specific cutting force of the material | N/mm² |
//! | f | feed per turn | mm/rev |
//! | De, d | diameter that cuts, diameter that is open already | mm |
//! | κ | half the point angle | |
//!
//! Source: Sandvik Coromant, *Metal Cutting Technology*, drilling formulas; the core's strength is
//! that of taps of high-speed steel by their known break torques (M6 9.2 N·m, M12 73 N·m).
use core::f64::consts::PI;
use units::{Length, Torque};

/// Shear strength of the core, N/mm².
const SHEAR_LIMIT_N_PER_MM2: f64 = 1000.0;
/// Core over diameter.
const CORE: f64 = 0.6;

/// Torque that breaks a tap of this diameter.
pub(crate) fn tap_strength(diameter: Length) -> Torque {
    let core = CORE * diameter.value();
    Torque::n_m(SHEAR_LIMIT_N_PER_MM2 * PI * core * core * core / 16.0 * 1e-3)
}

/// A drill and the material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drill {
    /// Diameter, mm.
    pub(crate) diameter: f64,
    /// Height of its point, mm.
    pub(crate) cone: f64,
    /// Sine of half its point angle.
    pub(crate) sine: f64,
    /// Specific cutting force, N/mm².
    pub(crate) kc: f64,
}

impl Drill {
    /// Stress over strength, with a feed per turn of so many mm at this depth where `open` is bored
    /// already.
    pub(crate) fn load(&self, feed: f64, depth: f64, open: f64) -> f64 {
        let cuts = if self.cone > 0.0 { (depth / self.cone).clamp(0.0, 1.0) } else { 1.0 };
        let outer = self.diameter * cuts;
        let inner = open.min(outer);
        let force = 0.5 * self.kc * feed * (outer - inner) / 2.0 * self.sine;
        let torque = self.kc * feed * (outer * outer - inner * inner) / 8000.0;
        let core = CORE * self.diameter;
        let shear = 16.0 * 1e3 * torque / (PI * core * core * core);
        let tension = 4.0 * force / (PI * core * core * libm::sqrt(3.0));
        libm::hypot(shear, tension) / SHEAR_LIMIT_N_PER_MM2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_5_mm_drill_in_c45_breaks_at_four_times_a_sane_feed() {
        // 5.3 N·m is the known break torque of a 5 mm core; 0.1 mm a turn takes 1.22 N·m
        let drill = Drill { diameter: 5.0, cone: 1.5, sine: 0.857, kc: 3900.0 };
        assert!((0.2..0.3).contains(&drill.load(0.1, 10.0, 0.0)));
        assert!((0.9..1.15).contains(&drill.load(0.43, 10.0, 0.0)));
        assert!(drill.load(0.43, 0.2, 0.0) < 0.1, "only the point is in the work");
        assert_eq!(drill.load(0.43, 10.0, 5.0), 0.0);
    }
}
