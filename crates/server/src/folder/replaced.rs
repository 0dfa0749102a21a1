//! A program that is replaced: opened once, compared, and kept beside the new one; and the hidden
//! files in which programs are written.
//!
//! ```text
//!   .leadscrew-program-Xy12   the new text, fsync ──rename──► part.ngc
//!   .leadscrew-program-Zw34   the old one,  fsync ──rename──► .part.ngc.before
//! ```
//!
//! Each is locked as long as it is written, so one that is not is what a killed server has left.
use std::fs::{File, Metadata};
use std::io::{self, Read as _, Seek as _};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// How names begin under which a program is written.
const NEW: &str = ".leadscrew-program-";

/// The program that is there.
pub(super) struct Old {
    file: File,
    about: Metadata,
    place: PathBuf,
}

impl Old {
    /// The file at a place; `None`: there is none.
    ///
    /// # Errors
    /// It is no regular file, or cannot be opened.
    pub(super) fn open(place: &Path) -> io::Result<Option<Self>> {
        let file = match store::regular::open(place) {
            Ok(file) => file,
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(e),
        };
        let about = file.metadata()?;
        Ok(Some(Self { file, about, place: place.to_owned() }))
    }

    /// Whether it has just this text.
    pub(super) fn has(&self, text: &[u8]) -> bool {
        let length = text.len() as u64;
        self.about.len() == length && self.read(length).is_ok_and(|there| there == text)
    }

    /// Reads its text, up to a limit in bytes.
    pub(super) fn read(&self, most: u64) -> Result<Vec<u8>, store::Error> {
        // a regular file has a beginning; where it has not, less is read, and it is another text
        let _ = (&self.file).rewind();
        store::read_stream(&self.file, &self.place, "a program that is replaced", most)
    }

    /// Keeps it where the version before is kept.
    pub(super) fn keep(&self, folder: &Path) -> io::Result<()> {
        let Some(before) = before(&self.place) else { return Ok(()) };
        let mut kept = new_file(folder)?;
        (&self.file).rewind()?;
        io::copy(&mut (&self.file).take(self.about.len()), kept.as_file_mut())?;
        self.give_permissions(&kept)?;
        kept.as_file().sync_all()?;
        kept.persist(before).map(drop).map_err(|e| e.error)
    }

    /// A file may be read and written by whom this one may be.
    pub(super) fn give_permissions(&self, to: &NamedTempFile) -> io::Result<()> {
        to.as_file().set_permissions(self.about.permissions())
    }
}

/// Where the version before is kept: beside it, hidden.
pub(super) fn before(target: &Path) -> Option<PathBuf> {
    let name = target.file_name()?.to_str()?;
    Some(target.with_file_name(format!(".{name}.before")))
}

/// A hidden file in which a program is written.
pub(super) fn new_file(folder: &Path) -> io::Result<NamedTempFile> {
    let new = tempfile::Builder::new().prefix(NEW).tempfile_in(folder)?;
    // on a file system without locks it is not removed by a later server
    let _ = new.as_file().try_lock();
    Ok(new)
}

/// Removes what a killed server was writing, in a folder and those in it down to a depth.
pub(super) fn remove_remains(folder: &Path, depth: usize) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let (name, Ok(kind)) = (entry.file_name(), entry.file_type()) else { continue };
        let name = name.to_string_lossy();
        if kind.is_dir() && depth > 0 && !name.starts_with('.') {
            remove_remains(&entry.path(), depth - 1);
        }
        if kind.is_file() && name.starts_with(NEW) {
            let is_left = |file: File| file.try_lock().is_ok();
            if store::regular::open(&entry.path()).is_ok_and(is_left) {
                // one that cannot be removed is in the way of nothing
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_a_killed_server_was_writing_is_removed_and_what_another_one_writes_is_not() {
        let home = tempfile::tempdir().expect("a folder");
        let at = |name: &str| home.path().join(name);
        fs::create_dir(at("parts")).expect("made");
        let left = [at(".leadscrew-program-Ab12"), at("parts/.leadscrew-program-Cd34")];
        let others = [at("a.ngc"), at(".a.ngc.before"), at("parts/.leadscrew-Ef56")];
        for file in left.iter().chain(&others) {
            fs::write(file, "M2\n").expect("written");
        }
        let pipe = at(".leadscrew-program-pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("run").success());
        let written = new_file(home.path()).expect("made");
        remove_remains(home.path(), 1);
        assert!(left.iter().all(|file| !file.exists()), "{left:?}");
        assert!(others.iter().all(|file| file.exists()), "{others:?}");
        assert!(written.path().exists() && pipe.exists());
    }
}
