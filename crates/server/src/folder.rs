//! The folder of programs: nothing outside it is read or written, whatever a path says, and nothing
//! in it that is no program.
//!
//! A path is a few plain names with `/` between them. It is resolved, links too, and what it leads
//! to must lie in the folder, in none that holds state or secrets ([`Closed`]), have the name of a
//! program and be one ([`program_files`]). A file that is there is replaced only by who says which
//! version of it he replaces, or that it may be any; the version before is kept beside it.
mod replaced;

use crate::tokens::hex;
use crate::wire::{FileBody, FolderBody};
use control::job::program_files;
use control::operation::hosted::{RefusalData, RefusalKind};
use replaced::{Old, before};
use sha2::{Digest, Sha256};
use std::io::Write as _;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::UNIX_EPOCH;

/// Largest program that is written.
pub(crate) const LARGEST_PROGRAM: usize = 16 << 20;
/// Longest path.
const LONGEST_PATH: usize = 512;
/// Folders within folders that are listed.
const DEEPEST: usize = 4;
/// Files that are listed.
const MOST_FILES: usize = 2000;

/// Why a file is not had.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum FolderError {
    /// No path of a program within the folder, or no program, and why.
    NotAPath(String),
    /// There is no such file.
    Missing(String),
    /// There is one already, and it is not the one that was to be replaced.
    Exists(String, &'static str),
    /// The disk's own reason.
    Disk(String),
}

impl core::fmt::Display for FolderError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (Self::NotAPath(text) | Self::Missing(text) | Self::Exists(text, _) | Self::Disk(text)) =
            self;
        f.write_str(text)
    }
}

/// Which file may be replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Replaces {
    /// None: the program is new.
    Nothing,
    /// The one of one of these versions.
    Version(Vec<String>),
    /// Replaces the file whatever its version.
    Any,
}

/// A program, and which version of it this is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ProgramText {
    pub(crate) text: Vec<u8>,
    pub(crate) version: String,
}

/// A place that holds state or secrets, and is no part of the folder wherever it lies.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Closed {
    place: PathBuf,
    /// The same folder under another name, as a mount gives it.
    file: Option<FileId>,
}

/// Device and number of a file.
type FileId = (u64, u64);

#[cfg(unix)]
fn file_id(path: &Path) -> Option<FileId> {
    use std::os::unix::fs::MetadataExt as _;
    path.metadata().ok().map(|about| (about.dev(), about.ino()))
}

#[cfg(not(unix))]
const fn file_id(_: &Path) -> Option<FileId> {
    None
}

impl Closed {
    fn of(place: &Path) -> Self {
        let place = resolved(place);
        let file = file_id(&place);
        Self { place, file }
    }

    /// Whether a path, which is resolved, leads to it or into it.
    fn holds(&self, path: &Path) -> bool {
        let is_it = |folder: &Path| self.file.is_some() && file_id(folder) == self.file;
        path.starts_with(&self.place) || path.ancestors().any(is_it)
    }
}

/// A path without links, though its end may not be there yet.
fn resolved(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let real = whole.ancestors().find_map(|part| Some((part, part.canonicalize().ok()?)));
    match real {
        Some((part, real)) => match whole.strip_prefix(part) {
            Ok(rest) if !rest.as_os_str().is_empty() => real.join(rest),
            _ => real,
        },
        None => whole,
    }
}

/// The folder.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    root: PathBuf,
    /// As the folder was named.
    named: PathBuf,
    /// Folders of the server's own: where they lie is not for clients.
    own: Vec<PathBuf>,
    closed: Vec<Closed>,
    /// One program is written at a time, so that the one that is replaced is the one that was
    /// compared.
    writing: Arc<Mutex<()>>,
}

