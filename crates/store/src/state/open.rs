//! A state folder is opened: what the control wrote last is in force again, and where that is not
//! so, or cannot be shown, each value is named.
//!
//! | the datum's file | the manifest has it | in force |
//! |---|---|---|
//! | as the manifest has it | yes | it |
//! | cut short, changed, missing, older, of another folder | yes | what the manifest has; that is said |
//! | edited by hand, and says so | yes | the file; each value that differs is a change |
//! | newer than the manifest | yes | the file; each value that differs is a change |
//! | any | no manifest is left | the file, or the version before it; each value is a change |
//!
//! Refused is the state of another machine, and one that a newer version has written. A folder in
//! which no control has kept anything is new, and nothing is said of it.
use super::changes::{self, FIRST_DAY, StateChange, UNKNOWN};
use super::manifest::{MANIFESTS, MachineIdentity, Manifest};
use super::seal::{self, Datum, Sealed, Untrusted};
use super::{AlarmFile, Finding, FolderLock, Machine, NEW, State, StateFolder, Weight};
use super::{plain, previous};
use crate::Error;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;

/// What is found while a folder is opened.
#[derive(Default)]
struct FolderFindings {
    findings: Vec<Finding>,
    changes: Vec<StateChange>,
    /// Some file of a control is there.
    any: bool,
}

impl StateFolder {
    /// Open the folder of this machine, make it if it is missing; what it says, and what the
    /// operator should know about it.
    ///
    /// # Errors
    /// The folder cannot be made or read; it is another machine's, or of a newer version; another
    /// control has it open: then its process is named.
    pub fn open(
        path: &Path,
        machine: &MachineIdentity,
    ) -> Result<(Self, State, Vec<Finding>), Error> {
        fs::create_dir_all(path)
            .map_err(|cause| Error::file("create the state folder", path, cause))?;
        let lock = FolderLock::take(path)?;
        let mut folder = Self {
            path: path.to_owned(),
            lock,
            manifest: Manifest::new(machine.clone(), path),
            next: None,
            stale: BTreeSet::new(),
            rejected: BTreeSet::new(),
            alarms: AlarmFile::default(),
            is_batch: false,
        };
        folder.remove_remains()?;
        let mut found = FolderFindings::default();
        let has_manifest = folder.read_manifests(machine, &mut found)?;
        if !has_manifest {
            folder.refuse_legacy(machine, &mut found)?;
        }
        let state = State {
            parameters: folder.read(has_manifest, &mut found)?,
            tools: folder.read(has_manifest, &mut found)?,
            changer: folder.read(has_manifest, &mut found)?,
            homed: folder.read(has_manifest, &mut found)?.unwrap_or_default(),
            last_program: folder.read(has_manifest, &mut found)?,
            alarms: folder.read_alarms(has_manifest, &mut found),
            settings: folder.read(has_manifest, &mut found)?,
            workpiece: folder.read(has_manifest, &mut found)?,
            changes: Vec::new(),
        };
        Ok(folder.opened(state, has_manifest, found))
    }

    /// What differs is kept until it is acknowledged, and what was damaged is whole again.
    fn opened(
        mut self,
        mut state: State,
        has_manifest: bool,
        mut found: FolderFindings,
    ) -> (Self, State, Vec<Finding>) {
        if !has_manifest && !found.any && self.lock.had_state() {
            found.changes.push(StateChange {
                datum: "all that was kept".into(),
                before: UNKNOWN.into(),
                now: FIRST_DAY.into(),
                why: "a control has kept its state in this folder, and its files are gone".into(),
            });
        }
        let differs = !found.changes.is_empty();
        if differs || !has_manifest || !self.stale.is_empty() {
            self.next().unacknowledged.extend(found.changes);
        }
        let manifest = self.next.as_ref().unwrap_or(&self.manifest);
        state.changes.clone_from(&manifest.unacknowledged);
        let repaired = self.commit().and_then(|()| {
            let name = AlarmFile::NAME;
            if self.rejected.contains(name) && differs {
                self.set_aside(name)?;
                self.alarms.must_be_written_anew();
                self.alarms.repair(&self.path)?;
            }
            Ok(())
        });
        if let Err(why) = repaired {
            let said = format!("cannot be written yet: {why}");
            found.findings.push(Finding::new(MANIFESTS[0], Weight::Note, said));
        }
        (self, state, found.findings)
    }

