//! What a control keeps when it is switched off, or killed: one folder, one file a datum, each
//! written whole or not at all.
//!
//! ```text
//!   parameters.var  work offsets and numbered parameters    alarms.jsonl   alarms, a line each
//!   tools.toml      tools with wear and life                settings.toml  overrides, switches, units
//!   homing.toml     references of absolute encoders         program.toml   the last program and its position
//!   workpiece.toml  the workpiece, and what was cut from it
//!   manifest.toml, manifest.copy.toml                       lock           process of the control that has it
//!                   all of it as it was written last, twice
//!
//!   save: new files, fsync ─► rename manifest.toml, fsync ─► link the file in force as NAME.previous,
//!         rename the new one to NAME, rename manifest.copy.toml, fsync
//! ```
//!
//! The first lines of each file say what it is, its version, the checksum of all that follows, and
//! when and for which machine it was written ([`seal`]). What does not fit is not believed: what
//! the manifest has of it is in force (`open`). Where something else is in force than what was
//! written last, or where nothing shows what that was, each value is a [`StateChange`], until it is
//! acknowledged. Nothing that was in the folder is removed: what was not believed is kept as
//! `NAME.rejected-1`, `-2` …
mod alarms;
pub mod broken_tools;
mod changer;
mod changes;
mod data;
pub mod lock;
mod manifest;
pub mod message_log;
mod open;
mod plain;
pub mod seal;

pub use alarms::{AlarmRecord, MOST_ALARMS};
pub use changer::{ChangerRecord, HalfWay};
pub use changes::StateChange;
pub use data::{HomedAxis, Homing, LastProgram, LengthDisplay, Machine, Settings, WorkpieceRecord};
pub use manifest::{MachineIdentity, Origin, today};
pub use seal::{Datum, Untrusted};

use crate::Error;
use crate::parameters::Parameters;
use alarms::AlarmFile;
use canon::ToolLibrary;
use lock::FolderLock;
use manifest::{MANIFESTS, Manifest};
use std::collections::BTreeSet;
use std::fmt;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Names of files that are being written; one that a killed control has left is removed by the
/// next.
const NEW: &str = ".state-new-";
/// Files of one name that are kept because they were not believed.
const MOST_REJECTED: u32 = 99;

/// What was found in a folder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Numbered parameters, work offsets among them; `None`: none were kept.
    pub parameters: Option<Parameters>,
    /// The tools; `None`: none were kept.
    pub tools: Option<ToolLibrary>,
    /// References of absolute encoders.
    pub homed: Homing,
    /// The program that was loaded last, and how far it came.
    pub last_program: Option<LastProgram>,
    /// Alarms, the oldest first.
    pub alarms: Vec<AlarmRecord>,
    /// What the operator had set; `None`: nothing was kept.
    pub settings: Option<Settings>,
    /// The workpiece on the machine; `None`: none was kept.
    pub workpiece: Option<WorkpieceRecord>,
    /// Where the tools of a changer are that a sequence works; `None`: that was not kept.
    pub changer: Option<ChangerRecord>,
    /// What is not what the control wrote last, and was not acknowledged.
    pub changes: Vec<StateChange>,
}

/// What became of a file that was not as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// It is used, and the operator should know something about it.
    Note,
    /// The version before it is used.
    PreviousUsed,
    /// Nothing of it could be used: the datum is as on the first day.
    Lost,
}

/// Something that the operator should know about a file of the folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Name of the file.
    pub file: String,
    /// What became of it.
    pub weight: Weight,
    /// A sentence that begins with the file's name.
    pub sentence: String,
}

impl Finding {
    fn new(file: &str, weight: Weight, rest: impl fmt::Display) -> Self {
        Self { file: file.to_owned(), weight, sentence: format!("{file} {rest}") }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence)
    }
}

/// A folder of a control's state, for one control at a time.
#[derive(Debug)]
pub struct StateFolder {
    path: PathBuf,
    lock: FolderLock,
    /// What is in force on the disk.
    manifest: Manifest,
    /// What is in force with the next commit.
    next: Option<Manifest>,
    /// Files that are written with the next commit though nothing of them changes.
    stale: BTreeSet<&'static str>,
    /// Files that were not believed: they are set aside before their name is needed.
    rejected: BTreeSet<String>,
    alarms: AlarmFile,
    /// What is saved waits for [`StateFolder::commit`].
    is_batch: bool,
}

