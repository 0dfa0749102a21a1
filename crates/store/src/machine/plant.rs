//! What a machine really is, as far as it differs from what its file says and its control believes.
//!
//! Two kinds: what is not known, drawn from the seed as `[scatter]` says ([`super::Scatter`]), and
//! errors that are stated to see what they do, in `[axes.x.errors]`, `[spindles.errors]` and
//! `[simulation.screw_growth]`. The simulated plant alone reads either; the control is never told.
use super::scatter::StatedBefore;
use crate::keys::Keys;
use units::{Angle, Length, Time};

/// `[simulation.plant]`: what encoders are like that no control needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Graduations {
    /// Diameter of the graduation of the motors' encoders.
    pub motor: Length,
    /// Diameter of the graduation of the spindles' encoders.
    pub spindle: Length,
}

/// `[simulation.screw_growth]`: screws get warm while they run and grow by s·(1 − e^(−t/T)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrewGrowth {
    /// s: of a screw as warm as it gets, length over length.
    pub warm: f64,
    /// T.
    pub time_constant: Time,
    /// Time that the machine has run since the work was touched off, when a program begins.
    pub running: Time,
}

/// Errors of an axis that are stated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisErrors {
    /// The axis moves so much farther than its scale, or its screw, says; length over length.
    pub scale: Option<f64>,
    /// The graduation of its motor's encoder is so far off its centre.
    pub encoder_eccentricity: Option<Length>,
}

/// Errors of a spindle that are stated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpindleErrors {
    /// The graduation of its encoder is so far off its centre.
    pub encoder_eccentricity: Option<Length>,
}

/// Amplitude of the reading's error, once per revolution, of a graduation off its centre.
pub fn eccentric(by: Length, diameter: Length) -> Angle {
    Angle::rev(2.0 * by.value() / diameter.value() / std::f64::consts::TAU)
}

impl Graduations {
    /// Of a machine whose file does not say it.
    pub(super) const TYPICAL: Self = Self { motor: Length::mm(40.0), spindle: Length::mm(60.0) };

    /// And what the version before stated beside it.
    pub(super) fn read(keys: &mut Keys<'_>, before: &mut StatedBefore) -> Self {
        let mut share = |key| keys.optional(key, 0.0..=80.0);
        before.backlash = share("backlash_scatter_percent");
        before.stiffness = share("stiffness_scatter_percent");
        before.friction = share("friction_scatter_percent");
        before.screw_lead = keys.optional("screw_lead_error_um_per_300_mm", 0.0..=3000.0);
        before.screw_wobble = keys.optional("screw_wobble_um", 0.0..=1000.0);
        before.gear_wobble = keys.optional("gear_wobble_arcsec", 0.0..=3600.0);
        before.encoder_eccentricity = keys.optional("encoder_eccentricity_um", ECCENTRICITY_UM);
        before.scale_error = keys.optional("scale_error_um_per_m", 0.0..=10_000.0);
        let mut diameter =
            |key, most, usual: Length| keys.optional(key, 5.0..=most).map_or(usual, Length::mm);
        Self {
            motor: diameter("motor_encoder_diameter_mm", 1000.0, Self::TYPICAL.motor),
            spindle: diameter("spindle_encoder_diameter_mm", 2000.0, Self::TYPICAL.spindle),
        }
    }
}

impl ScrewGrowth {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        const MOST_MIN: f64 = 60.0 * 24.0 * 7.0;
        let minutes = |n: f64| Time::s(n * 60.0);
        Self {
            warm: keys.number("warm_um_per_m", 0.0..=1000.0) * 1e-6,
            time_constant: minutes(keys.number("time_constant_min", 0.01..=MOST_MIN)),
            running: minutes(keys.optional("running_min", 0.0..=MOST_MIN).unwrap_or(0.0)),
        }
    }
}

/// Farthest that an encoder's graduation may be stated off its centre, µm.
const ECCENTRICITY_UM: std::ops::RangeInclusive<f64> = 0.0..=1000.0;

impl AxisErrors {
    /// `[axes.x.errors]`, or of a rotary axis.
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            scale: keys.optional("scale_error_ppm", -50_000.0..=50_000.0).map(|ppm| ppm * 1e-6),
            encoder_eccentricity: keys
                .optional("encoder_eccentricity_um", ECCENTRICITY_UM)
                .map(Length::um),
        }
    }
}

impl SpindleErrors {
    /// `[spindles.errors]`.
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            encoder_eccentricity: keys
                .optional("encoder_eccentricity_um", ECCENTRICITY_UM)
                .map(Length::um),
        }
    }
}
