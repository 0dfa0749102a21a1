//! The devices that there are: what is in their EEPROM and their dictionary.
use crate::coe::{
    Access, DataType, DeviceProfile, Dictionary, Object, ObjectEntry, Pdo, communication_objects,
};
use crate::device::{Application, Blueprint, Device, DigitalIo, Encoder};
use crate::profile::{EmulatedAxis, Motor, axis_objects, default_pdos, supported_modes};
use crate::quirks::Quirks;
use crate::sii::{Contents, Identity, SiiPdo, SiiSyncManager, words};

/// Vendor of all emulated devices: a number that the EtherCAT Technology Group has not assigned.
const VENDOR: u32 = 0x0000_0E5C;
/// Mailboxes of devices that have them: start and length, out and in.
const MAILBOXES: [(u16, u16); 2] = [(0x1000, 0x80), (0x1080, 0x80)];
/// Where outputs and inputs stand.
const OUTPUTS: u16 = 0x1100;
const INPUTS: u16 = 0x1700;
/// Shortest cycle of all, ns.
const LEAST_CYCLE_NS: u32 = 125_000;

/// A drive to be emulated.
#[derive(Clone, Debug)]
pub struct DriveModel {
    /// Serial number, to tell drives of one type apart.
    pub serial: u32,
    /// Axes; each has a motor of its own.
    pub motors: Vec<Motor>,
    /// What is different about it.
    pub quirks: Quirks,
    /// Nanoseconds that its clock gains in a second.
    pub drift_ppb: i64,
}

impl DriveModel {
    /// A drive with one axis, as the standards have it.
    pub fn new(serial: u32) -> Self {
        Self { serial, motors: vec![Motor::new()], quirks: Quirks::default(), drift_ppb: 0 }
    }
}

fn identity(product: u32, serial: u32) -> Identity {
    Identity { vendor: VENDOR, product, revision: 0x0001_0000, serial }
}

/// Makes a coupler: a device without process data.
pub fn coupler(drift_ppb: i64) -> Device {
    Device::new(Blueprint {
        words: words(&Contents {
            identity: identity(0x1100, 1),
            alias: 0,
            name: "Coupler",
            mailboxes: None,
            coe: 0,
            sync_managers: Vec::new(),
            fmmus: Vec::new(),
            tx_pdos: Vec::new(),
            rx_pdos: Vec::new(),
            assign_activate: None,
        }),
        identity: identity(0x1100, 1),
        quirks: Quirks::default(),
        drift_ppb,
        mailboxes: None,
        process: None,
        dictionary: None,
        application: Application::None,
        least_cycle_ns: LEAST_CYCLE_NS,
    })
}

/// Makes a terminal with eight digital outputs and eight digital inputs, without a mailbox and
/// without a clock.
pub fn digital_io() -> Device {
    let identity = identity(0x1008, 1);
    let pdo = |index, sync_manager, object| {
        let entries = (1..=8).map(|bit| (object, bit, 1)).collect();
        SiiPdo { index, sync_manager, entries }
    };
    let quirks = Quirks { no_clock: true, ..Quirks::default() };
    Device::new(Blueprint {
        words: words(&Contents {
            identity,
            alias: 0,
            name: "Digital I/O",
            mailboxes: None,
            coe: 0,
            sync_managers: vec![
                SiiSyncManager { start: 0x0F00, length: 1, control: 0x44, usage: 3 },
                SiiSyncManager { start: 0x1000, length: 1, control: 0x00, usage: 4 },
            ],
            fmmus: vec![1, 2],
            tx_pdos: vec![pdo(0x1A00, 1, 0x6000)],
            rx_pdos: vec![pdo(0x1600, 0, 0x7000)],
            assign_activate: None,
        }),
        identity,
        quirks,
        drift_ppb: 0,
        mailboxes: None,
        process: Some([0, 1]),
        dictionary: None,
        application: Application::DigitalIo(DigitalIo::default()),
        least_cycle_ns: LEAST_CYCLE_NS,
    })
}

