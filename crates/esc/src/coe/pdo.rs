//! Process data objects: what may be mapped and assigned, and where it stands in a buffer.
//!
//! ```text
//!   1C12:1 = 1600 ─► 1600:1 = 6040 00 16  ─► control word, 16 bits, at bit 0 of the outputs
//!                    1600:2 = 607A 00 32  ─► target position, at bit 16
//! ```
//!
//! A list is written with its count at 0, then its entries, then its count (ETG.1020, 11).
use super::{Abort, Dictionary, Handle};
use crate::al::AlState;
use crate::quirks::Quirks;

/// Assignment of the outputs' sync manager.
pub(crate) const RX_ASSIGNMENT: u16 = 0x1C12;
/// Assignment of the inputs' sync manager.
pub(crate) const TX_ASSIGNMENT: u16 = 0x1C13;
/// Most bytes of the process data of a direction.
const MOST_BYTES: usize = 512;

/// Way of process data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PdoDirection {
    /// From the master.
    Rx,
    /// To the master.
    Tx,
}

/// Returns the direction of a mapping object.
fn mapping_direction(index: u16) -> Option<PdoDirection> {
    match index {
        0x1600..=0x17FF => Some(PdoDirection::Rx),
        0x1A00..=0x1BFF => Some(PdoDirection::Tx),
        _ => None,
    }
}

fn assignment_direction(index: u16) -> Option<PdoDirection> {
    match index {
        RX_ASSIGNMENT => Some(PdoDirection::Rx),
        TX_ASSIGNMENT => Some(PdoDirection::Tx),
        _ => None,
    }
}

/// Checks what is written to a mapping or an assignment; any other object passes.
pub(crate) fn check(
    dictionary: &Dictionary,
    index: u16,
    sub: u8,
    value: i64,
    state: AlState,
    quirks: &Quirks,
) -> Result<(), Abort> {
    let mapping = mapping_direction(index);
    let assignment = assignment_direction(index);
    let Some(direction) = mapping.or(assignment) else { return Ok(()) };
    let is_fixed = if mapping.is_some() { quirks.fixed_mapping } else { quirks.fixed_assignment };
    if is_fixed || quirks.rx_pdo_alone && index == TX_ASSIGNMENT {
        return Err(Abort::ReadOnly);
    }
    if state != AlState::PreOp {
        return Err(Abort::State);
    }
    if sub > 0 && dictionary.number(index, 0) != Some(0) {
        return Err(Abort::SubindexZeroFirst);
    }
    let one_of = quirks.one_tx_pdo_of.filter(|_| direction == PdoDirection::Tx);
    match (sub, mapping.is_some()) {
        (0, true) => {
            if one_of.is_some_and(|most| value > i64::from(most)) {
                return Err(Abort::PdoTooLong);
            }
            let entries =
                dictionary.object(index).map_or(0, |object| i64::from(object.entries.len() as u8));
            if value >= entries {
                return Err(Abort::Range);
            }
            let bits = mapped(dictionary, index, value).map(|m| m.map(|(_, bits)| bits));
            let bits: usize = bits.sum::<Result<usize, Abort>>()?;
            if bits > MOST_BYTES * 8 { Err(Abort::PdoTooLong) } else { Ok(()) }
        }
        (0, false) => {
            if one_of.is_some() && value > 1 {
                return Err(Abort::PdoTooLong);
            }
            let lists: Result<Vec<_>, Abort> = (1..=value)
                .map(|sub| dictionary.number(index, sub as u8).ok_or(Abort::Range))
                .collect();
            let mut bits = 0;
            for list in lists? {
                let list = u16::try_from(list).map_err(|_| Abort::NotMappable)?;
                let count = dictionary.number(list, 0).ok_or(Abort::NotMappable)?;
                for entry in mapped(dictionary, list, count) {
                    bits += entry?.1;
                }
            }
            if bits > MOST_BYTES * 8 { Err(Abort::PdoTooLong) } else { Ok(()) }
        }
        (_, true) => check_entry(dictionary, value, direction, quirks).map(|_| ()),
        (_, false) => {
            let list = u16::try_from(value).map_err(|_| Abort::NotMappable)?;
            let fits =
                mapping_direction(list) == Some(direction) && dictionary.object(list).is_some();
            if fits { Ok(()) } else { Err(Abort::NotMappable) }
        }
    }
}

