//! The arguments of `leadscrew drives`.
use super::ProgramArgs;
use clap::Args;

/// `leadscrew drives`.
#[derive(Args, Debug, Clone)]
pub(crate) struct DrivesArgs {
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Name by which a control finds it: `--drives process:NAME`
    #[arg(long, value_name = "NAME", default_value = "default")]
    pub(crate) name: String,
    /// Network interface of EtherCAT drives [default: the machine's]
    #[arg(long, value_name = "IFACE")]
    pub(crate) interface: Option<String>,
    /// Seed of the machine that is simulated: what its control does not know
    /// (`machine show NAME --seed N`)
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Priority of the servo thread under `SCHED_FIFO`, 1 to 99
    #[arg(long, value_name = "N", default_value_t = 80, value_parser = clap::value_parser!(u8).range(1..=99))]
    pub(crate) priority: u8,
}
