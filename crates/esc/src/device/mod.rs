//! A device: its controller, its AL state, its mailbox, and the application that all that serves.
//!
//! ```text
//!   frame passes ─► controller ─► what was written ─► serve: AL request, mailbox, outputs
//!   time passes  ────────────────────────────────────► advance: SYNC0, watchdog, answers that are due
//! ```
use crate::al::{AlCode, AlState, ERROR};
use crate::clock::LocalClock;
use crate::coe::{Dictionary, Emergency, Mapping, Server};
use crate::controller::{Controller, PassingTime, Written};
use crate::frame::Datagram;
use crate::profile::{DriveState, EmulatedAxis, HomingSwitches, Motor};
use crate::quirks::Quirks;
use crate::registers as reg;
use crate::sii::Identity;
pub(crate) use application::{Application, DigitalIo, Encoder};
use std::collections::VecDeque;
use units::{Spin, Time};

mod application;
mod mail;
mod transitions;

/// Period of an application that nothing synchronises, ns.
const FREE_RUN_NS: u64 = 1_000_000;
/// Most periods that are executed at once; longer pauses are left out.
const MOST_STEPS: u64 = 64;

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
    /// Outputs have come since the last period.
    is_told: bool,
    /// Pulses of SYNC0 that were executed.
    syncs: u64,
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
            is_told: false,
            syncs: 0,
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

    /// Pulses of SYNC0 that it has executed since it was turned on.
    pub fn syncs(&self) -> u64 {
        self.syncs
    }

    /// Sets the digital inputs of an axis, 60FD, from outside; its own switches then have no
    /// effect.
    pub fn set_axis_inputs(&mut self, axis: usize, bits: u32) {
        if let Some(axis) = self.axis_mut(axis) {
            axis.outside_inputs = Some(bits);
        }
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
        // PDI and watchdog work; port 0 is connected, port 1 if a device follows; 2 and 3 closed
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
            (self.has_outputs, self.is_told) = (true, true);
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
                self.syncs += 1;
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
        let is_told = std::mem::take(&mut self.is_told);
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
                    axis.step(&mut self.dictionary, period, is_told, &mut says);
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
}
