//! AL requests of a device: what is checked before it goes up, and what ends when it goes down.
use super::{Application, Device, Pending};
use crate::al::{AlCode, AlState, ERROR, Transition, transition};
use crate::coe::{Emergency, Mapping, RX_ASSIGNMENT, Server, TX_ASSIGNMENT};
use crate::registers as reg;
use crate::sync_manager::{BufferDirection, SyncManager};

/// How long SAFE-OP waits for outputs on its way to OP, ns.
const WAIT_FOR_OUTPUTS_NS: u64 = 5_000_000_000;
/// Least bytes of a mailbox.
const LEAST_MAILBOX: u16 = 0x22;

impl Device {
    pub(super) fn request(&mut self, control: u8, now_ns: u64) {
        let is_acknowledged = control & ERROR != 0;
        if self.code != 0 {
            if !is_acknowledged {
                return;
            }
            self.code = 0;
            self.show();
        }
        let Some(to) = AlState::of(control & 0x0F) else {
            return self.refuse(AlCode::UnknownRequestedState);
        };
        let due_ns = now_ns + self.latency.transition_ns;
        self.pending = Some(Pending { to, due_ns, until_ns: due_ns + WAIT_FOR_OUTPUTS_NS });
    }

    pub(super) fn execute_request(&mut self, pending: Pending, now_ns: u64) {
        let to = pending.to;
        let result = match transition(self.state, to) {
            Transition::Stay | Transition::Down => Ok(()),
            Transition::Refuse => Err(AlCode::InvalidRequestedStateChange),
            Transition::StartBootstrap => Err(AlCode::BootstrapNotSupported),
            Transition::StartMailbox => self.check_mailboxes(),
            Transition::StartInputs => self.check_process_data(),
            Transition::StartOutputs => {
                let needs_outputs = self.outputs_bytes() > 0;
                let limit = self.watchdog_ns();
                let fresh = limit == 0 || now_ns.saturating_sub(self.outputs_ns) <= limit;
                let waits = needs_outputs && !(self.has_outputs && fresh) || self.waits_for_sync();
                match self.check_synchronisation() {
                    Ok(()) if waits => {
                        if now_ns < pending.until_ns {
                            return; // asked again when time has passed
                        }
                        Err(AlCode::NoValidOutputs)
                    }
                    result => result,
                }
            }
        };
        self.pending = None;
        match result {
            Ok(()) => self.go_to(to),
            Err(code) => self.refuse(code),
        }
    }

    pub(super) fn go_to(&mut self, to: AlState) {
        if to < self.state {
            self.leave(to);
        }
        if to == AlState::PreOp
            && self.state == AlState::Init
            && self.blueprint.quirks.emergency_at_start
        {
            self.say(Emergency { code: 0xFF00, register: 0x81, data: [1, 2, 3, 4, 5] });
        }
        self.state = to;
        self.show();
        self.deliver();
    }

    /// Leaves OP, or the mailbox.
    pub(super) fn leave(&mut self, to: AlState) {
        if self.state == AlState::Op {
            if let Application::Drive(axes) = &mut self.application {
                for axis in axes {
                    axis.lose_connection(&mut self.dictionary);
                }
            }
            self.has_outputs = false;
        }
        if to == AlState::Init {
            self.server = Server::new();
            self.outbox.clear();
            self.last_mail.clear();
            self.mail_due_ns = None;
        }
        self.state = to;
        if let Application::DigitalIo(io) = &mut self.application {
            io.outputs = 0;
        }
    }

    pub(super) fn check_mailboxes(&self) -> Result<(), AlCode> {
        let Some(expected) = self.blueprint.mailboxes else { return Ok(()) };
        let directions = [BufferDirection::Write, BufferDirection::Read];
        let fits = |i: usize| {
            let manager: &SyncManager = &self.controller.sync_managers[i];
            let (start, length) = expected[i];
            manager.is_enabled
                && manager.is_mailbox
                && manager.direction == directions[i]
                && manager.start == start
                && (LEAST_MAILBOX..=length).contains(&manager.length)
        };
        if fits(0) && fits(1) { Ok(()) } else { Err(AlCode::InvalidMailboxConfiguration) }
    }

    pub(super) fn outputs_bytes(&self) -> usize {
        match (&self.application, self.blueprint.process) {
            (Application::DigitalIo(_), Some(_)) => 1,
            _ => self.rx.bytes(),
        }
    }

    pub(super) fn check_process_data(&mut self) -> Result<(), AlCode> {
        let Some([out, into]) = self.blueprint.process else { return Ok(()) };
        let (mut wanted_out, mut wanted_in) = (1, 1);
        if self.blueprint.dictionary.is_some() {
            self.rx = Mapping::of(&self.dictionary, RX_ASSIGNMENT)
                .map_err(|_| AlCode::InvalidOutputConfiguration)?;
            self.tx = Mapping::of(&self.dictionary, TX_ASSIGNMENT)
                .map_err(|_| AlCode::InvalidInputConfiguration)?;
            (wanted_out, wanted_in) = (self.rx.bytes(), self.tx.bytes());
        }
        let fits = |i: usize, bytes: usize, direction| {
            let manager = &self.controller.sync_managers[i];
            if bytes == 0 {
                return !manager.is_enabled || manager.length == 0;
            }
            let kind = manager.is_enabled && !manager.is_mailbox && manager.direction == direction;
            kind && usize::from(manager.length) == bytes
        };
        if !fits(out, wanted_out, BufferDirection::Write) {
            return Err(AlCode::InvalidOutputConfiguration);
        }
        if !fits(into, wanted_in, BufferDirection::Read) {
            return Err(AlCode::InvalidInputConfiguration);
        }
        self.controller.inputs_mut(into);
        self.check_clock()
    }

    pub(super) fn check_clock(&mut self) -> Result<(), AlCode> {
        let activation = self.controller.memory.u8(reg::SYNC_ACTIVATION) & 7;
        let period = self.controller.memory.u32(reg::SYNC0_PERIOD);
        let needed = match self.blueprint.quirks.sync_activation {
            0 => 3,
            own => own & 7,
        };
        if activation & 1 != 0 {
            if activation != needed {
                return Err(AlCode::InvalidDcSyncConfiguration);
            }
            if period < self.blueprint.least_cycle_ns {
                return Err(AlCode::InvalidSyncCycleTime);
            }
        }
        if !self.blueprint.quirks.sync_type_reads_zero {
            let kind = if activation & 1 != 0 { 2 } else { 1 };
            self.dictionary.put(0x1C32, 1, kind);
            self.dictionary.put(0x1C33, 1, kind);
        }
        Ok(())
    }

    pub(super) fn check_synchronisation(&self) -> Result<(), AlCode> {
        let wanted = self.controller.memory.u8(reg::SYNC_ACTIVATION) & 1 != 0;
        if wanted && !self.controller.clock.is_synchronised() {
            return Err(AlCode::NoSyncError);
        }
        Ok(())
    }

    pub(super) fn waits_for_sync(&self) -> bool {
        self.controller.clock.is_synchronised() && !self.controller.clock.has_synced()
    }
}
