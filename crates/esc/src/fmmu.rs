//! A fieldbus memory management unit: from bits of the logical memory to bits of this device.
//!
//! ```text
//!   logical   start byte · start bit ────── length ────── last byte · end bit
//!                  │ bit by bit
//!   physical  start byte · start bit ──────
//! ```

/// A mapping, as its 16 bytes of registers have it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fmmu {
    logical: u32,
    length: u16,
    start_bit: u8,
    end_bit: u8,
    physical: u16,
    physical_bit: u8,
    pub(crate) reads: bool,
    pub(crate) writes: bool,
    is_active: bool,
}

/// Bytes that a datagram and a mapping have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Overlap {
    /// First byte within the datagram's data.
    pub(crate) offset: usize,
    /// First byte within the device.
    pub(crate) physical: u16,
    /// Length, bytes.
    pub(crate) length: usize,
}

impl Fmmu {
    pub(crate) fn of(registers: [u8; 16]) -> Self {
        let r = registers;
        Self {
            logical: u32::from_le_bytes([r[0], r[1], r[2], r[3]]),
            length: u16::from_le_bytes([r[4], r[5]]),
            start_bit: r[6] & 7,
            end_bit: r[7] & 7,
            physical: u16::from_le_bytes([r[8], r[9]]),
            physical_bit: r[10] & 7,
            reads: r[11] & 1 != 0,
            writes: r[11] & 2 != 0,
            is_active: r[12] & 1 != 0,
        }
    }

    /// Whole bytes are mapped to whole bytes.
    pub(crate) fn is_byte_wise(&self) -> bool {
        self.start_bit == 0 && self.end_bit == 7 && self.physical_bit == 0
    }

    /// Returns what a datagram at a logical address has in common with a mapping of whole bytes.
    pub(crate) fn overlap(&self, logical: u32, length: usize) -> Option<Overlap> {
        if !self.is_active {
            return None;
        }
        let (own, theirs) = (u64::from(self.logical), u64::from(logical));
        let start = own.max(theirs);
        let end = (own + u64::from(self.length)).min(theirs + length as u64);
        if start >= end {
            return None;
        }
        let into = u16::try_from(start - own).ok()?;
        Some(Overlap {
            offset: usize::try_from(start - theirs).ok()?,
            physical: self.physical.checked_add(into)?,
            length: usize::try_from(end - start).ok()?,
        })
    }

    /// Bits that a datagram and the mapping have in common: bit within the datagram's data, address
    /// and bit within the device.
    pub(crate) fn bits(
        &self,
        logical: u32,
        length: usize,
    ) -> impl Iterator<Item = (usize, u16, u8)> + use<> {
        let whole = usize::from(self.length) * 8;
        let unused = usize::from(self.start_bit) + 7 - usize::from(self.end_bit);
        let count = if self.is_active { whole.saturating_sub(unused) } else { 0 };
        let fmmu = *self;
        (0..count).filter_map(move |bit| {
            let at = u64::from(fmmu.logical) * 8 + u64::from(fmmu.start_bit) + bit as u64;
            let within = usize::try_from(at.checked_sub(u64::from(logical) * 8)?).ok()?;
            let physical = usize::from(fmmu.physical_bit) + bit;
            let address = fmmu.physical.checked_add(u16::try_from(physical / 8).ok()?)?;
            (within < length * 8).then_some((within, address, (physical % 8) as u8))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn registers(logical: u32, length: u16, bits: [u8; 3], physical: u16) -> [u8; 16] {
        let mut r = [0; 16];
        r[..4].copy_from_slice(&logical.to_le_bytes());
        r[4..6].copy_from_slice(&length.to_le_bytes());
        r[6] = bits[0];
        r[7] = bits[1];
        r[8..10].copy_from_slice(&physical.to_le_bytes());
        r[10] = bits[2];
        r[11] = 3;
        r[12] = 1;
        r
    }

    #[test]
    fn a_datagram_takes_the_part_of_the_mapping_that_it_covers() {
        let fmmu = Fmmu::of(registers(0x1_0010, 8, [0, 7, 0], 0x1100));
        assert_eq!(fmmu.overlap(0x1_0000, 16), None);
        let overlap = fmmu.overlap(0x1_0014, 100).unwrap();
        assert_eq!(overlap, Overlap { offset: 0, physical: 0x1104, length: 4 });
        let overlap = fmmu.overlap(0x1_0000, 18).unwrap();
        assert_eq!(overlap, Overlap { offset: 16, physical: 0x1100, length: 2 });
    }

    #[test]
    fn three_bits_in_the_middle_of_a_byte_go_to_the_bits_that_they_are_mapped_to() {
        let fmmu = Fmmu::of(registers(0x20, 1, [3, 5, 6], 0x0F00));
        let bits: Vec<_> = fmmu.bits(0x20, 1).collect();
        assert_eq!(bits, [(3, 0x0F00, 6), (4, 0x0F00, 7), (5, 0x0F01, 0)]);
        assert_eq!(fmmu.bits(0x21, 4).count(), 0);
    }

    #[test]
    fn a_mapping_across_two_bytes_has_the_bits_between() {
        // ETG.1000.4: from bit 6 of the first to bit 1 of the second byte
        let fmmu = Fmmu::of(registers(0x20, 2, [6, 1, 0], 0x1000));
        let bits: Vec<_> = fmmu.bits(0x1F, 4).map(|(bit, ..)| bit).collect();
        assert_eq!(bits, [14, 15, 16, 17]);
    }

    #[test]
    fn a_mapping_beyond_the_end_of_the_address_space_has_no_bytes() {
        let fmmu = Fmmu::of(registers(u32::MAX, 0xFFFF, [0, 7, 0], 0xFFFF));
        assert_eq!(
            fmmu.overlap(u32::MAX, 2),
            Some(Overlap { offset: 0, physical: 0xFFFF, length: 2 })
        );
        assert!(fmmu.bits(u32::MAX, 1400).count() <= 8 * 1400);
    }
}
