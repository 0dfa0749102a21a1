//! The sync-error monitor: how far the follower was from its coupling, in the material only.
//!
//! ```text
//!    |e|  stop ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─     above it the machine stops
//!         warn ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─     above it once: an event
//!         ______/\____/\/\___
//!         R plane │surface … bottom│
//!                 └── counted ─────┘
//! ```
//!
//! Above the surface an error cuts nothing, and judging it would only forbid fast run-ups.
use units::{Angle, Length};

use crate::Coupling;

/// Limits of the sync error in the material.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Windows {
    /// Worth an event.
    pub warn: Length,
    /// The machine stops.
    pub stop: Length,
}

/// What one reading was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Not in the material: not counted.
    Outside,
    /// In the material and within the windows.
    Within(Length),
    /// The first reading of this stroke beyond the warning window.
    Warn(Length),
    /// Beyond the stop window.
    Stop(Length),
}

/// What a whole tap came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Figures {
    /// Largest magnitude.
    pub max: Length,
    /// Root mean square.
    pub rms: Length,
    /// Periods counted.
    pub periods: u32,
}

/// Watches one tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Monitor {
    windows: Windows,
    surface: Length,
    /// +1 when the material lies towards positive coordinates, else −1.
    into: f64,
    max: Length,
    sum_of_squares_mm2: f64,
    periods: u32,
    warned: bool,
}

impl Monitor {
    /// A monitor for a hole that begins at `surface` and runs towards `bottom`.
    pub fn new(windows: Windows, surface: Length, bottom: Length) -> Self {
        let into = if bottom >= surface { 1.0 } else { -1.0 };
        Self {
            windows,
            surface,
            into,
            max: Length::ZERO,
            sum_of_squares_mm2: 0.0,
            periods: 0,
            warned: false,
        }
    }

    /// How deep in the material a coordinate is; negative above the surface.
    pub fn depth(&self, z: Length) -> Length {
        (z - self.surface) * self.into
    }

    /// Judge one reading.
    pub fn observe(&mut self, coupling: &Coupling, theta: Angle, z: Length) -> Verdict {
        if self.depth(z) < Length::ZERO {
            return Verdict::Outside;
        }
        let error = coupling.error(theta, z);
        self.max = self.max.max(error.abs());
        self.sum_of_squares_mm2 += error.value() * error.value();
        self.periods += 1;
        if error.abs() > self.windows.stop {
            Verdict::Stop(error)
        } else if error.abs() > self.windows.warn && !self.warned {
            self.warned = true;
            Verdict::Warn(error)
        } else {
            Verdict::Within(error)
        }
    }

    /// What has been seen so far.
    pub fn figures(&self) -> Figures {
        let mean = self.sum_of_squares_mm2 / f64::from(self.periods.max(1));
        Figures { max: self.max, rms: Length::mm(libm::sqrt(mean)), periods: self.periods }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::Lead;

    const WINDOWS: Windows = Windows { warn: Length::um(10.0), stop: Length::um(50.0) };

    fn seen(z: f64, error_um: f64) -> (Verdict, Figures) {
        let g = Coupling::line(Lead::mm_per_rev(-1.0), Angle::ZERO, Length::ZERO);
        let mut monitor = Monitor::new(WINDOWS, Length::ZERO, Length::mm(-20.0));
        let verdict = monitor.observe(&g, Angle::rev(-z), Length::mm(z) + Length::um(error_um));
        (verdict, monitor.figures())
    }

    #[test]
    fn errors_above_the_surface_do_not_count() {
        let (verdict, figures) = seen(2.0, 500.0);
        assert_eq!((verdict, figures.periods), (Verdict::Outside, 0));
    }

    #[test]
    fn errors_in_the_material_warn_and_then_stop() {
        assert!(matches!(seen(-5.0, 8.0).0, Verdict::Within(_)));
        assert!(matches!(seen(-5.0, -12.0).0, Verdict::Warn(_)));
        assert!(matches!(seen(-5.0, 60.0).0, Verdict::Stop(_)));
    }

    #[test]
    fn a_tap_warns_once() {
        let g = Coupling::line(Lead::mm_per_rev(-1.0), Angle::ZERO, Length::ZERO);
        let mut monitor = Monitor::new(WINDOWS, Length::ZERO, Length::mm(-20.0));
        let off = Length::mm(-5.0) + Length::um(20.0);
        assert!(matches!(monitor.observe(&g, Angle::rev(5.0), off), Verdict::Warn(_)));
        assert!(matches!(monitor.observe(&g, Angle::rev(5.0), off), Verdict::Within(_)));
        assert!((monitor.figures().rms.in_um() - 20.0).abs() < 1e-9);
    }
}
