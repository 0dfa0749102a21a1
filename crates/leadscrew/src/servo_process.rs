//! `leadscrew drives`: kernel and servo thread in a process of their own, for a control that leads
//! them over shared memory and may end at any moment.
//!
//! ```text
//!   control ═ shared memory ═ ServoProcess, a period by the clock: Fieldbus ─► kernel ─► Fieldbus
//!                                                                     │
//!                                                                     ├── the simulated machine
//!                                                                     └── an EtherCAT network
//! ```
use crate::ethercat::{DrivesReport, EthercatDrives, expected_network, machine_drives};
use bus::{Command, Feedback, Machine as _, Report};
use control::clock::{PeriodClock, now};
use control::drives::simulated;
use control::job::{ProgramOptions, Session};
use control::{Refused, config, run_by_deadline};
use shm::{Fieldbus, ServoProcess, ServoProcessOptions, WriteTo};
use sim::SimulatedMachine;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use store::machine::MachineFile;
use units::Time;

/// What a servo process leads.
#[derive(Clone, Debug)]
pub struct DrivesOptions {
    /// Machine and tools.
    pub source: ProgramOptions,
    /// Seed of what a control does not know of the machine; that of the machine's file if `None`.
    pub seed: Option<u64>,
    /// Name by which a control finds the process.
    pub name: String,
    /// Network interface, where it is another one than the machine's file says.
    pub interface: Option<String>,
    /// Priority of the servo thread among those that are run by deadline (`SCHED_FIFO`), 1 to 99.
    pub priority: u8,
}

/// See the module's header.
pub struct DrivesProcess {
    options: DrivesOptions,
    session: Session,
}

impl DrivesProcess {
    /// Drives of a machine that is read, not led yet.
    ///
    /// # Errors
    /// Machine or tools cannot be read.
    pub fn new(options: DrivesOptions) -> Result<Self, Refused> {
        let session = Session::load(&options.source, Path::new("-"), b"")?;
        Ok(Self { options, session })
    }

    /// Name of the machine.
    pub fn machine(&self) -> &str {
        &self.session.machine.name
    }

    /// Its drives, for a sentence.
    pub const fn kind(&self) -> &'static str {
        if self.session.machine.ethercat.is_some() { "EtherCAT" } else { "simulated" }
    }

    /// Runs the servo thread, which is the calling one, until `stop` is set and everything stands;
    /// what there is to say, and what the operating system has refused of what real time needs,
    /// goes to `say`.
    ///
    /// # Errors
    /// No machine can be as the file says, its network is not as expected, or the operating system
    /// refuses shared memory or the network interface.
    pub fn run(self, stop: &AtomicBool, say: impl FnMut(DrivesReport)) -> Result<(), Refused> {
        let Self { options, session } = self;
        if session.machine.ethercat.is_some() {
            lead_network(&options, &session.machine, stop, say)
        } else {
            lead_simulated(&options, &session, stop, say)
        }
    }
}

fn servo_process<F: Fieldbus>(
    fieldbus: F,
    name: &str,
    file: &MachineFile,
) -> Result<ServoProcess<F>, Refused> {
    let options = ServoProcessOptions {
        name: name.to_owned(),
        machine: Some(file.name.clone()),
        axes: std::array::from_fn(|index| file.axes[index].is_some()),
        spindles: file.spindles.len(),
        not_called: "the servo thread has not begun",
        axis_missing: |_| "leadscrew drives leads none".into(),
        undriven: |names| format!("leadscrew drives has no {names}"),
    };
    ServoProcess::new(fieldbus, options).map_err(Refused::because)
}

fn lead_simulated(
    options: &DrivesOptions,
    session: &Session,
    stop: &AtomicBool,
    mut say: impl FnMut(DrivesReport),
) -> Result<(), Refused> {
    let file = &session.machine;
    let seed = options.seed.unwrap_or(u64::from(file.simulation.seed));
    let (material, zero) = (file.setup.stock.material, session.work_zero());
    let simulated = config::simulator(file, &session.tools, material, seed, &zero);
    let machine = simulated::build(file, simulated::switched_on(simulated))?;
    let drives = SimulatedDrives { machine, began: now() };
    let mut process = servo_process(drives, &options.name, file)?;
    let period = Duration::from_secs_f64(file.control.period.value());
    for sentence in run_by_deadline(options.priority) {
        say(DrivesReport::Notice(sentence));
    }
    say(DrivesReport::Leads);
    let period_ns = u64::try_from(period.as_nanos()).unwrap_or(u64::MAX);
    let mut clock = PeriodClock::new(period);
    loop {
        if stop.load(Ordering::Acquire) {
            process.leave();
            if process.is_off() {
                return Ok(());
            }
        }
        process.update(period_ns);
        clock.wait();
    }
}

#[cfg(target_os = "linux")]
fn lead_network(
    options: &DrivesOptions,
    file: &MachineFile,
    stop: &AtomicBool,
    mut say: impl FnMut(DrivesReport),
) -> Result<(), Refused> {
    let stated = file.ethercat.as_ref().map(|network| &network.interface);
    let interface = options.interface.as_ref().or(stated).map_or("", String::as_str);
    let link = crate::ethercat::NetworkInterface::open(interface)?;
    let network = expected_network(file)?;
    let storage = ethercat::Storage::new();
    let mut master = ethercat::Master::new(&storage, &network)
        .ok_or_else(|| Refused::because("the storage of frames is in use"))?;
    let process = servo_process(crate::ethercat::Handover::default(), &options.name, file)?;
    for sentence in run_by_deadline(options.priority) {
        say(DrivesReport::Notice(sentence));
    }
    let mut drives = EthercatDrives::new(process, machine_drives(file)?, &network, link);
    let is_to_end = |_: &mut _| stop.load(Ordering::Acquire);
    let ended = drives.run(&mut master, is_to_end, &mut say);
    ended.map_err(|why| Refused::because(format!("{interface}: {why}")))?;
    let counters = drives.counters();
    say(DrivesReport::Notice(format!(
        "frames: {} complete, {} lost, {} short, {} without the reference clock",
        counters.complete, counters.lost, counters.short, counters.no_reference
    )));
    Ok(())
}

#[cfg(not(target_os = "linux"))]
fn lead_network(
    _: &DrivesOptions,
    _: &MachineFile,
    _: &AtomicBool,
    _: impl FnMut(DrivesReport),
) -> Result<(), Refused> {
    Err(Refused::because("drives on a network are led on Linux alone"))
}

/// The simulated machine in the place of a fieldbus.
struct SimulatedDrives {
    machine: SimulatedMachine,
    began: Instant,
}

impl Fieldbus for SimulatedDrives {
    fn read(&mut self, time: Time) -> Feedback {
        Feedback { time, ..*self.machine.feedback() }
    }

    fn write(&mut self, command: &Command, _: &Report, _: &WriteTo) {
        self.machine.exchange(command);
    }

    /// The tool stays where it is.
    fn off(&mut self) {
        let tool = self.machine.feedback().tool.unwrap_or(0);
        self.machine.exchange(&Command { tool, ..Command::default() });
    }

    fn now_ns(&self) -> i64 {
        i64::try_from((now() - self.began).as_nanos()).unwrap_or(i64::MAX)
    }
}
