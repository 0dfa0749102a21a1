//! A drive's current loop: the force or torque follows its reference with a first-order lag.
//!
//! ```text
//!   dT/dt = (Tref − T)/τ     over one step h of constant Tref:
//!   T⁺    = Tref + (T − Tref)·e^{−h/τ}                end of the step
//!   T̄     = Tref + (T − Tref)·(τ/h)(1 − e^{−h/τ})     mean over the step: what changes the momentum
//! ```
//!
//! Both are exact, so the step may be as long as one likes. τ = 0 is a drive without lag.

/// A first-order lag made ready for one step size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lag {
    kept_at_end: f64,
    kept_in_mean: f64,
}

impl Lag {
    /// For a time constant and a step, both in s.
    pub(crate) fn new(tau: f64, h: f64) -> Self {
        if tau <= 0.0 {
            return Self { kept_at_end: 0.0, kept_in_mean: 0.0 };
        }
        let lost = -(-h / tau).exp_m1();
        Self { kept_at_end: 1.0 - lost, kept_in_mean: tau / h * lost }
    }

    /// Advance `value` by one step towards `reference`; its mean over the step.
    #[inline]
    pub(crate) fn step(&self, value: &mut f64, reference: f64) -> f64 {
        let away = *value - reference;
        *value = reference + away * self.kept_at_end;
        reference + away * self.kept_in_mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::lag::{step_response, step_response_integral};

    #[test]
    fn the_step_response_is_exact_whatever_the_step() {
        let tau = 0.8e-3;
        for h in [10e-6, 25e-6, 1e-3] {
            let lag = Lag::new(tau, h);
            let (mut value, mut integral) = (0.0, 0.0);
            for i in 1..=40 {
                integral += h * lag.step(&mut value, 42.0);
                let t = f64::from(i) * h;
                assert!((value - 42.0 * step_response(t, tau)).abs() < 1e-9);
                assert!((integral - 42.0 * step_response_integral(t, tau)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn no_lag_follows_at_once() {
        let mut value = 0.0;
        assert_eq!(Lag::new(0.0, 25e-6).step(&mut value, 3.0), 3.0);
        assert_eq!(value, 3.0);
    }
}
