//! How the control leads drives through LinuxCNC's HAL.
use crate::keys::Keys;
use units::Time;

/// `[hal]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Hal {
    /// Name of the component: `loadrt leadscrew name=NAME`.
    pub component: String,
    /// A control that shows no sign of life for so long is gone: the component stops the machine.
    pub silent_after: Time,
    /// Servo periods after which an axis is where its drive was told to be.
    pub obeys_after_periods: f64,
}

impl Hal {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            component: if keys.has("component") {
                keys.text("component")
            } else {
                "default".into()
            },
            silent_after: Time::s(keys.number("silent_after_ms", 5.0..=5000.0) * 1e-3),
            obeys_after_periods: keys.number("obeys_after_periods", 0.0..=20.0),
        }
    }
}
