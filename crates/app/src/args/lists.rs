//! The arguments of `leadscrew codes` and `leadscrew machine`.
use clap::{Subcommand, ValueEnum};

/// `leadscrew machine`.
#[derive(Subcommand, Debug)]
pub(crate) enum MachineCommand {
    /// The embedded machines
    List,
    /// Print a machine's file: every value with its unit and source
    Show {
        /// A name from `list`, or a file
        machine: String,
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
