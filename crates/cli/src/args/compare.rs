//! The arguments of `leadscrew compare`.
use super::ProgramArgs;
use clap::Args;
use std::path::PathBuf;

/// `leadscrew compare`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CompareArgs {
    /// The program whose taps are compared
    pub(crate) program: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Instead of a program: holes of this thread [default: M6]
    #[arg(long, value_name = "THREAD", conflicts_with = "program")]
    pub(crate) size: Option<String>,
    /// Speed, rev/min: of the holes of a size, and at which the stopping time is taken
    #[arg(long, value_name = "RPM", default_value_t = 2000.0)]
    pub(crate) speed: f64,
    /// Depth of the holes, mm [default: 5 mm and 1.5 diameters]
    #[arg(long, value_name = "MM")]
    pub(crate) depth: Option<f64>,
    /// Holes tapped each way
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub(crate) samples: u32,
    /// Seed of the scatter
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Stopping time of the spindle [default: the machine's own ramp]
    #[arg(long, value_name = "SECONDS")]
    pub(crate) stopping_time: Option<f64>,
    /// Scatter of the spindle speed, 1σ
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0)]
    pub(crate) speed_scatter: f64,
    /// Scatter of the stopping time, 1σ
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0)]
    pub(crate) stopping_scatter: f64,
    /// Scatter of the relay's delay, 1σ
    #[arg(long, value_name = "MS", default_value_t = 5.0)]
    pub(crate) relay_scatter: f64,
    /// A page with table and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}
