//! What is expected on the wire: devices in their order, what they exchange and how they are
//! synchronised.

/// Who a device is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceIdentity {
    /// Vendor, as the EtherCAT Technology Group numbers them.
    pub vendor: u32,
    /// Product code.
    pub product: u32,
}

/// An entry of a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PdoEntry {
    /// Index of the object.
    pub index: u16,
    /// Subindex.
    pub sub: u8,
    /// Bits.
    pub bits: u8,
}

impl PdoEntry {
    /// An entry of a single value.
    pub const fn of(index: u16, bits: u8) -> Self {
        Self { index, sub: 0, bits }
    }

    /// As a mapping object has it.
    pub(crate) fn word(self) -> u32 {
        u32::from(self.index) << 16 | u32::from(self.sub) << 8 | u32::from(self.bits)
    }

    pub(crate) fn of_word(word: u32) -> Self {
        Self { index: (word >> 16) as u16, sub: (word >> 8) as u8, bits: word as u8 }
    }
}

/// A PDO with its mapping.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pdo {
    /// Index: 1600 and following to the device, 1A00 and following from it.
    pub index: u16,
    /// What is mapped.
    pub entries: Vec<PdoEntry>,
}

/// A value that is written before SAFE-OP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sdo {
    /// What is written, and in how many bits.
    pub entry: PdoEntry,
    /// The value; what the bits do not hold is left out.
    pub value: u32,
}

/// How a device is synchronised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sync {
    /// By its process data, or not at all.
    #[default]
    Free,
    /// By SYNC0 (`AssignActivate` 0300).
    Sync0,
    /// By SYNC0 and SYNC1 (`AssignActivate` 0700).
    Sync01 {
        /// From SYNC0 to SYNC1, ns.
        after_ns: u32,
    },
}

/// How a drive gets its setpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i8)]
pub enum DriveMode {
    /// Frequency converter, `vl`: 6042 in rpm.
    Velocity = 2,
    /// Cyclic synchronous position: 607A.
    Csp = 8,
    /// Cyclic synchronous velocity: 60FF.
    Csv = 9,
    /// Cyclic synchronous torque: 6071.
    Cst = 10,
}

impl DriveMode {
    /// Short name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "vl",
            Self::Csp => "csp",
            Self::Csv => "csv",
            Self::Cst => "cst",
        }
    }

    /// Bit of 6502.
    pub(crate) const fn bit(self) -> u32 {
        1 << (self as i8 - 1)
    }

    /// The object that the setpoint is written to.
    pub(crate) const fn target(self) -> u16 {
        match self {
            Self::Velocity => 0x6042,
            Self::Csp => 0x607A,
            Self::Csv => 0x60FF,
            Self::Cst => 0x6071,
        }
    }
}

/// An axis of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisSlot {
    /// Its number in the device: objects are 800 a slot higher.
    pub number: u8,
    /// How it gets its setpoints.
    pub mode: DriveMode,
    /// Counts by which the target may change in a cycle at most; a larger step is held back.
    pub most_step: u32,
    /// It says its torque, 6077, with each frame.
    pub says_torque: bool,
}

/// A device that is expected.
#[derive(Clone, Debug, Default)]
pub struct Device {
    /// Name, for people.
    pub name: String,
    /// Who it has to be; `None` if anybody may be there.
    pub identity: Option<DeviceIdentity>,
    /// What it receives and sends; empty: what it has of its own.
    pub pdos: Vec<Pdo>,
    /// What is written before SAFE-OP, in order.
    pub sdos: Vec<Sdo>,
    /// How it is synchronised.
    pub sync: Sync,
    /// Its axes, if it is a drive.
    pub slots: Vec<AxisSlot>,
}

impl Device {
    /// A device that is taken as it is.
    pub fn plain(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// A CiA 402 drive with these axes, on SYNC0: control word, target and mode to each; status
    /// word, position, mode, inputs and error code from each.
    pub fn drive(name: &str, slots: &[AxisSlot]) -> Self {
        let entries = |objects: &[(u16, u8)], offset: u16| -> Vec<PdoEntry> {
            objects.iter().map(|(index, bits)| PdoEntry::of(index + offset, *bits)).collect()
        };
        let pdos = slots.iter().flat_map(|slot| {
            let number = u16::from(slot.number);
            let bits = if slot.mode == DriveMode::Velocity { 16 } else { 32 };
            let rx = [(0x6040, 16), (slot.mode.target(), bits), (0x6060, 8)];
            let mut tx = vec![(0x6041, 16), (0x6064, 32), (0x6061, 8), (0x60FD, 32), (0x603F, 16)];
            if slot.says_torque {
                tx.push((0x6077, 16));
            }
            let offset = 0x800 * number;
            [
                Pdo { index: 0x1600 + 0x10 * number, entries: entries(&rx, offset) },
                Pdo { index: 0x1A00 + 0x10 * number, entries: entries(&tx, offset) },
            ]
        });
        Self {
            name: name.to_owned(),
            pdos: pdos.collect(),
            sync: Sync::Sync0,
            slots: slots.to_vec(),
            ..Self::default()
        }
    }

    /// A CiA 402 drive with one axis in CSP, on SYNC0: control word, target and mode to it; status
    /// word, position, speed, torque, mode and inputs from it.
    pub fn csp(name: &str, most_step: u32) -> Self {
        let entry = |(index, bits)| PdoEntry::of(index, bits);
        let rx = [(0x6040, 16), (0x607A, 32), (0x6060, 8)].map(entry);
        let tx =
            [(0x6041, 16), (0x6064, 32), (0x606C, 32), (0x6077, 16), (0x6061, 8), (0x60FD, 32)];
        Self {
            name: name.to_owned(),
            identity: None,
            pdos: vec![
                Pdo { index: 0x1600, entries: rx.to_vec() },
                Pdo { index: 0x1A00, entries: tx.map(entry).to_vec() },
            ],
            sdos: Vec::new(),
            sync: Sync::Sync0,
            slots: vec![AxisSlot { number: 0, mode: DriveMode::Csp, most_step, says_torque: true }],
        }
    }
}

/// Everything that is expected on a wire.
#[derive(Clone, Debug)]
pub struct Network {
    /// Devices, in the order of the wire.
    pub devices: Vec<Device>,
    /// Period of the frames and of SYNC0, ns.
    pub cycle_ns: u32,
    /// How long before SYNC0 the frame is out, ns.
    pub lead_ns: u32,
    /// Frames of the start by which the clocks are brought together.
    pub clock_frames: u32,
}

impl Network {
    /// A network at 1 kHz, the frame a quarter of a period before SYNC0.
    pub fn new(devices: Vec<Device>) -> Self {
        Self { devices, cycle_ns: 1_000_000, lead_ns: 250_000, clock_frames: 2_000 }
    }
}
