//! Ethernet frames with EtherCAT datagrams, parsed where they stand.
//!
//! ```text
//!   destination 6 · source 6 · type 88A4 · length and kind 2 · datagram · datagram · …
//!   datagram:  command 1 · index 1 · address 4 · length and flags 2 · interrupt 2 · data · counter 2
//! ```
//!
//! What is malformed ends the walk: the datagrams before it are executed, as a device does that
//! reads a frame from its beginning.

/// Bytes before the first datagram.
const HEADERS: usize = 16;
/// Bytes of a datagram before its data.
const DATAGRAM_HEADER: usize = 10;
/// Bytes of a datagram after its data.
const COUNTER: usize = 2;
/// Offset of the source address within a frame.
pub(crate) const SOURCE: usize = 6;
/// A frame with Ethernet's and EtherCAT's header and no datagram.
pub const EMPTY_FRAME: [u8; HEADERS] =
    [255, 255, 255, 255, 255, 255, 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x88, 0xA4, 0, 0x10];

/// What a datagram orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DatagramCommand {
    /// No operation.
    Nop,
    /// Read by position.
    Aprd,
    /// Write by position.
    Apwr,
    /// Read and write by position.
    Aprw,
    /// Read by configured address.
    Fprd,
    /// Write by configured address.
    Fpwr,
    /// Read and write by configured address.
    Fprw,
    /// Read of all devices, joined by OR.
    Brd,
    /// Write to all devices.
    Bwr,
    /// Read and write of all devices.
    Brw,
    /// Read of logical memory.
    Lrd,
    /// Write of logical memory.
    Lwr,
    /// Read and write of logical memory.
    Lrw,
    /// Read by position; all other devices write.
    Armw,
    /// Read by configured address; all other devices write.
    Frmw,
}

impl DatagramCommand {
    const ALL: [Self; 15] = [
        Self::Nop,
        Self::Aprd,
        Self::Apwr,
        Self::Aprw,
        Self::Fprd,
        Self::Fpwr,
        Self::Fprw,
        Self::Brd,
        Self::Bwr,
        Self::Brw,
        Self::Lrd,
        Self::Lwr,
        Self::Lrw,
        Self::Armw,
        Self::Frmw,
    ];

    /// Returns the command of a code; `None` where the code is reserved.
    pub fn of(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// Code of the command on the wire.
    pub fn code(self) -> u8 {
        self as u8
    }
}

/// A datagram in a frame.
#[derive(Debug)]
pub struct Datagram<'a> {
    /// What it orders; `None` where its code is reserved.
    pub command: Option<DatagramCommand>,
    /// Number that the master gave it.
    pub index: u8,
    /// Position or configured address (low word) and register (high word); or a logical address.
    pub address: &'a mut [u8; 4],
    /// Event bits of the devices that it passed, joined by OR.
    pub interrupt: &'a mut [u8; 2],
    /// What is read and written.
    pub data: &'a mut [u8],
    counter: &'a mut [u8; 2],
}

impl Datagram<'_> {
    /// Position or configured address.
    pub fn device(&self) -> u16 {
        u16::from_le_bytes([self.address[0], self.address[1]])
    }

    /// Address within a device.
    pub fn register(&self) -> u16 {
        u16::from_le_bytes([self.address[2], self.address[3]])
    }

    /// Logical address.
    pub fn logical(&self) -> u32 {
        u32::from_le_bytes(*self.address)
    }

    /// Working counter.
    pub fn working_counter(&self) -> u16 {
        u16::from_le_bytes(*self.counter)
    }

    pub(crate) fn count(&mut self, by: u16) {
        *self.counter = self.working_counter().wrapping_add(by).to_le_bytes();
    }

    pub(crate) fn step_position(&mut self) {
        let next = self.device().wrapping_add(1);
        self.address[..2].copy_from_slice(&next.to_le_bytes());
    }
}

/// Returns whether an Ethernet frame says of itself that it is one of EtherCAT's.
pub fn has_ethercat_type(frame: &[u8]) -> bool {
    frame.len() >= HEADERS && frame[12..14] == [0x88, 0xA4] && frame[15] >> 4 == 1
}

