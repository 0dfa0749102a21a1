//! A device: its controller, its AL state, its mailbox, and the application that all that serves.
//!
//! ```text
//!   frame passes ─► controller ─► what was written ─► serve: AL request, mailbox, outputs
//!   time passes  ────────────────────────────────────► advance: SYNC0, watchdog, answers that are due
//! ```
use crate::al::{AlCode, AlState, ERROR, Transition, transition};
use crate::clock::LocalClock;
use crate::coe::{
    COE, Context, Dictionary, Emergency, Mapping, RX_ASSIGNMENT, Server, Service, TX_ASSIGNMENT,
    error_reply, inform, parse,
};
use crate::controller::{Controller, PassingTime, Written};
use crate::frame::Datagram;
use crate::profile::{DriveState, EmulatedAxis, HomingSwitches, Motor};
use crate::quirks::Quirks;
use crate::registers as reg;
use crate::sii::Identity;
use crate::sync_manager::{BufferDirection, SyncManager};
use std::collections::VecDeque;
use units::{Angle, Spin, Time};

/// Most mails that wait to be read; a device that is asked for more leaves the newest out.
const MOST_MAILS: usize = 64;
/// Period of an application that nothing synchronises, ns.
const FREE_RUN_NS: u64 = 1_000_000;
/// Most periods that are executed at once; longer pauses are left out.
const MOST_STEPS: u64 = 64;
/// How long SAFE-OP waits for outputs on its way to OP, ns.
const WAIT_FOR_OUTPUTS_NS: u64 = 5_000_000_000;
/// Least bytes of a mailbox.
const LEAST_MAILBOX: u16 = 0x22;
/// Mailbox error: kind of mail that is not supported.
const UNSUPPORTED_PROTOCOL: u16 = 0x0002;
/// Mailbox error: its header does not fit.
const INVALID_HEADER: u16 = 0x0004;

/// How long a device takes, ns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Latency {
    /// Until mail is answered.
    pub mailbox_ns: u64,
    /// Until an AL request is executed.
    pub transition_ns: u64,
}

impl Default for Latency {
    fn default() -> Self {
        Self { mailbox_ns: 100_000, transition_ns: 500_000 }
    }
}

/// Eight digital outputs and inputs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DigitalIo {
    inputs: u8,
    outputs: u8,
}

/// An encoder on a shaft.
#[derive(Clone, Debug)]
pub(crate) struct Encoder {
    counts_per_rev: u32,
    angle: Angle,
    spin: Spin,
    latched: Option<u32>,
}

impl Encoder {
    pub(crate) fn new(counts_per_rev: u32) -> Self {
        Self { counts_per_rev, angle: Angle::ZERO, spin: Spin::ZERO, latched: None }
    }

    fn counts(&self, angle: Angle) -> u32 {
        (angle.value() * f64::from(self.counts_per_rev)).floor() as i64 as u32
    }

    fn step(&mut self, dictionary: &mut Dictionary, period: Time) {
        let before = self.angle.value().floor();
        self.angle += self.spin * period;
        let after = self.angle.value().floor();
        let enabled = dictionary.number(0x7010, 1).unwrap_or(0) & 1 != 0;
        if !enabled {
            self.latched = None;
        } else if before != after && self.latched.is_none() {
            self.latched = Some(self.counts(Angle::rev(before.max(after))));
        }
        dictionary.put(0x6010, 1, i64::from(self.latched.is_some()));
        dictionary.put(0x6010, 0x11, i64::from(self.counts(self.angle)));
        dictionary.put(0x6010, 0x12, i64::from(self.latched.unwrap_or(0)));
    }
}

/// What a device does.
#[derive(Clone, Debug)]
pub(crate) enum Application {
    None,
    DigitalIo(DigitalIo),
    Drive(Vec<EmulatedAxis>),
    Encoder(Encoder),
}

/// Everything that a device is made from.
#[derive(Clone, Debug)]
pub(crate) struct Blueprint {
    pub(crate) words: Vec<u16>,
    pub(crate) identity: Identity,
    pub(crate) quirks: Quirks,
    pub(crate) drift_ppb: i64,
    pub(crate) mailboxes: Option<[(u16, u16); 2]>,
    /// Sync managers of outputs and inputs.
    pub(crate) process: Option<[usize; 2]>,
    pub(crate) dictionary: Option<Dictionary>,
    pub(crate) application: Application,
    pub(crate) least_cycle_ns: u32,
}

/// An AL request that is being executed.
#[derive(Clone, Copy, Debug)]
struct Pending {
    to: AlState,
    due_ns: u64,
    until_ns: u64,
}

