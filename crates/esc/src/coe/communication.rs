//! Objects 1000 to 1FFF, which every device with a dictionary has.
use super::{Access, Allowed, DataType, Object, ObjectEntry, ObjectKind};
use crate::quirks::Quirks;
use crate::sii::Identity;

/// Most entries of a mapping.
const MOST_ENTRIES: u8 = 16;
/// Most PDOs of an assignment.
const MOST_PDOS: u8 = 8;

/// A PDO as it is at power on: index, entries (index, subindex, bits).
pub(crate) type Pdo = (u16, Vec<(u16, u8, u8)>);

/// What the objects say of a device.
#[derive(Clone, Debug)]
pub(crate) struct DeviceProfile {
    /// 1000: profile (low word) and kind.
    pub(crate) device_type: u32,
    pub(crate) name: &'static str,
    pub(crate) identity: Identity,
    pub(crate) rx: Vec<Pdo>,
    pub(crate) tx: Vec<Pdo>,
    /// Shortest cycle, ns.
    pub(crate) least_cycle_ns: u32,
}

/// Returns the objects of the communication area, 1000 to 1FFF.
pub(crate) fn communication_objects(profile: &DeviceProfile, quirks: &Quirks) -> Vec<Object> {
    use DataType::{U8, U32};
    let Identity { vendor, product, revision, serial } = profile.identity;
    let number =
        |sub, name, value: u32| ObjectEntry::number(sub, name, U32, Access::READ, i64::from(value));
    let mut types = [1, 2, 3, 4];
    if quirks.wrong_sync_manager_types {
        types.swap(2, 3);
    }
    let types = (1_u8..)
        .zip(types)
        .map(|(sub, kind)| ObjectEntry::number(sub, "Sync manager", U8, Access::READ, kind));
    let mut objects = vec![
        Object::variable(0x1000, "Device type", U32, Access::READ, i64::from(profile.device_type)),
        Object::variable(0x1001, "Error register", U8, Access::ACTUAL, 0),
        Object::text(0x1008, "Device name", profile.name),
        Object::text(0x1009, "Hardware version", "1.0"),
        Object::text(0x100A, "Software version", "1.0"),
        Object::record(
            0x1018,
            "Identity",
            vec![
                number(1, "Vendor", vendor),
                number(2, "Product code", product),
                number(3, "Revision", revision),
                number(4, "Serial number", serial),
            ],
        ),
        Object::counted(
            0x1C00,
            ObjectKind::Array,
            "Sync manager types",
            4,
            Access::READ,
            types.collect(),
        ),
        synchronisation(0x1C32, "Output sync manager", profile, quirks),
        synchronisation(0x1C33, "Input sync manager", profile, quirks),
    ];
    let rx_lists = profile.rx.iter().map(|pdo| mapping(pdo, "RxPDO mapping"));
    let tx_lists = profile.tx.iter().map(|pdo| mapping(pdo, "TxPDO mapping"));
    objects.extend(rx_lists.chain(tx_lists));
    let no_inputs = Vec::new();
    let tx = if quirks.rx_pdo_alone { &no_inputs } else { &profile.tx };
    objects.push(assignment(0x1C12, "RxPDO assignment", &profile.rx));
    objects.push(assignment(0x1C13, "TxPDO assignment", tx));
    objects
}

fn mapping((index, entries): &Pdo, name: &'static str) -> Object {
    let list = (1..=MOST_ENTRIES).map(|sub| {
        let value = entries.get(usize::from(sub) - 1).map_or(0, |(index, sub, bits)| {
            i64::from(*index) << 16 | i64::from(*sub) << 8 | i64::from(*bits)
        });
        ObjectEntry::number(sub, "Mapped entry", DataType::U32, Access::CONFIGURE, value)
    });
    let count = i64::from(entries.len() as u8);
    Object::counted(*index, ObjectKind::Record, name, count, Access::CONFIGURE, list.collect())
}

/// The first PDO of each list is assigned, or all of a device with several axes.
fn assignment(index: u16, name: &'static str, pdos: &[Pdo]) -> Object {
    let list = (1..=MOST_PDOS).map(|sub| {
        let value = pdos.get(usize::from(sub) - 1).map_or(0, |(index, _)| i64::from(*index));
        ObjectEntry::number(sub, "Assigned PDO", DataType::U16, Access::CONFIGURE, value)
    });
    let count = i64::from(pdos.len() as u8);
    Object::counted(index, ObjectKind::Array, name, count, Access::CONFIGURE, list.collect())
}

fn synchronisation(
    index: u16,
    name: &'static str,
    profile: &DeviceProfile,
    quirks: &Quirks,
) -> Object {
    use DataType::{U16, U32};
    let period = if quirks.sync_period_read_only { Access::READ } else { Access::CONFIGURE };
    let kind = ObjectEntry::number(1, "Synchronisation type", U16, Access::CONFIGURE, 0);
    let least = i64::from(profile.least_cycle_ns);
    Object::record(
        index,
        name,
        vec![
            kind.allowing(Allowed::OneOf(&[0, 1, 2, 3, 0x22])),
            ObjectEntry::number(2, "Cycle time", U32, period, 0),
            ObjectEntry::number(4, "Synchronisation types supported", U16, Access::READ, 0x0007),
            ObjectEntry::number(5, "Minimum cycle time", U32, Access::READ, least),
            ObjectEntry::number(6, "Calculation and copy time", U32, Access::READ, 20_000),
            ObjectEntry::number(11, "Missed cycles", U16, Access::READ, 0),
            ObjectEntry::number(12, "Cycle time too short", U16, Access::READ, 0),
        ],
    )
}
