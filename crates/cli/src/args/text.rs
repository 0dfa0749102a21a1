//! The arguments of the commands that read programs and move nothing: check, time, fmt, canon.
use super::{DialectChoice, Format, ProgramArgs};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `leadscrew check`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CheckArgs {
    /// Programs, or folders of them; `-` reads standard input
    #[arg(required = true)]
    pub(crate) programs: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// A table alone: each program with its verdict, how and where it was read, and the first thing
    /// wrong; then what was wrong, by how many programs have it
    #[arg(long)]
    pub(crate) summary: bool,
    /// How findings are printed
    #[arg(long, value_enum, default_value_t = FindingsFormat::Text)]
    pub(crate) format: FindingsFormat,
}

/// How findings are printed.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FindingsFormat {
    /// With carets
    Text,
    /// An array of objects
    Json,
    /// SARIF 2.1.0, which code hosts and editors read
    Sarif,
}

/// `leadscrew time`.
#[derive(Args, Debug, Clone)]
pub(crate) struct TimeArgs {
    /// The program; `-` reads standard input
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// How it is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// In JSON: every operation, not only the longest
    #[arg(long)]
    pub(crate) operations: bool,
    /// From a sample of a long program, within 2 % of what planning all of it finds
    #[arg(long, conflicts_with = "operations")]
    pub(crate) fast: bool,
    /// Also say how long planning took
    #[arg(long)]
    pub(crate) timings: bool,
}

/// `leadscrew fmt`.
#[derive(Args, Debug, Clone)]
pub(crate) struct FormatArgs {
    /// Programs, or folders of them; `-` reads standard input and writes standard output
    #[arg(required = true)]
    pub(crate) programs: Vec<PathBuf>,
    /// Change nothing; say what would change
    #[arg(long)]
    pub(crate) check: bool,
    /// Whose words the programs use
    #[arg(long, value_enum, default_value = "linuxcnc")]
    pub(crate) dialect: DialectChoice,
}

/// `leadscrew canon`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CanonArgs {
    /// The program; `-` reads standard input
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Which notation
    #[arg(long, value_enum, default_value_t = CanonFormat::Text)]
    pub(crate) format: CanonFormat,
    #[command(flatten)]
    pub(crate) left: LeftArgs,
}

/// What a program leaves behind.
#[derive(Args, Debug, Clone)]
pub(crate) struct LeftArgs {
    /// Write the numbered parameters as the program leaves them, in LinuxCNC's notation (.var)
    #[arg(long, value_name = "FILE")]
    pub(crate) write_parameters: Option<PathBuf>,
    /// Write the tool table as the program leaves it, in LinuxCNC's notation (.tbl)
    #[arg(long, value_name = "FILE")]
    pub(crate) write_tools: Option<PathBuf>,
}

impl LeftArgs {
    /// Whether anything is to be written.
    pub(crate) const fn is_asked(&self) -> bool {
        self.write_parameters.is_some() || self.write_tools.is_some()
    }
}

/// Which notation.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CanonFormat {
    /// A line an operation
    Text,
    /// A JSON object a line
    Json,
    /// The notation of LinuxCNC's stand-alone interpreter
    Linuxcnc,
}