impl Folder {
    /// Of a folder that is there.
    ///
    /// # Errors
    /// It is none, or cannot be read.
    pub(crate) fn open(path: &Path) -> Result<Self, String> {
        let root = path
            .canonicalize()
            .map_err(|e| format!("cannot open the folder of programs {}: {e}", path.display()))?;
        if root.is_dir() {
            replaced::remove_remains(&root, DEEPEST);
            let (own, closed) = (Vec::new(), Vec::new());
            return Ok(Self { root, named: path.to_owned(), own, closed, writing: Arc::default() });
        }
        Err(format!("{} is no folder: --programs takes one", path.display()))
    }

    /// The folder itself.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// Without a folder in which all is the server's own. It does not stand in what clients are
    /// shown, either.
    ///
    /// # Errors
    /// The programs lie in it.
    pub(crate) fn without_folder(
        mut self,
        what: &str,
        folder: Option<&Path>,
    ) -> Result<Self, String> {
        let Some(folder) = folder else { return Ok(self) };
        let closed = Closed::of(folder);
        if closed.holds(&self.root) {
            return Err(format!(
                "the folder of programs {} lies in {what} {}: name another one with --programs",
                self.named.display(),
                folder.display()
            ));
        }
        self.own.extend([folder.to_owned(), closed.place.clone()]);
        self.closed.push(closed);
        Ok(self)
    }

    /// Without the folder in which a file with secrets lies.
    ///
    /// # Errors
    /// The file lies among the programs, and not in a folder of its own.
    pub(crate) fn without_folder_of(
        mut self,
        what: &str,
        file: Option<&Path>,
    ) -> Result<Self, String> {
        let Some(file) = file else { return Ok(self) };
        let place = resolved(file);
        let folder = Closed::of(place.parent().unwrap_or(&place));
        let root = Closed::of(&self.root);
        if folder.place == self.root || (folder.file.is_some() && folder.file == root.file) {
            return Err(format!(
                "{what} {} lies in the folder of programs {}: move it out, or name another folder with --programs",
                file.display(),
                self.named.display()
            ));
        }
        // where the programs lie below it, the file itself is closed, and that is outside them
        if !folder.holds(&self.root) {
            self.closed.push(folder);
        }
        self.closed.push(Closed::of(&place));
        Ok(self)
    }

    /// A text without this folder, and those of the server, in its paths.
    pub(crate) fn shown(&self, text: &str) -> String {
        let hidden = core::iter::once(&self.root).chain(&self.own);
        hidden.fold(text.to_owned(), |text, folder| {
            text.replace(&format!("{}/", folder.display()), "")
        })
    }

    /// A file that is there, for the control.
    ///
    /// # Errors
    /// It is not, or it is no path of a program within the folder.
    pub(crate) fn existing(&self, path: &str) -> Result<PathBuf, RefusalData> {
        self.find(path).map_err(|error| RefusalData {
            kind: RefusalKind::Request,
            reason: error.to_string(),
            remedy: None,
            findings: Vec::new(),
        })
    }

    /// A path within it, whether or not there is a file: what an editor writes may not be saved
    /// yet.
    pub(crate) fn place(&self, path: &str) -> Option<PathBuf> {
        self.find(path).ok().or_else(|| {
            let full = self.root.join(plain(path).ok()?);
            let folder = full.parent()?.canonicalize().ok()?;
            let is_inside = self.is_open(&folder) && !full.exists();
            is_inside.then_some(full)
        })
    }

    /// What stands within it of a path.
    pub(crate) fn within(&self, path: &Path) -> Option<PathBuf> {
        path.canonicalize().ok()?.strip_prefix(&self.root).ok().map(Path::to_owned)
    }

    /// Whether a path, which is resolved, lies in the folder and in nothing that is closed.
    fn is_open(&self, path: &Path) -> bool {
        path.starts_with(&self.root) && !self.closed.iter().any(|closed| closed.holds(path))
    }

