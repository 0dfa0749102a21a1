//! `leadscrew drives`: kernel and servo thread in a process of their own.
use crate::args::DrivesArgs;
use crate::{interrupt, say};
use control::Refused;
use leadscrew::{DrivesOptions, DrivesProcess};

/// Lead drives until Ctrl-C, and bring them to rest.
pub(crate) fn command(args: &DrivesArgs) -> Result<(), Refused> {
    interrupt::watch()?;
    let process = DrivesProcess::new(DrivesOptions {
        source: args.source.on_a_machine(),
        seed: args.seed,
        name: args.name.clone(),
        priority: args.priority,
    })?;
    let (name, machine) = (&args.name, process.machine().to_owned());
    say::out(&format!(
        "leads the simulated drives of {machine}; a control of this machine finds them by --drives process:{name}\n"
    ))?;
    process.run(interrupt::flag(), |refused| say::err(&format!("{refused}\n")));
    Ok(())
}
