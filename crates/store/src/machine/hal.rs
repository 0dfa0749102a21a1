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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use crate::machine::parse;

    /// A machine in HAL whose spindle has such a drive.
    fn with(drive: &str) -> Result<crate::machine::MachineFile, String> {
        let hal = "[hal]\nsilent_after_ms = 500\nobeys_after_periods = 1\n";
        let text =
            format!("extends = \"tapping-center\"\nname = \"x\"\n{hal}[[spindles]]\n{drive}");
        parse(&text, 0).map_err(|found| format!("{found:?}"))
    }

    #[test]
    fn a_drive_in_hal_takes_a_speed_or_an_angle() {
        let told_an_angle = with("[spindles.drive]\nkind = \"position\"\n").unwrap();
        assert!(told_an_angle.spindles[0].closes_position);
        assert!(told_an_angle.spindles[0].own_ramps.is_none());
        for drive in ["", "[spindles.drive]\nkind = \"torque\"\n"] {
            let why = with(drive).unwrap_err();
            assert!(why.contains("S0406") && why.contains("or `kind = "), "{why}");
        }
        let why =
            with("encoder_index = true\n[spindles.drive]\nkind = \"position\"\n").unwrap_err();
        assert!(why.contains("S0406") && why.contains("expected false"), "{why}");
    }
}