    /// Where a path leads to that is there.
    fn find(&self, path: &str) -> Result<PathBuf, FolderError> {
        let relative = plain(path)?;
        let missing = || FolderError::Missing(format!("there is no program \"{}\"", short(path)));
        let full = self.root.join(&relative).canonicalize().map_err(|_| missing())?;
        if !self.is_open(&full) {
            return Err(outside(path));
        }
        named_as_program(path, &[&relative, &full])?;
        if full.is_file() { Ok(full) } else { Err(missing()) }
    }

    /// A program.
    ///
    /// # Errors
    /// It is not there, too large, no program, or cannot be read.
    pub(crate) fn read(&self, path: &str) -> Result<ProgramText, FolderError> {
        Self::read_at(&self.find(path)?, path)
    }

    /// The version of a program that was replaced last.
    ///
    /// # Errors
    /// There was no file.
    pub(crate) fn read_before(&self, path: &str) -> Result<ProgramText, FolderError> {
        let before = before(&self.find(path)?).filter(|before| before.is_file());
        let missing = || {
            let path = short(path);
            FolderError::Missing(format!("there is no version of \"{path}\" before this one"))
        };
        Self::read_at(&before.ok_or_else(missing)?, path)
    }

    fn read_at(full: &Path, path: &str) -> Result<ProgramText, FolderError> {
        let most = LARGEST_PROGRAM as u64;
        let text = store::read_bytes(full, "a program that is shown", most)
            .map_err(|e| FolderError::Disk(format!("cannot read \"{}\": {e}", short(path))))?;
        match program_files::check_text(&text) {
            // who has made an empty file can see that it is empty
            Err(why) if !text.is_empty() => Err(no_program(path, why)),
            _ => Ok(ProgramText { version: version(&text), text }),
        }
    }

    /// Writes a program, whole or not at all; which version it is.
    ///
    /// # Errors
    /// It is no path of a program within the folder, or no program; there is one already that is
    /// not to be replaced; the disk does not take it.
    pub(crate) fn write(
        &self,
        path: &str,
        text: &[u8],
        replaces: &Replaces,
    ) -> Result<String, FolderError> {
        program_files::check_text(text).map_err(|why| no_program(path, why))?;
        let target = self.target(path)?;
        let _one = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        let disk = |e: &dyn core::fmt::Display| {
            FolderError::Disk(format!("cannot write \"{}\": {e}", short(path)))
        };
        let old = Old::open(&target).map_err(|e| disk(&e))?;
        if old.as_ref().is_some_and(|old| old.has(text)) {
            // it is as it was: the version before stays what it is
            return match replaces {
                Replaces::Nothing => Err(exists(path)),
                Replaces::Version(_) | Replaces::Any => Ok(version(text)),
            };
        }
        may_replace(path, old.as_ref(), replaces)?;
        self.put(&target, text, old.as_ref()).map_err(|e| disk(&e))?;
        Ok(version(text))
    }

    /// Puts a text in a place, and the one that was there beside it.
    fn put(&self, target: &Path, text: &[u8], old: Option<&Old>) -> std::io::Result<()> {
        let beside = target.parent().unwrap_or(&self.root);
        let mut file = replaced::new_file(beside)?;
        file.write_all(text)?;
        if let Some(old) = old {
            old.give_permissions(&file)?;
        }
        file.as_file().sync_all()?;
        let placed = match old {
            None => file.persist_noclobber(target),
            Some(old) => {
                old.keep(beside)?;
                file.persist(target)
            }
        };
        placed.map(drop).map_err(|e| e.error)
    }

    /// Where a program is to be written.
    fn target(&self, path: &str) -> Result<PathBuf, FolderError> {
        let relative = plain(path)?;
        let full = self.root.join(&relative);
        let folder = full.parent().unwrap_or(&self.root).canonicalize().map_err(|_| {
            FolderError::Missing(format!("there is no folder for \"{}\"", short(path)))
        })?;
        let name = relative.file_name().ok_or_else(|| outside(path))?;
        let target = match std::fs::symlink_metadata(folder.join(name)) {
            Ok(_) => folder.join(name).canonicalize().map_err(|_| outside(path))?,
            Err(_) => folder.join(name),
        };
        if !self.is_open(&folder) || !self.is_open(&target) {
            return Err(outside(path));
        }
        if let Ok(about) = target.metadata() {
            must_be_a_file(path, &about)?;
        }
        named_as_program(path, &[&relative, &target])?;
        Ok(target)
    }

