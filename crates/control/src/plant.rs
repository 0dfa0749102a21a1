//! What the kernel controls: a simulated machine within this process, or a machine simulator in
//! another one.
use crate::{Refused, config};
use bus::{Command, Feedback, Machine, Truth};
use sim::{Fault, Faulty, SimulatedMachine};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;
use units::Time;
use wire::{Engagement, Remote, Welcome};

/// How long a control waits for a machine simulator to answer.
const ANSWER: Duration = Duration::from_secs(20);

/// A machine.
pub enum Plant {
    /// Within this process.
    Inside(Box<Faulty<SimulatedMachine>>),
    /// At the other end of a socket.
    Outside(Box<Remote<UnixStream>>),
    /// Drives that a component of LinuxCNC's HAL leads: a servo thread in another process, where
    /// the kernel is.
    Hal(Box<HalDrives>),
}

/// The drives of a HAL component, as this process has them: they obey the kernel that is there, and
/// no other.
pub struct HalDrives {
    /// The component; taken by who speaks with it.
    pub(crate) side: Option<shm::ControlSide>,
    /// What its kernel is made with, beside the configuration.
    pub(crate) silent_after: Time,
    pub(crate) obeys_after: [Time; bus::AXES],
    pub(crate) spindles_obey_after: [Time; bus::SPINDLES],
    period: Time,
    feedback: Feedback,
}

impl HalDrives {
    /// What the component keeps of a tool in the work.
    pub(crate) fn retained(&self) -> Option<shm::RetainedMemory> {
        self.side.as_ref().map(shm::ControlSide::retained)
    }

    /// A period without the component: nothing moves, and nothing is ready.
    fn pass(&mut self) -> &Feedback {
        self.feedback.time += self.period;
        &self.feedback
    }
}

/// The component of LinuxCNC's HAL that this machine's file names.
///
/// # Errors
/// The file names none, or it is not there, or another control has it.
pub fn hal(file: &store::machine::MachineFile) -> Result<Plant, Refused> {
    let Some(hal) = &file.hal else {
        return Err(Refused::because(format!(
            "the machine {} has no [hal] section: it says how HAL's drives are led, as in machines/hal/mill.toml",
            file.name
        )));
    };
    let side =
        shm::ControlSide::find(&hal.component).map_err(|why| Refused::because(why.to_string()))?;
    let period = file.control.period;
    Ok(Plant::Hal(Box::new(HalDrives {
        side: Some(side),
        silent_after: hal.silent_after,
        obeys_after: [period * hal.obeys_after_periods; bus::AXES],
        spindles_obey_after: [period * hal.obeys_after_periods; bus::SPINDLES],
        period,
        feedback: Feedback { tool: Some(0), ..Feedback::default() },
    })))
}

impl Plant {
    /// A simulated machine in which nothing fails.
    pub fn simulated(machine: SimulatedMachine) -> Self {
        Self::simulated_with_seed(machine, 0)
    }

    /// The same; the seed is that of faults which scatter.
    pub fn simulated_with_seed(machine: SimulatedMachine, seed: u64) -> Self {
        Self::Inside(Box::new(Faulty::new(machine, &[], seed)))
    }

    /// Holes that were tapped and, as far as is known, not drilled.
    pub fn assumed_holes(&self) -> usize {
        match self {
            Self::Inside(machine) => {
                machine.machine().holes().iter().filter(|hole| hole.assumed).count()
            }
            Self::Outside(_) | Self::Hal(_) => 0,
        }
    }

    /// Let a fault of the machine come now.
    pub fn strike(&mut self, fault: Fault) {
        if let Self::Inside(machine) = self {
            machine.strike(fault);
        }
    }

    /// Blanks are clamped on the work spindle of a machine that is simulated here; on any other one
    /// they are clamped by hand.
    ///
    /// # Errors
    /// They cannot be ground on this machine; nothing is changed.
    pub fn clamp(&mut self, grinding: sim::Grinding) -> Result<(), Refused> {
        let Self::Inside(machine) = self else { return Ok(()) };
        machine.machine_mut().clamp(grinding).map_err(|problems| {
            Refused::because(format!("cams cannot be ground here: {}", problems.join("; ")))
        })
    }

    /// A new tool is in the place of a broken one on a machine that is simulated, here or in
    /// another process.
    pub fn renew_tool(&mut self, number: u32) {
        match self {
            Self::Inside(machine) => machine.machine_mut().renew_tool(number),
            Self::Outside(remote) => remote.renew_tool(number),
            Self::Hal(_) => {}
        }
    }

    /// A stock of these dimensions is clamped on a machine that is simulated here; on any other one
    /// that is done by hand.
    pub fn clamp_stock(&mut self, stock: &sim::Stock, bar: Option<sim::Bar>) {
        if let Self::Inside(machine) = self {
            machine.machine_mut().clamp_stock(stock, bar);
        }
    }

