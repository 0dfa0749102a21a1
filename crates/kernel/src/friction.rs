//! What friction will take, known before it is felt.
//!
//! ```text
//!   F │        ┌─────────  g(v) = Fc + (Fs − Fc)·exp(−(v/vs)²)
//!     │      ╱
//!     │    ╱  σ₀ before sliding: after a reversal friction is a spring for some µm of way
//!     └──────────────────► way since the reversal
//! ```
//!
//! LuGre's bristles driven by the *setpoint*: over a small way dx at a constant g the bristles'
//! force obeys dF/dx = σ₀·(1 − sgn(dx)·F/g), so that
//!
//! ```text
//!   F⁺ = s·g + (F − s·g)·exp(−σ₀·|dx|/g),   s = sgn(dx)
//! ```
//!
//! exactly, for any step. Damping of the bristles σ₁·ż and the viscous part σ₂·v are added. An axis
//! that stands keeps F: so does its guideway.
//!
//! Source: Canudas de Wit et al., IEEE Trans. Automatic Control 40 (1995), 419–425.
use crate::config::{AxisFriction, SpindleFriction};
use core::f64::consts::TAU;
use units::{Spin, Torque};

/// Beyond so many lengths of its spring the bristles slide: exp(−30) is nothing.
const SLIDING: f64 = 30.0;

/// Friction of a guideway along its setpoint: mm, s, N.
#[derive(Clone, Debug)]
pub(crate) struct Bristles {
    coulomb_n: f64,
    excess_n: f64,
    per_stribeck: f64,
    sigma0_n_per_mm: f64,
    sigma1_n_s_per_mm: f64,
    sigma2_n_s_per_mm: f64,
    per_period: f64,
    bent_n: f64,
}

impl Bristles {
    pub(crate) fn new(friction: &AxisFriction, period_s: f64) -> Self {
        Self {
            coulomb_n: friction.coulomb.value(),
            excess_n: (friction.breakaway - friction.coulomb).value().max(0.0),
            per_stribeck: 1.0 / friction.stribeck.value(),
            sigma0_n_per_mm: friction.bristle_stiffness.value(),
            sigma1_n_s_per_mm: friction.bristle_damping_n_s_per_m * 1e-3,
            sigma2_n_s_per_mm: friction.viscous_n_s_per_m * 1e-3,
            per_period: 1.0 / period_s,
            bent_n: 0.0,
        }
    }

    /// Force after a way `dx` done in one period at a speed `v`.
    pub(crate) fn slide(&mut self, dx: f64, v: f64) -> f64 {
        if dx == 0.0 {
            return self.bent_n;
        }
        let ratio = v * self.per_stribeck;
        let square = ratio * ratio;
        let excess = if square < SLIDING { self.excess_n * libm::exp(-square) } else { 0.0 };
        let g = self.coulomb_n + excess;
        if g <= 0.0 {
            return self.sigma2_n_s_per_mm * v;
        }
        let target = g * dx.signum();
        let lengths = self.sigma0_n_per_mm * dx.abs() / g;
        let rest = if lengths < SLIDING { libm::exp(-lengths) } else { 0.0 };
        let before = self.bent_n;
        self.bent_n = target + (before - target) * rest;
        let bending_mm_per_s = (self.bent_n - before) / self.sigma0_n_per_mm * self.per_period;
        self.bent_n + self.sigma1_n_s_per_mm * bending_mm_per_s + self.sigma2_n_s_per_mm * v
    }
}

/// Friction of a spindle at a speed: c₀·tanh(ω/ω₀) + c₁·ω.
pub(crate) fn spindle_friction(friction: &SpindleFriction, spin: Spin) -> Torque {
    let ratio = spin / friction.rounding;
    let sign = if ratio.abs() < SLIDING { libm::tanh(ratio) } else { ratio.signum() };
    friction.coulomb * sign + Torque::n_m(friction.viscous_n_m_s_per_rad * TAU * spin.value())
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::CoordinateSpeed;
    use units::{Force, Stiffness};

    const Z: AxisFriction = AxisFriction {
        coulomb: Force::n(150.0),
        breakaway: Force::n(150.0),
        stribeck: CoordinateSpeed::new(2.0),
        bristle_stiffness: Stiffness::n_per_mm(20_000.0),
        bristle_damping_n_s_per_m: 0.0,
        viscous_n_s_per_m: 0.0,
    };

    fn after(ways: &[(f64, u32)]) -> f64 {
        let mut bristles = Bristles::new(&Z, 250e-6);
        let mut force = 0.0;
        for &(way, steps) in ways {
            for _ in 0..steps {
                let dx = way / f64::from(steps);
                force = bristles.slide(dx, dx / 250e-6);
            }
        }
        force
    }

    #[test]
    fn after_a_reversal_friction_is_a_spring_and_then_slides_the_other_way() {
        assert!((after(&[(1.0, 100)]) - 150.0).abs() < 1e-9);
        // dF/dx = 2·σ₀ right after the reversal; Dahl's closed form after 5 µm:
        // F = −Fc + 2·Fc·exp(−σ₀·x/Fc)
        let exact = -150.0 + 300.0 * (-20_000.0 * 0.005 / 150.0f64).exp();
        assert!((after(&[(1.0, 100), (-0.005, 50)]) - exact).abs() < 1e-9);
        assert!((after(&[(1.0, 100), (-1.0, 100)]) + 150.0).abs() < 1e-9);
    }

    #[test]
    fn the_force_does_not_depend_on_how_the_way_is_divided() {
        let (coarse, fine) = (after(&[(1.0, 10), (-0.008, 2)]), after(&[(1.0, 10), (-0.008, 400)]));
        assert!((coarse - fine).abs() < 1e-9);
    }

    #[test]
    fn an_axis_that_stands_keeps_its_friction() {
        let mut bristles = Bristles::new(&Z, 250e-6);
        let moving = bristles.slide(0.003, 12.0);
        assert_eq!(bristles.slide(0.0, 0.0), moving);
    }
}
