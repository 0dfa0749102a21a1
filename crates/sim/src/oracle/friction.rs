//! The steady state of the `LuGre` model: Stribeck's curve.
//!
//! ```text
//!   dz/dt = 0  ⇒  z = g(v)·sgn v/σ₀  ⇒  F(v) = [Fc + (Fs − Fc)·e^{−(v/vs)²}]·sgn v + σ₂·v
//! ```
//!
//! Source: Canudas de Wit et al., IEEE Trans. Automatic Control 40 (1995), eq. (5).
use crate::Lugre;
use units::{Force, Speed};

/// e^{−u}, the Stribeck term at u = (v/vs)².
pub fn stribeck(u: f64) -> f64 {
    (-u).exp()
}

/// Force of a guideway that slides at constant speed.
pub fn steady_force(model: &Lugre, speed: Speed) -> Force {
    let share = stribeck((speed.value() / model.stribeck.value()).powi(2));
    let dry = model.coulomb + (model.breakaway - model.coulomb) * share;
    let viscous = Force::n(model.viscous_n_s_per_m * speed.value() * 1e-3);
    dry * speed.value().signum() + viscous
}
