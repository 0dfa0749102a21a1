//! The arguments of `leadscrew codes` and `leadscrew machine`.
use super::common::DialectChoice;
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `leadscrew machine`.
#[derive(Subcommand, Debug)]
pub(crate) enum MachineCommand {
    /// The embedded machines
    List,
    /// Print a machine's file: every value with its unit and source; and what the simulated machine
    /// may be instead
    Show {
        /// A name from `list`, or a file
        machine: String,
        /// Seed of the simulated machine that is shown beside what its control believes
        /// [default: the file's]
        #[arg(long, value_name = "N")]
        seed: Option<u64>,
        /// Number of its workpiece
        #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
        part: u32,
    },
    /// Say everything that is wrong with a machine file
    Check {
        /// A name from `list`, or a file
        machine: String,
    },
    /// Write a machine file from a LinuxCNC configuration; say what was taken, what was guessed,
    /// and what is missing
    Import {
        /// Its INI file; HAL files that it names are found beside it, and in LinuxCNC's library
        #[arg(value_name = "FILE.ini")]
        ini: PathBuf,
        /// HAL files beside those that it names
        #[arg(value_name = "FILE.hal")]
        hal: Vec<PathBuf>,
        /// Where the machine file goes, which is not there yet
        /// [default: standard output; the remarks go to standard error]
        #[arg(long, value_name = "FILE.toml")]
        out: Option<PathBuf>,
    },
}

/// `leadscrew explain`.
#[derive(Args, Debug, Clone)]
pub(crate) struct ExplainArgs {
    /// Codes of findings, as in I0501, and numbers of alarms, as in 105 [default: all findings]
    #[arg(value_name = "CODE")]
    pub(crate) codes: Vec<String>,
}

/// `leadscrew codes`.
#[derive(Args, Debug)]
pub(crate) struct CodesArgs {
    /// Count those of these programs, or of the programs in these folders, instead: how often each
    /// code is used, in how many of them, whether it is known, and where it comes first
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub(crate) of: Vec<PathBuf>,
    /// How the programs are read [default: the machine's, else as their words tell]
    #[arg(long, value_enum, requires = "of")]
    pub(crate) dialect: Option<DialectChoice>,
    /// A machine whose own codes are known, as its file has them: a name from `machine list`, or a
    /// file
    #[arg(long, requires = "of")]
    pub(crate) machine: Option<String>,
    /// How they are printed
    #[arg(long, value_enum, default_value_t = CodesFormat::Text)]
    pub(crate) format: CodesFormat,
}

/// How the codes are printed.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CodesFormat {
    /// A table
    Text,
    /// An array of objects
    Json,
}
