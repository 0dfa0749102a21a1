//! The arguments of `leadscrew trace`.
use clap::{Subcommand, ValueEnum};
use std::path::PathBuf;

/// `leadscrew trace`.
#[derive(Subcommand, Debug)]
pub(crate) enum TraceCommand {
    /// Say what a recording holds: its columns with their ranges, and what the kernel was doing
    #[command(after_help = "Example: leadscrew trace show out/plate")]
    Show {
        /// Folder of a run, or a recording in Parquet: a run's trace, or what the page's scope has
        /// saved
        run: PathBuf,
    },
    /// Write a recording in another format, with the unit of each column
    #[command(
        after_help = "MCAP has a message for each period in Protocol Buffers, with its descriptor: PlotJuggler, Foxglove and
Rerun open it. What has no value there is NaN. Parquet is written with encodings that all readers have.

Examples:
  leadscrew trace convert out/plate --to mcap                      makes out/plate/trace.mcap
  leadscrew trace convert out/plate --to csv --out plate.csv
  leadscrew trace convert scope-12.5s.parquet --to mcap"
    )]
    Convert {
        /// Folder of a run, or a recording in Parquet: a run's trace, or what the page's scope has
        /// saved
        run: PathBuf,
        /// The format
        #[arg(long, value_enum, value_name = "FORMAT")]
        to: TraceFormat,
        /// The new file [default: beside the recording, with the ending of the format]
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
}

/// What a recording is written as.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TraceFormat {
    /// MCAP
    Mcap,
    /// Text, comma-separated
    Csv,
    /// Parquet
    Parquet,
}