/// EEPROM of a device with mailbox and dictionary.
fn mailbox_device(profile: &DeviceProfile, quirks: &Quirks, alias: u16) -> Vec<u16> {
    // SDO, information, assignment, mapping, complete access
    let information = if quirks.no_sdo_information { 0 } else { 0x02 };
    let complete = if quirks.no_complete_access { 0 } else { 0x20 };
    let pdos = |list: &[Pdo], sync_manager| {
        let pdo = |(index, entries): &(u16, Vec<_>)| SiiPdo {
            index: *index,
            sync_manager,
            entries: entries.clone(),
        };
        list.iter().map(pdo).collect()
    };
    let bytes = |list: &[Pdo]| {
        let bits: u16 = list.iter().flat_map(|(_, e)| e).map(|(.., bits)| u16::from(*bits)).sum();
        bits.div_ceil(8)
    };
    let activation = if quirks.sync_activation == 0 { 3 } else { quirks.sync_activation };
    words(&Contents {
        identity: profile.identity,
        alias,
        name: profile.name,
        mailboxes: Some(MAILBOXES),
        coe: 0x0D | information | complete,
        sync_managers: vec![
            SiiSyncManager {
                start: MAILBOXES[0].0,
                length: MAILBOXES[0].1,
                control: 0x26,
                usage: 1,
            },
            SiiSyncManager {
                start: MAILBOXES[1].0,
                length: MAILBOXES[1].1,
                control: 0x22,
                usage: 2,
            },
            SiiSyncManager { start: OUTPUTS, length: bytes(&profile.rx), control: 0x64, usage: 3 },
            SiiSyncManager { start: INPUTS, length: bytes(&profile.tx), control: 0x20, usage: 4 },
        ],
        fmmus: vec![1, 2, 3],
        tx_pdos: pdos(&profile.tx, 3),
        rx_pdos: pdos(&profile.rx, 2),
        assign_activate: (!quirks.no_clock).then_some(u16::from(activation) << 8),
    })
}

fn with_dictionary(
    profile: &DeviceProfile,
    quirks: Quirks,
    drift_ppb: i64,
    dictionary: Dictionary,
    application: Application,
) -> Device {
    Device::new(Blueprint {
        words: mailbox_device(profile, &quirks, 0),
        identity: profile.identity,
        quirks,
        drift_ppb,
        mailboxes: Some(MAILBOXES),
        process: Some([2, 3]),
        dictionary: Some(dictionary),
        application,
        least_cycle_ns: profile.least_cycle_ns,
    })
}

/// Makes a CiA 402 drive.
pub fn drive(model: &DriveModel) -> Device {
    let quirks = &model.quirks;
    let offsets: Vec<u16> =
        (0..model.motors.len().min(8) as u16).map(|axis| 0x800 * axis).collect();
    let pdos = |list: usize, first: u16| -> Vec<_> {
        let pdo = |offset: &u16| (first + offset / 0x80, default_pdos(*offset)[list].clone());
        offsets.iter().map(pdo).collect()
    };
    let profile = DeviceProfile {
        device_type: 0x0002_0192,
        name: "Drive",
        identity: identity(0x0402, model.serial),
        rx: pdos(0, 0x1600),
        tx: pdos(1, 0x1A00),
        least_cycle_ns: LEAST_CYCLE_NS,
    };
    let axes = offsets.iter().zip(&model.motors);
    let objects = axes.clone().flat_map(|(offset, motor)| axis_objects(*offset, motor, quirks));
    let dictionary =
        Dictionary::new(communication_objects(&profile, quirks).into_iter().chain(objects));
    let modes = supported_modes(quirks);
    let axes = axes.filter_map(|(offset, motor)| {
        EmulatedAxis::new(&dictionary, *offset, motor.clone(), modes)
    });
    let application = Application::Drive(axes.collect());
    with_dictionary(&profile, quirks.clone(), model.drift_ppb, dictionary, application)
}

/// Makes an encoder terminal: a counter of 32 bits with a latch at the index mark.
pub fn encoder(counts_per_rev: u32, quirks: Quirks) -> Device {
    use DataType::{U16, U32};
    let profile = DeviceProfile {
        device_type: 0x0000_1389,
        name: "Encoder",
        identity: identity(0x5101, 1),
        rx: vec![(0x1600, vec![(0x7010, 1, 16), (0x7010, 0x11, 32)])],
        tx: vec![(0x1A00, vec![(0x6010, 1, 16), (0x6010, 0x11, 32), (0x6010, 0x12, 32)])],
        least_cycle_ns: LEAST_CYCLE_NS,
    };
    let actual =
        |sub, name, data_type| ObjectEntry::number(sub, name, data_type, Access::ACTUAL, 0);
    let setpoint =
        |sub, name, data_type| ObjectEntry::number(sub, name, data_type, Access::SETPOINT, 0);
    let objects = [
        Object::record(
            0x6010,
            "Encoder inputs",
            vec![
                actual(1, "Status", U16),
                actual(0x11, "Counter value", U32),
                actual(0x12, "Latch value", U32),
            ],
        ),
        Object::record(
            0x7010,
            "Encoder outputs",
            vec![setpoint(1, "Control", U16), setpoint(0x11, "Set counter value", U32)],
        ),
    ];
    let dictionary =
        Dictionary::new(communication_objects(&profile, &quirks).into_iter().chain(objects));
    let application = Application::Encoder(Encoder::new(counts_per_rev));
    with_dictionary(&profile, quirks, 0, dictionary, application)
}
