//! A sync manager: it keeps the wire and the application from touching the same bytes at once.
//!
//! ```text
//!   mailbox   empty ──last byte written──► full ──last byte read──► empty     the other side waits
//!   buffered  the writer always can, the reader always gets the newest complete one (three buffers)
//! ```
//!
//! An access has to begin at the first byte; a buffer changes hands at its last one.

/// Direction of a buffer between application and wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum BufferDirection {
    /// The application writes, the wire reads.
    #[default]
    Read,
    /// The wire writes, the application reads.
    Write,
}

/// A sync manager as its eight bytes of registers have it.
#[derive(Clone, Debug, Default)]
#[allow(clippy::struct_excessive_bools)] // bits of its registers
pub(crate) struct SyncManager {
    pub(crate) start: u16,
    pub(crate) length: u16,
    pub(crate) is_mailbox: bool,
    pub(crate) direction: BufferDirection,
    pub(crate) has_watchdog: bool,
    pub(crate) is_enabled: bool,
    /// Bit 1 of its activation: a change asks for the last mail anew.
    pub(crate) repeat: bool,
    /// A mailbox holds mail.
    pub(crate) is_full: bool,
    /// The wire has begun an access and not come to its end.
    is_open: bool,
}

impl SyncManager {
    /// Takes a configuration over; a change of it empties the buffers.
    pub(crate) fn configure(&mut self, registers: [u8; 8]) {
        let [s0, s1, l0, l1, control, _, activation, _] = registers;
        let new = Self {
            start: u16::from_le_bytes([s0, s1]),
            length: u16::from_le_bytes([l0, l1]),
            is_mailbox: control & 0x03 == 2,
            direction: if control & 0x0C == 4 {
                BufferDirection::Write
            } else {
                BufferDirection::Read
            },
            has_watchdog: control & 0x40 != 0,
            is_enabled: activation & 1 != 0,
            repeat: activation & 2 != 0,
            ..Self::default()
        };
        let same = (new.start, new.length, new.is_mailbox, new.direction, new.is_enabled)
            == (self.start, self.length, self.is_mailbox, self.direction, self.is_enabled);
        if same {
            self.repeat = new.repeat;
            self.has_watchdog = new.has_watchdog;
        } else {
            *self = new;
        }
    }

    /// Its status byte.
    pub(crate) fn status(&self) -> u8 {
        u8::from(self.is_mailbox && self.is_full) << 3
    }

    /// Returns whether it guards a byte of a range.
    pub(crate) fn overlaps(&self, at: u16, length: usize) -> bool {
        let (start, end) =
            (usize::from(self.start), usize::from(self.start) + usize::from(self.length));
        let (at, last) = (usize::from(at), usize::from(at) + length);
        self.is_enabled && at < end && start < last
    }

    /// Returns whether the wire may access a range that overlaps.
    pub(crate) fn allows(&self, direction: BufferDirection, at: u16) -> bool {
        let begins = at <= self.start || self.is_open;
        let has_turn = !self.is_mailbox || self.is_full == (direction == BufferDirection::Read);
        direction == self.direction && begins && has_turn
    }

    /// Takes note of an access of the wire that was allowed; true if it came to the last byte.
    pub(crate) fn accessed(&mut self, at: u16, length: usize) -> bool {
        let end = usize::from(self.start) + usize::from(self.length);
        let completes = usize::from(at) + length >= end;
        self.is_open = !completes;
        if completes {
            self.is_full = self.is_mailbox && self.direction == BufferDirection::Write;
        }
        completes
    }

    /// Returns whether an access that is at its first byte has just begun.
    pub(crate) fn begins(&self, at: u16) -> bool {
        at <= self.start
    }
}