impl StateFolder {
    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its lock, for the sync record, which lies in the same folder.
    pub fn lock(&self) -> FolderLock {
        self.lock.clone()
    }

    /// What is saved from now on is on the disk with the next [`StateFolder::commit`].
    pub fn begin_batch(&mut self) {
        self.is_batch = true;
    }

    /// Keep numbered parameters and work offsets.
    ///
    /// # Errors
    /// The disk refuses; what was kept before counts on.
    pub fn save_parameters(&mut self, parameters: &Parameters) -> Result<(), Error> {
        self.save(parameters)
    }

    /// Keep the tools, with wear and life.
    ///
    /// # Errors
    /// As [`StateFolder::save_parameters`].
    pub fn save_tools(&mut self, tools: &ToolLibrary) -> Result<(), Error> {
        self.save(tools)
    }

    /// Keep the references of absolute encoders.
    ///
    /// # Errors
    /// As [`StateFolder::save_parameters`].
    pub fn save_homed(&mut self, homed: &Homing) -> Result<(), Error> {
        self.save(homed)
    }

    /// Keep which program is loaded, and how far it is.
    ///
    /// # Errors
    /// As [`StateFolder::save_parameters`].
    pub fn save_last_program(&mut self, program: &LastProgram) -> Result<(), Error> {
        self.save(program)
    }

    /// Keep what the operator has set.
    ///
    /// # Errors
    /// As [`StateFolder::save_parameters`].
    pub fn save_settings(&mut self, settings: &Settings) -> Result<(), Error> {
        self.save(settings)
    }

    /// Keep which workpiece is on the machine, and what was cut from it.
    ///
    /// # Errors
    /// As [`StateFolder::save_parameters`].
    pub fn save_workpiece(&mut self, workpiece: &WorkpieceRecord) -> Result<(), Error> {
        self.save(workpiece)
    }

    /// Keep where the tools are, and how far a tool change is.
    ///
    /// # Errors
    /// As [`StateFolder::save_parameters`].
    pub fn save_changer(&mut self, changer: &ChangerRecord) -> Result<(), Error> {
        self.save(changer)
    }

    /// Keep an alarm, after those that are kept already; of very many the oldest are forgotten.
    ///
    /// # Errors
    /// As [`StateFolder::save_parameters`].
    pub fn save_alarm(&mut self, alarm: AlarmRecord) -> Result<(), Error> {
        let name = AlarmFile::NAME;
        if self.rejected.contains(name) {
            self.set_aside(name)?;
            self.alarms.must_be_written_anew();
        }
        self.alarms.add(&self.path, alarm)?;
        let last = self.alarms.last();
        self.next().alarms = last;
        self.end_save()
    }

    /// The operator has seen what differs from what the control wrote last: it is in force.
    ///
    /// # Errors
    /// As [`StateFolder::save_parameters`].
    pub fn acknowledge(&mut self) -> Result<(), Error> {
        self.next().unacknowledged.clear();
        self.end_save()
    }

    /// Save a datum whole: when this returns it is on the disk, unless a batch was begun.
    fn save<D: Datum>(&mut self, datum: &D) -> Result<(), Error> {
        self.stage::<D>(datum.body());
        self.end_save()
    }

    /// A datum is written with the next commit, if it is not what is written already.
    fn stage<D: Datum>(&mut self, body: String) {
        let manifest = self.next.as_ref().unwrap_or(&self.manifest);
        let is_same = manifest.entry(D::FILE).is_some_and(|entry| entry.body == body);
        if !is_same {
            self.next().set(D::FILE, body);
        }
    }

    fn next(&mut self) -> &mut Manifest {
        let Self { manifest, next, .. } = self;
        next.get_or_insert_with(|| Manifest {
            generation: manifest.generation + 1,
            ..manifest.clone()
        })
    }

