//! The arguments of `leadscrew simulator` and `leadscrew recover`.
use super::{Format, ProgramArgs};
use bus::DriveReaction;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `leadscrew simulator`.
#[derive(Args, Debug, Clone)]
#[command(group = clap::ArgGroup::new("what").required(true).args(["listen", "ethercat", "status", "power_cut", "quit"]))]
pub(crate) struct SimulatorArgs {
    /// Listen here, a Unix socket, for one control after the other
    #[arg(long, value_name = "PATH")]
    pub(crate) listen: Option<PathBuf>,
    /// Answer as its EtherCAT drives on this network interface
    #[arg(long, value_name = "IFACE")]
    pub(crate) ethercat: Option<String>,
    /// Priority (`SCHED_FIFO`) of its thread, 1 to 99
    #[arg(long, value_name = "N", default_value_t = 81, requires = "ethercat", value_parser = clap::value_parser!(u8).range(1..=99))]
    pub(crate) priority: u8,
    /// Ask the machine simulator that listens here how it is
    #[arg(long, value_name = "PATH")]
    pub(crate) status: Option<PathBuf>,
    /// Cut the power of the machine simulator that listens here, and give it back
    #[arg(long, value_name = "PATH")]
    pub(crate) power_cut: Option<PathBuf>,
    /// End the machine simulator that listens here
    #[arg(long, value_name = "PATH")]
    pub(crate) quit: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Seed of the machine that is simulated: what its control does not know
    /// (`machine show NAME --seed N`), and the cut's scatter
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Material of the workpiece [default: the machine's set-up]
    #[arg(long, value_name = "NAME")]
    pub(crate) material: Option<String>,
    /// Let time pass as on the wall, instead of waiting for the control
    #[arg(long)]
    pub(crate) real_time: bool,
    /// The mains fail at this machine time, seconds; several separated by commas. They come back
    /// for the next control
    #[arg(long, value_name = "SECONDS", value_delimiter = ',')]
    pub(crate) power_cut_at: Vec<f64>,
    /// What the drives do when the control falls silent [default: the machine's]
    #[arg(long, value_parser = drive_reaction())]
    pub(crate) on_link_loss: Option<DriveReaction>,
    /// What they do when the mains fail [default: the machine's]
    #[arg(long, value_parser = drive_reaction())]
    pub(crate) on_power_loss: Option<DriveReaction>,
    /// The spindle's encoder does not count turns without power [default: the machine's]
    #[arg(long)]
    pub(crate) single_turn: bool,
    /// Number of this very machine
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) serial: u64,
    /// Epoch of its encoders [default: a new one, as for new encoders]
    #[arg(long, value_name = "N")]
    pub(crate) epoch: Option<u64>,
}

/// What drives do that are left alone, by its name in machine files.
fn drive_reaction() -> impl TypedValueParser<Value = DriveReaction> {
    let values = DRIVE_REACTIONS.map(|(name, help, _)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(values).try_map(|name| {
        let named = DRIVE_REACTIONS.into_iter().find(|(known, ..)| *known == name);
        named.map(|(.., reaction)| reaction).ok_or("no such reaction")
    })
}

const DRIVE_REACTIONS: [(&str, &str, DriveReaction); 4] = [
    ("off", "Outputs off: brakes clamp, spindles coast", DriveReaction::Off),
    ("coast", "Spindles coast; an axis that is tied to one goes with it", DriveReaction::Coast),
    ("quick-stop", "Each brakes by itself", DriveReaction::QuickStop),
    ("coupled-stop", "Coupled ones brake together", DriveReaction::CoupledStop),
];

/// `leadscrew recover`.
#[derive(Args, Debug, Clone)]
pub(crate) struct RecoverArgs {
    /// The machine simulator
    #[arg(long, alias = "iron", value_name = "PATH")]
    pub(crate) simulator: PathBuf,
    /// The machine: a name from `leadscrew machine list`, or a file [default: tapping-center]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) machine: Option<String>,
    /// Folder of the sync record [default: $XDG_STATE_HOME/leadscrew/MACHINE-NUMBER, or below
    /// ~/.local/state]
    #[arg(long, value_name = "DIR")]
    pub(crate) state: Option<PathBuf>,
    /// Rehearse: say what would be done, and move nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Draw where the tap stands and the way back
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) picture: Option<PathBuf>,
    /// Who moves back onto the thread
    #[arg(long, value_enum, default_value_t = RecoveryWay::UnloadFirst)]
    pub(crate) way: RecoveryWay,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// State that you have seen that no tool is in the work: record and machine forget it
    #[arg(long, alias = "discard-record", conflicts_with_all = ["dry_run", "picture"])]
    pub(crate) tool_is_free: bool,
}

/// Who moves back onto the thread.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RecoveryWay {
    /// In a stiff holder the feed, to where nothing presses; then the axis that overran
    UnloadFirst,
    /// The axis that overran
    Direct,
}

impl From<RecoveryWay> for control::recovery::RecoveryWay {
    fn from(way: RecoveryWay) -> Self {
        match way {
            RecoveryWay::UnloadFirst => Self::UnloadFirst,
            RecoveryWay::Direct => Self::Direct,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test may panic
mod tests {
    use crate::args::{Cli, Command};
    use clap::{CommandFactory, Parser};

    fn parsed(line: &str) -> Command {
        Cli::try_parse_from(line.split_whitespace()).unwrap().command
    }

    #[test]
    fn names_of_one_version_ago_are_read_and_not_shown() {
        for name in ["simulator", "iron"] {
            let listening = parsed(&format!("leadscrew {name} --listen a"));
            assert!(matches!(listening, Command::Simulator(args) if args.listen.is_some()));
            let run = parsed(&format!("leadscrew run part.ngc --{name} a"));
            assert!(matches!(run, Command::Run(args) if args.simulator.is_some()));
            let recover = parsed(&format!("leadscrew recover --{name} a"));
            assert!(matches!(recover, Command::Recover(args) if args.simulator.ends_with("a")));
        }
        let mut all = Cli::command();
        let shown = all.render_long_help().to_string();
        assert!(shown.contains("simulator") && !shown.contains("iron "), "{shown}");
        for command in all.get_subcommands_mut() {
            let shown = command.render_long_help().to_string();
            assert!(!shown.contains("--iron"), "{shown}");
        }
    }
}
