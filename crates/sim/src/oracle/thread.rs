//! A screw's helix, and the force of a tap held by a spring against it.
//!
//! ```text
//!   helix          z = z₀ + H·(θ − θ₀)
//!
//!   sync offset    spindle ──[holder kh]── tap ──[flanks kf, play c]── thread
//!   e = z − g(θ)   |e| ≤ c/2:  nothing happens
//!                  else        F = (|e| − c/2)·kh·kf/(kh + kf), two springs in a row
//! ```
//!
//! Source: geometry; springs in series.
use units::{Angle, Force, Lead, Length, Stiffness};

/// Where a helix stands at an angle.
pub fn helix(from: Length, lead: Lead, turned: Angle) -> Length {
    from + lead * turned
}

/// Magnitude of the axial force when spindle and thread are apart by `offset`, the holder within
/// its travel.
pub fn force_at_offset(offset: Length, holder: Stiffness, flank: Stiffness, play: Length) -> Force {
    let pressed = (offset.abs() - play / 2.0).max(Length::ZERO);
    let (kh, kf) = (holder.value(), flank.value());
    Stiffness::n_per_mm(kh * kf / (kh + kf)) * pressed
}
