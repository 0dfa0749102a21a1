//! What a control keeps when it is switched off, or killed: one folder, one file a datum, each
//! written whole or not at all.
//!
//! ```text
//!   parameters.var  work offsets and numbered parameters    alarms.jsonl   alarms, a line each
//!   tools.toml      tools with wear and life                settings.toml  overrides, switches, units
//!   homing.toml     references of absolute encoders         program.toml   the last program and its position
//!   machine.toml    whose folder this is                    lock           process of the control that has it
//!
//!   save: new file, fsync ─► link the one in force as NAME.previous ─► rename the new one to NAME ─► fsync the folder
//! ```
//!
//! The first line of each file says what it is, its version and the checksum of all that follows
//! ([`seal`]). What does not fit is not believed: the version before it is used, and that is said.
//! Nothing that was in the folder is removed: what was not believed is kept as `NAME.rejected-1`,
//! `-2` … when the datum is saved next.
mod alarms;
mod data;
pub mod lock;
pub mod message_log;
mod plain;
pub mod seal;

pub use alarms::{AlarmRecord, MOST_ALARMS};
pub use data::{HomedAxis, Homing, LastProgram, LengthDisplay, Machine, Settings};
pub use seal::{Datum, Untrusted};

use crate::Error;
use crate::parameters::Parameters;
use alarms::AlarmFile;
use canon::ToolLibrary;
use lock::FolderLock;
use seal::Sealed;
use std::collections::{BTreeMap, BTreeSet};
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
    /// What is in force on the disk, so that nothing is written that is there already.
    written: BTreeMap<&'static str, String>,
    /// Files that were not believed: they are set aside before their name is needed.
    rejected: BTreeSet<String>,
    alarms: AlarmFile,
}

