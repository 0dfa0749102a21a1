//! An EtherCAT slave controller: it executes the datagrams of a frame on the registers and the
//! process memory of its device, and says what the application has to do about it.
use crate::clock::LocalClock;
use crate::eeprom::Eeprom;
use crate::fmmu::Fmmu;
use crate::frame::{Datagram, DatagramCommand};
use crate::memory::{Memory, SIZE};
use crate::quirks::Quirks;
use crate::registers as reg;
use crate::sync_manager::{BufferDirection, SyncManager};

/// Longest data of a datagram.
const MOST_DATA: usize = 2048;
/// Bit of the event register: AL status has changed.
const AL_EVENT: u16 = 1 << 3;

/// When a frame passes a device.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PassingTime {
    /// At port 0.
    pub(crate) arrives_ns: u64,
    /// At port 1, on its way back; `None` for the last device.
    pub(crate) returns_ns: Option<u64>,
}

/// What the wire has written that the application has to look at.
#[derive(Clone, Copy, Debug, Default)]
#[allow(clippy::struct_excessive_bools)] // events that do not exclude one another
pub(crate) struct Written {
    /// AL control.
    pub(crate) al_control: bool,
    /// The mailbox, to its last byte.
    pub(crate) mailbox: bool,
    /// The mailbox was read, to its last byte.
    pub(crate) mail_taken: bool,
    /// The repeat request of the read mailbox changed.
    pub(crate) repeat: bool,
    /// Outputs guarded by a watchdog, to their last byte.
    pub(crate) outputs: bool,
}

/// The controller of a device.
#[derive(Clone, Debug)]
pub(crate) struct Controller {
    pub(crate) memory: Memory,
    pub(crate) sync_managers: [SyncManager; reg::CHANNELS],
    fmmus: [Fmmu; reg::CHANNELS],
    /// What the application has written or the wire has completed, by sync manager.
    buffers: [Vec<u8>; reg::CHANNELS],
    eeprom: Eeprom,
    pub(crate) clock: LocalClock,
    has_clock: bool,
    has_cyclic_unit: bool,
    /// What the application has not looked at.
    pub(crate) written: Written,
    scratch: Vec<u8>,
}

impl Controller {
    pub(crate) fn new(words: Vec<u16>, clock: LocalClock, quirks: &Quirks) -> Self {
        let mut memory = Memory::new();
        let features: u16 = if quirks.no_clock { 0 } else { 0x010C };
        let alias = words.get(4).copied().unwrap_or_default();
        // an ET1100 with two ports
        memory.set(reg::TYPE, &[0x11, 0, 2, 0]);
        memory.set(reg::FMMUS, &[reg::CHANNELS as u8, reg::CHANNELS as u8, 8, 0x0F]);
        debug_assert_eq!((reg::SYNC_MANAGERS, reg::RAM_SIZE, reg::PORTS), (5, 6, 7));
        memory.set(reg::FEATURES, &features.to_le_bytes());
        memory.set(reg::ALIAS, &alias.to_le_bytes());
        memory.set(reg::DL_CONTROL, &[0x01, 0, 0x07, 0]);
        memory.set(reg::WATCHDOG_DIVIDER, &2498_u16.to_le_bytes());
        memory.set(reg::WATCHDOG_TIME, &1000_u16.to_le_bytes());
        memory.set(0x0410, &1000_u16.to_le_bytes());
        memory.set(reg::WATCHDOG_STATUS, &[1]);
        memory.set(reg::EEPROM_CONTROL, &[0xC0, 0]);
        memory.set(reg::SPEED_COUNTER, &0x1000_u16.to_le_bytes());
        memory.set(0x0934, &0x0C00_u16.to_le_bytes());
        Self {
            memory,
            sync_managers: Default::default(),
            fmmus: Default::default(),
            buffers: std::array::from_fn(|_| Vec::with_capacity(512)),
            eeprom: Eeprom::new(words),
            clock,
            has_clock: !quirks.no_clock,
            has_cyclic_unit: !quirks.no_cyclic_unit_control,
            written: Written::default(),
            scratch: Vec::with_capacity(MOST_DATA),
        }
    }

    /// System time of the device.
    pub(crate) fn system_time(&self, now_ns: u64) -> u64 {
        self.clock.local(now_ns).wrapping_add(self.memory.u64(reg::TIME_OFFSET))
    }

