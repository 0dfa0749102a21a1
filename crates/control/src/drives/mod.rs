//! The door for machines: what carries commands to a machine, and its feedback back.
//!
//! ```text
//!   Control ─► Door::open ─► Box<dyn Drives> ─► executor ──Command──► machine
//!                 │                                     ◄──Feedback──
//!                 ├── simulated    a simulated machine in this process
//!                 ├── remote       a machine simulator in another process, over a socket
//!                 ├── process      a kernel in the servo thread of `leadscrew drives`, over shared memory
//!                 └── hal          the same in LinuxCNC's HAL
//! ```
//!
//! A further kind of machine is a file here with its [`Door`], and its line in [`DOORS`]. A crate
//! that brings a kind of its own hands its [`Door`] over in
//! [`ControlOptions::drives`](crate::ControlOptions::drives). Each kind passes the suite
//! `test_support::drives`.
pub mod hal;
mod process;
pub mod remote;
mod seat;
pub mod simulated;

pub use seat::{SeatText, SharedSeat};
pub use simulated::Simulation;

use crate::Refused;
use bus::{EngagedTool, Machine};
use canon::{Position, ToolLibrary};
use sim::Fault;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use store::machine::{MachineFile, StockMaterial};
use wire::Welcome;

/// A machine as its control holds it.
pub trait Drives: Machine + Send {
    /// Tells the machine, with each command from now on, which tool only recovery may take out.
    /// A machine that ends with its control does not keep it.
    fn engage(&mut self, tool: Option<EngagedTool>);

    /// Tells a simulated machine that a new tool is in the place of a broken one. On a real one
    /// that was done by hand.
    fn renew_tool(&mut self, number: u32);

    /// Why the machine cannot be reached any more, in a sentence.
    fn lost(&self) -> Option<String>;

    /// True where machine and drives go on when their control ends: a tool that is left in the work
    /// is for `recover`.
    fn outlives_control(&self) -> bool;

    /// The place of the kernel, where that runs in the servo thread of another process. Commands
    /// and feedback are exchanged there, and [`Machine::exchange`] only lets time pass.
    fn seat(&mut self) -> Option<&mut SharedSeat> {
        None
    }

    /// The simulated machine, where it is in this process.
    fn simulation(&self) -> Option<&Simulation> {
        None
    }

    /// As [`Drives::simulation`].
    fn simulation_mut(&mut self) -> Option<&mut Simulation> {
        None
    }
}

/// A kind of machine.
#[derive(Debug)]
pub struct Door {
    /// The kind's name, as `--drives` takes it.
    pub name: &'static str,
    /// What its machines are reached by; `None` where there is only one.
    pub address: Option<&'static str>,
    /// Connects with a machine of this kind.
    pub open: fn(&Opening<'_>) -> Result<Opened, Refused>,
}

/// The kinds of machines that this program leads.
pub const DOORS: [&Door; 4] = [&simulated::DOOR, &remote::DOOR, &process::DOOR, &hal::DOOR];

/// A kind of machine, and which one of it.
#[derive(Clone, Debug)]
pub struct DrivesChoice {
    /// The kind.
    pub door: &'static Door,
    /// Where the machine is reached, for a kind that has addresses.
    pub address: Option<PathBuf>,
}

impl Default for DrivesChoice {
    fn default() -> Self {
        Self::of(&simulated::DOOR)
    }
}

impl DrivesChoice {
    /// A machine of this kind, of which there is only one.
    pub const fn of(door: &'static Door) -> Self {
        Self { door, address: None }
    }

    /// The machine simulator that listens on a socket.
    pub const fn simulator(socket: PathBuf) -> Self {
        Self { door: &remote::DOOR, address: Some(socket) }
    }
}

/// As `--drives` takes it: `hal`, `simulator:PATH`.
impl FromStr for DrivesChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, address) = match text.split_once(':') {
            Some((name, address)) => (name, Some(address).filter(|address| !address.is_empty())),
            None => (text, None),
        };
        let door = DOORS.into_iter().find(|door| door.name == name);
        match door {
            Some(door) if door.address.is_some() == address.is_some() => {
                Ok(Self { door, address: address.map(PathBuf::from) })
            }
            _ => Err(format!("expected {}", DOORS.map(Door::form).join(", "))),
        }
    }
}