    /// Its files.
    pub(crate) fn list(&self) -> FolderBody {
        let mut programs = Vec::new();
        let is_shortened = !self.list_below(&self.root, DEEPEST, &mut programs);
        programs.sort_by(|a, b| a.path.cmp(&b.path));
        FolderBody { programs, is_shortened }
    }

    /// False: there are more.
    fn list_below(&self, folder: &Path, depth: usize, files: &mut Vec<FileBody>) -> bool {
        let Ok(entries) = std::fs::read_dir(folder) else { return true };
        let mut is_whole = true;
        for entry in entries.flatten() {
            if entry.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            let Ok(kind) = entry.file_type() else { continue };
            if kind.is_dir() {
                if !self.is_open(&entry.path()) {
                    continue;
                }
                is_whole &= depth > 0 && self.list_below(&entry.path(), depth - 1, files);
                continue;
            }
            let Some(path) = self.name_of(&entry.path()) else { continue };
            // what lies outside is not had, so it is not listed
            let Ok(data) = self.find(&path).and_then(|full| {
                std::fs::metadata(full).map_err(|e| FolderError::Disk(e.to_string()))
            }) else {
                continue;
            };
            if files.len() == MOST_FILES {
                return false;
            }
            let modified = data.modified().ok().and_then(|at| at.duration_since(UNIX_EPOCH).ok());
            let modified_s = modified.map_or(0, |since| since.as_secs());
            files.push(FileBody { path, bytes: data.len(), modified_s });
        }
        is_whole
    }

    fn name_of(&self, full: &Path) -> Option<String> {
        let below = full.strip_prefix(&self.root).ok()?;
        let names: Option<Vec<_>> = below.iter().map(|name| name.to_str()).collect();
        names.map(|names| names.join("/"))
    }
}

/// A few plain names with `/` between them.
fn plain(path: &str) -> Result<PathBuf, FolderError> {
    let wrong = |why: &str| Err(FolderError::NotAPath(format!("\"{}\" {why}", short(path))));
    if path.is_empty() || path.len() > LONGEST_PATH {
        return wrong(&format!("is no path: it has 1 to {LONGEST_PATH} characters"));
    }
    if path.chars().any(|c| c.is_control() || c == '\\') {
        return wrong("has characters that no program's path has");
    }
    let names: Vec<_> = Path::new(path).components().collect();
    for name in &names {
        match name {
            Component::Normal(name) if !name.to_string_lossy().starts_with('.') => {}
            Component::Normal(_) => return wrong("has a hidden name in it"),
            _ => return Err(outside(path)),
        }
    }
    Ok(names.iter().collect())
}

/// Which version a text is.
fn version(text: &[u8]) -> String {
    hex(&Sha256::digest(text)[..16])
}

/// What is replaced is a program: no folder, no named pipe, socket or device.
fn must_be_a_file(path: &str, about: &std::fs::Metadata) -> Result<(), FolderError> {
    let what = match about {
        about if about.is_file() => return Ok(()),
        about if about.is_dir() => "is a folder",
        _ => "is no file but a named pipe, a socket or a device: remove it, or write another one",
    };
    Err(FolderError::NotAPath(format!("\"{}\" {what}", short(path))))
}

