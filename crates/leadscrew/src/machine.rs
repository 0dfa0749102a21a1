//! A machine file in memory, whose values can be changed; what is changed is read and checked like
//! any machine file.
use control::Refused;
use control::config::machine_file::{self, MachineSource};
use serde_json::Value;
use store::machine::{self, MachineFile};

/// A machine: its file's text, and what was read from it.
#[derive(Debug, Clone)]
pub struct Machine {
    source: MachineSource,
    text: String,
    file: MachineFile,
}

impl Machine {
    /// By the name of an embedded model, or from a file.
    ///
    /// # Errors
    /// A name that is not known, a file that cannot be read, and everything that is wrong with it.
    pub fn load(source: impl Into<MachineSource>) -> Result<Self, Refused> {
        let source = source.into();
        let file = machine_file::load(&source)?;
        let text = machine_file::text(&source)?;
        Ok(Self { source, text, file })
    }

    /// The same with values changed, by their keys: `axes.z.structure.backlash_um`,
    /// `spindles.0.inertia_kg_m2`. All are changed, then the file is checked.
    ///
    /// # Errors
    /// Everything that is wrong with the file then: unknown keys, such as one with another unit,
    /// values out of bounds, values that contradict each other.
    pub fn with(&self, changes: &[(String, Value)]) -> Result<Self, Refused> {
        let base = match (&self.source.text, machine::embedded(&self.source.name)) {
            (None, Some(_)) => format!("extends = \"{}\"\n", self.source.name),
            _ => self.text.clone(),
        };
        let text = changes.iter().try_fold(base, |text, (key, value)| {
            machine::changed(&text, key, value).map_err(Refused::because)
        })?;
        Self::load(MachineSource { name: self.source.name.clone(), text: Some(text) })
    }

    /// What a key is; `None`: it is stated nowhere, neither here nor in what this file extends.
    pub fn value(&self, key: &str) -> Option<Value> {
        machine::value(&self.text, key)
    }

    /// What stands for it where a program is brought to a machine.
    pub const fn source(&self) -> &MachineSource {
        &self.source
    }

    /// Text of its file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What was read from it.
    pub const fn file(&self) -> &MachineFile {
        &self.file
    }
}