    /// Another workpiece is clamped on a machine that is simulated here; on any other one that is
    /// done by hand.
    pub fn renew_work(&mut self) {
        if let Self::Inside(machine) = self {
            machine.machine_mut().renew_work();
        }
    }

    /// A fault of the machine is over.
    pub fn repair(&mut self, fault: Fault) {
        if let Self::Inside(machine) = self {
            machine.repair(fault);
        }
    }

    /// The control is gone: the kernel must not tick.
    pub fn is_abandoned(&self) -> bool {
        matches!(self, Self::Inside(machine) if machine.is_abandoned())
    }

    /// With each command from now on: the tool that is in the work. A machine within this process
    /// is gone with its control.
    pub fn engage(&mut self, engagement: Option<Engagement>) {
        if let Self::Outside(remote) = self {
            remote.engage(engagement);
        }
    }

    /// A period without a control.
    pub fn wait(&mut self) {
        if let Self::Inside(machine) = self {
            machine.wait();
        }
    }

    /// Power and control are back.
    pub fn mend(&mut self) {
        if let Self::Inside(machine) = self {
            machine.mend();
        }
    }

    /// The same machine in the same state, to try something on; another process has no copy.
    pub fn copy(&self) -> Option<Self> {
        match self {
            Self::Inside(machine) => Some(Self::Inside(machine.clone())),
            Self::Outside(_) | Self::Hal(_) => None,
        }
    }

    /// What is gone and why, in a sentence, once it is.
    pub fn lost(&self) -> Option<String> {
        match self {
            Self::Inside(_) | Self::Hal(_) => None,
            Self::Outside(remote) => {
                remote.lost().map(|why| format!("the machine simulator is gone: {why}"))
            }
        }
    }
}

/// A simulated machine of this file.
///
/// # Errors
/// It has numbers that no machine can have.
pub fn simulated(
    file: &store::machine::MachineFile,
    config: sim::Config,
) -> Result<SimulatedMachine, Refused> {
    let bar = config::bar(file, &config);
    let (bosses, setter) = config::touched(file, &config);
    let simulator = SimulatedMachine::new(config).map_err(|problems| {
        let problems = problems.join("; ");
        Refused::because(format!("the machine cannot be simulated: {problems}"))
    })?;
    let simulator =
        simulator.with_inputs(config::inputs(&file.simulation.inputs)).with_touched(bosses, setter);
    let simulator = match bar {
        Some(bar) => simulator.with_bar(bar),
        None => simulator,
    };
    let simulator = match config::plain_drive(file) {
        Some(drive) => simulator.with_plain_drive(drive),
        None => simulator,
    };
    Ok(match file.simulation.tap_wear {
        Some(wear) => simulator.with_tap_wear(sim::TapWear {
            life: wear.life,
            rise: wear.rise_share,
            scatter: wear.scatter_share,
        }),
        None => simulator,
    })
}

/// Which machine, which encoders: for the sync record.
pub fn identity(welcome: &Welcome) -> store::sync_record::Identity {
    store::sync_record::Identity {
        machine: welcome.machine.clone(),
        serial: welcome.serial,
        epoch: welcome.epoch,
    }
}

impl Machine for Plant {
    fn period(&self) -> Time {
        match self {
            Self::Inside(machine) => machine.period(),
            Self::Outside(remote) => remote.period(),
            Self::Hal(drives) => drives.period,
        }
    }

    fn feedback(&self) -> &Feedback {
        match self {
            Self::Inside(machine) => machine.feedback(),
            Self::Outside(remote) => remote.feedback(),
            Self::Hal(drives) => &drives.feedback,
        }
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        match self {
            Self::Inside(machine) => machine.exchange(command),
            Self::Outside(remote) => remote.exchange(command),
            Self::Hal(drives) => drives.pass(),
        }
    }

    fn truth(&self) -> Option<&Truth> {
        match self {
            Self::Inside(machine) => machine.truth(),
            Self::Outside(remote) => remote.truth(),
            Self::Hal(_) => None,
        }
    }
}

/// A connection to the machine simulator that listens there.
///
/// # Errors
/// Nothing listens there, or what does is no machine.
pub fn connect(path: &Path) -> Result<UnixStream, Refused> {
    let failed = |e| {
        let path = path.display();
        Refused::because(format!(
            "no machine simulator listens at {path}: {e}; start one with: leadscrew simulator --machine NAME --listen {path}"
        ))
    };
    let stream = UnixStream::connect(path).map_err(failed)?;
    stream.set_read_timeout(Some(ANSWER)).map_err(failed)?;
    Ok(stream)
}

/// What is said of a machine simulator that does not answer as it should.
pub fn gone(path: &Path, error: &wire::Error) -> Refused {
    Refused::because(format!("the machine simulator at {}: {error}", path.display()))
}
