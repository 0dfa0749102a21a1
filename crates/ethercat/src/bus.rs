//! A network in OP: one frame a cycle, and what became of it.
use crate::cia402::Wanted;
use crate::drive::{DriveAxis, DriveCommand};
use crate::error::StartError;
use crate::exchange::{Emergency, Exchange, Losses};
use crate::link::FrameLink;
use crate::network::Network;
use crate::pace::Pacer;
use crate::pdo::Images;
use crate::scan::{FIRST_STATION, Group, find_refusal};
use ethercrab::subdevice_group::{HasDc, Op};
use ethercrab::{Command, MainDevice, SubDeviceState};

/// How long devices may take from SAFE-OP to OP, ns.
const MOST_TO_OP_NS: u64 = 3_000_000_000;
/// Cycles between two looks at who refuses.
const LOOK_EVERY: u64 = 100;

/// Beyond the master's own time the reference clock may leap so far, ns.
const MOST_LEAP_NS: u64 = 20_000_000;
/// Status of the sync manager of the mailbox that is read, and its length.
const MAIL_STATUS: u16 = 0x080D;
const MAIL_LENGTH: u16 = 0x080A;
/// Bit of the status.
const MAIL_IS_THERE: u8 = 0x08;

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply {
    /// Every device has executed it.
    Complete {
        /// Time of the reference clock, ns.
        reference_ns: u64,
        /// How late the frame was against SYNC0 less the lead, ns.
        phase_ns: i64,
    },
    /// Not every device has: the inputs are the last ones.
    Short {
        /// Working counter.
        counter: u16,
        /// Working counter if every device executes it.
        expected: u16,
    },
    /// It did not come in time.
    Lost,
    /// The reference clock did not answer, or its time stands or leaps.
    NoReference,
}

/// A cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// What became of its frame.
    pub reply: Reply,
    /// Frames in a row that were not complete, this one too.
    pub missed_in_a_row: u32,
    /// Devices in OP.
    pub in_op: usize,
}

/// Frames since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Executed by every device.
    pub complete: u64,
    /// Not executed by every device.
    pub short: u64,
    /// Not back in time.
    pub lost: u64,
    /// Without the time of the reference clock.
    pub no_reference: u64,
    /// What came without a place.
    pub losses: Losses,
}

impl Counters {
    /// None yet.
    pub const fn new() -> Self {
        let losses = Losses { foreign: 0, echoes: 0, unexpected: 0, malformed: 0, not_sent: 0 };
        Self { complete: 0, short: 0, lost: 0, no_reference: 0, losses }
    }
}

/// A network that exchanges process data.
pub struct Bus<'m, 's> {
    main: &'m MainDevice<'s>,
    exchange: &'m mut Exchange<'s>,
    group: Group<Op, HasDc>,
    drives: Vec<DriveAxis>,
    expected: u16,
    cycle_ns: u64,
    pacer: Pacer,
    /// Time of the reference clock, and of the master's own, when it was last believed.
    last_reference: Option<(u64, u64)>,
    missed: u32,
    in_op: usize,
    counters: Counters,
    next_mail: usize,
}

impl<'m, 's> Bus<'m, 's> {
    pub(crate) fn new(
        main: &'m MainDevice<'s>,
        exchange: &'m mut Exchange<'s>,
        group: Group<Op, HasDc>,
        images: &[Images],
        network: &Network,
        now_ns: u64,
    ) -> Self {
        let drives = DriveAxis::all(&network.devices, images);
        let expected = group.iter(main).map(|device| {
            let io = device.io_raw();
            u16::from(!io.inputs().is_empty()) + 2 * u16::from(!io.outputs().is_empty())
        });
        let expected = expected.sum();
        let start_ns = now_ns + u64::from(network.cycle_ns);
        Self {
            main,
            exchange,
            group,
            drives,
            expected,
            cycle_ns: u64::from(network.cycle_ns),
            pacer: Pacer::new(network.cycle_ns, network.lead_ns, start_ns),
            last_reference: None,
            missed: 0,
            in_op: 0,
            counters: Counters::default(),
            next_mail: 0,
        }
    }

    /// Exchanges process data until every device is in OP.
    pub(crate) fn reach_op(
        &mut self,
        link: &mut impl FrameLink,
        network: &Network,
    ) -> Result<(), StartError> {
        let until_ns = link.now_ns() + MOST_TO_OP_NS;
        let mut cycles = 0;
        while self.in_op < network.devices.len() {
            self.cycle(link);
            cycles += 1;
            let late = link.now_ns() >= until_ns;
            if late || cycles % LOOK_EVERY == 0 {
                let look = find_refusal(self.main, network);
                let refusal = self.exchange.run(link, look, until_ns + MOST_TO_OP_NS).flatten();
                if let Some(refusal) = refusal {
                    return Err(refusal);
                }
            }
            if late {
                let names: Vec<&str> = network.devices.iter().map(|d| d.name.as_str()).collect();
                return Err(StartError::NoOp {
                    name: names.join(", "),
                    after_ms: MOST_TO_OP_NS / 1_000_000,
                });
            }
        }
        self.counters = Counters::default();
        self.exchange.losses = Losses::default();
        Ok(())
    }

    /// Waits for the time of the next frame, sends it, and takes what comes back.
    pub fn cycle(&mut self, link: &mut impl FrameLink) -> Cycle {
        self.pacer.catch_up(link.now_ns());
        let send_ns = self.pacer.next_ns();
        self.exchange.idle(link, send_ns);
        self.write_outputs();
        let until_ns = send_ns + self.cycle_ns * 3 / 4;
        let answer = self.exchange.run(link, self.group.tx_rx_dc(self.main), until_ns);
        let reply = match answer {
            Some(Ok(response)) => {
                let in_op = |state: &&SubDeviceState| **state == SubDeviceState::Op;
                self.in_op = response.subdevice_states.iter().filter(in_op).count();
                let time = response.extra.dc_system_time;
                self.judge(response.working_counter, time, link.now_ns())
            }
            Some(Err(_)) | None => Reply::Lost,
        };
        self.count(reply);
        if matches!(reply, Reply::Complete { .. }) {
            self.read_inputs();
        }
        Cycle { reply, missed_in_a_row: self.missed, in_op: self.in_op }
    }

