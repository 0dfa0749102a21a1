//! An actuator that may swing: what it can do, and what its loop makes of what it is told.
use super::series::Actuator;

/// What one actuator can do: mm and s, or rev and s; N, or N·m.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Farthest from the middle.
    pub travel: f64,
    /// Speed.
    pub speed: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Jerk.
    pub jerk: f64,
    /// What its drive needs and has, if that is known.
    pub effort: Option<Effort>,
}

/// Force or torque = `per_acceleration`·ẍ + `per_speed`·ẋ + `constant`, within ±most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Mass or inertia, in the units of the amplitude.
    pub per_acceleration: f64,
    /// Viscous friction.
    pub per_speed: f64,
    /// Coulomb friction and what turning takes.
    pub constant: f64,
    /// What the drive gives.
    pub most: f64,
}

/// An actuator that may swing.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Which.
    pub actuator: Actuator,
    /// What it can do.
    pub limits: Limits,
    /// What its closed loop makes of each harmonic, real and imaginary part; empty: 1, it is
    /// compensated.
    pub response: Vec<[f64; 2]>,
}

impl Limits {
    /// The share of each that peaks use.
    pub(super) fn shares(&self, peaks: &[f64; 5]) -> [f64; 5] {
        let effort = self.effort.map_or(f64::INFINITY, |e| e.most);
        let most = [self.travel, self.speed, self.acceleration, self.jerk, effort];
        [0, 1, 2, 3, 4].map(|n| peaks[n] / most[n])
    }
}

impl Drive {
    pub(super) fn at(&self, harmonic: usize) -> [f64; 2] {
        self.response.get(harmonic).copied().unwrap_or([1.0, 0.0])
    }
}