/// An emulated device.
#[derive(Clone, Debug)]
pub struct Device {
    blueprint: Box<Blueprint>,
    controller: Controller,
    /// How long it takes.
    pub latency: Latency,
    state: AlState,
    code: u16,
    pending: Option<Pending>,
    dictionary: Dictionary,
    application: Application,
    server: Server,
    mail: Vec<u8>,
    mail_due_ns: Option<u64>,
    outbox: VecDeque<Vec<u8>>,
    last_mail: Vec<u8>,
    counter: u8,
    rx: Mapping,
    tx: Mapping,
    has_outputs: bool,
    outputs_ns: u64,
    stepped_ns: u64,
}

impl Device {
    pub(crate) fn new(blueprint: Blueprint) -> Self {
        let clock = LocalClock::new(0, blueprint.drift_ppb);
        let mut device = Self {
            controller: Controller::new(blueprint.words.clone(), clock, &blueprint.quirks),
            latency: Latency::default(),
            state: AlState::Init,
            code: 0,
            pending: None,
            dictionary: blueprint.dictionary.clone().unwrap_or_default(),
            application: blueprint.application.clone(),
            server: Server::new(),
            mail: Vec::with_capacity(512),
            mail_due_ns: None,
            outbox: VecDeque::new(),
            last_mail: Vec::new(),
            counter: 0,
            rx: Mapping::default(),
            tx: Mapping::default(),
            has_outputs: false,
            outputs_ns: 0,
            stepped_ns: 0,
            blueprint: Box::new(blueprint),
        };
        device.show();
        device
    }

    /// Turns the device off and on again: all but the motors' positions is as it was at first.
    pub fn power_cycle(&mut self, now_ns: u64) {
        let mut new = Self::new((*self.blueprint).clone());
        // a clock starts at 0 when its device is turned on
        new.controller.clock.restart(now_ns);
        new.latency = self.latency;
        new.stepped_ns = now_ns;
        if let (Application::Drive(before), Application::Drive(after)) =
            (&self.application, &mut new.application)
        {
            for (before, after) in before.iter().zip(after) {
                after.motor.angle = before.motor.angle;
            }
        }
        *self = new;
    }

    /// Who it says it is.
    pub fn identity(&self) -> Identity {
        self.blueprint.identity
    }

    /// AL state.
    pub fn state(&self) -> AlState {
        self.state
    }

    /// AL status code; 0 if there is no error.
    pub fn code(&self) -> u16 {
        self.code
    }

    /// The object dictionary; empty for a device without one.
    pub fn dictionary(&self) -> &Dictionary {
        &self.dictionary
    }

    /// System time by its clock, ns.
    pub fn system_time(&self, now_ns: u64) -> u64 {
        self.controller.system_time(now_ns)
    }

    fn axis(&self, axis: usize) -> Option<&EmulatedAxis> {
        match &self.application {
            Application::Drive(axes) => axes.get(axis),
            _ => None,
        }
    }

    fn axis_mut(&mut self, axis: usize) -> Option<&mut EmulatedAxis> {
        match &mut self.application {
            Application::Drive(axes) => axes.get_mut(axis),
            _ => None,
        }
    }

    /// State of an axis of a drive.
    pub fn drive_state(&self, axis: usize) -> Option<DriveState> {
        self.axis(axis).map(|axis| axis.state)
    }

    /// Motor of an axis of a drive.
    pub fn motor(&self, axis: usize) -> Option<&Motor> {
        self.axis(axis).map(|axis| &axis.motor)
    }

    /// Motor of an axis, to be turned by hand.
    pub fn motor_mut(&mut self, axis: usize) -> Option<&mut Motor> {
        self.axis_mut(axis).map(|axis| &mut axis.motor)
    }

    /// Switches of an axis.
    pub fn switches_mut(&mut self, axis: usize) -> Option<&mut HomingSwitches> {
        self.axis_mut(axis).map(|axis| &mut axis.switches)
    }

    /// Makes an axis find a fault of its own.
    pub fn fail(&mut self, axis: usize, code: u16) {
        if let Some(axis) = self.axis_mut(axis) {
            axis.fail(code);
        }
    }

    /// Deflects the probe of an axis, or lets it back.
    pub fn set_probe(&mut self, axis: usize, is_deflected: bool) {
        if let Some(axis) = self.axis_mut(axis) {
            axis.probe_input = is_deflected;
        }
    }

    /// Digital outputs: 0 outside of OP.
    pub fn digital_outputs(&self) -> u8 {
        match &self.application {
            Application::DigitalIo(io) => io.outputs,
            _ => 0,
        }
    }

    /// Sets digital inputs.
    pub fn set_digital_inputs(&mut self, inputs: u8) {
        if let Application::DigitalIo(io) = &mut self.application {
            io.inputs = inputs;
        }
    }

    /// Sets the speed of an encoder's shaft.
    pub fn set_shaft(&mut self, spin: Spin) {
        if let Application::Encoder(encoder) = &mut self.application {
            encoder.spin = spin;
        }
    }

