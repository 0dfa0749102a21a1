//! From a machine's file to what is expected on its wire, and to what its drives are.
use bus::DriveReaction;
use control::Refused;
use ethercat::{
    AxisInputs, AxisSlot, CountScale, Device, DeviceIdentity, DriveMode, LedDrive, MachineDrives,
    Network, PdoEntry, Sdo, Terminal,
};
use store::machine::{
    DeviceProfile, DriveSlot, EthercatDevice, EthercatNetwork, MachineFile, Motor, SlotMode,
};

/// A target may change by this many times what the fastest motion of an axis changes it in a cycle.
const ROOM: f64 = 2.0;
/// Frames of the start by which the clocks are brought together.
const CLOCK_FRAMES: u32 = 2_000;
/// Option code of 6007, the end of the connection: no voltage, and quick stop.
const DISABLE_VOLTAGE: u32 = 2;
const QUICK_STOP: u32 = 3;

/// A drive, its slot in the file, what its load goes in a turn and how fast that is at most, a
/// second.
struct Used<'a> {
    index: usize,
    slot: &'a DriveSlot,
    per_rev: f64,
    fastest: f64,
    is_spindle: bool,
}

fn network_of(file: &MachineFile) -> Result<&EthercatNetwork, Refused> {
    let missing = || {
        Refused::because(format!(
            "the machine {} has no [ethercat] section: it says which drives are on the network, as in machines/ethercat/mill.toml",
            file.name
        ))
    };
    file.ethercat.as_ref().ok_or_else(missing)
}

/// All drives that something of the machine uses.
fn used(file: &MachineFile) -> Vec<Used<'_>> {
    let axes = file.axes.iter().enumerate().filter_map(|(index, axis)| {
        let axis = axis.as_ref()?;
        let per_rev = match axis.drive.motor {
            Motor::BallScrew { lead, .. } => lead.value(),
            // a pole pitch of a linear motor stands for its turn
            Motor::Linear { .. } => 1.0,
        };
        let (slot, fastest) = (axis.ethercat.as_ref()?, axis.rapid.value());
        Some(Used { index, slot, per_rev, fastest, is_spindle: false })
    });
    let spindles = file.spindles.iter().enumerate().filter_map(|(index, spindle)| {
        let (slot, fastest) = (spindle.ethercat.as_ref()?, spindle.max.value());
        Some(Used { index, slot, per_rev: 1.0, fastest, is_spindle: true })
    });
    axes.chain(spindles).collect()
}

impl Used<'_> {
    fn scale(&self) -> CountScale {
        let DriveSlot { counts_per_rev, gear, is_reversed, .. } = *self.slot;
        CountScale { counts_per_rev, gear, is_reversed, per_rev: self.per_rev }
    }

    const fn mode(&self) -> DriveMode {
        match self.slot.mode {
            SlotMode::Csp => DriveMode::Csp,
            SlotMode::Csv => DriveMode::Csv,
            SlotMode::Velocity => DriveMode::Velocity,
        }
    }

    fn axis_slot(&self, cycle_s: f64) -> AxisSlot {
        let most_step = match self.mode() {
            DriveMode::Csp => {
                let counts = self.scale().counts_per_unit().abs() * self.fastest * cycle_s * ROOM;
                counts.ceil().min(f64::from(i32::MAX)) as u32
            }
            // a speed may change at once: the drive has ramps, or the kernel has
            DriveMode::Csv | DriveMode::Velocity | DriveMode::Cst => u32::MAX,
        };
        AxisSlot {
            number: self.slot.slot,
            mode: self.mode(),
            most_step,
            says_torque: self.slot.torque_rated.is_some(),
        }
    }
}

/// Slots of a device in their order.
fn slots_of<'a>(used: &'a [Used<'_>], device: &EthercatDevice) -> Vec<&'a Used<'a>> {
    let mut slots: Vec<_> = used.iter().filter(|one| one.slot.device == device.name).collect();
    slots.sort_by_key(|one| one.slot.slot);
    slots
}