    /// Executes a datagram that passes.
    pub(crate) fn execute(&mut self, datagram: &mut Datagram<'_>, moment: PassingTime) {
        use DatagramCommand as C;
        let Some(command) = datagram.command else { return };
        let is_selected = match command {
            C::Nop => return,
            C::Lrd | C::Lwr | C::Lrw => return self.execute_logical(command, datagram, moment),
            C::Aprd | C::Apwr | C::Aprw | C::Armw => datagram.device() == 0,
            C::Fprd | C::Fpwr | C::Fprw | C::Frmw => self.has_address(datagram.device()),
            C::Brd | C::Bwr | C::Brw => true,
        };
        if !matches!(command, C::Fprd | C::Fpwr | C::Fprw | C::Frmw) {
            datagram.step_position();
        }
        let (reads, writes) = match command {
            C::Aprd | C::Fprd | C::Brd => (is_selected, false),
            C::Apwr | C::Fpwr | C::Bwr => (false, is_selected),
            C::Aprw | C::Fprw | C::Brw => (is_selected, is_selected),
            C::Armw | C::Frmw => (is_selected, !is_selected),
            C::Nop | C::Lrd | C::Lwr | C::Lrw => (false, false),
        };
        let joins = matches!(command, C::Brd | C::Brw);
        self.access(datagram, reads, writes, joins, moment);
        let events = self.memory.u16(reg::EVENTS) & self.memory.u16(reg::EVENT_MASK);
        let interrupt = u16::from_le_bytes(*datagram.interrupt) | events;
        *datagram.interrupt = interrupt.to_le_bytes();
    }

    fn has_address(&self, address: u16) -> bool {
        let alias_is_on = self.memory.u8(reg::DL_CONTROL + 3) & 1 != 0;
        address == self.memory.u16(reg::STATION)
            || alias_is_on && address == self.memory.u16(reg::ALIAS)
    }

    fn access(
        &mut self,
        datagram: &mut Datagram<'_>,
        reads: bool,
        writes: bool,
        joins: bool,
        moment: PassingTime,
    ) {
        let at = datagram.register();
        let length = datagram.data.len();
        let mut incoming = std::mem::take(&mut self.scratch);
        incoming.clear();
        incoming.extend_from_slice(&datagram.data[..length.min(MOST_DATA)]);
        if reads && self.read(at, length, moment) {
            let own = self.memory.bytes(at, length);
            for (byte, own) in datagram.data.iter_mut().zip(own) {
                *byte = if joins { *byte | own } else { *own };
            }
            self.after_read(at, length);
            datagram.count(1);
        }
        if writes && self.write(at, &incoming, moment) {
            datagram.count(if reads { 2 } else { 1 });
        }
        self.scratch = incoming;
    }

    fn execute_logical(
        &mut self,
        command: DatagramCommand,
        datagram: &mut Datagram<'_>,
        moment: PassingTime,
    ) {
        let logical = datagram.logical();
        let (mut has_read, mut has_written) = (false, false);
        for fmmu in self.fmmus {
            if fmmu.writes && command != DatagramCommand::Lrd {
                has_written |= self.write_mapped(&fmmu, logical, datagram.data, moment);
            }
        }
        for fmmu in self.fmmus {
            if fmmu.reads && command != DatagramCommand::Lwr {
                has_read |= self.read_mapped(&fmmu, logical, datagram.data, moment);
            }
        }
        let written = if command == DatagramCommand::Lrw { 2 } else { 1 };
        datagram.count(u16::from(has_read) + u16::from(has_written) * written);
    }

    fn write_mapped(
        &mut self,
        fmmu: &Fmmu,
        logical: u32,
        data: &[u8],
        moment: PassingTime,
    ) -> bool {
        if fmmu.is_byte_wise() {
            let Some(overlap) = fmmu.overlap(logical, data.len()) else { return false };
            let part = &data[overlap.offset..overlap.offset + overlap.length];
            return self.write(overlap.physical, part, moment);
        }
        let mut any = false;
        let mut open: Option<(u16, u8)> = None;
        for (bit, address, at) in fmmu.bits(logical, data.len()) {
            let mut byte = match open {
                Some((before, byte)) if before == address => byte,
                _ => {
                    any |= open.is_some_and(|(before, byte)| self.write(before, &[byte], moment));
                    self.memory.u8(address)
                }
            };
            byte = byte & !(1 << at) | (data[bit / 8] >> (bit % 8) & 1) << at;
            open = Some((address, byte));
        }
        any | open.is_some_and(|(before, byte)| self.write(before, &[byte], moment))
    }

    fn read_mapped(
        &mut self,
        fmmu: &Fmmu,
        logical: u32,
        data: &mut [u8],
        moment: PassingTime,
    ) -> bool {
        if fmmu.is_byte_wise() {
            let Some(overlap) = fmmu.overlap(logical, data.len()) else { return false };
            if !self.read(overlap.physical, overlap.length, moment) {
                return false;
            }
            let own = self.memory.bytes(overlap.physical, overlap.length);
            data[overlap.offset..overlap.offset + overlap.length].copy_from_slice(own);
            self.after_read(overlap.physical, overlap.length);
            return true;
        }
        let mut any = false;
        for (bit, address, at) in fmmu.bits(logical, data.len()) {
            if self.read(address, 1, moment) {
                let value = self.memory.u8(address) >> at & 1;
                data[bit / 8] = data[bit / 8] & !(1 << (bit % 8)) | value << (bit % 8);
                self.after_read(address, 1);
                any = true;
            }
        }
        any
    }

