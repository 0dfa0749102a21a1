//! `leadscrew drives`: kernel and servo thread in a process of their own.
use crate::args::DrivesArgs;
use crate::{interrupt, say};
use control::Refused;
use leadscrew::ethercat::DrivesReport;
use leadscrew::{DrivesOptions, DrivesProcess};

/// Lead drives until Ctrl-C, and bring them to rest.
pub(crate) fn command(args: &DrivesArgs) -> Result<(), Refused> {
    interrupt::watch()?;
    let process = DrivesProcess::new(DrivesOptions {
        source: args.source.on_a_machine(),
        seed: args.seed,
        name: args.name.clone(),
        interface: args.interface.clone(),
        priority: args.priority,
    })?;
    let (name, kind, machine) = (&args.name, process.kind(), process.machine().to_owned());
    let mut unsaid = Ok(());
    process.run(interrupt::flag(), |report| match report {
        DrivesReport::Leads => {
            unsaid = say::out(&format!(
                "leads the {kind} drives of {machine}; a control of this machine finds them by --drives process:{name}\n"
            ));
        }
        DrivesReport::Notice(text) => say::err(&format!("{text}\n")),
    })?;
    unsaid
}
