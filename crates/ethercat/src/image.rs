//! Where the values of a device stand in its part of the process image.
use crate::network::PdoEntry;

/// Place of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImagePlace {
    /// First byte of the device's outputs or inputs.
    pub byte: usize,
    /// Its length.
    pub bytes: usize,
}

/// What a device receives or sends, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    entries: Vec<(PdoEntry, usize)>,
    bits: usize,
}

impl Image {
    /// Appends an entry; one of index 0 is a gap.
    pub fn push(&mut self, entry: PdoEntry) {
        self.entries.push((entry, self.bits));
        self.bits += usize::from(entry.bits);
    }

    /// Bytes of all.
    pub fn bytes(&self) -> usize {
        self.bits.div_ceil(8)
    }

    /// Place of an object's value; `None` where it is not mapped, or not at whole bytes.
    pub fn find(&self, index: u16, sub: u8) -> Option<ImagePlace> {
        let (entry, bit) = self.entries.iter().find(|(e, _)| (e.index, e.sub) == (index, sub))?;
        let whole = bit % 8 == 0 && entry.bits % 8 == 0;
        whole.then(|| ImagePlace { byte: bit / 8, bytes: usize::from(entry.bits) / 8 })
    }
}

impl ImagePlace {
    /// Reads a signed value; 0 where the bytes are not there.
    pub fn read(self, from: &[u8]) -> i64 {
        let bytes = from.get(self.byte..self.byte + self.bytes).unwrap_or_default();
        let mut whole = [0; 8];
        let used = bytes.len().min(8);
        whole[..used].copy_from_slice(&bytes[..used]);
        let unused = 64 - 8 * used as u32;
        if used == 0 { 0 } else { i64::from_le_bytes(whole) << unused >> unused }
    }

    /// Writes a value; what the bytes do not hold is left out.
    pub fn write(self, into: &mut [u8], value: i64) {
        if let Some(place) = into.get_mut(self.byte..self.byte + self.bytes)
            && let Some(bytes) = value.to_le_bytes().get(..place.len())
        {
            place.copy_from_slice(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_behind_one_another_and_gaps_are_left_out() {
        let mut image = Image::default();
        for (index, bits) in [(0x6041, 16), (0x6061, 8), (0, 8), (0x6064, 32)] {
            image.push(PdoEntry::of(index, bits));
        }
        assert_eq!(image.bytes(), 8);
        let position = image.find(0x6064, 0).unwrap();
        assert_eq!(position, ImagePlace { byte: 4, bytes: 4 });
        let mut bytes = [0; 8];
        position.write(&mut bytes, -2);
        assert_eq!((position.read(&bytes), bytes[3], bytes[4]), (-2, 0, 0xFE));
        assert_eq!(image.find(0x6077, 0), None);
    }
}