/// What is expected on the wire of this machine.
///
/// # Errors
/// It has no network.
pub fn expected_network(file: &MachineFile) -> Result<Network, Refused> {
    let network = network_of(file)?;
    let all = used(file);
    let cycle_s = network.cycle.value();
    let ns = |time: units::Time| (time.value() * 1e9).round() as u32;
    let devices = network.devices.iter().map(|device| {
        let slots = slots_of(&all, device);
        let mut expected = if slots.is_empty() {
            Device::plain(&device.name)
        } else {
            let slots: Vec<_> = slots.iter().map(|one| one.axis_slot(cycle_s)).collect();
            let sdos = slots.iter().flat_map(|slot| start_values(file, ns(network.cycle), *slot));
            let sdos = sdos.collect();
            Device { sdos, ..Device::drive(&device.name, &slots) }
        };
        let identity = device.identity;
        expected.identity = identity.map(|(vendor, product)| DeviceIdentity { vendor, product });
        expected
    });
    let devices = devices.collect();
    let (cycle_ns, lead_ns) = (ns(network.cycle), ns(network.lead));
    Ok(Network { devices, cycle_ns, lead_ns, clock_frames: CLOCK_FRAMES })
}

/// What is written to a drive before it is used: the time from setpoint to setpoint, and what it
/// does when the connection ends.
fn start_values(file: &MachineFile, cycle_ns: u32, slot: AxisSlot) -> Vec<Sdo> {
    let offset = 0x800 * u16::from(slot.number);
    let entry = |index: u16, sub, bits| PdoEntry { index: index + offset, sub, bits };
    // as a number of up to 8 bits and a power of ten, s
    let (mut number, mut exponent) = (u64::from(cycle_ns), -9_i8);
    while number % 10 == 0 || number > 255 {
        (number, exponent) = (number / 10, exponent + 1);
    }
    // a drive brakes for itself: no drive keeps a coupling without the network
    let at_the_end = match file.drives.on_link_loss {
        DriveReaction::Off | DriveReaction::Coast => DISABLE_VOLTAGE,
        DriveReaction::QuickStop | DriveReaction::CoupledStop => QUICK_STOP,
    };
    vec![
        Sdo { entry: entry(0x60C2, 1, 8), value: number as u32 },
        Sdo { entry: entry(0x60C2, 2, 8), value: u32::from(exponent.cast_unsigned()) },
        Sdo { entry: entry(0x6007, 0, 16), value: at_the_end },
    ]
}

/// The machine on its network.
///
/// # Errors
/// It has no network.
pub fn machine_drives(file: &MachineFile) -> Result<MachineDrives, Refused> {
    let network = network_of(file)?;
    let all = used(file);
    let (mut axes, mut spindles, mut drive) = (Vec::new(), Vec::new(), 0);
    for device in &network.devices {
        for one in slots_of(&all, device) {
            let inputs = one.slot.inputs;
            let inputs = AxisInputs { home: inputs.home, limits: inputs.limits };
            let (index, mode, scale) = (one.index, one.mode(), one.scale());
            let torque_rated = one.slot.torque_rated;
            let led = LedDrive { index, drive, mode, scale, inputs, torque_rated };
            if one.is_spindle { &mut spindles } else { &mut axes }.push(led);
            drive += 1;
        }
    }
    let terminals = network.devices.iter().enumerate().filter_map(|(device, of)| {
        let [inputs_from, outputs_from] = of.signals_from;
        match of.profile {
            DeviceProfile::DigitalIo => {
                Some(Terminal::Digital { device, inputs_from, outputs_from })
            }
            DeviceProfile::ToolChanger => Some(Terminal::ToolChanger { device }),
            DeviceProfile::Plain | DeviceProfile::Cia402 => None,
        }
    });
    Ok(MachineDrives::new(&axes, &spindles, &terminals.collect::<Vec<_>>()))
}