    /// Returns true if a manifest of this machine is there: the one of the highest generation is in
    /// force.
    fn read_manifests(
        &mut self,
        machine: &MachineIdentity,
        found: &mut FolderFindings,
    ) -> Result<bool, Error> {
        let (mut ours, mut foreign, mut newer, mut bad) = (Vec::new(), None, None, Vec::new());
        for name in MANIFESTS {
            match self.look::<Manifest>(name) {
                Ok(Some(Sealed { value, .. })) if value.machine == *machine => {
                    ours.push((name, value));
                }
                Ok(Some(Sealed { value, .. })) => {
                    bad.push((name, format!("is of the machine {}", value.machine)));
                    self.rejected.insert(name.to_owned());
                    foreign = Some(value.machine.to_string());
                }
                Ok(None) => bad.push((name, "is missing".into())),
                Err(why) => {
                    if matches!(why, Untrusted::Version { .. }) {
                        newer = Some(why.clone());
                    }
                    found.any = true;
                    bad.push((name, why.to_string()));
                }
            }
        }
        // one of another folder fits none of the data
        let folders = self.folders_of_data();
        if !folders.is_empty() {
            for (name, _) in ours.extract_if(.., |(_, of)| !folders.contains(&of.folder)) {
                self.rejected.insert(name.to_owned());
                bad.push((name, "is of another folder".into()));
                found.any = true;
            }
        }
        let best = ours.iter().map(|(_, manifest)| manifest.generation).max();
        let Some(best) = best else {
            return match (foreign, newer) {
                (Some(other), _) => Err(self.of_another(&other, &machine.to_string())),
                (None, Some(why)) => {
                    let why = format!("{} {why}: name another folder", MANIFESTS[0]);
                    Err(Error::file("use the state folder", &self.path, io::Error::other(why)))
                }
                (None, None) => Ok(false),
            };
        };
        found.any = true;
        for (name, why) in bad {
            self.stale.insert(MANIFESTS[0]);
            // killed before its first copy was there
            if best > 1 || why != "is missing" {
                let said = format!("{why}: its copy is used");
                found.findings.push(Finding::new(name, Weight::Note, said));
            }
        }
        if ours.iter().any(|(_, manifest)| manifest.generation < best) {
            self.stale.insert(MANIFESTS[0]);
        }
        let newest = ours.into_iter().find(|(_, manifest)| manifest.generation == best);
        self.manifest = newest.map_or_else(Manifest::default, |(_, manifest)| manifest);
        Ok(true)
    }

    /// Marks of the folders in which the data that are there were written.
    fn folders_of_data(&self) -> Vec<String> {
        let of = |name: &str| {
            let bytes = plain::read(&self.path.join(name), Manifest::LARGEST).ok()??;
            seal::origin(&bytes).map(|origin| origin.folder)
        };
        super::data::FILES.iter().filter_map(|name| of(name)).collect()
    }

    /// A folder without manifest may say in `machine.toml` whose it is.
    fn refuse_legacy(
        &mut self,
        machine: &MachineIdentity,
        found: &mut FolderFindings,
    ) -> Result<(), Error> {
        match self.look::<Machine>(Machine::FILE) {
            Ok(Some(Sealed { value, .. })) if value.name != machine.name => {
                Err(self.of_another(&format!("`{}`", value.name), &machine.to_string()))
            }
            Ok(None) => Ok(()),
            Ok(Some(_)) | Err(_) => {
                found.any = true;
                Ok(())
            }
        }
    }

    fn of_another(&self, other: &str, own: &str) -> Error {
        let why = format!(
            "it is the state of the machine {other}, and this one is {own}: name another folder"
        );
        Error::file("use the state folder", &self.path, io::Error::other(why))
    }

    /// Reads a file; one that is not believed is set aside before its name is written.
    fn look<D: Datum>(&mut self, name: &str) -> Result<Option<Sealed<D>>, Untrusted> {
        let read = plain::read(&self.path.join(name), D::LARGEST);
        let read = read.and_then(|bytes| bytes.map(|b| seal::open::<D>(&b)).transpose());
        if read.is_err() {
            self.rejected.insert(name.to_owned());
        }
        read
    }

