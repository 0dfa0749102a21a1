//! The spindle's own torque: by how much its model is off, learnt above the work from the same
//! motion.
//!
//! ```text
//!   measured = g·J·α + f·friction + noise        above the surface: there the tap cuts nothing
//!
//!   A = Σ x·xᵀ/σ² + P,   b = Σ x·m/σ² + P·1,   (g, f) = A⁻¹·b        x = (J·α, friction)
//! ```
//!
//! Least squares with what is known before (P): a torque constant and an inertia within
//! `GAIN_SPREAD`, a friction within `FRICTION_SPREAD`. What earlier strokes have shown counts
//! less with each stroke, as bearings get warm.

/// Standard deviation of g before anything is measured.
const GAIN_SPREAD: f64 = 0.05;
/// The same of f.
const FRICTION_SPREAD: f64 = 0.3;
/// P: weights of what is known before.
const PRIOR: (f64, f64) =
    (1.0 / (GAIN_SPREAD * GAIN_SPREAD), 1.0 / (FRICTION_SPREAD * FRICTION_SPREAD));
/// Least noise of a reading that is taken into account, N·m: what the model does not have.
const LEAST_NOISE: f64 = 0.02;
/// What is kept of earlier strokes at the beginning of the next one.
const KEPT: f64 = 0.8;

/// Sums over readings above the work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OwnTorque {
    /// Σ x·xᵀ/σ²: of J·α, of both, of friction.
    pub squares: [f64; 3],
    /// Σ x·m/σ².
    pub products: [f64; 2],
}

impl OwnTorque {
    /// A stroke begins: earlier ones count less.
    pub fn fade(&mut self) {
        for sum in self.squares.iter_mut().chain(&mut self.products) {
            *sum *= KEPT;
        }
    }

    /// Takes a reading above the work: torques of acceleration and of friction by the model, the
    /// one measured, and its noise, N·m.
    pub fn add(&mut self, (inertial, friction): (f64, f64), measured: f64, noise: f64) {
        let noise = noise.max(LEAST_NOISE);
        let weight = 1.0 / (noise * noise);
        self.squares[0] += weight * inertial * inertial;
        self.squares[1] += weight * inertial * friction;
        self.squares[2] += weight * friction * friction;
        self.products[0] += weight * inertial * measured;
        self.products[1] += weight * friction * measured;
    }

    /// g and f.
    pub fn factors(&self) -> (f64, f64) {
        let (p, q) = PRIOR;
        let (a, b, c) = (self.squares[0] + p, self.squares[1], self.squares[2] + q);
        let (u, v) = (self.products[0] + p, self.products[1] + q);
        let determinant = a * c - b * b;
        ((u * c - v * b) / determinant, (a * v - b * u) / determinant)
    }

    /// Standard deviation of g.
    pub fn gain_error(&self) -> f64 {
        let (p, q) = PRIOR;
        let (a, b, c) = (self.squares[0] + p, self.squares[1], self.squares[2] + q);
        libm::sqrt(c / (a * c - b * b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_measured_leaves_the_model_as_it_is() {
        let (g, f) = OwnTorque::default().factors();
        assert!((g - 1.0).abs() < 1e-12 && (f - 1.0).abs() < 1e-12);
        assert!((OwnTorque::default().gain_error() - GAIN_SPREAD).abs() < 1e-12);
    }

    #[test]
    fn a_run_up_and_a_way_at_speed_show_both_factors() {
        let mut own = OwnTorque::default();
        for period in 0..400 {
            let inertial = if period < 60 { 36.0 } else { 0.0 };
            let noise = if period % 2 == 0 { 0.8 } else { -0.8 };
            own.add((inertial, 0.5), 1.03 * inertial + 1.2 * 0.5 + noise, 0.8);
        }
        let (g, f) = own.factors();
        assert!((g - 1.03).abs() < 0.003 && (f - 1.2).abs() < 0.03, "{g} {f}");
        assert!(own.gain_error() < 0.005);
    }
}
