//! A machine in another process, which outlives the control: the sync record that is kept of it,
//! and a tool that a control before this one has left in its work. It is a machine simulator, or a
//! component of LinuxCNC's HAL.
//!
//! ```text
//!   switched on: machine keeps, record says, encoders show ──► nothing is in the work │ left: nothing but recovery moves
//!   program:     record on the disk ──► machine is told of the tool ──► … ──► tool is out ──► machine is told ──► record says so
//! ```
//!
//! Places in the record are those that the machine's encoders read: the axes of a control that
//! begins are not homed.
use super::kept::{Kept, LockedFolder};
use crate::drives::remote::identity;
use crate::recovery::{self, LeftTool};
use bus::{EngagedTool, Feedback};
use shm::RetainedState;
use std::path::Path;
use store::machine::MachineFile;
use store::sync_record::slots::Slots;
use store::sync_record::{Identity, SyncRecord, Untrusted};
use units::Time;
use wire::{Observed, Welcome};

/// See the module's header.
pub(super) struct Outside {
    pub(super) welcome: Welcome,
    pub(super) identity: Identity,
    /// The tool that the machine is told to be in its work.
    pub(super) engagement: Option<EngagedTool>,
    pub(super) left: Option<LeftTool>,
    /// The tool is out: when the record says so.
    pub(super) is_out: Option<Time>,
    pub(super) has_told_loss: bool,
    pub(super) kind: OutsideKind,
}

/// What is in the other process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OutsideKind {
    Simulator,
    Hal,
}

/// A tool that a control before this one has left in the work: what is known of it, and what is
/// not.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct LeftInWork {
    /// The tool, by the record.
    pub tool: Option<u32>,
    /// The program that led it there …
    pub program: Option<String>,
    /// … the line …
    pub line: Option<u32>,
    /// … and which of its holes and threads it is, counted from 1.
    pub hole: Option<u32>,
    /// How far the tip of a tap stands below the surface, mm; below zero it is above.
    pub depth_mm: Option<f64>,
    /// How far the program led it, mm below the surface.
    pub programmed_depth_mm: Option<f64>,
    /// How far it stands off its thread, µm …
    pub off_thread_um: Option<f64>,
    /// … and what that is certain to.
    pub within_um: Option<f64>,
    /// On what the certainty rests, or why there is none.
    pub certain_by: Option<String>,
    /// What moves first, in a sentence.
    pub moves_first: Option<String>,
    /// Why it may be broken.
    pub not_known_whole: Option<String>,
    /// Why no recovery takes it out; `null`: `recover` does.
    pub refused: Option<String>,
}

/// What is kept of a machine that a component of HAL leads, which has begun a session; what the
/// operator should know of it.
pub(super) fn on_hal(
    machine: &MachineFile,
    retained: &RetainedState,
    feedback: &Feedback,
    kept: &Kept,
) -> (Outside, Option<String>) {
    let welcome = Welcome {
        machine: machine.name.clone(),
        serial: 0,
        epoch: retained.loaded,
        period: machine.control.period,
        real_time: true,
        turns_lost: [false; bus::SPINDLES],
        stop: retained.stop,
        evidence: retained.evidence,
        observed: Observed { feedback: *feedback, truth: None },
    };
    let mut outside = Outside::new(welcome, OutsideKind::Hal);
    let said = outside.find(kept.folder(), machine);
    (outside, said)
}

impl Outside {
    /// A machine that has said what it keeps as it was connected; what the operator should know.
    pub(super) fn welcomed(
        welcome: Welcome,
        machine: &MachineFile,
        kept: &Kept,
    ) -> (Self, Option<String>) {
        let mut outside = Self::new(welcome, OutsideKind::Simulator);
        let said = outside.find(kept.folder(), machine);
        (outside, said)
    }

    fn new(welcome: Welcome, kind: OutsideKind) -> Self {
        Self {
            identity: identity(&welcome),
            engagement: welcome.evidence.in_work,
            welcome,
            left: None,
            is_out: None,
            has_told_loss: false,
            kind,
        }
    }

    /// Whether a control before this one has left a tool in the work, by machine, record and
    /// encoders; what is said of it.
    fn find(&mut self, folder: Option<&LockedFolder>, machine: &MachineFile) -> Option<String> {
        match folder.map(|folder| (folder, self.read(folder))) {
            Some((folder, Ok(record))) => {
                self.look(record.clone(), folder.path(), machine);
                if self.left.is_none() && record.is_some_and(|record| record.stage.is_in_work()) {
                    self.is_out = Some(Time::ZERO); // machine or encoders show it
                }
            }
            Some((_, Err(why))) => self.left = Some(LeftTool::Unmoved(None, why.to_string())),
            None => {
                let why = self.engagement.map(|kept| {
                    format!(
                        "the machine keeps that tool {} is in its work (engagement {}), and this control has no sync record of it: name \
                         the state folder of the control that led it there with --state",
                        kept.tool, kept.number
                    )
                });
                self.left = why.map(|why| LeftTool::Unmoved(None, why));
            }
        }
        let left = self.left.as_ref()?;
        Some(match left.record() {
            Some(record) => {
                let (tool, place) = (record.stroke.tool, &record.place);
                format!(
                    "tool {tool} stands in the work: it was left at line {} of {}",
                    place.line, place.program
                )
            }
            None => "a tool may stand in the work".to_owned(),
        })
    }

    pub(super) fn read(&self, folder: &LockedFolder) -> Result<Option<SyncRecord>, Untrusted> {
        Slots::open(folder.for_record(), &self.identity).map(|(_, kept)| kept.record)
    }

    pub(super) fn look(
        &mut self,
        record: Option<SyncRecord>,
        folder: &Path,
        machine: &MachineFile,
    ) {
        let folder = folder.display().to_string();
        self.left = recovery::left(record, &self.welcome, &folder, machine);
    }
}
