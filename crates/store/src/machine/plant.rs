//! What a machine really is, as far as it differs from what its file says and its control believes.
//!
//! Two kinds: what is not known, drawn from the seed within `[simulation.plant]`, and errors that are stated to see what they do,
//! in `[axes.x.errors]` and `[spindles.errors]`. The simulated plant alone reads either; the control is never told.
//!
//! | key | what it is |
//! |---|---|
//! | `screw_lead_error_um_per_300_mm` | cumulative lead error, as ISO 3408-3 has it (half of V300p, to either side) |
//! | `screw_wobble_um` | amplitude of the screw's error once per revolution (half of v2πp) |
//! | `gear_wobble_arcsec` | the same of a rotary axis' gear, at the table |
//! | `encoder_eccentricity_um` | a graduation off its centre by e reads 2·e/diameter rad wrong, once per revolution |
//! | `scale_error_um_per_m` | error of a linear scale, growing with the length |
use super::setup::percent;
use crate::keys::Keys;
use units::{Angle, Coordinate, Length};

/// How far the plant may be from its file, to either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantScatter {
    /// Play, as a fraction.
    pub backlash_share: f64,
    /// Stiffness between motor and table.
    pub stiffness_share: f64,
    /// Friction of guideways and spindles.
    pub friction_share: f64,
    /// Cumulative lead error of ball screws, length over length.
    pub screw_lead_error: f64,
    /// Amplitude of their error once per revolution.
    pub screw_wobble: Length,
    /// The same of a rotary axis' gear.
    pub gear_wobble: Coordinate,
    /// How far an encoder's graduation is off its centre.
    pub encoder_eccentricity: Length,
    /// Diameter of the graduation of the motors' encoders.
    pub motor_encoder_diameter: Length,
    /// Diameter of the graduation of the spindles' encoders.
    pub spindle_encoder_diameter: Length,
    /// Error of linear scales, length over length.
    pub scale_error: f64,
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

impl PlantScatter {
    /// Of a machine whose file does not say it.
    pub const TYPICAL: Self = Self {
        backlash_share: 0.2,
        stiffness_share: 0.15,
        friction_share: 0.2,
        screw_lead_error: 6e-3 / 300.0,
        screw_wobble: Length::um(3.0),
        gear_wobble: Coordinate::new(5.0 / 3600.0),
        encoder_eccentricity: Length::um(3.0),
        motor_encoder_diameter: Length::mm(40.0),
        spindle_encoder_diameter: Length::mm(60.0),
        scale_error: 3e-6,
    };

    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        const SHARE: std::ops::RangeInclusive<f64> = 0.0..=80.0;
        let usual = Self::TYPICAL;
        let mut share = |key, usual: f64| {
            if keys.has(key) { percent(keys, key, SHARE) } else { usual }
        };
        let backlash_share = share("backlash_scatter_percent", usual.backlash_share);
        let stiffness_share = share("stiffness_scatter_percent", usual.stiffness_share);
        let friction_share = share("friction_scatter_percent", usual.friction_share);
        let mut number = |key, bounds, scale: f64, usual: f64| {
            keys.optional(key, bounds).map_or(usual, |n| n * scale)
        };
        Self {
            backlash_share,
            stiffness_share,
            friction_share,
            screw_lead_error: number(
                "screw_lead_error_um_per_300_mm",
                0.0..=3000.0,
                1e-3 / 300.0,
                usual.screw_lead_error,
            ),
            screw_wobble: Length::mm(number(
                "screw_wobble_um",
                0.0..=1000.0,
                1e-3,
                usual.screw_wobble.value(),
            )),
            gear_wobble: Coordinate::new(number(
                "gear_wobble_arcsec",
                0.0..=3600.0,
                1.0 / 3600.0,
                usual.gear_wobble.value(),
            )),
            encoder_eccentricity: Length::mm(number(
                "encoder_eccentricity_um",
                0.0..=1000.0,
                1e-3,
                usual.encoder_eccentricity.value(),
            )),
            motor_encoder_diameter: Length::mm(number(
                "motor_encoder_diameter_mm",
                5.0..=1000.0,
                1.0,
                usual.motor_encoder_diameter.value(),
            )),
            spindle_encoder_diameter: Length::mm(number(
                "spindle_encoder_diameter_mm",
                5.0..=2000.0,
                1.0,
                usual.spindle_encoder_diameter.value(),
            )),
            scale_error: number("scale_error_um_per_m", 0.0..=10_000.0, 1e-6, usual.scale_error),
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