impl StateFolder {
    /// Open a folder, make it if it is missing; what it says, and what the operator should know
    /// about it.
    ///
    /// # Errors
    /// The folder cannot be made or read, or another control has it open: then its process is
    /// named.
    pub fn open(path: &Path) -> Result<(Self, State, Vec<Finding>), Error> {
        fs::create_dir_all(path)
            .map_err(|cause| Error::file("create the state folder", path, cause))?;
        let lock = FolderLock::take(path)?;
        let mut folder = Self {
            path: path.to_owned(),
            lock,
            written: BTreeMap::new(),
            rejected: BTreeSet::new(),
            alarms: AlarmFile::default(),
        };
        folder.remove_remains()?;
        let mut found = Vec::new();
        let state = State {
            parameters: folder.read(&mut found),
            tools: folder.read(&mut found),
            homed: folder.read(&mut found).unwrap_or_default(),
            last_program: folder.read(&mut found),
            alarms: folder.read_alarms(&mut found),
            settings: folder.read(&mut found),
        };
        Ok((folder, state, found))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its lock, for the sync record, which lies in the same folder.
    pub fn lock(&self) -> FolderLock {
        self.lock.clone()
    }

    /// This folder is that machine's: it is marked so, or it is another one's.
    ///
    /// # Errors
    /// The folder of another machine, whose offsets and tools this one must not use; a disk that
    /// refuses.
    pub fn claim(&mut self, machine: &str) -> Result<Vec<Finding>, Error> {
        let mut found = Vec::new();
        match self.read::<Machine>(&mut found) {
            Some(known) if known.name != machine => {
                let why = format!(
                    "it is the state of the machine `{}`, and this one is `{machine}`: name another folder",
                    known.name
                );
                Err(Error::file("use the state folder", &self.path, io::Error::other(why)))
            }
            Some(_) => Ok(found),
            None => self.save(&Machine { name: machine.to_owned() }).map(|()| found),
        }
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
        self.alarms.add(&self.path, alarm)
    }

    /// Save a datum whole: when this returns it is on the disk.
    fn save<D: Datum>(&mut self, datum: &D) -> Result<(), Error> {
        let body = datum.body();
        if self.written.get(D::FILE) == Some(&body) {
            return Ok(());
        }
        for name in [D::FILE.to_owned(), previous(D::FILE)] {
            if self.rejected.contains(&name) {
                self.set_aside(&name)?;
            }
        }
        let text = seal::sealed::<D>(&body);
        self.replace(D::FILE, text.as_bytes())
            .map_err(|cause| Error::file("write", &self.path.join(D::FILE), cause))?;
        self.written.insert(D::FILE, body);
        Ok(())
    }

    /// The new bytes under their name, the old ones as the version before.
    fn replace(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut new = tempfile::Builder::new().prefix(NEW).tempfile_in(&self.path)?;
        new.write_all(bytes)?;
        new.as_file().sync_all()?;
        let (path, before) = (self.path.join(name), self.path.join(previous(name)));
        // a link first: at every instant both names are there, and hold whole files
        let link = self.path.join(format!("{NEW}{name}"));
        remove(&link)?;
        match fs::hard_link(&path, &link) {
            Ok(()) => {
                fs::rename(&link, &before)?;
                // renaming one link of a file over another one leaves both
                remove(&link)?;
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            // a file system without links
            Err(_) => fs::rename(&path, &before)?,
        }
        new.persist(&path).map_err(|e| e.error)?;
        crate::output::sync_folder(&self.path)
    }

    /// A datum: the version in force, or the one before it.
    fn read<D: Datum>(&mut self, found: &mut Vec<Finding>) -> Option<D> {
        let before = previous(D::FILE);
        let mut look = |name: &str| {
            let read = plain::read(&self.path.join(name), D::LARGEST);
            let read = read.and_then(|bytes| bytes.map(|b| seal::open::<D>(&b)).transpose());
            if read.is_err() {
                self.rejected.insert(name.to_owned());
            }
            read
        };
        let why = match look(D::FILE) {
            Ok(Some(Sealed { value, is_edited })) => {
                if is_edited {
                    let said = "was edited by hand: it is used as it stands";
                    found.push(Finding::new(D::FILE, Weight::Note, said));
                } else {
                    self.written.insert(D::FILE, value.body());
                }
                return Some(value);
            }
            Ok(None) => None,
            Err(why) => Some(why),
        };
        let (weight, value, said) = match (why, look(&before)) {
            (None, Ok(None)) => return None,
            (None, Ok(Some(old))) => (Weight::PreviousUsed, Some(old.value), "is missing".into()),
            (Some(why), Ok(Some(old))) => (Weight::PreviousUsed, Some(old.value), why.to_string()),
            (Some(why), Ok(None)) => (Weight::Lost, None, why.to_string()),
            (None, Err(old)) => (Weight::Lost, None, format!("is missing, and {before} {old}")),
            (Some(why), Err(old)) => (Weight::Lost, None, format!("{why}; {before} {old}")),
        };
        let end = match weight {
            Weight::Note | Weight::PreviousUsed => "the version before it is used",
            Weight::Lost => "nothing of it is used",
        };
        found.push(Finding::new(D::FILE, weight, format!("{said}: {end}")));
        value
    }

    fn read_alarms(&mut self, found: &mut Vec<Finding>) -> Vec<AlarmRecord> {
        let name = AlarmFile::NAME;
        match plain::read(&self.path.join(name), AlarmFile::LARGEST) {
            Ok(None) => Vec::new(),
            Ok(Some(bytes)) => {
                let (file, bad) = AlarmFile::parse(&bytes);
                if bad > 0 {
                    self.rejected.insert(name.to_owned());
                    let lines = if bad == 1 { "1 line".into() } else { format!("{bad} lines") };
                    let said = format!("has {lines} cut short or changed: the others are used");
                    found.push(Finding::new(name, Weight::Note, said));
                }
                self.alarms = file;
                self.alarms.alarms().to_vec()
            }
            Err(why) => {
                self.rejected.insert(name.to_owned());
                let said = format!("{why}: nothing of it is used");
                found.push(Finding::new(name, Weight::Lost, said));
                Vec::new()
            }
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

    /// What a killed control was writing.
    fn remove_remains(&self) -> Result<(), Error> {
        let failed = |cause| Error::file("read the state folder", &self.path, cause);
        for entry in fs::read_dir(&self.path).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            if is_file && entry.file_name().to_string_lossy().starts_with(NEW) {
                // one that cannot be removed is in the way of nothing
                let _ = fs::remove_file(entry.path());
            }
        }
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
