//! The simulated machine with its drives and encoders, as a process of its own at a Unix socket.
//!
//! ```text
//!   control ══ Unix socket ══► session: command ─► monitor ─► exchange ─► feedback
//!                  │ ends, is silent, orders what no drive obeys, or the power is cut
//!                  ▼
//!              drives left alone: coast, quick stop or coupled stop ─► everything stands ─► next session
//! ```
//!
//! In lock-step time waits for the control: the same inputs give the same outputs. When the control
//! is gone the machine simulator runs down in its own time. With `--real-time` a period lasts as
//! long as on a machine, and a control that is late gets its last command repeated until the
//! drives' watchdog has had enough. Workpiece, tap and encoders live here and outlive every
//! control.
mod command_monitor;
mod exclusive;
mod process;
mod retained;

mod serve;

use bus::DriveReaction;
use control::Refused;
use control::drives::remote::{connect, gone};
use control::job::ProgramOptions;
use std::path::Path;
use units::Time;
use wire::Order;

pub use process::SimulatorProcess;
pub use serve::Listening;

/// Which machine is simulated, and what happens to it and to its controls.
#[derive(Clone, Debug)]
pub struct SimulatorOptions {
    /// Machine and tools, as for a program that is run on it.
    pub source: ProgramOptions,
    /// Material of the workpiece; that of the machine's set-up if `None`.
    pub material: Option<String>,
    /// Seed of what its control does not know; that of the machine's file if `None`.
    pub seed: Option<u64>,
    /// Time passes as on the wall, instead of waiting for the control.
    pub real_time: bool,
    /// Machine times at which the mains fail; they come back for the next control.
    pub power_cuts: Vec<Time>,
    /// What the drives do when the control falls silent; as in the machine's file if `None`.
    pub on_link_loss: Option<DriveReaction>,
    /// What they do when the mains fail; as in the machine's file if `None`.
    pub on_power_loss: Option<DriveReaction>,
    /// No spindle's encoder counts turns without power, whatever the machine's file says.
    pub single_turn: bool,
    /// Number of this very machine.
    pub serial: u64,
    /// Epoch of its encoders; a new one, as for new encoders, if `None`.
    pub epoch: Option<u64>,
}

/// What the machine simulator that listens at `path` answers to an order: its status, as JSON.
///
/// # Errors
/// No machine simulator listens there, or it does not answer.
pub fn order(path: &Path, order: Order) -> Result<String, Refused> {
    wire::order(connect(path)?, order).map_err(|e| gone(path, &e))
}