impl Door {
    /// How a machine of this kind is named: `hal`, `simulator:PATH`.
    fn form(&self) -> String {
        self.address.map_or_else(|| self.name.to_owned(), |what| format!("{}:{what}", self.name))
    }
}

/// What a machine is opened for.
pub struct Opening<'a> {
    /// The machine as its file describes it.
    pub machine: &'a MachineFile,
    /// Where the machine is reached.
    pub address: Option<&'a Path>,
    /// The control keeps a sync record: it can recover a tool that it left in the work.
    pub keeps_record: bool,
    /// The control keeps real time.
    pub is_real_time: bool,
    /// What a simulated machine in this process cuts, and with what.
    pub tools: &'a ToolLibrary,
    /// Material of its stock.
    pub material: StockMaterial,
    /// Zero of its stock, machine coordinates.
    pub zero: &'a Position,
    /// Seed of what the control does not know of it.
    pub seed: u64,
}

/// A machine that was opened.
pub struct Opened {
    /// The machine.
    pub drives: Box<dyn Drives>,
    /// Identity of a machine in another process, and what it has kept of a tool in its work; a
    /// machine behind a [`SharedSeat`] says it when its session has begun.
    pub welcome: Option<Welcome>,
}

/// What a control tries on a simulated machine in its own process; on any other machine each of
/// these does nothing, and is done by hand.
impl dyn Drives + '_ {
    /// Number of holes that were tapped and, as far as is known, not drilled.
    pub fn assumed_holes(&self) -> usize {
        let holes = self.simulation().map(|simulated| simulated.machine().holes());
        holes.map_or(0, |holes| holes.iter().filter(|hole| hole.assumed).count())
    }

    /// Makes a fault of the machine come now.
    pub fn strike(&mut self, fault: Fault) {
        if let Some(simulated) = self.simulation_mut() {
            simulated.strike(fault);
        }
    }

    /// Ends a fault of the machine.
    pub fn repair(&mut self, fault: Fault) {
        if let Some(simulated) = self.simulation_mut() {
            simulated.repair(fault);
        }
    }

    /// Clamps blanks on the work spindle.
    ///
    /// # Errors
    /// They cannot be ground on this machine; nothing is changed.
    pub fn clamp(&mut self, grinding: sim::Grinding) -> Result<(), Refused> {
        let Some(simulated) = self.simulation_mut() else { return Ok(()) };
        simulated.machine_mut().clamp(grinding).map_err(|problems| {
            Refused::because(format!("cams cannot be ground here: {}", problems.join("; ")))
        })
    }

    /// Clamps a stock of these dimensions.
    pub fn clamp_stock(&mut self, stock: &sim::Stock, bar: Option<sim::Bar>) {
        if let Some(simulated) = self.simulation_mut() {
            simulated.machine_mut().clamp_stock(stock, bar);
        }
    }

    /// Clamps another workpiece.
    pub fn renew_work(&mut self) {
        if let Some(simulated) = self.simulation_mut() {
            simulated.machine_mut().renew_work();
        }
    }

    /// True where the control is gone, by a simulated fault: the kernel must not tick.
    pub fn is_abandoned(&self) -> bool {
        self.simulation().is_some_and(Simulation::is_abandoned)
    }

    /// Lets a period pass without a control.
    pub fn wait(&mut self) {
        if let Some(simulated) = self.simulation_mut() {
            simulated.wait();
        }
    }

    /// Brings power and control back.
    pub fn mend(&mut self) {
        if let Some(simulated) = self.simulation_mut() {
            simulated.mend();
        }
    }

    /// The same machine in the same state, to try something on.
    pub fn copy(&self) -> Option<Box<dyn Drives>> {
        let simulated = self.simulation()?.clone();
        Some(Box::new(simulated))
    }
}
