//! How a drive measures the torque that it gives: `measured_torque`, of an axis' drive or of a
//! spindle.
//!
//! ```toml
//! [axes.z.drive.measured_torque]
//! resolution_percent = 0.1      # of the drive's peak, as all shares here
//! noise_percent = 0.5           # standard deviation
//! delay_ms = 1
//! ```
//!
//! `from = "none"` takes back what a base states.
use super::setup::percent;
use crate::keys::Keys;
use units::Time;

/// How a drive measures its torque; a linear motor's its force. Shares are of its peak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredTorque {
    /// One step of the reading.
    pub resolution_share: f64,
    /// Standard deviation of the reading.
    pub noise_share: f64,
    /// From what is given to what is said.
    pub delay: Time,
}

impl MeasuredTorque {
    pub(super) fn read(keys: &mut Keys<'_>) -> Option<Self> {
        let stated = keys.optional_section("measured_torque", |k| {
            let sources = [("drive", true), ("none", false)];
            let is_measured = k.optional_choice("from", &sources).unwrap_or(true);
            let stated = Self {
                resolution_share: percent(k, "resolution_percent", 0.0..=10.0),
                noise_share: percent(k, "noise_percent", 0.0..=20.0),
                delay: Time::s(k.number("delay_ms", 0.0..=50.0) * 1e-3),
            };
            is_measured.then_some(stated)
        });
        stated.flatten()
    }
}