/// Calls `visit` with each datagram of a frame, in order, up to the first that is malformed.
pub fn datagrams(frame: &mut [u8], mut visit: impl FnMut(Datagram<'_>)) {
    if !has_ethercat_type(frame) {
        return;
    }
    let length = usize::from(u16::from_le_bytes([frame[14], frame[15]]) & 0x07FF);
    let end = frame.len().min(HEADERS + length);
    let mut rest = &mut frame[HEADERS..end];
    loop {
        let Some((header, body)) = rest.split_first_chunk_mut::<DATAGRAM_HEADER>() else { return };
        let flags = u16::from_le_bytes([header[6], header[7]]);
        let length = usize::from(flags & 0x07FF);
        if body.len() < length + COUNTER {
            return;
        }
        let [command, index, address @ .., _, _, i0, i1] = header;
        let Some(address) = address.first_chunk_mut::<4>() else { return };
        let (data, after) = body.split_at_mut(length);
        let Some((counter, after)) = after.split_first_chunk_mut::<COUNTER>() else { return };
        let mut interrupt = [*i0, *i1];
        visit(Datagram {
            command: DatagramCommand::of(*command),
            index: *index,
            address,
            interrupt: &mut interrupt,
            data,
            counter,
        });
        [*i0, *i1] = interrupt;
        if flags & 0x8000 == 0 {
            return;
        }
        rest = after;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn two_reads() -> Vec<u8> {
        let mut frame = EMPTY_FRAME.to_vec();
        frame.extend([7, 1, 0, 0, 0x10, 0, 2, 0x80, 0, 0, 0xAA, 0xBB, 0, 0]);
        frame.extend([1, 2, 0xFF, 0xFF, 0x30, 1, 1, 0, 0, 0, 0xCC, 5, 0]);
        let length = u16::try_from(frame.len() - HEADERS).unwrap() | 0x1000;
        frame[14..16].copy_from_slice(&length.to_le_bytes());
        frame
    }

    #[test]
    fn datagrams_are_visited_in_order_with_their_own_data() {
        let mut seen = Vec::new();
        datagrams(&mut two_reads(), |d| {
            seen.push((d.command, d.index, d.device(), d.register(), d.data.to_vec()));
        });
        let expected = [
            (Some(DatagramCommand::Brd), 1, 0, 0x0010, vec![0xAA, 0xBB]),
            (Some(DatagramCommand::Aprd), 2, 0xFFFF, 0x0130, vec![0xCC]),
        ];
        assert_eq!(seen, expected);
    }

    #[test]
    fn codes_are_those_of_the_standard() {
        // ETG.1000.4, table 16 and following
        let codes = [
            DatagramCommand::Aprd,
            DatagramCommand::Fprd,
            DatagramCommand::Brd,
            DatagramCommand::Lrd,
            DatagramCommand::Lrw,
        ];
        assert_eq!(codes.map(DatagramCommand::code), [1, 4, 7, 10, 12]);
        assert_eq!(
            [DatagramCommand::Armw, DatagramCommand::Frmw].map(DatagramCommand::code),
            [13, 14]
        );
        assert_eq!(DatagramCommand::of(15), None);
        for code in 0..15 {
            assert_eq!(DatagramCommand::of(code).map(DatagramCommand::code), Some(code));
        }
    }

    #[test]
    fn a_frame_of_another_protocol_has_no_datagrams() {
        let mut frame = two_reads();
        frame[13] = 0x00;
        datagrams(&mut frame, |_| panic!("it is no frame of EtherCAT's"));
    }

    proptest! {
        #[test]
        fn no_frame_panics(mut bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            datagrams(&mut bytes, |mut d| d.count(1));
        }

        #[test]
        fn no_mutated_frame_panics(at in 12_usize..40, to in any::<u8>(), cut in 0_usize..45) {
            let mut frame = two_reads();
            if let Some(byte) = frame.get_mut(at) {
                *byte = to;
            }
            frame.truncate(cut);
            datagrams(&mut frame, |mut d| d.step_position());
        }
    }
}
