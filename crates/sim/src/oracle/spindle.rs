//! A spindle's run-up, overshoot and coast-down.
//!
//! ```text
//!   torque limited, ω ≤ ωb = P/T:   t = J·ω/T
//!   power limited,  ω ≥ ωb:         t = J·ωb/T + J·(ω² − ωb²)/2P        (d(½Jω²)/dt = P)
//!   braking at constant α:          overshoot = ω²/2α
//!   coasting with c₀ + c₁·ω:        ω(t) = (ω₀ + c₀/c₁)·e^{−c₁t/J} − c₀/c₁
//! ```
//!
//! Source: Newton's second law and the work-energy theorem, integrated.
use crate::SpindleModel;
use units::{Angle, Spin, SpinAccel, Time};

/// Run-up of a spindle without friction and lag, at its torque and power limit.
#[derive(Clone, Copy, Debug)]
pub struct RunUp {
    inertia: f64,
    torque: f64,
    power: f64,
}

impl RunUp {
    /// Of this spindle.
    pub fn of(model: &SpindleModel) -> Self {
        Self {
            inertia: model.inertia.value(),
            torque: model.peak_torque.value(),
            power: model.peak_power.value(),
        }
    }

    /// From rest to a speed.
    pub fn time_to(&self, spin: Spin) -> Time {
        let omega = spin.in_rad_per_s().abs();
        let base = self.power / self.torque;
        let linear = self.inertia * omega.min(base) / self.torque;
        let square = (omega.powi(2) - base.powi(2)).max(0.0) * self.inertia / (2.0 * self.power);
        Time::s(linear + square)
    }
}

/// How far a spindle turns on while it brakes from `spin` at constant `braking`: ω²/2α.
pub fn overshoot(spin: Spin, braking: SpinAccel) -> Angle {
    Angle::rev(spin.value().powi(2) / (2.0 * braking.value()))
}

/// Speed after coasting for a time, as long as it still turns well above the rounding speed.
pub fn coast_down(model: &SpindleModel, from: Spin, after: Time) -> Spin {
    let (c0, c1) = (model.coulomb.value(), model.viscous_n_m_s_per_rad);
    let decay = (-c1 * after.value() / model.inertia.value()).exp();
    let omega = (from.in_rad_per_s() + c0 / c1) * decay - c0 / c1;
    Spin::rev_per_s(omega / core::f64::consts::TAU)
}