    /// Puts an emergency into the mailbox, as soon as there is one.
    pub fn say(&mut self, emergency: Emergency) {
        let mut mail = Vec::new();
        emergency.write(&mut mail);
        self.post(mail);
    }

    pub(crate) fn set_ports(&mut self, has_next: bool) {
        // PDI and watchdog work; port 0 is connected, port 1 if a device follows; 2 and 3 are closed
        let status: u16 = if has_next { 0x5A33 } else { 0x5613 };
        self.controller.memory.set(reg::DL_STATUS, &status.to_le_bytes());
    }

    pub(crate) fn execute(&mut self, datagram: &mut Datagram<'_>, moment: PassingTime) {
        self.controller.execute(datagram, moment);
    }

    pub(crate) fn keeps_source_address(&self) -> bool {
        self.blueprint.quirks.source_address_kept
    }

    fn show(&mut self) {
        let error = if self.code == 0 { 0 } else { ERROR };
        self.controller.set_al(self.state as u8 | error, self.code);
    }

    fn refuse(&mut self, code: AlCode) {
        self.code = code as u16;
        self.pending = None;
        self.show();
    }

    /// Takes note of what a frame has written.
    pub(crate) fn serve(&mut self, now_ns: u64) {
        let written = std::mem::take(&mut self.controller.written);
        let Written { al_control, mailbox, mail_taken, repeat, outputs } = written;
        if outputs {
            self.has_outputs = true;
            self.outputs_ns = now_ns;
            self.controller.memory.set(reg::WATCHDOG_STATUS, &[1]);
            let synchronised = self.controller.clock.is_synchronised();
            if self.state == AlState::Op && !synchronised && now_ns > self.stepped_ns {
                let passed = (now_ns - self.stepped_ns).min(MOST_STEPS * FREE_RUN_NS);
                self.step(now_ns, passed);
            }
        }
        if al_control {
            self.request(self.controller.memory.u8(reg::AL_CONTROL), now_ns);
        }
        if mailbox {
            self.mail_due_ns = Some(now_ns + self.latency.mailbox_ns);
        }
        if repeat {
            self.repeat_mail();
        }
        if mail_taken {
            self.deliver();
        }
        self.advance(now_ns);
    }

    fn repeat_mail(&mut self) {
        let wanted = u8::from(self.controller.sync_managers[1].repeat);
        let status = reg::SYNC_MANAGER + 8 + 7;
        self.controller.memory.set(status, &[wanted << 1]);
        if !self.last_mail.is_empty() {
            self.controller.sync_managers[1].is_full = false;
            self.controller.put_mail(1, &self.last_mail);
        }
    }

    /// Lets time pass.
    pub(crate) fn advance(&mut self, now_ns: u64) {
        if let Some(pending) = self.pending
            && pending.due_ns <= now_ns
        {
            self.execute_request(pending, now_ns);
        }
        if self.mail_due_ns.is_some_and(|due| due <= now_ns) {
            self.mail_due_ns = None;
            self.answer_mail();
        }
        self.watch_outputs(now_ns);
        let period = self.controller.memory.u32(reg::SYNC0_PERIOD);
        if self.controller.clock.is_synchronised() {
            let system = self.controller.system_time(now_ns);
            self.controller.clock.skip_syncs(system, period, MOST_STEPS);
            while self.controller.clock.take_sync(system, period) {
                self.step(now_ns, u64::from(period));
            }
            return;
        }
        let waits_for_outputs = self.state == AlState::Op && self.rx.bytes() > 0;
        let passed = now_ns.saturating_sub(self.stepped_ns);
        if !waits_for_outputs && passed >= FREE_RUN_NS {
            for _ in 0..(passed / FREE_RUN_NS).min(MOST_STEPS) {
                self.step(now_ns, FREE_RUN_NS);
            }
        }
    }

    fn step(&mut self, now_ns: u64, period_ns: u64) {
        self.stepped_ns = now_ns;
        let period = Time::s(period_ns as f64 * 1e-9);
        let is_op = self.state == AlState::Op;
        if let (true, Some([out, _])) = (is_op && self.has_outputs, self.blueprint.process) {
            self.rx.receive(self.controller.outputs(out), &mut self.dictionary);
        }
        let mut says = None;
        match &mut self.application {
            Application::None => {}
            Application::DigitalIo(io) => {
                io.outputs = if is_op {
                    self.controller.outputs(0).first().copied().unwrap_or(0)
                } else {
                    0
                };
                if let Some(place) = self.controller.inputs_mut(1).first_mut() {
                    *place = io.inputs;
                }
            }
            Application::Drive(axes) => {
                for axis in axes {
                    axis.step(&mut self.dictionary, period, &mut says);
                }
            }
            Application::Encoder(encoder) => encoder.step(&mut self.dictionary, period),
        }
        if let Some(emergency) = says
            && self.state != AlState::Init
        {
            self.say(emergency);
        }
        if let (true, Some([_, into])) = (self.state >= AlState::SafeOp, self.blueprint.process)
            && self.blueprint.dictionary.is_some()
        {
            self.tx.send(&self.dictionary, self.controller.inputs_mut(into));
        }
    }

