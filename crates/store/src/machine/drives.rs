//! What the drives do by themselves when the control falls silent or the mains fail.
use crate::keys::Keys;
use bus::DriveReaction;
use units::Time;

/// `[drives]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drives {
    /// After so long without a command they take the control for dead.
    pub watchdog: Time,
    /// What they do then.
    pub on_link_loss: DriveReaction,
    /// What they do when the mains fail.
    pub on_power_loss: DriveReaction,
    /// Their DC bus, without which a stop needs mains.
    pub bus: Option<DcBus>,
}

/// The bus that all drives are fed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DcBus {
    /// Capacitance, F.
    pub capacitance_f: f64,
    /// Voltage in operation, V.
    pub voltage_v: f64,
    /// Voltage below which the drives trip, V.
    pub trip_v: f64,
}

const REACTIONS: [(&str, DriveReaction); 4] = [
    ("off", DriveReaction::Off),
    ("coast", DriveReaction::Coast),
    ("quick-stop", DriveReaction::QuickStop),
    ("coupled-stop", DriveReaction::CoupledStop),
];

impl Default for Drives {
    /// Drives of which nothing is known can brake while they have mains.
    fn default() -> Self {
        Self {
            watchdog: Time::s(5e-3),
            on_link_loss: DriveReaction::QuickStop,
            on_power_loss: DriveReaction::Off,
            bus: None,
        }
    }
}

impl Drives {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let drives = Self {
            watchdog: Time::s(keys.number("watchdog_ms", 0.1..=10_000.0) * 1e-3),
            on_link_loss: keys.choice("on_link_loss", &REACTIONS),
            on_power_loss: keys.choice("on_power_loss", &REACTIONS),
            bus: keys.optional_section("bus", |k| DcBus {
                capacitance_f: k.number("capacitance_uf", 1.0..=1e6) * 1e-6,
                voltage_v: k.number("voltage_v", 24.0..=2000.0),
                trip_v: k.number("trip_v", 1.0..=2000.0),
            }),
        };
        if drives.bus.is_some_and(|bus| bus.trip_v >= bus.voltage_v) {
            keys.conflict("bus", "`trip_v` must be below `voltage_v`");
        }
        if drives.bus.is_none() && drives.on_power_loss != DriveReaction::Off {
            let message = "a stop without mains lives on the DC bus: expected [drives.bus], or `on_power_loss = \"off\"`";
            keys.conflict("on_power_loss", message);
        }
        drives
    }
}
