//! Exact solutions: what the equations must give, in closed form, with the source.
//!
//! The simulator is tested against these before anything else is tested on the simulator. They are
//! public so that the tests of the control can use them too. None of them shares a line with the
//! integration.

pub mod friction;
pub mod lag;
pub mod spindle;
pub mod thread;

use crate::AxisModel;
use core::f64::consts::TAU;

/// How motor and table swing against each other when both are free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeMode {
    /// √(k/mr)/2π, Hz.
    pub natural_hz: f64,
    /// The frequency one sees: natural·√(1 − ζ²), Hz.
    pub damped_hz: f64,
    /// ζ.
    pub damping_ratio: f64,
}

/// The mode of an axis' two masses m₁, m₂ on a spring k: ω = √(k(1/m₁ + 1/m₂)), ωd = ω√(1 − ζ²).
///
/// Source: Den Hartog, *Mechanical Vibrations*, 4th ed. 1956, §2.2 and §3.1.
pub fn free_mode(model: &AxisModel) -> FreeMode {
    let masses = 1.0 / model.table.value() + 1.0 / model.motor_mass().value();
    let natural_hz = (model.stiffness.value() * 1e3 * masses).sqrt() / TAU;
    let damping_ratio = model.damping_ratio;
    FreeMode {
        natural_hz,
        damped_hz: natural_hz * (1.0 - damping_ratio.powi(2)).sqrt(),
        damping_ratio,
    }
}

/// Distance from rest under constant acceleration: ½·a·t².
pub fn ramp_up(acceleration: f64, t: f64) -> f64 {
    acceleration * t * t / 2.0
}