    fn watchdog_ns(&self) -> u64 {
        let divider = u64::from(self.controller.memory.u16(reg::WATCHDOG_DIVIDER));
        let ticks = u64::from(self.controller.memory.u16(reg::WATCHDOG_TIME));
        (divider + 2) * 40 * ticks
    }

    fn watch_outputs(&mut self, now_ns: u64) {
        let Some([out, _]) = self.blueprint.process else { return };
        let limit = self.watchdog_ns();
        let guarded = self.controller.sync_managers[out].has_watchdog && limit > 0;
        if self.state == AlState::Op && guarded && now_ns.saturating_sub(self.outputs_ns) > limit {
            let count = self.controller.memory.u8(reg::WATCHDOG_COUNT).saturating_add(1);
            self.controller.memory.set(reg::WATCHDOG_COUNT, &[count]);
            self.controller.memory.set(reg::WATCHDOG_STATUS, &[0]);
            self.leave(AlState::SafeOp);
            self.refuse(AlCode::SyncManagerWatchdog);
        }
    }

    fn request(&mut self, control: u8, now_ns: u64) {
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

    fn execute_request(&mut self, pending: Pending, now_ns: u64) {
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

    fn go_to(&mut self, to: AlState) {
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
    fn leave(&mut self, to: AlState) {
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

    fn check_mailboxes(&self) -> Result<(), AlCode> {
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

    fn outputs_bytes(&self) -> usize {
        match (&self.application, self.blueprint.process) {
            (Application::DigitalIo(_), Some(_)) => 1,
            _ => self.rx.bytes(),
        }
    }

    fn check_process_data(&mut self) -> Result<(), AlCode> {
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

    fn check_clock(&mut self) -> Result<(), AlCode> {
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

    fn check_synchronisation(&self) -> Result<(), AlCode> {
        let wanted = self.controller.memory.u8(reg::SYNC_ACTIVATION) & 1 != 0;
        if wanted && !self.controller.clock.is_synchronised() {
            return Err(AlCode::NoSyncError);
        }
        Ok(())
    }

    fn waits_for_sync(&self) -> bool {
        self.controller.clock.is_synchronised() && !self.controller.clock.has_synced()
    }

    fn answer_mail(&mut self) {
        let mut mail = std::mem::take(&mut self.mail);
        self.controller.take_mail(0, &mut mail);
        let mut reply = Vec::new();
        match parse(&mail) {
            None => error_reply(&mut reply, INVALID_HEADER),
            Some(mail) if mail.kind != COE => error_reply(&mut reply, UNSUPPORTED_PROTOCOL),
            Some(mail) => self.answer_coe(mail.body, &mut reply),
        }
        self.mail = mail;
        if !reply.is_empty() {
            self.post(reply);
        }
    }

    fn answer_coe(&mut self, body: &[u8], reply: &mut Vec<u8>) {
        let Some((header, request)) = body.split_at_checked(2) else {
            return error_reply(reply, INVALID_HEADER);
        };
        let service = header[1] >> 4;
        let mailbox = usize::from(self.controller.sync_managers[1].length);
        let quirks = &self.blueprint.quirks;
        if service == Service::SdoRequest as u8 {
            let dictionary = &mut self.dictionary;
            let mut context = Context { dictionary, state: self.state, quirks, mailbox };
            if !self.server.answer(request, &mut context, reply) {
                reply.clear();
            }
        } else if service == Service::SdoInformation as u8 && !quirks.no_sdo_information {
            for mail in inform(request, &self.dictionary, mailbox) {
                self.post(mail);
            }
        } else {
            error_reply(reply, UNSUPPORTED_PROTOCOL);
        }
    }

    fn post(&mut self, mut mail: Vec<u8>) {
        if self.outbox.len() >= MOST_MAILS || self.blueprint.mailboxes.is_none() {
            return;
        }
        self.counter = self.counter % 7 + 1;
        crate::coe::finish(&mut mail, self.counter);
        self.outbox.push_back(mail);
        self.deliver();
    }

    /// Puts the next mail into the mailbox, if that is empty.
    fn deliver(&mut self) {
        if self.state == AlState::Init || self.blueprint.mailboxes.is_none() {
            return;
        }
        if let Some(mail) = self.outbox.front()
            && self.controller.put_mail(1, mail)
            && let Some(mail) = self.outbox.pop_front()
        {
            self.last_mail = mail;
        }
    }
}