    fn judge(&mut self, counter: u16, reference_ns: u64, now_ns: u64) -> Reply {
        if !self.is_plausible(reference_ns, now_ns) {
            self.pacer.missed();
            return Reply::NoReference;
        }
        self.last_reference = Some((reference_ns, now_ns));
        let phase_ns = self.pacer.answered(reference_ns);
        if counter == self.expected {
            Reply::Complete { reference_ns, phase_ns }
        } else {
            Reply::Short { counter, expected: self.expected }
        }
    }

    /// Returns whether the reference clock has gone on as the master's own has.
    fn is_plausible(&self, reference_ns: u64, now_ns: u64) -> bool {
        let Some((last_ns, at_ns)) = self.last_reference else { return reference_ns > 0 };
        let passed = now_ns.saturating_sub(at_ns);
        reference_ns > last_ns && reference_ns - last_ns <= passed + passed / 100 + MOST_LEAP_NS
    }

    fn count(&mut self, reply: Reply) {
        let counter = match reply {
            Reply::Complete { .. } => &mut self.counters.complete,
            Reply::Short { .. } => &mut self.counters.short,
            Reply::Lost => &mut self.counters.lost,
            Reply::NoReference => &mut self.counters.no_reference,
        };
        *counter += 1;
        match reply {
            Reply::Complete { .. } => self.missed = 0,
            _ => self.missed = self.missed.saturating_add(1),
        }
        if reply == Reply::Lost {
            self.pacer.missed();
        }
    }

    fn write_outputs(&mut self) {
        for drive in &mut self.drives {
            if let Ok(device) = self.group.subdevice(self.main, drive.device) {
                drive.send(device.io_raw_mut().outputs());
            }
        }
    }

    fn read_inputs(&mut self) {
        for drive in &mut self.drives {
            if let Ok(device) = self.group.subdevice(self.main, drive.device) {
                drive.receive(device.io_raw().inputs());
            }
        }
    }

    /// Axes, in the order of the wire.
    pub fn drives(&self) -> &[DriveAxis] {
        &self.drives
    }

    /// Says what is wanted of an axis from the next cycle on.
    pub fn command(&mut self, axis: usize, command: DriveCommand) {
        if let Some(drive) = self.drives.get_mut(axis) {
            drive.set_command(command);
        }
    }

    /// Wants all axes without torque.
    pub fn switch_off(&mut self) {
        for drive in &mut self.drives {
            drive.set_command(DriveCommand { wanted: Wanted::Off, target: drive.sent_target() });
        }
    }

    /// Resets the fault of an axis: by an operator's order alone.
    pub fn reset_fault(&mut self, axis: usize) {
        if let Some(drive) = self.drives.get_mut(axis) {
            drive.reset_fault();
        }
    }

    /// Copies the inputs of a device; returns how many bytes there are.
    pub fn inputs(&self, device: usize, into: &mut [u8]) -> usize {
        let Ok(device) = self.group.subdevice(self.main, device) else { return 0 };
        let io = device.io_raw();
        let bytes = io.inputs();
        let copied = bytes.len().min(into.len());
        into[..copied].copy_from_slice(&bytes[..copied]);
        bytes.len()
    }

    /// Sets the outputs of a device without axes; returns how many bytes there are.
    pub fn set_outputs(&mut self, device: usize, from: &[u8]) -> usize {
        let Ok(device) = self.group.subdevice(self.main, device) else { return 0 };
        let mut io = device.io_raw_mut();
        let bytes = io.outputs();
        let copied = bytes.len().min(from.len());
        bytes[..copied].copy_from_slice(&from[..copied]);
        bytes.len()
    }

    /// Frames since the start.
    pub fn counters(&self) -> Counters {
        Counters { losses: self.exchange.losses, ..self.counters }
    }

    /// Working counter if every device executes a frame.
    pub fn expected_counter(&self) -> u16 {
        self.expected
    }

    /// Looks whether a device has something in its mailbox, the next one at each call, in what is
    /// left of the cycle; an emergency is kept.
    pub fn poll_mail(&mut self, link: &mut impl FrameLink) {
        let devices = self.exchange.mailboxes.len();
        if devices == 0 {
            return;
        }
        let at = self.next_mail % devices;
        self.next_mail = at + 1;
        let mailbox = self.exchange.mailboxes[at];
        if mailbox == 0 {
            return;
        }
        let station = FIRST_STATION + at as u16;
        let main = self.main;
        let mail = async {
            let read = |register: u16| Command::fprd(station, register).ignore_wkc();
            let status: u8 = read(MAIL_STATUS).receive(main).await?;
            if status & MAIL_IS_THERE != 0 {
                let length: u16 = read(MAIL_LENGTH).receive(main).await?;
                read(mailbox).receive_slice(main, length).await?;
            }
            Ok::<(), ethercrab::error::Error>(())
        };
        let until_ns = self.pacer.next_ns().saturating_sub(self.cycle_ns / 8);
        // what does not come in time is asked for again at the next turn
        let _ = self.exchange.run(link, mail, until_ns);
    }

    /// Emergencies since the master was made, the oldest first, and how many there were in all.
    pub fn emergencies(&self) -> (&[Emergency], usize) {
        (self.exchange.emergencies(), self.exchange.emergency_count)
    }
}
