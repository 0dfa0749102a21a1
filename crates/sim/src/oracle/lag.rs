//! First-order lag after a unit step of its reference.
//!
//! ```text
//!   y(t) = 1 − e^{−t/τ}          ∫₀ᵗ y = t − τ(1 − e^{−t/τ})
//! ```
//!
//! Source: any text on linear systems; e.g. Franklin, Powell, Emami-Naeini, *Feedback Control of
//! Dynamic Systems*, 7th ed. 2015, §3.3.

/// y(t).
pub fn step_response(t: f64, tau: f64) -> f64 {
    -(-t / tau).exp_m1()
}

/// ∫₀ᵗ y.
pub fn step_response_integral(t: f64, tau: f64) -> f64 {
    t - tau * step_response(t, tau)
}