/// Whether what is there may be replaced.
fn may_replace(path: &str, old: Option<&Old>, replaces: &Replaces) -> Result<(), FolderError> {
    let path = short(path);
    match (old, replaces) {
        (None, Replaces::Nothing | Replaces::Any) | (Some(_), Replaces::Any) => Ok(()),
        (Some(_), Replaces::Nothing) => Err(exists(&path)),
        (None, Replaces::Version(_)) => Err(FolderError::Exists(
            format!("\"{path}\" is no longer there"),
            "write it as a new program, without If-Match",
        )),
        (Some(old), Replaces::Version(known)) => {
            let text =
                old.read(LARGEST_PROGRAM as u64).map_err(|e| FolderError::Disk(e.to_string()))?;
            if known.contains(&version(&text)) {
                return Ok(());
            }
            Err(FolderError::Exists(
                format!("\"{path}\" has been changed since it was read"),
                "read it again, and write what is new with the If-Match of its ETag",
            ))
        }
    }
}

fn exists(path: &str) -> FolderError {
    FolderError::Exists(
        format!("there is a \"{}\" already", short(path)),
        "send If-Match with the ETag of the program that is replaced, or write to ?replace=true",
    )
}

/// All of these have the name of a program.
fn named_as_program(path: &str, files: &[&Path]) -> Result<(), FolderError> {
    if files.iter().all(|file| program_files::has_name_of_one(file)) {
        return Ok(());
    }
    Err(no_program(path, &program_files::names()))
}

fn no_program(path: &str, why: &str) -> FolderError {
    FolderError::NotAPath(format!("\"{}\" is no program: {why}", short(path)))
}

fn outside(path: &str) -> FolderError {
    let reason = format!("\"{}\" leads out of the folder of programs", short(path));
    FolderError::NotAPath(reason)
}