/// An entry of a mapping: where its value is, and its bits. A gap has no place.
fn check_entry(
    dictionary: &Dictionary,
    value: i64,
    direction: PdoDirection,
    quirks: &Quirks,
) -> Result<(Option<Handle>, usize), Abort> {
    let (index, sub, bits) = ((value >> 16) as u16, (value >> 8) as u8, value as u8);
    if index == 0 {
        // a gap; values stand at whole bytes here
        return if bits.is_multiple_of(8) {
            Ok((None, usize::from(bits)))
        } else {
            Err(Abort::NotMappable)
        };
    }
    if quirks.torque_by_sdo_only && index & 0x07FF == 0x0077 && index >= 0x6000 {
        return Err(Abort::NotMappable);
    }
    let handle = dictionary.find(index, sub).ok_or(Abort::NoObject)?;
    let entry = dictionary.at(handle).ok_or(Abort::NoObject)?;
    let allowed = match direction {
        PdoDirection::Rx => entry.access.rx,
        PdoDirection::Tx => entry.access.tx || entry.access.rx,
    };
    let fits = entry.bits() == usize::from(bits);
    if allowed && fits { Ok((Some(handle), usize::from(bits))) } else { Err(Abort::NotMappable) }
}

/// Returns the first `count` entries of a mapping.
fn mapped(
    dictionary: &Dictionary,
    index: u16,
    count: i64,
) -> impl Iterator<Item = Result<(Option<Handle>, usize), Abort>> + '_ {
    let direction = mapping_direction(index);
    (1..=count).map(move |sub| {
        let value = dictionary.number(index, sub as u8).ok_or(Abort::Range)?;
        let direction = direction.ok_or(Abort::NotMappable)?;
        check_entry(dictionary, value, direction, &Quirks::default())
    })
}

/// Where the values of assigned PDOs stand in a buffer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mapping {
    /// Place, first bit, bits.
    entries: Vec<(Handle, usize, usize)>,
    bits: usize,
}

impl Mapping {
    /// Reads what is assigned.
    pub(crate) fn of(dictionary: &Dictionary, assignment: u16) -> Result<Self, Abort> {
        let mut mapping = Self::default();
        for sub in 1..=dictionary.number(assignment, 0).unwrap_or(0) {
            let list = dictionary.number(assignment, sub as u8).ok_or(Abort::Range)?;
            let list = u16::try_from(list).map_err(|_| Abort::NotMappable)?;
            let count = dictionary.number(list, 0).ok_or(Abort::NotMappable)?;
            for entry in mapped(dictionary, list, count) {
                let (handle, bits) = entry?;
                if let Some(handle) = handle {
                    mapping.entries.push((handle, mapping.bits, bits));
                }
                mapping.bits += bits;
            }
        }
        Ok(mapping)
    }

    /// Bytes that the buffer has.
    pub(crate) fn bytes(&self) -> usize {
        self.bits.div_ceil(8)
    }

    /// Takes the values from a buffer.
    pub(crate) fn receive(&self, buffer: &[u8], dictionary: &mut Dictionary) {
        for (handle, at, bits) in &self.entries {
            if let Some(bytes) = buffer.get(at / 8..at / 8 + bits / 8) {
                let number =
                    dictionary.at(*handle).map_or(0, |entry| entry.data_type.number(bytes));
                dictionary.set(*handle, number);
            }
        }
    }

    /// Puts the values into a buffer.
    pub(crate) fn send(&self, dictionary: &Dictionary, buffer: &mut [u8]) {
        for (handle, at, bits) in &self.entries {
            if let Some(place) = buffer.get_mut(at / 8..at / 8 + bits / 8) {
                let bytes = dictionary.get(*handle).to_le_bytes();
                place.copy_from_slice(&bytes[..place.len()]);
            }
        }
    }
}
