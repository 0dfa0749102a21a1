//! What a network of drives cannot be, a sentence each.
use super::axis::{Axis, PositionFrom};
use super::ethercat::{DeviceProfile, DriveSlot, EthercatNetwork, SlotMode};
use super::homing::HomingMethod;
use super::spindle::Spindle;
use units::Time;

/// What has drives, and the network that they are on.
pub(super) struct NetworkDrives<'a> {
    pub(super) network: Option<&'a EthercatNetwork>,
    pub(super) axes: &'a [Option<Axis>],
    pub(super) spindles: &'a [Spindle],
    pub(super) period: Time,
    /// Drives are led through HAL.
    pub(super) has_hal: bool,
}

impl NetworkDrives<'_> {
    /// Everything that is wrong with them.
    pub(super) fn problems(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        let axes = self.axes.iter().flatten();
        let Some(network) = self.network else {
            let has_slot = axes.map(|axis| axis.ethercat.is_some());
            let turning = self.spindles.iter().map(|spindle| spindle.ethercat.is_some());
            if has_slot.chain(turning).any(|has| has) {
                wrong.push("drives are on a network that is not there: expected [ethercat]".into());
            }
            return wrong;
        };
        if self.has_hal {
            wrong.push(
                "drives are led through HAL or over EtherCAT: expected [hal] or [ethercat]".into(),
            );
        }
        refuse_times(self.period, network, &mut wrong);
        refuse_names(network, &mut wrong);
        let mut taken: Vec<(&str, u8, String)> = Vec::new();
        for axis in axes {
            let of = format!("axis {}", axis.letter.letter());
            refuse_axis(axis, &of, &mut wrong);
            refuse_slot(network, axis.ethercat.as_ref(), of, &mut taken, &mut wrong);
        }
        for spindle in self.spindles {
            let of = format!("spindle \"{}\"", spindle.name);
            refuse_spindle(spindle, &of, &mut wrong);
            refuse_slot(network, spindle.ethercat.as_ref(), of, &mut taken, &mut wrong);
        }
        wrong
    }
}

fn refuse_times(period: Time, network: &EthercatNetwork, wrong: &mut Vec<String>) {
    let us = |time: Time| (time.value() * 1e9).round() / 1e3;
    let (cycle, period) = (us(network.cycle), us(period));
    if cycle != period {
        wrong.push(format!(
            "`cycle_us` is {cycle} and control.period_us {period}: expected {period}, a frame a servo period"
        ));
    }
    if network.lead >= network.cycle {
        wrong.push(format!(
            "`lead_us` is {}: expected less than the cycle of {cycle} µs",
            us(network.lead)
        ));
    }
}

fn refuse_names(network: &EthercatNetwork, wrong: &mut Vec<String>) {
    for (at, device) in network.devices.iter().enumerate() {
        if network.devices[..at].iter().any(|before| before.name == device.name) {
            wrong.push(format!("two devices are named \"{}\"", device.name));
        }
        if device.signals_from != [None; 2] && device.profile != DeviceProfile::DigitalIo {
            wrong.push(format!(
                "`inputs_from` and `outputs_from` of device \"{}\" are for profile = \"digital-io\"",
                device.name
            ));
        }
    }
    let changers = network.devices.iter().filter(|d| d.profile == DeviceProfile::ToolChanger);
    if changers.count() > 1 {
        wrong.push("two devices are tool changers: expected one at most".into());
    }
}

fn refuse_slot<'a>(
    network: &EthercatNetwork,
    slot: Option<&'a DriveSlot>,
    of: String,
    taken: &mut Vec<(&'a str, u8, String)>,
    wrong: &mut Vec<String>,
) {
    let Some(slot) = slot else {
        wrong.push(format!("{of} has no drive on the network: expected its table `ethercat`"));
        return;
    };
    match network.devices.iter().find(|device| device.name == slot.device) {
        None => {
            let names: Vec<&str> = network.devices.iter().map(|d| d.name.as_str()).collect();
            wrong.push(format!(
                "{of}: there is no device \"{}\": expected one of {}",
                slot.device,
                names.join(", ")
            ));
        }
        Some(device) if device.profile != DeviceProfile::Cia402 => {
            wrong.push(format!(
                "{of}: device \"{}\" is no drive: expected profile = \"cia402\"",
                device.name
            ));
        }
        Some(_) => {}
    }
    let same =
        |(device, number, _): &&(&str, u8, String)| *device == slot.device && *number == slot.slot;
    if let Some((.., before)) = taken.iter().find(same) {
        wrong.push(format!(
            "{of} and {before} are both slot {} of device \"{}\"",
            slot.slot, slot.device
        ));
    }
    taken.push((&slot.device, slot.slot, of));
}

fn refuse_axis(axis: &Axis, of: &str, wrong: &mut Vec<String>) {
    let Some(slot) = &axis.ethercat else { return };
    if slot.mode != SlotMode::Csp {
        wrong.push(format!("{of} is commanded positions: expected mode = \"csp\""));
    }
    if matches!(axis.position_from, PositionFrom::Motor { .. }) {
        wrong.push(format!(
            "the drive of {of} closes the position loop, and what it reports is where the axis is: expected position_from = \"scale\" (\"table\" of a rotary axis)"
        ));
    }
    match axis.homing.method {
        HomingMethod::Switch if slot.inputs.home.is_none() => wrong.push(format!(
            "{of} is homed by its switch, which is not read: expected inputs = {{ home = \"60FD.2\" }}"
        )),
        HomingMethod::SwitchAndIndex | HomingMethod::Index | HomingMethod::HardStop => {
            wrong.push(format!(
                "{of}: index marks and forces are not exchanged: expected method = \"switch\", \"absolute\" or \"given\" for its homing"
            ));
        }
        HomingMethod::Switch | HomingMethod::Absolute | HomingMethod::Given => {}
    }
}

fn refuse_spindle(spindle: &Spindle, of: &str, wrong: &mut Vec<String>) {
    let Some(slot) = &spindle.ethercat else { return };
    let (expected, fits) = match (spindle.closes_position, &spindle.own_ramps) {
        (true, _) => ("mode = \"csp\"", slot.mode == SlotMode::Csp),
        (false, Some(_)) => ("mode = \"csv\" or \"vl\"", slot.mode != SlotMode::Csp),
        (false, None) => {
            wrong.push(format!(
                "the drive of {of} is told a torque: expected kind = \"position\" or \"speed\" under [spindles.drive]"
            ));
            return;
        }
    };
    if !fits {
        wrong.push(format!(
            "the mode of {of} does not fit its [spindles.drive]: expected {expected}"
        ));
    }
    if spindle.encoder_index {
        wrong
            .push(format!("index marks of {of} are not exchanged: expected encoder_index = false"));
    }
    if spindle.own_ramps.is_some_and(|own| own.orients) {
        wrong
            .push(format!("the drive of {of} is not asked to orient it: expected orients = false"));
    }
}
