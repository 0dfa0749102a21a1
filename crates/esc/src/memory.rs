//! Registers and process memory of a controller, little endian.

/// Bytes of memory: 4 KiB of registers, 8 KiB of process memory.
pub(crate) const SIZE: usize = 0x3000;

/// Memory of a controller.
#[derive(Clone, Debug)]
pub(crate) struct Memory(Box<[u8; SIZE]>);

impl Memory {
    pub(crate) fn new() -> Self {
        Self(Box::new([0; SIZE]))
    }

    /// Bytes from an address on; empty where they do not all exist.
    pub(crate) fn bytes(&self, at: u16, length: usize) -> &[u8] {
        let at = usize::from(at);
        self.0.get(at..at + length).unwrap_or_default()
    }

    /// As [`Memory::bytes`], to be written.
    pub(crate) fn bytes_mut(&mut self, at: u16, length: usize) -> &mut [u8] {
        let at = usize::from(at);
        self.0.get_mut(at..at + length).unwrap_or_default()
    }

    pub(crate) fn get<const N: usize>(&self, at: u16) -> [u8; N] {
        self.bytes(at, N).try_into().unwrap_or([0; N])
    }

    pub(crate) fn set(&mut self, at: u16, bytes: &[u8]) {
        let place = self.bytes_mut(at, bytes.len());
        if place.len() == bytes.len() {
            place.copy_from_slice(bytes);
        }
    }

    pub(crate) fn u8(&self, at: u16) -> u8 {
        self.get::<1>(at)[0]
    }

    pub(crate) fn u16(&self, at: u16) -> u16 {
        u16::from_le_bytes(self.get(at))
    }

    pub(crate) fn u32(&self, at: u16) -> u32 {
        u32::from_le_bytes(self.get(at))
    }

    pub(crate) fn u64(&self, at: u16) -> u64 {
        u64::from_le_bytes(self.get(at))
    }
}
