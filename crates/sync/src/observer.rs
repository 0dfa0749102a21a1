//! The master's observer: angle, speed and acceleration from a quantised encoder, and their prediction.
//!
//! ```text
//!   ordered acceleration u ──►┌───────────────┐
//!                             │ θ̂, ω̂, d̂ model │──► after T: θ̂ + ω̂T + ½(u+d̂)T²
//!   encoder q·floor(θ/q) ───►└───────────────┘
//!                  r = measured − predicted corrects all three
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | θ, ω | angle, speed | rev, rev/s |
//! | u | acceleration the drive is ordered | rev/s² |
//! | d | acceleration nobody ordered: cutting torque, friction, a saturated drive | rev/s² |
//! | h | period | s |
//! | ξ | e^(−2π·f·h), triple pole at the bandwidth f | — |
//!
//! Steady-state gains of an α-β-γ filter with a triple real pole (Morrison's fading-memory filter of
//! second degree): α = 1−ξ³, β = 3/2(1−ξ)²(1+ξ), γ = (1−ξ)³. With u known, a planned ramp leaves no
//! residual; the bandwidth only decides how fast d is learnt against how much quantisation passes.
//!
//! The stopping angle at a constant deceleration is ω²/2a.
use units::{Angle, Spin, SpinAccel, Time};

use crate::Rotation;

/// Estimates how a master turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    period_s: f64,
    alpha: f64,
    beta: f64,
    gamma: f64,
    theta_rev: f64,
    omega_rev_per_s: f64,
    ordered_rev_per_s2: f64,
    disturbance_rev_per_s2: f64,
}

impl Observer {
    /// An observer of a master at rest at `angle`, called once a `period`, that learns disturbances
    /// with a bandwidth in Hz (well below half the sampling rate).
    pub fn new(period: Time, bandwidth_hz: f64, angle: Angle) -> Self {
        let xi = libm::exp(-core::f64::consts::TAU * bandwidth_hz * period.value());
        Self {
            period_s: period.value(),
            alpha: 1.0 - xi * xi * xi,
            beta: 1.5 * (1.0 - xi) * (1.0 - xi) * (1.0 + xi),
            gamma: (1.0 - xi) * (1.0 - xi) * (1.0 - xi),
            theta_rev: angle.value(),
            omega_rev_per_s: 0.0,
            ordered_rev_per_s2: 0.0,
            disturbance_rev_per_s2: 0.0,
        }
    }

    /// Take one reading, and the acceleration ordered for the period now beginning.
    pub fn update(&mut self, measured: Angle, ordered: SpinAccel) {
        let h = self.period_s;
        let a = self.ordered_rev_per_s2 + self.disturbance_rev_per_s2;
        let theta = self.theta_rev + h * (self.omega_rev_per_s + h * a / 2.0);
        let omega = self.omega_rev_per_s + h * a;
        let r = measured.value() - theta;
        self.theta_rev = theta + self.alpha * r;
        self.omega_rev_per_s = omega + self.beta / h * r;
        self.disturbance_rev_per_s2 += self.gamma / (h * h) * r;
        self.ordered_rev_per_s2 = ordered.value();
    }

    /// How the master turns at the moment of the last reading; [`Rotation::after`] predicts from there.
    pub const fn now(&self) -> Rotation {
        Rotation {
            angle: Angle::rev(self.theta_rev),
            spin: Spin::rev_per_s(self.omega_rev_per_s),
            accel: SpinAccel::rev_per_s2(self.ordered_rev_per_s2 + self.disturbance_rev_per_s2),
        }
    }
}

/// Angle a master turns until it stands, at a constant deceleration: ω²/2a.
pub fn stopping_angle(spin: Spin, deceleration: SpinAccel) -> Angle {
    Angle::rev(spin.value() * spin.value() / (2.0 * deceleration.value().abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: Time = Time::s(250e-6);

    /// Run an observer on θ(t) seen through an encoder; the largest error of angle [rev] and speed
    /// [rev/s], predicted `ahead` periods, after settling.
    fn worst(
        counts: f64,
        ahead: u32,
        theta: impl Fn(f64) -> (f64, f64),
        ordered: f64,
    ) -> (f64, f64) {
        let mut observer = Observer::new(H, 100.0, Angle::ZERO);
        let (mut angle, mut spin) = (0.0f64, 0.0f64);
        for k in 0..4000u32 {
            let measured = (theta(f64::from(k) * H.value()).0 * counts).floor() / counts;
            observer.update(Angle::rev(measured), SpinAccel::rev_per_s2(ordered));
            let predicted = observer.now().after(H * f64::from(ahead));
            let (real, rate) = theta(f64::from(k + ahead) * H.value());
            if k > 400 {
                angle = angle.max((predicted.angle.value() - real).abs());
                spin = spin.max((predicted.spin.value() - rate).abs());
            }
        }
        (angle, spin)
    }

    #[test]
    fn a_constant_speed_is_predicted_to_the_encoders_step() {
        let counts = 1_048_576.0;
        let (angle, spin) = worst(counts, 2, |t| (100.0 * t, 100.0), 0.0);
        assert!(angle < 2.0 / counts, "{angle} rev");
        assert!(spin < 2e-3, "{spin} rev/s");
    }

    #[test]
    fn a_coarse_encoder_is_smoothed_below_its_step() {
        let (angle, _) = worst(4096.0, 2, |t| (37.3 * t, 37.3), 0.0);
        assert!(angle < 1.0 / 4096.0, "{angle} rev");
    }

    #[test]
    fn an_acceleration_nobody_ordered_is_learnt() {
        let ramp = |t: f64| (50.0 * t * t, 100.0 * t);
        let (angle, _) = worst(1_048_576.0, 1, ramp, 0.0);
        assert!(angle < 3e-6, "{angle} rev");
        let (ordered, _) = worst(1_048_576.0, 1, ramp, 100.0);
        assert!(ordered < 3e-6, "{ordered} rev");
    }

    #[test]
    fn a_spindle_at_6000_rpm_braked_at_400_rev_per_s2_turns_twelve_and_a_half_times() {
        let angle = stopping_angle(Spin::rpm(6000.0), SpinAccel::rev_per_s2(-400.0));
        assert_eq!(angle, Angle::rev(12.5));
    }
}