    /// A datum that is in force.
    fn read<D: Datum>(
        &mut self,
        has_manifest: bool,
        found: &mut FolderFindings,
    ) -> Result<Option<D>, Error> {
        let mut file = self.look::<D>(D::FILE);
        found.any |= !matches!(file, Ok(None));
        if !has_manifest {
            return self.read_alone(file, found);
        }
        if let Ok(Some(Sealed { origin: Some(origin), .. })) = &file
            && origin.folder != self.manifest.folder
        {
            let own = (self.manifest.folder.clone(), self.manifest.machine.name.clone());
            let other = (origin.folder.clone(), origin.machine.clone());
            file = Err(Untrusted::OtherOrigin { found: other, own });
            self.rejected.insert(D::FILE.to_owned());
        }
        let Some(entry) = self.manifest.entry(D::FILE).cloned() else {
            return Ok(self.read_unlisted(file, found));
        };
        let kept = "what the control wrote last is in force, from the manifest";
        let mut say = |weight, rest: String| {
            found.findings.push(Finding::new(D::FILE, weight, rest));
        };
        match file {
            Ok(Some(Sealed { value, is_edited: false, .. })) if value.body() == entry.body => {
                return Ok(Some(value));
            }
            Ok(Some(Sealed { value, is_edited: true, .. })) => {
                say(Weight::Note, "was edited by hand: it is used as it stands".into());
                let body = value.body();
                if body != entry.body {
                    let why = format!("{} was edited by hand and is in force", D::FILE);
                    found.changes.extend(changes::between(
                        D::FILE,
                        Some(&entry.body),
                        Some(&body),
                        &why,
                    ));
                }
                self.stage::<D>(body);
                self.stale.insert(D::FILE);
                return Ok(Some(value));
            }
            Ok(Some(Sealed { value, origin: Some(origin), .. }))
                if origin.generation > self.manifest.generation =>
            {
                let why = format!(
                    "{} of {} is in force: it is newer than the manifest, which has it of {}",
                    D::FILE,
                    origin.when,
                    entry.when
                );
                let body = value.body();
                let changes = changes::between(D::FILE, Some(&entry.body), Some(&body), &why);
                found.changes.extend(changes);
                self.next().generation = origin.generation + 1;
                self.stage::<D>(body);
                self.stale.insert(D::FILE);
                return Ok(Some(value));
            }
            Ok(Some(Sealed { origin, .. })) => {
                // a control was killed before the file had followed the manifest
                if origin.is_none_or(|origin| origin.generation != entry.before) {
                    say(Weight::Note, format!("is older than the manifest: {kept}"));
                    self.rejected.insert(D::FILE.to_owned());
                }
            }
            Ok(None) => {
                if entry.before > 0 || entry.generation < self.manifest.generation {
                    say(Weight::Note, format!("is missing: {kept}"));
                }
            }
            Err(why) => say(Weight::Note, format!("{why}: {kept}")),
        }
        self.stale.insert(D::FILE);
        match D::parse(&entry.body) {
            Ok(value) => Ok(Some(value)),
            Err(why) => {
                let why = format!("{} and the manifest say what cannot be ({why})", D::FILE);
                found.changes.extend(changes::between(D::FILE, Some(&entry.body), None, &why));
                Ok(None)
            }
        }
    }

    /// A file of which the manifest knows nothing.
    fn read_unlisted<D: Datum>(
        &mut self,
        file: Result<Option<Sealed<D>>, Untrusted>,
        found: &mut FolderFindings,
    ) -> Option<D> {
        let said = match file {
            Ok(None) => return None,
            Ok(Some(Sealed { value, is_edited, origin })) => {
                let newer = origin.filter(|origin| origin.generation > self.manifest.generation);
                if is_edited || newer.is_some() {
                    let body = value.body();
                    let why = match &newer {
                        Some(newer) => {
                            self.next().generation = newer.generation + 1;
                            format!("{} of {} is newer than the manifest", D::FILE, newer.when)
                        }
                        None => format!("{} was written by hand and is in force", D::FILE),
                    };
                    let changes = changes::between(D::FILE, Some(""), Some(&body), &why);
                    found.changes.extend(changes);
                    self.stage::<D>(body);
                    self.stale.insert(D::FILE);
                    return Some(value);
                }
                self.rejected.insert(D::FILE.to_owned());
                "is not what this control has written: nothing of it is used".into()
            }
            Err(why) => format!("{why}: nothing of it is used"),
        };
        found.findings.push(Finding::new(D::FILE, Weight::Lost, said));
        None
    }

