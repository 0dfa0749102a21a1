//! The arguments of `leadscrew compensation`.
use super::{Switch, WorkSpeedChoice};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `leadscrew compensation`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CompensationArgs {
    /// The cam library (TOML)
    pub(crate) library: PathBuf,
    /// The machine: a name from `leadscrew machine list`, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "cam-grinder")]
    pub(crate) machine: String,
    /// Speeds of the work, rev/min
    #[arg(long, value_delimiter = ',', value_name = "RPM", default_values_t = [10.0, 30.0, 60.0, 100.0])]
    pub(crate) speeds: Vec<f64>,
    /// Numbers of the cams [default: all of the library]
    #[arg(long, value_delimiter = ',', value_name = "P")]
    pub(crate) cams: Vec<u32>,
    /// Revolutions that are learnt from
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) learn: u32,
    /// Feed-forward of X: without it the lag of its loop shows
    #[arg(long, value_enum, default_value_t = Switch::Off)]
    pub(crate) feed_forward: Switch,
    /// How the work turns [default: as the cam library says]
    #[arg(long, value_enum)]
    pub(crate) work_speed: Option<WorkSpeedChoice>,
    /// What is printed
    #[arg(long, value_enum, default_value_t = CompensationOutput::Text)]
    pub(crate) format: CompensationOutput,
    /// A page with the table and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}

/// What `leadscrew compensation` prints.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CompensationOutput {
    /// A table
    Text,
    /// One JSON object
    Json,
}
