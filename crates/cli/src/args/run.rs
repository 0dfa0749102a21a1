//! The arguments of `leadscrew run`.
use super::{Format, ProgramArgs};
use clap::{Args, ValueEnum};
use control::job::ProgramOptions;
use std::path::PathBuf;

/// `leadscrew run`.
#[allow(clippy::struct_excessive_bools)] // options, each asked for by itself
#[derive(Args, Debug, Clone)]
pub(crate) struct RunArgs {
    /// The program; `-` reads standard input
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Folder for report.html, certificate.json and trace.parquet; written whole or not at all
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// The report alone, without a folder for the rest [default: report.html here]
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "report.html")]
    pub(crate) report: Option<PathBuf>,
    /// The machine that is simulated, where it is another one than the control believes: the
    /// control keeps to --machine
    #[arg(long, value_name = "NAME|FILE", conflicts_with = "simulator")]
    pub(crate) plant: Option<String>,
    /// Seed of the machine that is simulated: what its control does not know
    /// (`machine show NAME --seed N`), and the cut's scatter
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Number of the workpiece on that machine: what varies from part to part is drawn for each
    /// [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), conflicts_with = "simulator")]
    pub(crate) part: Option<u32>,
    /// Material of the workpiece [default: the machine's set-up]
    #[arg(long, value_name = "NAME")]
    pub(crate) material: Option<String>,
    /// Unit of lengths in report and tables [default: as the program writes them]
    #[arg(long, value_enum)]
    pub(crate) units: Option<Units>,
    /// How the summary is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// Also say how fast the simulation and the kernel's tick were
    #[arg(long)]
    pub(crate) timings: bool,
    /// By the clock: kernel and machine in a servo thread of their own, which says with --timings
    /// how well it kept its time
    #[arg(long, conflicts_with_all = ["fault", "recover"])]
    pub(crate) real_time: bool,
    /// Also print what happened, a line an event
    #[arg(long)]
    pub(crate) log: bool,
    /// Control the machine simulator that listens here, instead of simulating one
    #[arg(long, alias = "iron", value_name = "PATH")]
    pub(crate) simulator: Option<PathBuf>,
    /// Folder of the sync record [default with --simulator: see below; else none is kept]
    #[arg(long, value_name = "DIR")]
    pub(crate) state: Option<PathBuf>,
    /// A new one is in the place of this tool, which broke before: with --state, whose folder keeps
    /// which tools are broken; several as in 3,5
    #[arg(long, value_name = "N", value_delimiter = ',')]
    pub(crate) renew_tool: Vec<u32>,
    /// Begin at a line, as in 27, at a hole, as in "hole 5", or at a tool, as in "tool 3": tool,
    /// spindle and modes as they would be there; never within a cycle
    #[arg(long, value_name = "LINE|hole N|tool N")]
    pub(crate) from: Option<control::job::restart::From>,
    /// Begin there though the program is not the one of the sync record: it was changed since
    #[arg(long, requires = "from")]
    pub(crate) program_changed: bool,
    /// Let the machine fail: WHAT at MOMENT; several separated by `;`, see below
    #[arg(long, value_name = "WHAT at MOMENT", conflicts_with = "simulator")]
    pub(crate) fault: Vec<String>,
    /// What the operator orders: WHAT at MOMENT; several separated by `;`, see below
    #[arg(long, value_name = "WHAT at MOMENT")]
    pub(crate) operator: Vec<String>,
    /// After a stop in a thread: take the tap out along it, and end there, or continue with the
    /// remaining holes
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "out", conflicts_with = "simulator")]
    pub(crate) recover: Option<AfterStop>,
    /// Force the tapping ramp from rest to full speed into this time, against the power curve
    #[arg(long, value_name = "SECONDS")]
    pub(crate) force_ramp: Option<f64>,
    /// Learn from tap to tap, and keep what was learnt in this file; `off`: do not
    /// [default: as the machine's file says]
    #[arg(long, value_name = "FILE|off")]
    pub(crate) learning: Option<PathBuf>,
    /// How the feed is tied to the spindle [default: the machine's]
    #[arg(long, value_enum)]
    pub(crate) synchronisation: Option<Synchronisation>,
    #[command(flatten)]
    pub(crate) left: super::LeftArgs,
}

impl RunArgs {
    /// What the program is loaded with, without a command line.
    pub(crate) fn options(&self) -> ProgramOptions {
        let source = self.source.options();
        ProgramOptions {
            // a machine that is simulated elsewhere is what it is
            chooses: source.chooses && self.plant.is_none() && self.simulator.is_none(),
            plant: self.plant.as_ref().map(Into::into),
            ..source
        }
    }
}

/// Unit of lengths.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Units {
    /// Millimetres and micrometres
    Mm,
    /// Inches and microinches
    Inch,
}

impl From<Units> for canon::LengthUnit {
    fn from(units: Units) -> Self {
        match units {
            Units::Mm => Self::Millimetre,
            Units::Inch => Self::Inch,
        }
    }
}

/// What comes after a tap has been taken out.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AfterStop {
    /// The end
    Out,
    /// The remaining holes
    Continue,
}

/// How the feed is tied to the spindle.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Synchronisation {
    /// Spindle and feed obey one planned trajectory
    Command,
    /// The feed follows the observed spindle, predicted to when the command acts
    Encoder,
    /// The feed follows the measured angle with speed feed-forward, not predicted: lags by v·Ts
    EncoderNoPrediction,
    /// The feed follows the measured angle by its position gain alone: lags by v/Kp + v·Ts
    EncoderNoFeedForward,
}

impl From<Synchronisation> for leadscrew::Synchronisation {
    fn from(asked: Synchronisation) -> Self {
        match asked {
            Synchronisation::Command => Self::Command,
            Synchronisation::Encoder => Self::Encoder,
            Synchronisation::EncoderNoPrediction => Self::EncoderNoPrediction,
            Synchronisation::EncoderNoFeedForward => Self::EncoderNoFeedForward,
        }
    }
}

impl From<AfterStop> for control::stops::AfterStop {
    fn from(after: AfterStop) -> Self {
        match after {
            AfterStop::Out => Self::Out,
            AfterStop::Continue => Self::Continue,
        }
    }
}
