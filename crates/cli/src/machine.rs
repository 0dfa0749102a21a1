//! `leadscrew machine`: what machines there are, and what is wrong with a file that describes one.
use crate::args::MachineCommand;
use crate::say;
use crate::tables::table;
use bus::DriveReaction;
use control::Refused;
use control::config::machine_file::{MachineSource, load, text};
use store::machine::{self, MachineFile};

/// Do it.
pub(crate) fn command(order: &MachineCommand) -> Result<(), Refused> {
    match order {
        MachineCommand::List => list(),
        MachineCommand::Show { machine, seed, part } => say::out(&shown(machine, *seed, *part)?),
        MachineCommand::Check { machine } => {
            let file = load(machine)?;
            control::job::subprograms::folders_of(machine, &file)?;
            control::services::learning::Memory::load(None, &file)?;
            let mut text = format!("{}: in order. {}\n", file.name, file.description);
            for warning in warnings(&file).chain(crate::coasting::warnings(&file)) {
                text += &format!("warning: {warning}\n");
            }
            say::out(&text)
        }
    }
}

/// The text of a machine's file, with what the simulated one may be; one that is wrong is shown as it is.
pub(crate) fn shown(
    source: impl Into<MachineSource>,
    seed: Option<u64>,
    part: u32,
) -> Result<String, Refused> {
    let source = source.into();
    let plant = load(&source).map(|file| crate::plant_table::lines(&file, seed, part));
    Ok(text(&source)? + &plant.unwrap_or_default())
}

/// What is allowed and yet leaves a tool in the work without help.
fn warnings(file: &MachineFile) -> impl Iterator<Item = String> {
    let drives = file.drives;
    let keys = [
        ("on_link_loss", drives.on_link_loss, "the control dies"),
        ("on_power_loss", drives.on_power_loss, "the mains fail"),
    ];
    keys.into_iter().filter(|(_, reaction, _)| *reaction == DriveReaction::Off).map(|(key, _, when)| {
        format!(
            "[drives] {key} is \"off\": if {when} in a synchronised cut, spindle and axes run down apart, and nothing is guaranteed of the \
             tool: \"coupled-stop\", \"quick-stop\" or \"coast\" works where the drives can{}",
            if key == "on_power_loss" { ", with [drives.bus]" } else { "" }
        )
    })
}

fn list() -> Result<(), Refused> {
    let mut table = table(["machine", "what it is", "axes", "spindles"]);
    for name in machine::EMBEDDED {
        let file = load(name)?;
        let axes: String = file.axes.iter().flatten().map(|a| a.letter.letter()).collect();
        let spindles: Vec<_> =
            file.spindles.iter().map(|s| format!("{} {:.0} rpm", s.name, s.max.in_rpm())).collect();
        table.add_row([name, &file.description, &axes, &spindles.join(", ")]);
    }
    say::out(&format!(
        "{table}\n\nThe first is the default. `leadscrew machine show NAME` prints its file to start your own from.\n"
    ))
}
