//! The cumulative sum test: finds that a noisy reading has left its bound, as soon as its noise
//! allows.
//!
//! ```text
//!   S ← max(0, S + x − k)      alarm where S > h,   h = ln(1/p)·σ²/(2·d)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x, σ | reading, standard deviation of its noise | N·m |
//! | k | bound: what a good reading is below by d or more | N·m |
//! | p | chance of a false alarm each time that the sum begins anew | 1 |
//!
//! A reading that is above the bound by D is found in about h/D periods: a large overload in one or
//! two, a small one in as many as its noise takes. Source: Page, Continuous inspection schemes,
//! Biometrika 41 (1954); the threshold is Wald's for a sequential test of a mean (exponential bound
//! exp(−2·d·h/σ²)).
use libm::log;

/// Chance of a false alarm each time that the sum begins anew.
const FALSE_ALARM: f64 = 1e-10;
/// Share of the distance below which noise is as good as none.
const LEAST_DISTANCE: f64 = 1e-6;

/// Page's sum for one bound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detector {
    sum: f64,
    /// Readings since it was zero.
    readings: u32,
}

impl Detector {
    /// A sum that has seen nothing.
    pub const NEW: Self = Self { sum: 0.0, readings: 0 };

    /// Takes a reading that is above the bound by `excess`, where a good reading is below it by
    /// `distance` on average with noise of standard deviation `noise`; true: the bound is exceeded.
    pub fn exceeds(&mut self, excess: f64, distance: f64, noise: f64) -> bool {
        self.sum = (self.sum + excess).max(0.0);
        self.readings = if self.sum > 0.0 { self.readings.saturating_add(1) } else { 0 };
        self.sum > threshold(distance, noise)
    }

    /// Begins anew.
    pub const fn reset(&mut self) {
        *self = Self::NEW;
    }

    /// Readings since the sum was zero.
    pub const fn readings(&self) -> u32 {
        self.readings
    }

    /// Mean excess of these.
    pub fn mean(&self) -> f64 {
        self.sum / f64::from(self.readings.max(1))
    }
}

/// h of the picture, N·m times periods.
pub fn threshold(distance: f64, noise: f64) -> f64 {
    -log(FALSE_ALARM) * noise * noise / (2.0 * distance.max(LEAST_DISTANCE))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Periods until a constant excess is found.
    fn found_after(excess: f64, distance: f64, noise: f64) -> usize {
        let mut detector = Detector::NEW;
        (1..100_000).find(|_| detector.exceeds(excess, distance, noise)).unwrap_or(usize::MAX)
    }

    #[test]
    fn an_excess_is_found_after_the_threshold_over_it() {
        // ln(1e10)·0.84²/(2·4) = 2.03: an excess of 3 is found at once, one of 0.5 in five periods
        assert_eq!(found_after(3.0, 4.0, 0.84), 1);
        assert_eq!(found_after(0.5, 4.0, 0.84), 5);
    }

    #[test]
    fn without_noise_any_excess_is_found_at_once_and_none_is_never() {
        assert_eq!(found_after(1e-9, 0.5, 0.0), 1);
        let mut detector = Detector::NEW;
        assert!(!detector.exceeds(0.0, 0.5, 0.0));
    }
}
