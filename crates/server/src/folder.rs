//! The folder of programs: nothing outside it is read or written, whatever a path says.
//!
//! A path is a few plain names with `/` between them. It is resolved, links too, and what it leads
//! to must lie in the folder.
use crate::wire::{FileBody, FolderBody};
use control::operation::hosted::{RefusalData, RefusalKind};
use std::io::Write as _;
use std::path::{Component, Path, PathBuf};
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
    /// No path within the folder, and why.
    NotAPath(String),
    /// There is no such file.
    Missing(String),
    /// There is one already.
    Exists(String),
    /// The disk's own reason.
    Disk(String),
}

impl core::fmt::Display for FolderError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (Self::NotAPath(text) | Self::Missing(text) | Self::Exists(text) | Self::Disk(text)) =
            self;
        f.write_str(text)
    }
}

/// The folder.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    root: PathBuf,
    /// Folders of the server's own: where they lie is not for clients.
    own: Vec<PathBuf>,
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
            return Ok(Self { root, own: Vec::new() });
        }
        Err(format!("{} is no folder: --programs takes one", path.display()))
    }

    /// The folder itself.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// This folder of the server does not stand in what clients are shown, either.
    #[must_use]
    pub(crate) fn hiding(mut self, folder: Option<&Path>) -> Self {
        let whole = folder.and_then(|folder| folder.canonicalize().ok());
        self.own.extend(folder.map(Path::to_owned).into_iter().chain(whole));
        self
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
    /// It is not, or it is no path within the folder.
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
            let is_inside = folder.starts_with(&self.root) && !full.exists();
            is_inside.then_some(full)
        })
    }

    /// What stands within it of a path.
    pub(crate) fn within(&self, path: &Path) -> Option<PathBuf> {
        path.canonicalize().ok()?.strip_prefix(&self.root).ok().map(Path::to_owned)
    }

    /// Where a path leads to that is there.
    fn find(&self, path: &str) -> Result<PathBuf, FolderError> {
        let full = self.root.join(plain(path)?);
        let missing = || FolderError::Missing(format!("there is no program \"{}\"", short(path)));
        let full = full.canonicalize().map_err(|_| missing())?;
        if !full.starts_with(&self.root) {
            return Err(outside(path));
        }
        if full.is_file() { Ok(full) } else { Err(missing()) }
    }

    /// A program's text.
    ///
    /// # Errors
    /// It is not there, too large, or cannot be read.
    pub(crate) fn read(&self, path: &str) -> Result<Vec<u8>, FolderError> {
        let full = self.find(path)?;
        let disk =
            |e: std::io::Error| FolderError::Disk(format!("cannot read \"{}\": {e}", short(path)));
        let bytes = std::fs::metadata(&full).map_err(disk)?.len();
        if bytes > LARGEST_PROGRAM as u64 {
            return Err(FolderError::Disk(format!(
                "\"{}\" is too large: {bytes} bytes, a program is {LARGEST_PROGRAM} at most",
                short(path)
            )));
        }
        std::fs::read(&full).map_err(disk)
    }

    /// Write a program, whole or not at all.
    ///
    /// # Errors
    /// It is no path within the folder, is there already and must not be, or cannot be written.
    pub(crate) fn write(
        &self,
        path: &str,
        text: &[u8],
        overwrites: bool,
    ) -> Result<(), FolderError> {
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
        if !folder.starts_with(&self.root) || !target.starts_with(&self.root) {
            return Err(outside(path));
        }
        if target.is_dir() {
            let reason = format!("\"{}\" is a folder", short(path));
            return Err(FolderError::NotAPath(reason));
        }
        if !overwrites && target.exists() {
            return Err(FolderError::Exists(format!("there is a \"{}\" already", short(path))));
        }
        let disk = |e: &dyn core::fmt::Display| {
            FolderError::Disk(format!("cannot write \"{}\": {e}", short(path)))
        };
        let beside = target.parent().unwrap_or(&self.root);
        let mut file = tempfile::Builder::new()
            .prefix(".leadscrew-")
            .tempfile_in(beside)
            .map_err(|e| disk(&e))?;
        file.write_all(text).map_err(|e| disk(&e))?;
        file.as_file().sync_all().map_err(|e| disk(&e))?;
        let kept = if overwrites { file.persist(&target) } else { file.persist_noclobber(&target) };
        kept.map_err(|e| disk(&e.error))?;
        Ok(())
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
            assert!(folder.write(path, b"M2\n", true).is_err(), "{path:?} was written");
        }
        assert_eq!(std::fs::read(outside.path().join("secret.ngc")).expect("read"), b"M30\n");
        assert!(!outside.path().join("new.ngc").exists());
        assert!(folder.list().programs.is_empty(), "{:?}", folder.list());
    }

    #[test]
    fn a_program_is_written_whole_and_read_again() {
        let dir = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(dir.path().join("parts")).expect("made");
        let folder = Folder::open(dir.path()).expect("opened");
        folder.write("parts/a.ngc", b"G0 X1\n", false).expect("written");
        let again = folder.write("parts/a.ngc", b"G0 X2\n", false);
        assert!(matches!(again, Err(FolderError::Exists(_))), "{again:?}");
        folder.write("parts/a.ngc", b"G0 X2\n", true).expect("overwritten");
        assert_eq!(folder.read("parts/a.ngc").expect("read"), b"G0 X2\n");
        let list = folder.list();
        assert_eq!(list.programs.len(), 1);
        assert_eq!((list.programs[0].path.as_str(), list.programs[0].bytes), ("parts/a.ngc", 6));
        let full = folder.existing("parts/a.ngc").expect("there");
        assert_eq!(folder.shown(&format!("{}: bad", full.display())), "parts/a.ngc: bad");
    }
}
