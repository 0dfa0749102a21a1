//! What outlives the control: offsets, tools, the last program and how far it came, alarms,
//! settings; in a state folder.
//!
//! One thread writes all of it ([`writer`](super::writer)). A control that is called in lock-step
//! waits for it: a request that changes something is accepted when it is on the disk, not before.
//! One that is hosted waits for no disk: the answer to such a request does.
use super::request::Refusal;
use super::writer::{Key, StateWriter, Ticket, Write};
use crate::Refused;
use std::path::{Path, PathBuf};
use store::machine::MachineFile;
use store::parameters::Parameters;
use store::state::lock::FolderLock;
use store::state::{Homing, MachineIdentity, State, StateFolder};
use store::sync_record::slots;

/// A state folder, and what was found in it; without one nothing is kept.
#[derive(Default)]
pub(super) struct Kept {
    folder: Option<KeptFolder>,
    /// References of absolute encoders.
    pub(super) homed: Homing,
}

/// Where the folder is, who has it, and what writes into it.
struct KeptFolder {
    place: LockedFolder,
    writer: StateWriter,
    /// A save returns when it is on the disk.
    waits: bool,
}

/// A folder that this control has locked.
#[derive(Clone, Debug)]
pub(super) struct LockedFolder {
    path: PathBuf,
    lock: FolderLock,
}

impl LockedFolder {
    /// Where it is.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The same folder for the sync record.
    pub(super) fn for_record(&self) -> slots::StateFolder {
        slots::StateFolder::at(self.path.clone(), self.lock.clone())
    }
}

impl Kept {
    /// Open the folder of this machine; what it says, and what the operator should know of it.
    pub(super) fn open(
        path: Option<&Path>,
        machine: &MachineFile,
    ) -> Result<(Self, State, Vec<String>), Refused> {
        let Some(path) = path else { return Ok((Self::default(), State::default(), Vec::new())) };
        let (folder, state, found) = StateFolder::open(path, &MachineIdentity::of(machine))?;
        let said = found.into_iter().map(|finding| finding.to_string()).collect();
        let homed = state.homed.clone();
        let place = LockedFolder { path: folder.path().to_owned(), lock: folder.lock() };
        let writer = StateWriter::start(folder)
            .map_err(|e| Refused::because(format!("cannot start a thread: {e}")))?;
        let folder = KeptFolder { place, writer, waits: true };
        Ok((Self { folder: Some(folder), homed }, state, said))
    }

    /// The folder, if there is one.
    pub(super) fn folder(&self) -> Option<&LockedFolder> {
        self.folder.as_ref().map(|folder| &folder.place)
    }

    /// From now on no save waits for the disk. `before` is called in the thread that writes, before
    /// each write.
    pub(super) fn write_beside(&mut self, before: Box<dyn FnMut() + Send>) {
        if let Some(folder) = &mut self.folder {
            folder.waits = false;
            folder.writer.call_before(before);
        }
    }

    /// Save something, if there is a folder.
    pub(super) fn save(
        &mut self,
        key: Key,
        save: impl FnOnce(&mut StateFolder) -> Result<(), store::Error> + Send + 'static,
    ) -> Result<(), Refusal> {
        let write = move |folder: &mut StateFolder| {
            save(folder).map_err(|why| format!("it cannot be kept: {why}"))
        };
        self.write(key, Box::new(write))
            .map_err(|why| Refusal::because(format!("{why}; it stays as it was")))
    }

    /// Write something after all that was to be written before.
    pub(super) fn write(&mut self, key: Key, write: Write) -> Result<(), String> {
        let Some(KeptFolder { writer, waits, .. }) = &mut self.folder else { return Ok(()) };
        let ticket = writer.write(key, write);
        if *waits { writer.wait_for(&ticket) } else { Ok(()) }
    }

    /// What was to be written last.
    pub(super) fn last(&self) -> Option<Ticket> {
        self.folder.as_ref().and_then(|folder| folder.writer.last())
    }

    /// Something of the sync record is not on the disk yet.
    pub(super) fn is_writing_record(&self) -> bool {
        self.folder.as_ref().is_some_and(|folder| folder.writer.is_writing(Key::Record))
    }

    /// What could not be written since the last time, in sentences.
    pub(super) fn take_failed(&mut self) -> Vec<String> {
        match &mut self.folder {
            Some(folder) if !folder.waits => folder.writer.take_failed(),
            Some(_) | None => Vec::new(),
        }
    }

    /// Call this when what a ticket is of is on the disk, or cannot be written, and why.
    pub(super) fn when_written(
        &self,
        ticket: Ticket,
        then: impl FnOnce(Result<(), String>) + Send + 'static,
    ) {
        match &self.folder {
            Some(folder) => folder.writer.when_written(ticket, Box::new(then)),
            None => then(Ok(())),
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
