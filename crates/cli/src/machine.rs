//! `leadscrew machine`: what machines there are, and what is wrong with a file that describes one.
use crate::args::MachineCommand;
use crate::say;
use crate::tables::table;
use bus::DriveReaction;
use control::Refused;
use control::config::machine_file::{MachineSource, load, text};
use std::path::{Path, PathBuf};
use store::linuxcnc::{self, Remark, RemarkKind};
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
            let warned = warnings(&file).chain(crate::coasting::warnings(&file));
            for warning in warned.chain(unanswered(&file)) {
                text += &format!("warning: {warning}\n");
            }
            say::out(&text)
        }
        MachineCommand::Import { ini, hal, out } => import(ini, hal, out.as_deref()),
    }
}

/// A machine file from a LinuxCNC configuration: whole and one that can be run, or none.
fn import(ini: &Path, hal: &[PathBuf], out: Option<&Path>) -> Result<(), Refused> {
    if let Some(out) = out.filter(|out| out.exists()) {
        let text = format!(
            "{} is there already: import writes over no machine file; name another, or remove it",
            out.display()
        );
        return Err(Refused::because(text));
    }
    let imported = linuxcnc::read(ini, hal)?;
    let lines = remarks(&imported.remarks);
    let Some(text) = imported.text else {
        say::err(&lines);
        let wrong =
            imported.remarks.iter().filter(|remark| remark.kind == RemarkKind::Wrong).count();
        let text = format!("{}: {wrong} wrong, and no machine file is written", ini.display());
        return Err(Refused::because(text));
    };
    let name = out.unwrap_or(ini).display().to_string();
    if let Err(refused) = load(MachineSource { name, text: Some(text.clone()) }) {
        say::err(&lines);
        return Err(refused);
    }
    let Some(out) = out else {
        say::err(&lines);
        return say::out(&text);
    };
    store::output::write_file(out, text.as_bytes())?;
    let next = format!(
        "{} is written: look at what was guessed and what is missing, and answer [hal.safety] where it is there\n",
        out.display()
    );
    say::out(&(lines + &next))
}

fn remarks(all: &[Remark]) -> String {
    all.iter().fold(String::new(), |text, remark| text + &remark.to_string() + "\n")
}

/// The text of a machine's file, with what the simulated one may be; one that is wrong is shown as
/// it is.
pub(crate) fn shown(
    source: impl Into<MachineSource>,
    seed: Option<u64>,
    part: u32,
) -> Result<String, Refused> {
    let source = source.into();
    let plant = load(&source).map(|file| {
        crate::compensation_chart::lines(&file) + &crate::plant_table::lines(&file, seed, part)
    });
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

/// Pins that stopped the machine in another control and have no answer yet: without one HAL's
/// drives are not led.
fn unanswered(file: &MachineFile) -> impl Iterator<Item = String> {
    let open = file.hal.iter().flat_map(|hal| &hal.unanswered);
    open.map(|what| format!("[hal.safety] {what}; no drive is led before it is answered"))
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
