//! A machine file by its name: an embedded model, or a file.
use super::{control, simulator};
use crate::Refused;
use store::machine::{self, MachineFile};

/// Which machine is meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MachineSource {
    /// Name of an embedded model, or of a file.
    pub name: String,
    /// The text that stands for that file, such as one with values changed; `None` is as it is
    /// there.
    pub text: Option<String>,
}

impl From<&str> for MachineSource {
    fn from(name: &str) -> Self {
        Self { name: name.to_owned(), text: None }
    }
}

impl From<&String> for MachineSource {
    fn from(name: &String) -> Self {
        name.as_str().into()
    }
}

impl From<String> for MachineSource {
    fn from(name: String) -> Self {
        Self { name, text: None }
    }
}

impl From<&Self> for MachineSource {
    fn from(source: &Self) -> Self {
        source.clone()
    }
}

/// A machine by its embedded name, or from a file: one that can be controlled and simulated.
///
/// # Errors
/// A name that is not known, a file that cannot be read, and what the machine's file says wrong.
pub fn load(source: impl Into<MachineSource>) -> Result<MachineFile, Refused> {
    let MachineSource { name, text } = source.into();
    let stands = text.as_deref().or_else(|| machine::embedded(&name));
    let file = match stands {
        None => machine::load(&path(&name)?)?,
        Some(text) => machine::parse(text, 0)
            .map_err(|findings| Refused::text(name.clone(), text, findings))?,
    };
    can_be_run(&name, &file)?;
    Ok(file)
}

/// What no section of the file can see alone: loops too fast for the servo period, physics too
/// coarse for an axis.
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
pub fn text(source: impl Into<MachineSource>) -> Result<String, Refused> {
    let MachineSource { name, text } = source.into();
    match text.or_else(|| machine::embedded(&name).map(str::to_owned)) {
        Some(text) => Ok(text),
        None => Ok(store::read_text(&path(&name)?, "a machine file", store::SMALL_FILE_LIMIT)?),
    }
}

/// What the simulated machine may be other than its control believes, and what it may not: it has
/// the same axes and spindles, the same servo period and work clamped at the same place.
///
/// # Errors
/// What it may not.
pub fn fits(plant: &MachineFile, believed: &MachineFile) -> Result<(), Refused> {
    let letters = |file: &MachineFile| {
        file.axes.iter().flatten().map(|a| a.letter.letter()).collect::<String>()
    };
    let spindles = |file: &MachineFile| {
        file.spindles.iter().map(|s| s.name.clone()).collect::<Vec<_>>().join(", ")
    };
    let period = |file: &MachineFile| format!("{} µs", file.control.period.value() * 1e6);
    let zero =
        |file: &MachineFile| format!("{:?} mm", file.setup.g54.linear.map(units::Length::value));
    let all = [
        ("axes", letters(plant), letters(believed)),
        ("spindles", spindles(plant), spindles(believed)),
        ("servo period", period(plant), period(believed)),
        ("work offset G54", zero(plant), zero(believed)),
    ];
    for (what, real, told) in all {
        if real != told {
            return Err(Refused::because(format!(
                "the plant {} does not fit the machine {}: {what} {real}, expected {told}",
                plant.name, believed.name
            )));
        }
    }
    Ok(())
}

/// A file's path, unless the name looks like that of an unknown machine.
fn path(name: &str) -> Result<std::path::PathBuf, Refused> {
    let path = std::path::PathBuf::from(name);
    let is_file = path.exists() || path.extension().is_some() || name.contains(['/', '\\']);
    if is_file {
        return Ok(path);
    }
    let known = machine::EMBEDDED.join(", ");
    Err(Refused::because(format!("there is no machine \"{name}\": expected {known}, or a file")))
}
