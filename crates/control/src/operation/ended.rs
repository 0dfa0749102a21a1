//! A program that has ended, with all that report, certificate and history are made from.
use super::event::Alarm;
use crate::Outcome;
use crate::job::Session;
use crate::job::preflight::Proved;
use crate::observers::TraceThread;
use std::path::PathBuf;
use store::output::Folder;

/// A program that has ended, was given up, or was stopped by an alarm.
pub struct EndedProgram {
    /// The folder of the run, with its trace; it vanishes if it is not finished.
    pub folder: Folder,
    /// What writes its trace: to be waited for before the folder is finished.
    pub trace: Option<TraceThread>,
    /// Its name.
    pub name: String,
    /// Where it lies.
    pub path: PathBuf,
    /// Its text.
    pub text: Vec<u8>,
    /// What it met.
    pub session: Session,
    /// What was known of it.
    pub proved: Proved,
    /// What came of it: features and violated safety checks are its own, not those of programs
    /// before it.
    pub outcome: Outcome,
    /// What has stopped it.
    pub alarms: Vec<Alarm>,
    /// Which of the machines of this file it was.
    pub seed: u64,
}

impl EndedProgram {
    /// Without what was cut, and seen, before its first operation.
    pub(super) fn alone(mut self, first: u32) -> Self {
        self.outcome.features.retain(|feature| feature.op >= first);
        self.outcome.watch = self.outcome.watch.of_program();
        let alarm = |fault| Alarm::of(fault, Some(self.name.clone()));
        self.alarms = self.outcome.faults.iter().map(alarm).collect();
        self
    }
}
