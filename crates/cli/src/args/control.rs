//! The arguments of `leadscrew control`.
use super::ProgramArgs;
use clap::Args;
use control::DrivesChoice;
use std::path::PathBuf;

/// `leadscrew control`.
#[derive(Args, Debug, Clone)]
pub(crate) struct ControlArgs {
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Take requests from a file, a line each; `-` is standard input [default: the terminal]
    #[arg(long, value_name = "FILE")]
    pub(crate) script: Option<PathBuf>,
    /// Lead drives instead of a machine that is simulated in this process: `hal`, those of the
    /// component `leadscrew` in LinuxCNC's HAL that the machine's file names in [hal];
    /// `simulator:PATH`, a machine simulator that listens there
    #[arg(long, value_name = "KIND", conflicts_with_all = ["seed", "clamped"])]
    pub(crate) drives: Option<DrivesChoice>,
    /// Seed of the machine that is simulated: what its control does not know
    /// (`machine show NAME --seed N`)
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Keep offsets, tools, alarms and the last program in this folder [default: nothing is kept]
    #[arg(long, value_name = "DIR")]
    pub(crate) state: Option<PathBuf>,
    /// Clamp the simulated stock this far from where the machine's file says, millimetres, as in
    /// X0.4,Y-0.3,Z1.2
    #[arg(long, value_name = "AXES")]
    pub(crate) clamped: Option<String>,
    /// By the clock, with kernel and machine in a servo thread of their own; in a script as well
    #[arg(long)]
    pub(crate) real_time: bool,
}
