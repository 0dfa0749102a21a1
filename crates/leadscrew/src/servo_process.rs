//! `leadscrew drives`: kernel and servo thread in a process of their own, for a control that leads
//! them over shared memory and may end at any moment.
//!
//! ```text
//!   control ═ shared memory ═ ServoProcess, a period by the clock: Fieldbus ─► kernel ─► Fieldbus
//!                                                                     │
//!                                                                     └── the simulated machine
//! ```
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
    /// Priority of the servo thread among those that are run by deadline (`SCHED_FIFO`), 1 to 99.
    pub priority: u8,
}

/// See the module's header.
pub struct DrivesProcess {
    process: ServoProcess<SimulatedDrives>,
    period: Duration,
    priority: u8,
    machine: String,
}

impl DrivesProcess {
    /// A simulated machine, its drives off.
    ///
    /// # Errors
    /// Machine or tools cannot be read, no machine can be as the file says, or the operating system
    /// refuses shared memory.
    pub fn new(options: DrivesOptions) -> Result<Self, Refused> {
        let session = Session::load(&options.source, Path::new("-"), b"")?;
        let file = &session.machine;
        let seed = options.seed.unwrap_or(u64::from(file.simulation.seed));
        let (material, zero) = (file.setup.stock.material, session.work_zero());
        let simulated = config::simulator(file, &session.tools, material, seed, &zero);
        let machine = simulated::build(file, simulated::switched_on(simulated))?;
        let drives = SimulatedDrives { machine, began: now() };
        let process = ServoProcess::new(
            drives,
            ServoProcessOptions {
                name: options.name,
                machine: Some(file.name.clone()),
                axes: std::array::from_fn(|index| file.axes[index].is_some()),
                spindles: file.spindles.len(),
                not_called: "the servo thread has not begun",
                axis_missing: |_| "leadscrew drives leads none".into(),
                undriven: |names| format!("leadscrew drives has no {names}"),
            },
        );
        Ok(Self {
            process: process.map_err(Refused::because)?,
            period: Duration::from_secs_f64(file.control.period.value()),
            priority: options.priority,
            machine: file.name.clone(),
        })
    }

    /// Name of the machine.
    pub fn machine(&self) -> &str {
        &self.machine
    }

    /// Runs the servo thread, which is the calling one, until `stop` is set and everything stands;
    /// what the operating system has refused of what real time needs goes to `refused`, in
    /// sentences.
    pub fn run(mut self, stop: &AtomicBool, refused: impl Fn(&str)) {
        for sentence in run_by_deadline(self.priority) {
            refused(&sentence);
        }
        let period_ns = u64::try_from(self.period.as_nanos()).unwrap_or(u64::MAX);
        let mut clock = PeriodClock::new(self.period);
        loop {
            if stop.load(Ordering::Acquire) {
                self.process.leave();
                if self.process.is_off() {
                    return;
                }
            }
            self.process.update(period_ns);
            clock.wait();
        }
    }
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
