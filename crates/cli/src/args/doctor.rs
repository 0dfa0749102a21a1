//! The arguments of `leadscrew doctor`.
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `leadscrew doctor`.
#[derive(Args, Debug, Clone)]
pub(crate) struct DoctorArgs {
    /// The machine to be led: a name from `leadscrew machine list`, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "tapping-center")]
    pub(crate) machine: String,
    /// Network interface of EtherCAT drives [default: the machine's]
    #[arg(long, value_name = "IFACE")]
    pub(crate) interface: Option<String>,
    /// How long latency is measured, s; 0: not at all
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    pub(crate) seconds: f64,
    /// Keep every core busy meanwhile, as building or a slicer does
    #[arg(long)]
    pub(crate) load: bool,
    /// What is printed
    #[arg(long, value_enum, default_value_t = DoctorOutput::Text)]
    pub(crate) format: DoctorOutput,
    /// A page with the findings and a picture of lateness
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}

/// What `leadscrew doctor` prints.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DoctorOutput {
    /// Topic by topic
    Text,
    /// One JSON object
    Json,
}