    /// A datum of a folder without manifest: the file, or the version before it.
    fn read_alone<D: Datum>(
        &mut self,
        file: Result<Option<Sealed<D>>, Untrusted>,
        found: &mut FolderFindings,
    ) -> Result<Option<D>, Error> {
        let before = previous(D::FILE);
        let why = match &file {
            Ok(Some(_)) => "",
            Ok(None) => "is missing",
            Err(why) => &why.to_string(),
        };
        let mut old = Ok(None);
        if !why.is_empty() {
            old = self.look::<D>(&before);
            found.any |= !matches!(old, Ok(None));
            if matches!((&file, &old), (Ok(None), Ok(None))) {
                return Ok(None);
            }
        }
        let (name, weight, read) = match (file, old) {
            (Ok(Some(file)), _) => (D::FILE.to_owned(), Weight::Note, Some(file)),
            (_, Ok(Some(old))) => (before, Weight::PreviousUsed, Some(old)),
            _ => (before, Weight::Lost, None),
        };
        let end = match weight {
            Weight::Note => "it is used, and no manifest shows that it was written last",
            Weight::PreviousUsed => "the version before it is used",
            Weight::Lost => "nothing of it is used",
        };
        let colon = if why.is_empty() { "has no manifest" } else { why };
        found.findings.push(Finding::new(D::FILE, weight, format!("{colon}: {end}")));
        let Some(Sealed { value, origin, .. }) = read else {
            let why = format!("{} {colon}, and no copy of it is left", D::FILE);
            found.changes.extend(changes::between(D::FILE, None, None, &why));
            return Ok(None);
        };
        if let Some(origin) = origin.as_ref().filter(|o| o.machine != self.manifest.machine.name) {
            let own = self.manifest.machine.to_string();
            return Err(self.of_another(&format!("`{}`", origin.machine), &own));
        }
        let when = origin.map_or_else(
            || "of a time that is not known".into(),
            |o| {
                let next = self.next();
                next.generation = next.generation.max(o.generation + 1);
                format!("of {}", o.when)
            },
        );
        let why = format!("{name} {when} is in force: no manifest shows what was written last");
        let body = value.body();
        found.changes.extend(changes::between(D::FILE, None, Some(&body), &why));
        self.stage::<D>(body);
        self.stale.insert(D::FILE);
        Ok(Some(value))
    }

    fn read_alarms(
        &mut self,
        has_manifest: bool,
        found: &mut FolderFindings,
    ) -> Vec<super::AlarmRecord> {
        let name = AlarmFile::NAME;
        let mut known = self.manifest.alarms;
        match plain::read(&self.path.join(name), AlarmFile::LARGEST) {
            Ok(None) => {}
            Ok(Some(bytes)) => {
                found.any = true;
                let (file, bad) = AlarmFile::parse(&bytes);
                if bad > 0 {
                    self.rejected.insert(name.to_owned());
                    let lines = if bad == 1 { "1 line".into() } else { format!("{bad} lines") };
                    let said = format!("has {lines} cut short or changed: the others are used");
                    found.findings.push(Finding::new(name, Weight::Note, said));
                }
                self.alarms = file;
            }
            Err(why) => {
                found.any = true;
                self.rejected.insert(name.to_owned());
                let said = format!("{why}: nothing of it is used");
                found.findings.push(Finding::new(name, Weight::Lost, said));
                known = known.max(1);
            }
        }
        known = known.max(self.alarms.last());
        let missing = self.alarms.hold_to(known);
        let left = self.alarms.alarms().len();
        if missing > 0 {
            self.rejected.insert(name.to_owned());
            found.changes.push(StateChange {
                datum: "history of alarms".into(),
                before: format!("{} alarms", left as u64 + missing),
                now: format!("{left} alarms"),
                why: format!("{name} was cut short or changed: what is whole of it is used"),
            });
        }
        let file = self.path.join(name);
        if missing == 0 && !has_manifest && found.any && file.symlink_metadata().is_ok() {
            found.changes.push(StateChange {
                datum: "history of alarms".into(),
                before: UNKNOWN.into(),
                now: format!("{left} alarms"),
                why: "no manifest shows how many there were".into(),
            });
        }
        if missing > 0 || !has_manifest {
            self.next().alarms = self.alarms.last();
        }
        self.alarms.alarms().to_vec()
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
