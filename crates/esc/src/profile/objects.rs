//! The objects of an axis: 6000 to 67FF, the next axis of a device 800 higher.
use super::homing::METHODS;
use super::motor::Motor;
use crate::coe::{Access, Allowed, DataType, Object, ObjectEntry, ObjectValue};
use crate::quirks::Quirks;

/// Modes with all of them, and without one or two.
const MODES: [&[i64]; 4] =
    [&[0, 2, 6, 8, 9, 10], &[0, 2, 6, 8, 10], &[0, 2, 6, 8, 9], &[0, 2, 6, 8]];

/// Returns the modes that a drive has.
pub(crate) fn supported_modes(quirks: &Quirks) -> &'static [i64] {
    MODES[usize::from(quirks.no_csv) + 2 * usize::from(quirks.no_cst)]
}

/// Returns the objects of an axis, from index 6000 + `offset` on.
#[allow(clippy::too_many_lines)] // a table
pub(crate) fn axis_objects(offset: u16, motor: &Motor, quirks: &Quirks) -> Vec<Object> {
    use DataType::{I8, I16, I32, U8, U16, U32};
    let one = |index: u16, name, data_type, access, value: i64| {
        Object::variable(index + offset, name, data_type, access, value)
    };
    let pair = |index: u16, name, data_type, access, values: [(&'static str, i64); 2]| {
        let entries = (1_u8..).zip(values);
        let entries = entries
            .map(|(sub, (name, value))| ObjectEntry::number(sub, name, data_type, access, value));
        Object::record(index + offset, name, entries.collect())
    };
    let modes = supported_modes(quirks);
    // 6502: a bit for each mode but none
    let bits = modes.iter().filter(|mode| **mode > 0).map(|mode| 1_i64 << (mode - 1)).sum();
    let counts = i64::from(motor.counts_per_rev);
    let most_rpm = motor.most_spin.in_rpm().round() as i64;
    let rated = (motor.rated_torque.value() * 1e3).round() as i64;
    let torque = if quirks.torque_by_sdo_only { Access::READ } else { Access::ACTUAL };
    let mut limits = pair(
        0x607D,
        "Software position limit",
        I32,
        Access::WRITE,
        [("Negative", i64::from(i32::MIN)), ("Positive", i64::from(i32::MAX))],
    );
    if quirks.no_positive_software_limit {
        limits.entries.pop();
        limits.entries[0].value = ObjectValue::Number(1);
    }
    vec![
        one(0x603F, "Error code", U16, Access::ACTUAL, 0),
        one(0x6040, "Control word", U16, Access::SETPOINT, 0),
        one(0x6041, "Status word", U16, Access::ACTUAL, 0),
        one(0x6042, "vl target velocity", I16, Access::SETPOINT, 0),
        one(0x6043, "vl velocity demand", I16, Access::ACTUAL, 0),
        one(0x6044, "vl velocity actual value", I16, Access::ACTUAL, 0),
        pair(
            0x6048,
            "vl velocity acceleration",
            U32,
            Access::WRITE,
            [("Speed", 1000), ("Time", 1)],
        ),
        pair(
            0x6049,
            "vl velocity deceleration",
            U32,
            Access::WRITE,
            [("Speed", 1000), ("Time", 1)],
        ),
        one(0x605A, "Quick stop option", I16, Access::WRITE, 2)
            .allowing(Allowed::OneOf(&[0, 1, 2, 5, 6])),
        one(0x605E, "Fault reaction option", I16, Access::WRITE, 2),
        one(0x6007, "Abort connection option", I16, Access::WRITE, 1)
            .allowing(Allowed::Between(0, 3)),
        one(0x6060, "Modes of operation", I8, Access::SETPOINT, 0).allowing(Allowed::OneOf(modes)),
        one(0x6061, "Modes of operation display", I8, Access::ACTUAL, 0),
        one(0x6062, "Position demand value", I32, Access::ACTUAL, 0),
        one(0x6064, "Position actual value", I32, Access::ACTUAL, 0),
        one(0x6065, "Following error window", U32, Access::WRITE, counts),
        one(0x6066, "Following error time out", U16, Access::WRITE, 10),
        one(0x606C, "Velocity actual value", I32, Access::ACTUAL, 0),
        one(0x6071, "Target torque", I16, Access::SETPOINT, 0),
        one(0x6076, "Rated torque", U32, Access::READ, rated),
        one(0x6077, "Torque actual value", I16, torque, 0),
        one(0x607A, "Target position", I32, Access::SETPOINT, 0),
        one(0x607C, "Home offset", I32, Access::WRITE, 0),
        limits,
        one(0x6080, "Max motor speed", U32, Access::WRITE, most_rpm),
        one(0x6085, "Quick stop deceleration", U32, Access::WRITE, counts * 500),
        pair(
            0x608F,
            "Position encoder resolution",
            U32,
            Access::READ,
            [("Counts", counts), ("Turns", 1)],
        ),
        one(0x6098, "Homing method", I8, Access::SETPOINT, 0).allowing(Allowed::OneOf(METHODS)),
        pair(
            0x6099,
            "Homing speeds",
            U32,
            Access::WRITE,
            [("Towards the switch", counts * 10), ("Towards the zero", counts)],
        ),
        one(0x60B8, "Touch probe function", U16, Access::SETPOINT, 0),
        one(0x60B9, "Touch probe status", U16, Access::ACTUAL, 0),
        one(0x60BA, "Touch probe 1 rising", I32, Access::ACTUAL, 0),
        one(0x60BB, "Touch probe 1 falling", I32, Access::ACTUAL, 0),
        one(0x60BC, "Touch probe 2 rising", I32, Access::ACTUAL, 0),
        one(0x60BD, "Touch probe 2 falling", I32, Access::ACTUAL, 0),
        Object::record(
            0x60C2 + offset,
            "Interpolation time period",
            vec![
                ObjectEntry::number(1, "Period", U8, Access::WRITE, 1),
                ObjectEntry::number(2, "Exponent", I8, Access::WRITE, -3),
            ],
        ),
        one(0x60F4, "Following error actual value", I32, Access::ACTUAL, 0),
        one(0x60FD, "Digital inputs", U32, Access::ACTUAL, 0),
        one(0x60FF, "Target velocity", I32, Access::SETPOINT, 0),
        one(0x6502, "Supported drive modes", U32, Access::READ, bits),
    ]
}

/// The PDOs that an axis has at power on: entries of the RxPDO and of the TxPDO.
pub(crate) fn default_pdos(offset: u16) -> [Vec<(u16, u8, u8)>; 2] {
    let of =
        |list: &[(u16, u8)]| list.iter().map(|(index, bits)| (index + offset, 0, *bits)).collect();
    [of(&[(0x6040, 16), (0x607A, 32)]), of(&[(0x6041, 16), (0x6064, 32)])]
}
