//! `leadscrew machine`: what machines there are, and what is wrong with a file that describes one.
use crate::args::MachineCommand;
use crate::refused::Refused;
use crate::say;
use crate::tables::table;
use crate::wiring;
use store::machine::{self, MachineFile, Reaction};

/// Do it.
pub(crate) fn command(order: &MachineCommand) -> Result<(), Refused> {
    match order {
        MachineCommand::List => list(),
        MachineCommand::Show { machine, seed } => {
            let text = text(machine)?;
            // a file that is wrong is shown as it is
            let plant = load(machine).map(|file| crate::plant_table::lines(&file, *seed));
            say::out(&(text + &plant.unwrap_or_default()))
        }
        MachineCommand::Check { machine } => {
            let file = load(machine)?;
            crate::subprograms::folders_of(machine, &file)?;
            crate::learning::Memory::load(None, &file)?;
            let mut text = format!("{}: in order. {}\n", file.name, file.description);
            for warning in warnings(&file).chain(crate::coasting::warnings(&file)) {
                text += &format!("warning: {warning}\n");
            }
            say::out(&text)
        }
    }
}

/// A machine by its embedded name, or from a file: one that can be controlled and simulated.
pub(crate) fn load(name: &str) -> Result<MachineFile, Refused> {
    let file = match machine::embedded(name) {
        None => machine::load(&path(name)?)?,
        Some(text) => machine::parse(text, 0)
            .map_err(|findings| Refused::text(name.to_owned(), text, findings))?,
    };
    can_be_run(name, &file)?;
    Ok(file)
}

/// What no section of the file can see alone: loops too fast for the servo period, physics too coarse for an axis.
fn can_be_run(name: &str, file: &MachineFile) -> Result<(), Refused> {
    let mut wrong = Vec::new();
    wiring::control(file, None, true).problems(|problem| wrong.push(problem.to_string()));
    let (tools, seed) = (canon::ToolLibrary::default(), u64::from(file.simulation.seed));
    let material = file.setup.stock.material;
    let config = wiring::simulator(file, &tools, material, seed, &file.setup.g54);
    wrong.extend(config.problems());
    if wrong.is_empty() {
        return Ok(());
    }
    Err(Refused::because(format!("the machine {name} cannot be run: {}", wrong.join("; "))))
}

/// What is allowed and yet leaves a tool in the work without help.
fn warnings(file: &MachineFile) -> impl Iterator<Item = String> {
    let drives = file.drives;
    let keys = [
        ("on_link_loss", drives.on_link_loss, "the control dies"),
        ("on_power_loss", drives.on_power_loss, "the mains fail"),
    ];
    keys.into_iter().filter(|(_, reaction, _)| *reaction == Reaction::Off).map(|(key, _, when)| {
        format!(
            "[drives] {key} is \"off\": if {when} in a synchronised cut, spindle and axes run down apart, and nothing is guaranteed of the \
             tool: \"coupled-stop\", \"quick-stop\" or \"coast\" works where the drives can{}",
            if key == "on_power_loss" { ", with [drives.bus]" } else { "" }
        )
    })
}

/// Its text, as it is printed.
pub(crate) fn text(name: &str) -> Result<String, Refused> {
    match machine::embedded(name) {
        Some(text) => Ok(text.to_owned()),
        None => Ok(store::read_text(&path(name)?, "a machine file", store::SMALL_FILE_LIMIT)?),
    }
}

/// A file's path, unless the name looks like that of a machine nobody knows.
fn path(name: &str) -> Result<std::path::PathBuf, Refused> {
    let path = std::path::PathBuf::from(name);
    let is_file = path.exists() || path.extension().is_some() || name.contains(['/', '\\']);
    if is_file {
        return Ok(path);
    }
    let known = machine::EMBEDDED.join(", ");
    Err(Refused::because(format!("there is no machine \"{name}\": expected {known}, or a file")))
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