fn short(path: &str) -> String {
    path.chars().take(80).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_outside_the_folder_is_read_or_written() {
        let outside = tempfile::tempdir().expect("a folder");
        std::fs::write(outside.path().join("secret.ngc"), "M30\n").expect("written");
        let inside = outside.path().join("programs");
        std::fs::create_dir(&inside).expect("made");
        std::os::unix::fs::symlink(outside.path(), inside.join("out")).expect("linked");
        std::os::unix::fs::symlink(outside.path().join("secret.ngc"), inside.join("link.ngc"))
            .expect("linked");
        std::os::unix::fs::symlink(outside.path().join("new.ngc"), inside.join("dangling.ngc"))
            .expect("linked");
        let folder = Folder::open(&inside).expect("opened");
        for path in [
            "../secret.ngc",
            "/etc/passwd",
            "a/../../secret.ngc",
            "./../secret.ngc",
            "out/secret.ngc",
            "link.ngc",
            "dangling.ngc",
            "..",
            ".",
            "",
            ".hidden",
            "a\\b",
            "a\0b",
        ] {
            assert!(folder.read(path).is_err(), "{path:?} was read");
            let written = folder.write(path, b"M2\n", &Replaces::Any);
            assert!(written.is_err(), "{path:?} was written");
        }
        assert_eq!(std::fs::read(outside.path().join("secret.ngc")).expect("read"), b"M30\n");
        assert!(!outside.path().join("new.ngc").exists());
        assert!(folder.list().programs.is_empty(), "{:?}", folder.list());
    }

    /// Each of these would wait for a program at the other end.
    #[test]
    fn what_is_no_file_is_neither_read_nor_written_nor_listed_nor_waited_for() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        let pipe = |name: &str| {
            let made = std::process::Command::new("mkfifo").arg(at(name)).status();
            assert!(made.expect("run").success());
        };
        pipe("pipe.ngc");
        std::os::unix::fs::symlink("pipe.ngc", at("link.ngc")).expect("linked");
        let _listener = std::os::unix::net::UnixListener::bind(at("socket.ngc")).expect("bound");
        std::os::unix::fs::symlink("/dev/null", at("device.ngc")).expect("linked");
        let folder = Folder::open(dir.path()).expect("opened");
        let version = Replaces::Version(vec!["0".into()]);
        for name in ["pipe.ngc", "link.ngc", "socket.ngc", "device.ngc"] {
            for replaces in [&Replaces::Any, &Replaces::Nothing, &version] {
                let written = folder.write(name, b"M2\n", replaces);
                assert!(matches!(written, Err(FolderError::NotAPath(_))), "{name}: {written:?}");
            }
            assert!(folder.read(name).is_err() && folder.read_before(name).is_err(), "{name}");
            assert!(folder.existing(name).is_err() && folder.place(name).is_none(), "{name}");
        }
        assert!(folder.list().programs.is_empty(), "{:?}", folder.list());
        // the version before a program
        folder.write("a.ngc", b"G0 X1\n", &Replaces::Nothing).expect("written");
        pipe(".a.ngc.before");
        assert!(folder.read_before("a.ngc").is_err());
        folder.write("a.ngc", b"G0 X2\n", &Replaces::Any).expect("written");
        assert_eq!(folder.read_before("a.ngc").expect("kept").text, b"G0 X1\n");
        let hidden = std::fs::read_dir(dir.path()).expect("read").flatten();
        let hidden = hidden.filter(|e| e.file_name().to_string_lossy().starts_with(".leadscrew"));
        assert_eq!(hidden.count(), 0, "nothing is left of what was written");
    }

    #[test]
    fn a_program_is_written_whole_and_read_again() {
        let dir = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(dir.path().join("parts")).expect("made");
        let folder = Folder::open(dir.path()).expect("opened");
        folder.write("parts/a.ngc", b"G0 X1\n", &Replaces::Nothing).expect("written");
        let again = folder.write("parts/a.ngc", b"G0 X2\n", &Replaces::Nothing);
        assert!(matches!(again, Err(FolderError::Exists(..))), "{again:?}");
        folder.write("parts/a.ngc", b"G0 X2\n", &Replaces::Any).expect("overwritten");
        assert_eq!(folder.read("parts/a.ngc").expect("read").text, b"G0 X2\n");
        let list = folder.list();
        assert_eq!(list.programs.len(), 1);
        assert_eq!((list.programs[0].path.as_str(), list.programs[0].bytes), ("parts/a.ngc", 6));
        let full = folder.existing("parts/a.ngc").expect("there");
        assert_eq!(folder.shown(&format!("{}: bad", full.display())), "parts/a.ngc: bad");
    }

    #[test]
    fn who_replaces_a_program_says_which_and_the_one_before_is_kept() {
        let dir = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(dir.path()).expect("opened");
        let write = |text: &[u8], replaces| folder.write("a.ngc", text, &replaces);
        let of = |versions: &[&String]| {
            Replaces::Version(versions.iter().map(|&version| version.clone()).collect())
        };
        let first = write(b"G0 X1\n", Replaces::Nothing).expect("new");
        assert!(folder.read_before("a.ngc").is_err(), "there was none");
        assert_eq!(folder.read("a.ngc").expect("read").version, first);
        let second = write(b"G0 X2\n", of(&[&first])).expect("it is the one");
        assert_eq!(folder.read_before("a.ngc").expect("kept").text, b"G0 X1\n");
        let stale = write(b"G0 X3\n", of(&[&first]));
        assert!(matches!(stale, Err(FolderError::Exists(..))), "{stale:?}");
        // the same once more leaves the version before as it is
        assert_eq!(write(b"G0 X2\n", of(&[&second])), Ok(second));
        assert_eq!(folder.read_before("a.ngc").expect("kept").text, b"G0 X1\n");
        assert!(matches!(write(b" \n", Replaces::Any), Err(FolderError::NotAPath(_))));
        assert_eq!(folder.read("a.ngc").expect("read").text, b"G0 X2\n");
        std::fs::remove_file(dir.path().join("a.ngc")).expect("removed");
        let gone = write(b"G0 X3\n", of(&[&first]));
        assert!(matches!(gone, Err(FolderError::Exists(..))), "{gone:?}");
    }

    #[test]
    fn nothing_but_programs_is_read_written_or_listed() {
        let dir = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(dir.path()).expect("opened");
        let files = ["key.pem", "tokens.toml", "parameters.var", "lock", "mqtt-login"];
        for file in files {
            std::fs::write(dir.path().join(file), "secret").expect("written");
            let link = dir.path().join(format!("{}.ngc", file.replace('.', "-")));
            std::os::unix::fs::symlink(dir.path().join(file), &link).expect("linked");
            let link = link.file_name().and_then(|name| name.to_str()).expect("a name").to_owned();
            for path in [file, &link] {
                let read = folder.read(path);
                assert!(matches!(read, Err(FolderError::NotAPath(_))), "{path}: {read:?}");
                assert!(folder.existing(path).is_err(), "{path}");
                assert!(folder.write(path, b"M2\n", &Replaces::Any).is_err(), "{path}");
            }
        }
        std::fs::write(dir.path().join("key.ngc"), "-----BEGIN PRIVATE KEY-----\n")
            .expect("written");
        assert!(folder.read("key.ngc").is_err(), "a program's name alone makes none");
        let secret = b"[[token]]\nname = \"mine\"\n";
        assert!(folder.write("mine.ngc", secret, &Replaces::Any).is_err());
        let listed = folder.list().programs;
        assert_eq!(listed.iter().map(|file| &*file.path).collect::<Vec<_>>(), ["key.ngc"]);
        for file in files {
            assert_eq!(std::fs::read(dir.path().join(file)).expect("read"), b"secret", "{file}");
        }
    }

    #[test]
    fn what_holds_state_or_secrets_is_no_part_of_it_and_is_told_apart_or_refused() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        for folder in ["shop/out/lathe", "shop/parts", "elsewhere"] {
            std::fs::create_dir_all(at(folder)).expect("made");
        }
        for file in ["shop/out/lathe/a.ngc", "shop/parts/a.ngc", "shop/t.toml", "shop/out/t.toml"] {
            std::fs::write(at(file), "M30\n").expect("written");
        }
        std::os::unix::fs::symlink(at("shop/out"), at("elsewhere/link")).expect("linked");
        std::os::unix::fs::symlink(at("shop/out/lathe"), at("shop/parts/link")).expect("linked");
        let open = || Folder::open(&at("shop")).expect("opened");
        let state = |folder: Folder, place: &str| {
            folder.without_folder("the state folder", Some(&at(place)))
        };
        let tokens = |folder: Folder, place: &str| {
            folder.without_folder_of("the file of tokens", Some(&at(place)))
        };
        for place in ["shop/out/lathe", "elsewhere/link/lathe", "shop/out/lathe/../lathe"] {
            let folder = state(open(), place).expect("told apart");
            assert!(folder.read("parts/a.ngc").is_ok());
            for path in ["out/lathe/a.ngc", "out/lathe/new.ngc", "parts/link/a.ngc"] {
                assert!(folder.read(path).is_err(), "{place}: {path}");
                assert!(folder.write(path, b"M2\n", &Replaces::Any).is_err(), "{place}: {path}");
                assert!(folder.place(path).is_none(), "{place}: {path}");
            }
            assert_eq!(folder.list().programs.len(), 1, "{place}");
        }
        let folder = state(open(), "shop/not/there/yet").expect("told apart");
        std::fs::create_dir_all(at("shop/not/there/yet")).expect("made");
        assert!(folder.write("not/there/yet/a.ngc", b"M2\n", &Replaces::Any).is_err());
        for place in ["shop", ".", "shop/parts/.."] {
            let why = state(open(), place).expect_err("it cannot be told apart");
            assert!(why.contains("the state folder") && why.contains("shop"), "{why}");
        }
        assert!(tokens(open(), "shop/out/t.toml").expect("apart").read("out/lathe/a.ngc").is_err());
        let why = tokens(open(), "shop/t.toml").expect_err("it lies among the programs");
        assert!(why.contains("t.toml") && why.contains("shop"), "{why}");
        let inner = Folder::open(&at("shop/parts")).expect("opened");
        assert!(tokens(inner, "shop/t.toml").expect("apart").read("a.ngc").is_ok());
    }
}
