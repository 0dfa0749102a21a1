//! The arguments of `leadscrew codes` and `leadscrew machine`.
use clap::{Subcommand, ValueEnum};

/// `leadscrew machine`.
#[derive(Subcommand, Debug)]
pub(crate) enum MachineCommand {
    /// The embedded machines
    List,
    /// Print a machine's file: every value with its unit and source; and what the simulated machine may be instead
    Show {
        /// A name from `list`, or a file
        machine: String,
        /// Seed of the simulated machine that is shown beside what its control believes [default: the file's]
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
}

/// How the codes are printed.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CodesFormat {
    /// A table
    Text,
    /// An array of objects
    Json,
}
