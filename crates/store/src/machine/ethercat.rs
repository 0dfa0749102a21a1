//! How drives on an EtherCAT network are led.
//!
//! ```text
//!   [ethercat]              interface, times            [[ethercat.devices]]   in the order of the wire
//!   [axes.x.ethercat]       which device leads the axis, and what a count is
//!   [spindles.ethercat]     the same of a spindle
//! ```
use crate::keys::Keys;
use units::{Time, Torque};

/// Most devices on a wire, and axes of a device.
const MOST_DEVICES: usize = 32;
const MOST_SLOT: u32 = 7;
/// Highest bit of 60FD.
const MOST_BIT: u8 = 31;

/// `[ethercat]`.
#[derive(Clone, Debug, PartialEq)]
pub struct EthercatNetwork {
    /// Name of the network interface.
    pub interface: String,
    /// Period of the frames: the servo period.
    pub cycle: Time,
    /// The frame is out so long before the drives take their setpoints.
    pub lead: Time,
    /// Servo periods from a command to the feedback that shows it.
    pub obeys_after_periods: f64,
    /// A control that shows no sign of life for so long is gone.
    pub silent_after: Time,
    /// The devices, in the order of the wire.
    pub devices: Vec<EthercatDevice>,
}

/// `[[ethercat.devices]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct EthercatDevice {
    /// Its name in this file.
    pub name: String,
    /// What it is.
    pub profile: DeviceProfile,
    /// Vendor and product that it has to have; `None`: anybody may be there.
    pub identity: Option<(u32, u32)>,
    /// Numbers of the machine's digital signals that its first input and output bit are.
    pub signals_from: [Option<u8>; 2],
}

/// What a device is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceProfile {
    /// Nothing is exchanged with it, or nobody reads it.
    Plain,
    /// A drive.
    Cia402,
    /// Digital inputs and outputs.
    DigitalIo,
    /// Eight outputs are the number of the tool that is wanted, eight inputs the one in the
    /// spindle; 255 while it is changed.
    ToolChanger,
}

/// `[axes.x.ethercat]`, `[spindles.ethercat]`: an axis of a drive.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveSlot {
    /// Name of the device.
    pub device: String,
    /// Axis of the device, from 0: its objects are 800 (hex) higher each.
    pub slot: u8,
    /// How it is commanded.
    pub mode: SlotMode,
    /// Counts per turn of the motor.
    pub counts_per_rev: u32,
    /// Turns of the motor per turn of the screw or the spindle, as a fraction.
    pub gear: (u32, u32),
    /// Positive counts are the negative direction.
    pub is_reversed: bool,
    /// Bits of 60FD.
    pub inputs: SlotInputs,
    /// Rated torque of the motor, of which 6077 is in thousandths; `None`: it is not read.
    pub torque_rated: Option<Torque>,
}

/// How a drive is commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotMode {
    /// Positions, cyclic synchronous.
    Csp,
    /// Speeds, cyclic synchronous.
    Csv,
    /// The speed of a frequency converter.
    Velocity,
}

/// Bits of 60FD that are switches of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SlotInputs {
    /// Home switch.
    pub home: Option<u8>,
    /// Limit switches at the negative and at the positive end.
    pub limits: [Option<u8>; 2],
}

impl EthercatNetwork {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let mut us = |key, bounds| Time::s(keys.number(key, bounds) * 1e-6);
        let (cycle, lead) = (us("cycle_us", 62.5..=10_000.0), us("lead_us", 10.0..=9000.0));
        let obeys = keys.optional("obeys_after_periods", 0.0..=20.0);
        Self {
            interface: keys.text("interface"),
            cycle,
            lead,
            // out with the next frame, taken at the SYNC0 after it, reached by the next one
            obeys_after_periods: obeys.unwrap_or(3.0),
            silent_after: Time::s(keys.number("silent_after_ms", 5.0..=5000.0) * 1e-3),
            devices: keys.sections("devices", MOST_DEVICES, EthercatDevice::read),
        }
    }
}

impl EthercatDevice {
    fn read(keys: &mut Keys<'_>) -> Self {
        let profiles = [
            ("cia402", DeviceProfile::Cia402),
            ("digital-io", DeviceProfile::DigitalIo),
            ("tool-changer", DeviceProfile::ToolChanger),
            ("plain", DeviceProfile::Plain),
        ];
        let most = bus::DIGITAL as u32 - 1;
        let mut first =
            |key| keys.optional_whole(key, 0..=most).and_then(|number| u8::try_from(number).ok());
        let signals_from = [first("inputs_from"), first("outputs_from")];
        Self {
            name: keys.text("name"),
            profile: keys.choice("profile", &profiles),
            identity: keys.optional_section("identity", |k| {
                (k.whole("vendor", 0..=u32::MAX), k.whole("product", 0..=u32::MAX))
            }),
            signals_from,
        }
    }
}

impl DriveSlot {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let modes = [("csp", SlotMode::Csp), ("csv", SlotMode::Csv), ("vl", SlotMode::Velocity)];
        let gear = keys.optional_text("gear");
        Self {
            device: keys.text("device"),
            slot: keys.optional_whole("slot", 0..=MOST_SLOT).unwrap_or(0) as u8,
            mode: keys.choice("mode", &modes),
            counts_per_rev: keys.whole("counts_per_rev", 16..=1 << 30),
            gear: gear.map_or((1, 1), |text| read_gear(&text, keys)),
            is_reversed: keys
                .optional_choice("direction", &[("+", false), ("-", true)])
                .unwrap_or(false),
            inputs: keys.optional_section("inputs", SlotInputs::read).unwrap_or_default(),
            torque_rated: keys.optional("torque_rated_n_m", 1e-3..=1e6).map(Torque::n_m),
        }
    }
}

impl SlotInputs {
    fn read(keys: &mut Keys<'_>) -> Self {
        let mut bit = |key| read_bit(key, keys);
        Self { home: bit("home"), limits: [bit("limit_neg"), bit("limit_pos")] }
    }
}

/// `60FD.2` is 2.
fn read_bit(key: &'static str, keys: &mut Keys<'_>) -> Option<u8> {
    let text = keys.optional_text(key)?;
    let bit = text.strip_prefix("60FD.").and_then(|bit| bit.parse().ok());
    let bit = bit.filter(|bit: &u8| *bit <= MOST_BIT);
    if bit.is_none() {
        keys.conflict(key, format!("`{key}` is \"{text}\": expected 60FD.0 to 60FD.{MOST_BIT}"));
    }
    bit
}

/// `3/2` is three turns of the motor for two of the screw.
fn read_gear(text: &str, keys: &Keys<'_>) -> (u32, u32) {
    const MOST: u32 = 100_000;
    let parts = text.split_once('/').map(|(a, b)| (a.trim().parse(), b.trim().parse()));
    match parts {
        Some((Ok(motor), Ok(load)))
            if (1..=MOST).contains(&motor) && (1..=MOST).contains(&load) =>
        {
            (motor, load)
        }
        _ => {
            let message = format!(
                "`gear` is \"{text}\": expected turns of the motor/turns of the load, such as 3/2, each from 1 to {MOST}"
            );
            keys.conflict("gear", message);
            (1, 1)
        }
    }
}

#[cfg(test)]
#[path = "ethercat_tests.rs"]
mod tests;
