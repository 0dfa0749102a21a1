//! The arguments of `leadscrew commission`.
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `leadscrew commission`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CommissionArgs {
    /// Steps, in this order [default: all]
    #[arg(value_enum, value_name = "STEP")]
    pub(crate) steps: Vec<CommissionStep>,
    /// The machine as its file takes it to be: a name from `leadscrew machine list`, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "tapping-center")]
    pub(crate) machine: String,
    /// The machine as it is, on the simulator [default: the file's, as the seed draws it]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) plant: Option<String>,
    /// Seed of the machine that is simulated [default: the machine file's]
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Factor on how far play, stiffness and friction vary about the file
    #[arg(long, value_name = "FACTOR", default_value_t = 2.0)]
    pub(crate) scatter: f64,
    /// Write the file with what was found
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) write: Option<PathBuf>,
    /// What is printed
    #[arg(long, value_enum, default_value_t = CommissionOutput::Text)]
    pub(crate) format: CommissionOutput,
    /// A page with values and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}

/// A step of commissioning.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CommissionStep {
    /// Friction, weight, masses, spring and play of linear axes
    Axes,
    /// Inertia, friction and ramps of the first spindle
    Spindle,
    /// Circles and taps in air with the file before and after
    Proof,
}

/// What `leadscrew commission` prints.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CommissionOutput {
    /// A table
    Text,
    /// One JSON object
    Json,
}
