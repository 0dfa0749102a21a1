//! The servo process on a network: a frame, a period of the kernel, the next frame.
//!
//! ```text
//!   Bus::cycle ─► MachineDrives::read ─► Handover ─► ServoProcess::update ─► Handover ─► MachineDrives::write
//!      ▲  the frame of this period, with what the period before has commanded                    │
//!      └─────────────────────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! The network is the master of time: a period begins when its frame is due by the reference clock.
//! A network that is lost is started anew, beneath the same process: what it keeps of a tool in the
//! work outlives that.
use bus::{Command, Feedback, Report};
use ethercat::{
    Ahead, Bus, Counters, Cycle, FrameLink, MachineDrives, Master, Network, Reply, StartError,
};
use shm::{Fieldbus, ServoProcess, WriteTo};
use units::Time;

/// A network whose frames do not come for so long is lost, ns.
const LOST_NS: u64 = 200_000_000;
/// From one try to start a lost network to the next, ns.
const AGAIN_NS: u64 = 1_000_000_000;

/// What goes from the network to the kernel and back in a period.
#[derive(Clone, Copy, Debug, Default)]
pub struct Handover {
    feedback: Feedback,
    /// The feedback is of this period.
    is_new: bool,
    commanded: Option<(Command, WriteTo)>,
    now_ns: i64,
}

impl Fieldbus for Handover {
    fn read(&mut self, time: Time) -> Feedback {
        if self.is_new {
            self.feedback.time = time;
        }
        self.feedback
    }

    fn write(&mut self, command: &Command, _: &Report, to: &WriteTo) {
        self.commanded = Some((*command, *to));
    }

    fn off(&mut self) {
        self.commanded = None;
    }

    fn now_ns(&self) -> i64 {
        self.now_ns
    }
}

/// What there is to say of a network.
#[derive(Clone, Debug, PartialEq)]
pub enum DrivesReport {
    /// All devices are in OP.
    Leads,
    /// Something that a person should know.
    Notice(String),
}

/// Drives on a network, led by a servo process.
pub struct EthercatDrives<'n, L> {
    process: ServoProcess<Handover>,
    drives: MachineDrives,
    network: &'n Network,
    link: L,
    counters: Counters,
}

impl<'n, L: FrameLink> EthercatDrives<'n, L> {
    /// Drives of this network behind a link.
    pub const fn new(
        process: ServoProcess<Handover>,
        drives: MachineDrives,
        network: &'n Network,
        link: L,
    ) -> Self {
        let counters = Counters::new();
        Self { process, drives, network, link, counters }
    }

    /// Frames of the last start.
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// Leads the drives until `is_to_end` and everything stands. A network that is lost later is
    /// started anew as often as it takes.
    ///
    /// # Errors
    /// The first start is refused.
    pub fn run(
        &mut self,
        master: &mut Master<'_>,
        mut is_to_end: impl FnMut(&mut L) -> bool,
        mut say: impl FnMut(DrivesReport),
    ) -> Result<(), StartError> {
        let mut refused: Option<StartError> = None;
        let mut has_run = false;
        loop {
            match master.start(&mut self.link) {
                Ok(mut bus) => {
                    has_run = true;
                    refused = None;
                    self.drives.restart();
                    say(DrivesReport::Leads);
                    if self.lead(&mut bus, &mut is_to_end, &mut say) {
                        return Ok(());
                    }
                }
                Err(why) if !has_run => return Err(why),
                Err(why) => {
                    if refused.as_ref() != Some(&why) {
                        say(DrivesReport::Notice(format!("the network cannot be started: {why}")));
                        refused = Some(why);
                    }
                }
            }
            if self.wait_blind(&mut is_to_end) {
                return Ok(());
            }
        }
    }

    /// Leads drives that are in OP; false if the network is lost.
    fn lead(
        &mut self,
        bus: &mut Bus<'_, '_>,
        is_to_end: &mut impl FnMut(&mut L) -> bool,
        say: &mut impl FnMut(DrivesReport),
    ) -> bool {
        let mut missed_since = None;
        loop {
            if is_to_end(&mut self.link) {
                self.process.leave();
                if self.process.is_off() {
                    self.send_off(bus);
                    return true;
                }
            }
            let cycle = self.cycle(bus);
            self.counters = bus.counters();
            if let Some(fault) = self.drives.take_fault() {
                let name = self.name_of(fault.drive);
                let code = fault.code;
                say(DrivesReport::Notice(format!(
                    "drive {name} has a fault, error code {code:04X}"
                )));
            }
            if matches!(cycle.reply, Reply::Complete { .. }) {
                missed_since = None;
                continue;
            }
            let now_ns = self.link.now_ns();
            let since = *missed_since.get_or_insert(now_ns);
            if now_ns - since > LOST_NS {
                let devices = self.network.devices.len();
                say(DrivesReport::Notice(format!(
                    "the network is lost: no complete frame for {} ms, {} of {devices} devices in OP",
                    LOST_NS / 1_000_000,
                    cycle.in_op
                )));
                return false;
            }
        }
    }

    /// A period of the network and of the kernel.
    fn cycle(&mut self, bus: &mut Bus<'_, '_>) -> Cycle {
        let Self { process, drives, link, network, .. } = self;
        let cycle = bus.cycle(link);
        let handover = process.fieldbus_mut();
        handover.is_new = matches!(cycle.reply, Reply::Complete { .. });
        handover.feedback = Feedback { time: handover.feedback.time, ..drives.read(bus, &cycle) };
        handover.now_ns = link.now_ns().cast_signed();
        process.update(u64::from(network.cycle_ns));
        match process.fieldbus_mut().commanded {
            Some((command, to)) => {
                let (axes, spindles) = (to.obeys_after, to.spindles_obey_after);
                drives.write(bus, &command, &Ahead { axes, spindles });
            }
            None => drives.off(bus),
        }
        cycle
    }

    /// Sends what switches everything off.
    fn send_off(&mut self, bus: &mut Bus<'_, '_>) {
        self.drives.off(bus);
        for _ in 0..2 {
            bus.cycle(&mut self.link);
        }
    }

    /// Periods without a network: sessions end, none finds a machine that is not there. True if it
    /// is to end.
    fn wait_blind(&mut self, is_to_end: &mut impl FnMut(&mut L) -> bool) -> bool {
        let cycle_ns = u64::from(self.network.cycle_ns);
        let until_ns = self.link.now_ns() + AGAIN_NS;
        let mut next_ns = self.link.now_ns();
        while next_ns < until_ns {
            next_ns += cycle_ns;
            while self.link.now_ns() < next_ns {
                self.link.wait(next_ns);
            }
            if is_to_end(&mut self.link) {
                self.process.leave();
                if self.process.is_off() {
                    return true;
                }
            }
            let handover = self.process.fieldbus_mut();
            (handover.is_new, handover.now_ns) = (false, next_ns.cast_signed());
            handover.feedback.axes.iter_mut().for_each(|axis| axis.ready = false);
            handover.feedback.spindles.iter_mut().for_each(|spindle| spindle.ready = false);
            self.process.update(cycle_ns);
        }
        false
    }

    fn name_of(&self, drive: usize) -> &str {
        let slots = self.network.devices.iter().flat_map(|of| of.slots.iter().map(|_| &of.name));
        slots.into_iter().nth(drive).map_or("?", String::as_str)
    }
}
