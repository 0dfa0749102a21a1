//! What outlives the control: offsets, tools, the last program and how far it came, alarms,
//! settings; in a state folder.
//!
//! A request that changes something is accepted when it is on the disk, not before.
use super::request::Refusal;
use crate::Refused;
use std::path::Path;
use store::parameters::Parameters;
use store::state::{Homing, State, StateFolder};

/// A state folder, and what was found in it; without one nothing is kept.
#[derive(Default)]
pub(super) struct Kept {
    folder: Option<StateFolder>,
    /// References of absolute encoders.
    pub(super) homed: Homing,
}

impl Kept {
    /// Open the folder of this machine; what it says, and what the operator should know of it.
    pub(super) fn open(
        path: Option<&Path>,
        machine: &str,
    ) -> Result<(Self, State, Vec<String>), Refused> {
        let Some(path) = path else { return Ok((Self::default(), State::default(), Vec::new())) };
        let (mut folder, state, mut found) = StateFolder::open(path)?;
        found.extend(folder.claim(machine)?);
        let said = found.into_iter().map(|finding| finding.to_string()).collect();
        let homed = state.homed.clone();
        Ok((Self { folder: Some(folder), homed }, state, said))
    }

    /// The folder, if there is one.
    pub(super) const fn folder(&self) -> Option<&StateFolder> {
        self.folder.as_ref()
    }

    /// Save something, if there is a folder.
    pub(super) fn save(
        &mut self,
        save: impl FnOnce(&mut StateFolder) -> Result<(), store::Error>,
    ) -> Result<(), Refusal> {
        match &mut self.folder {
            None => Ok(()),
            Some(folder) => save(folder).map_err(|why| {
                Refusal::because(format!("it cannot be kept, and stays as it was: {why}"))
            }),
        }
    }
}

/// Those that are not zero, and those that LinuxCNC wants to find in its file.
pub fn kept_parameters(left: &interp::Parameters) -> Parameters {
    /// The first parameter that outlives a subprogram's call.
    const FIRST_KEPT: u32 = 31;
    let mut kept = Parameters::default();
    let systems = (5221..=5381).step_by(20).flat_map(|first| first..first + 10);
    let wanted = (5161..=5169).chain(5181..=5189).chain(5210..=5220).chain(systems);
    let set = left.iter().map(|(number, _)| number as u32).filter(|number| *number >= FIRST_KEPT);
    for number in wanted.chain(set) {
        let value = left.get(number as usize).unwrap_or(0.0);
        let _ = kept.set(number, value); // its numbers are in order
    }
    kept
}
