//! What is in a device's EEPROM: the slave information interface (ETG.2010).
//!
//! ```text
//!   word  0  configuration, checksum    4  alias    8  vendor, product, revision, serial
//!        18h mailboxes    3Eh size      40h categories: kind, words, data … FFFFh
//! ```

/// Who a device says it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Vendor, as the EtherCAT Technology Group numbers them.
    pub vendor: u32,
    /// Product code.
    pub product: u32,
    /// Revision.
    pub revision: u32,
    /// Serial number.
    pub serial: u32,
}

/// Sync manager as the EEPROM has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SiiSyncManager {
    pub(crate) start: u16,
    pub(crate) length: u16,
    pub(crate) control: u8,
    /// 1 mailbox out, 2 mailbox in, 3 outputs, 4 inputs.
    pub(crate) usage: u8,
}

/// PDO as the EEPROM has it: index, sync manager, entries (index, subindex, bits).
#[derive(Clone, Debug)]
pub(crate) struct SiiPdo {
    pub(crate) index: u16,
    pub(crate) sync_manager: u8,
    pub(crate) entries: Vec<(u16, u8, u8)>,
}

/// Everything that an EEPROM says.
#[derive(Clone, Debug)]
pub(crate) struct Contents {
    pub(crate) identity: Identity,
    pub(crate) alias: u16,
    pub(crate) name: &'static str,
    /// Start and length of the mailboxes: out, in.
    pub(crate) mailboxes: Option<[(u16, u16); 2]>,
    /// Bits of the CoE features.
    pub(crate) coe: u8,
    pub(crate) sync_managers: Vec<SiiSyncManager>,
    /// 1 outputs, 2 inputs, 3 mailbox state.
    pub(crate) fmmus: Vec<u8>,
    pub(crate) tx_pdos: Vec<SiiPdo>,
    pub(crate) rx_pdos: Vec<SiiPdo>,
    /// `AssignActivate` of the mode with a distributed clock.
    pub(crate) assign_activate: Option<u16>,
}

/// Returns the words of an EEPROM.
pub(crate) fn words(contents: &Contents) -> Vec<u16> {
    let mut bytes = vec![0_u8; 0x80];
    let mut put =
        |word: usize, value: &[u8]| bytes[2 * word..2 * word + value.len()].copy_from_slice(value);
    let Identity { vendor, product, revision, serial } = contents.identity;
    put(0, &0x0C08_u16.to_le_bytes());
    put(4, &contents.alias.to_le_bytes());
    for (i, value) in [vendor, product, revision, serial].into_iter().enumerate() {
        put(8 + 2 * i, &value.to_le_bytes());
    }
    if let Some([out, into]) = contents.mailboxes {
        for (i, value) in [out.0, out.1, into.0, into.1, 0x0004].into_iter().enumerate() {
            put(0x18 + i, &u16::to_le_bytes(value));
        }
    }
    put(0x3E, &15_u16.to_le_bytes());
    put(0x3F, &1_u16.to_le_bytes());
    let checksum = crc8(&bytes[..14]);
    bytes[14] = checksum;
    let mut category = |kind: u16, mut data: Vec<u8>| {
        if data.len() % 2 == 1 {
            data.push(0xFF);
        }
        bytes.extend(kind.to_le_bytes());
        bytes.extend(((data.len() / 2) as u16).to_le_bytes());
        bytes.extend(data);
    };
    category(10, strings(&[contents.name, "Leadscrew, emulated"]));
    category(30, general(contents));
    category(40, contents.fmmus.clone());
    let managers = contents.sync_managers.iter().flat_map(|m| {
        let [s, l] = [m.start, m.length].map(u16::to_le_bytes);
        [s[0], s[1], l[0], l[1], m.control, 0, 1, m.usage]
    });
    category(41, managers.collect());
    for (kind, pdos) in [(50, &contents.tx_pdos), (51, &contents.rx_pdos)] {
        if !pdos.is_empty() {
            category(kind, pdos.iter().flat_map(pdo).collect());
        }
    }
    if let Some(assign) = contents.assign_activate {
        let mut mode = vec![0_u8; 24];
        mode[8..10].copy_from_slice(&assign.to_le_bytes());
        category(60, mode);
    }
    bytes.extend([0xFF, 0xFF]);
    bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect()
}

fn strings(texts: &[&str]) -> Vec<u8> {
    let mut data = vec![texts.len() as u8];
    for text in texts {
        data.push(text.len() as u8);
        data.extend(text.bytes());
    }
    data
}

fn general(contents: &Contents) -> Vec<u8> {
    let mut data = vec![0; 32];
    // group, image, order and name: strings 2, none, 1, 1
    data[..4].copy_from_slice(&[2, 0, 1, 1]);
    data[5] = contents.coe;
    data[16] = 0x11;
    data
}

fn pdo(pdo: &SiiPdo) -> Vec<u8> {
    let mut data = pdo.index.to_le_bytes().to_vec();
    data.extend([pdo.entries.len() as u8, pdo.sync_manager, 0, 0, 0, 0]);
    for (index, subindex, bits) in &pdo.entries {
        data.extend(index.to_le_bytes());
        data.extend([*subindex, 0, 0, *bits, 0, 0]);
    }
    data
}

/// Checksum of the first seven words: x⁸ + x² + x + 1, from FF.
fn crc8(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0xFF, |crc, byte| {
        (0..8).fold(crc ^ byte, |crc, _| if crc & 0x80 == 0 { crc << 1 } else { crc << 1 ^ 0x07 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CRC-8 by the polynomial 07 from FF: of "123456789" it is FB; with its own checksum behind
    /// them, the residue of any bytes is 0.
    #[test]
    fn the_checksum_is_the_crc_of_the_standard() {
        assert_eq!(crc8(b"123456789"), 0xFB);
        let words = [0x04, 0x01, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        assert_eq!(crc8(&[&words[..], &[crc8(&words)]].concat()), 0);
    }
}