    /// Brings what a read shows up to date; false where the wire may not read.
    fn read(&mut self, at: u16, length: usize, moment: PassingTime) -> bool {
        if length == 0 || usize::from(at) + length > SIZE {
            return false;
        }
        if reg::is_clock(at) {
            if !self.has_clock {
                return false;
            }
            let time = self.system_time(moment.arrives_ns);
            self.memory.set(reg::SYSTEM_TIME, &time.to_le_bytes());
            self.memory.set(reg::TIME_DIFFERENCE, &self.clock.difference().to_le_bytes());
        }
        for i in 0..reg::CHANNELS {
            let manager = &self.sync_managers[i];
            if !manager.overlaps(at, length) {
                continue;
            }
            if !manager.allows(BufferDirection::Read, at) {
                return false;
            }
            if manager.begins(at) && !manager.is_mailbox {
                self.memory.set(manager.start, &self.buffers[i]);
            }
        }
        true
    }

    fn after_read(&mut self, at: u16, length: usize) {
        let touches =
            |register: u16| at <= register && usize::from(register) < usize::from(at) + length;
        if touches(reg::AL_STATUS) {
            let events = self.memory.u16(reg::EVENTS) & !AL_EVENT;
            self.memory.set(reg::EVENTS, &events.to_le_bytes());
        }
        for i in 0..reg::CHANNELS {
            let manager = &mut self.sync_managers[i];
            if manager.overlaps(at, length) && manager.accessed(at, length) && manager.is_mailbox {
                self.written.mail_taken = true;
                self.show_status(i);
            }
        }
    }

    /// Writes what the wire may write; false where it may write nothing of it.
    fn write(&mut self, at: u16, data: &[u8], moment: PassingTime) -> bool {
        let length = data.len();
        if length == 0 || usize::from(at) + length > SIZE || reg::is_clock(at) && !self.has_clock {
            return false;
        }
        let overlapping = |manager: &&SyncManager| manager.overlaps(at, length);
        if !self
            .sync_managers
            .iter()
            .filter(overlapping)
            .all(|m| m.allows(BufferDirection::Write, at))
        {
            return false;
        }
        let mut any = false;
        for (i, byte) in (0_u16..).zip(data) {
            let address = at + i;
            if address >= reg::REGISTER_BYTES || self.may_write(address) {
                self.memory.set(address, &[*byte]);
                any = true;
            }
        }
        for i in 0..reg::CHANNELS {
            let manager = &mut self.sync_managers[i];
            if manager.overlaps(at, length) && manager.accessed(at, length) {
                self.completed(i);
            }
        }
        if any && at < reg::REGISTER_BYTES {
            self.after_write(at, length, data, moment);
        }
        any
    }

    fn may_write(&self, address: u16) -> bool {
        let protected = match address {
            reg::CYCLIC_UNIT => !self.has_cyclic_unit,
            // start and periods, while the sync unit is on
            0x0990..=0x09A7 => self.memory.u8(reg::SYNC_ACTIVATION) & 1 != 0,
            // start, length and control of a sync manager that is on
            0x0800..=0x083F => {
                let (channel, byte) = ((address - reg::SYNC_MANAGER) / 8, address % 8);
                byte == 5
                    || byte == 7
                    || byte < 5 && self.sync_managers[usize::from(channel)].is_enabled
            }
            _ => false,
        };
        !protected && reg::is_writable(address)
    }

    /// A buffer has been written to its last byte.
    fn completed(&mut self, i: usize) {
        let manager = &self.sync_managers[i];
        if manager.is_mailbox {
            self.written.mailbox = true;
        } else {
            let bytes = self.memory.bytes(manager.start, usize::from(manager.length));
            self.buffers[i].clear();
            self.buffers[i].extend_from_slice(bytes);
            self.written.outputs |= manager.has_watchdog;
        }
        self.show_status(i);
    }

