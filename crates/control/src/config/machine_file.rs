//! A machine file by its name: an embedded model, or a file.
use super::{control, simulator};
use crate::Refused;
use store::machine::{self, MachineFile};

/// A machine by its embedded name, or from a file: one that can be controlled and simulated.
///
/// # Errors
/// A name that is not known, a file that cannot be read, and what the machine's file says wrong.
pub fn load(name: &str) -> Result<MachineFile, Refused> {
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
    control(file, None, true).problems(|problem| wrong.push(problem.to_string()));
    let (tools, seed) = (canon::ToolLibrary::default(), u64::from(file.simulation.seed));
    let material = file.setup.stock.material;
    let config = simulator(file, &tools, material, seed, &file.setup.g54);
    wrong.extend(config.problems());
    if wrong.is_empty() {
        return Ok(());
    }
    Err(Refused::because(format!("the machine {name} cannot be run: {}", wrong.join("; "))))
}

/// Its text, as it is printed.
///
/// # Errors
/// A name that is not known, and a file that cannot be read.
pub fn text(name: &str) -> Result<String, Refused> {
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