    fn end_save(&mut self) -> Result<(), Error> {
        if self.is_batch { Ok(()) } else { self.commit() }
    }

    /// What was saved is on the disk when this returns; a batch is over.
    ///
    /// # Errors
    /// The disk refuses: nothing of it counts.
    pub fn commit(&mut self) -> Result<(), Error> {
        self.is_batch = false;
        let Some(next) = self.next.take() else { return Ok(()) };
        let is_due = |name: &str, generation| {
            generation == next.generation || self.stale.iter().any(|stale| *stale == name)
        };
        let due = next.file.iter().filter(|entry| is_due(&entry.name, entry.generation));
        let files: Vec<(String, String)> =
            due.map(|entry| (entry.name.clone(), sealed_entry(&next, entry))).collect();
        for name in files.iter().map(|(name, _)| name.as_str()).chain(MANIFESTS) {
            for name in [name.to_owned(), previous(name)] {
                if self.rejected.contains(&name) {
                    self.set_aside(&name)?;
                }
            }
        }
        let manifest = seal::sealed_as(Manifest::KIND, Manifest::VERSION, None, &next.body());
        self.write_together(&manifest, &files)
            .map_err(|cause| Error::file("write", &self.path, cause))?;
        self.stale.clear();
        self.manifest = next;
        Ok(())
    }

    /// All is written under names of its own and on the disk before the first takes its place: a
    /// full disk changes nothing.
    fn write_together(&mut self, manifest: &str, files: &[(String, String)]) -> io::Result<()> {
        let new = |text: &str| {
            let mut new = tempfile::Builder::new().prefix(NEW).tempfile_in(&self.path)?;
            new.write_all(text.as_bytes())?;
            new.as_file().sync_all()?;
            io::Result::Ok(new)
        };
        let (first, copy) = (new(manifest)?, new(manifest)?);
        let written: Vec<_> =
            files.iter().map(|(name, text)| Ok((name, new(text)?))).collect::<io::Result<_>>()?;
        let into = |new: tempfile::NamedTempFile, name: &str| {
            new.persist(self.path.join(name)).map(drop).map_err(|e| e.error)
        };
        into(first, MANIFESTS[0])?;
        crate::output::sync_folder(&self.path)?;
        for (name, new) in written {
            self.keep_previous(name)?;
            into(new, name)?;
        }
        into(copy, MANIFESTS[1])?;
        crate::output::sync_folder(&self.path)?;
        self.lock.keeps_state()
    }

    /// The file in force is kept as the version before.
    fn keep_previous(&self, name: &str) -> io::Result<()> {
        let (path, before) = (self.path.join(name), self.path.join(previous(name)));
        // a link first: at every instant both names are there, and hold whole files
        let link = self.path.join(format!("{NEW}{name}"));
        remove(&link)?;
        match fs::hard_link(&path, &link) {
            Ok(()) => {
                fs::rename(&link, &before)?;
                // renaming one link of a file over another one leaves both
                remove(&link)
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
            // a file system without links
            Err(_) => fs::rename(&path, &before),
        }
    }

    /// Keep a file that was not believed under another name.
    fn set_aside(&mut self, name: &str) -> Result<(), Error> {
        let from = self.path.join(name);
        let failed = |cause| Error::file("set aside", &from, cause);
        let free = (1..=MOST_REJECTED)
            .map(|n| self.path.join(format!("{name}.rejected-{n}")))
            .find(|to| to.symlink_metadata().is_err());
        let Some(to) = free else {
            let why =
                format!("{MOST_REJECTED} files {name}.rejected-… are kept already: remove some");
            return Err(failed(io::Error::other(why)));
        };
        match fs::rename(&from, to) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(failed(e)),
            _ => {}
        }
        self.rejected.remove(name);
        Ok(())
    }
}

/// Remove a name that may not be there.
fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

/// Name of the version before.
fn previous(name: &str) -> String {
    format!("{name}.previous")
}

/// A datum's file.
fn sealed_entry(manifest: &Manifest, entry: &manifest::WrittenDatum) -> String {
    let (kind, version) = data::kind(&entry.name);
    seal::sealed_as(kind, version, Some(&manifest.origin(entry)), &entry.body)
}