    fn after_write(&mut self, at: u16, length: usize, data: &[u8], moment: PassingTime) {
        let end = usize::from(at) + length;
        let touches = |register: u16| at <= register && usize::from(register) < end;
        let overlaps = |first: u16, bytes: u16| at < first + bytes && usize::from(first) < end;
        if overlaps(reg::FMMU, 0x80) {
            self.fmmus =
                std::array::from_fn(|i| Fmmu::of(self.memory.get(reg::FMMU + 16 * i as u16)));
        }
        if overlaps(reg::SYNC_MANAGER, 0x40) {
            for i in 0..reg::CHANNELS {
                let repeat = self.sync_managers[i].repeat;
                let registers = self.memory.get(reg::SYNC_MANAGER + 8 * i as u16);
                self.sync_managers[i].configure(registers);
                self.written.repeat |= self.sync_managers[i].repeat != repeat;
                self.show_status(i);
            }
        }
        if overlaps(0x0300, 0x0E) {
            self.memory.set(0x0300, &[0; 14]);
        }
        if overlaps(reg::WATCHDOG_COUNT, 2) {
            self.memory.set(reg::WATCHDOG_COUNT, &[0; 2]);
        }
        self.written.al_control |= touches(reg::AL_CONTROL);
        if overlaps(reg::EEPROM_CONTROL, 2) {
            if self.memory.u8(reg::EEPROM_OWNER) & 1 == 0 {
                self.eeprom.execute(&mut self.memory);
            } else {
                self.memory.set(reg::EEPROM_CONTROL, &[0xC0, 0x20]);
            }
        }
        if reg::is_clock(at) {
            self.after_clock_write(at, data, moment, touches);
        }
    }

    fn after_clock_write(
        &mut self,
        at: u16,
        data: &[u8],
        moment: PassingTime,
        touches: impl Fn(u16) -> bool,
    ) {
        let now = moment.arrives_ns;
        if touches(reg::RECEIVE_TIMES) {
            let local = self.clock.local(now);
            let back = moment.returns_ns.map_or(0, |back| self.clock.local(back));
            self.memory.set(reg::RECEIVE_TIMES, &(local as u32).to_le_bytes());
            self.memory.set(reg::RECEIVE_TIMES + 4, &(back as u32).to_le_bytes());
            self.memory.set(reg::RECEIVE_TIME, &local.to_le_bytes());
        }
        if at == reg::SYSTEM_TIME && data.len() >= 4 {
            let system = self.system_time(now);
            let low = u64::from(self.memory.u32(reg::SYSTEM_TIME));
            let received = match data.len() {
                8.. => self.memory.u64(reg::SYSTEM_TIME),
                _ => system & !0xFFFF_FFFF | low,
            };
            self.clock.compare(system, received, self.memory.u32(reg::TIME_DELAY), now);
        }
        if touches(reg::SPEED_COUNTER) {
            self.clock.reset_loop(now);
        }
        if touches(reg::SYNC_ACTIVATION) {
            if self.memory.u8(reg::SYNC_ACTIVATION) & 3 == 3 {
                self.clock.start_sync(self.memory.u64(reg::SYNC_START), self.system_time(now));
            } else {
                self.clock.stop_sync();
            }
        }
    }

    fn show_status(&mut self, i: usize) {
        let status = self.sync_managers[i].status();
        self.memory.set(reg::SYNC_MANAGER + 8 * i as u16 + 5, &[status]);
    }

    /// Shows the application's AL state.
    pub(crate) fn set_al(&mut self, status: u8, code: u16) {
        if self.memory.u8(reg::AL_STATUS) != status {
            let events = self.memory.u16(reg::EVENTS) | AL_EVENT;
            self.memory.set(reg::EVENTS, &events.to_le_bytes());
        }
        self.memory.set(reg::AL_STATUS, &[status, 0]);
        self.memory.set(reg::AL_CODE, &code.to_le_bytes());
    }

    /// Takes the mail that the wire has written into a mailbox.
    pub(crate) fn take_mail(&mut self, i: usize, into: &mut Vec<u8>) {
        let manager = &mut self.sync_managers[i];
        into.clear();
        into.extend_from_slice(self.memory.bytes(manager.start, usize::from(manager.length)));
        manager.is_full = false;
        self.show_status(i);
    }

    /// Puts mail into a mailbox that the wire reads; false while it is full.
    pub(crate) fn put_mail(&mut self, i: usize, mail: &[u8]) -> bool {
        let manager = &mut self.sync_managers[i];
        let length = usize::from(manager.length);
        if manager.is_full || !manager.is_enabled || mail.len() > length {
            return false;
        }
        manager.is_full = true;
        let place = self.memory.bytes_mut(manager.start, length);
        place.fill(0);
        if let Some(place) = place.get_mut(..mail.len()) {
            place.copy_from_slice(mail);
        }
        self.show_status(i);
        true
    }

    /// What the wire has last written completely into a buffer.
    pub(crate) fn outputs(&self, i: usize) -> &[u8] {
        &self.buffers[i]
    }

    /// Buffer from which the wire reads, to be written by the application.
    pub(crate) fn inputs_mut(&mut self, i: usize) -> &mut [u8] {
        let length = usize::from(self.sync_managers[i].length).min(512);
        self.buffers[i].resize(length, 0);
        &mut self.buffers[i]
    }
}
