//! A folder of results that is complete or not there; a file that is the old one or the new one.
//!
//! ```text
//!   out/ is not there yet:                          out/ is there:
//!
//!   .out-Xy12/  report.html                         out/.leadscrew-Xy12/  report.html …
//!               certificate.json                    1 remove out/certificate.json
//!      │ fsync  trace.parquet                       2 rename each file into out/
//!      ▼ rename                                     3 certificate.json last
//!   out/
//! ```
//!
//! A folder that is there keeps what others put into it: only the names of this run are replaced.
//! The certificate goes first and comes last, so at every instant, a power cut included, a
//! certificate that lies in the folder belongs to the files beside it. A run that fails or is
//! refused leaves `out/` as it was; a killed one leaves a hidden folder besides.
use crate::{Error, regular};
use std::{
    ffi::OsStr,
    fs::{self, File},
    io::{self, Write},
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// The file that says that a folder is complete.
pub const CERTIFICATE: &str = "certificate.json";

/// A folder of results in the making. Dropped without [`Folder::finish`], it vanishes.
#[derive(Debug)]
pub struct Folder {
    destination: PathBuf,
    exists: bool,
    making: TempDir,
}

impl Folder {
    /// Begin a folder that shall become `destination`.
    ///
    /// # Errors
    /// When `destination` is a file, its parent is missing, or nothing can be written there.
    pub fn begin(destination: &Path) -> Result<Self, Error> {
        let failed = |cause| Error::file("create the folder", destination, cause);
        let exists = match fs::metadata(destination) {
            Ok(meta) if meta.is_dir() => true,
            Ok(_) => return Err(failed(io::Error::other("there is a file of that name"))),
            Err(e) if e.kind() == io::ErrorKind::NotFound => false,
            Err(e) => return Err(failed(e)),
        };
        let making = if exists {
            hidden(".leadscrew-", FOLDER_MODE).tempdir_in(destination)
        } else {
            let name = destination.file_name().unwrap_or(OsStr::new("out")).to_string_lossy();
            hidden(&format!(".{name}-"), FOLDER_MODE).tempdir_in(parent(destination))
        };
        Ok(Self { destination: destination.to_owned(), exists, making: making.map_err(failed)? })
    }

    /// Where it will be.
    pub fn destination(&self) -> &Path {
        &self.destination
    }

    /// Where a file of this run is written until it is finished.
    pub fn path(&self, name: &str) -> PathBuf {
        self.making.path().join(name)
    }

    /// Write a file whole.
    ///
    /// # Errors
    /// When the file system refuses.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        regular::create(&self.path(name))
            .and_then(|mut file| file.write_all(bytes))
            .map_err(|cause| Error::file("write", &self.destination.join(name), cause))
    }

    /// Everything is written: put it on the disk and under its name.
    ///
    /// # Errors
    /// When the file system refuses; what was at the destination is still there then, but for the
    /// certificate if some of the files have been replaced already.
    pub fn finish(self) -> Result<PathBuf, Error> {
        self.put_in_place().map_err(|cause| Error::file("write", &self.destination, cause))?;
        Ok(self.destination.clone())
    }

    fn put_in_place(&self) -> io::Result<()> {
        let mut names = Vec::new();
        for entry in fs::read_dir(self.making.path())? {
            let entry = entry?;
            regular::open(&entry.path())?.sync_all()?;
            names.push(entry.file_name());
        }
        sync_folder(self.making.path())?;
        if !self.exists {
            fs::rename(self.making.path(), &self.destination)?;
            return sync_folder(parent(&self.destination));
        }
        let certificate = self.destination.join(CERTIFICATE);
        if names.iter().any(|n| n == CERTIFICATE) && certificate.exists() {
            fs::remove_file(&certificate)?;
            sync_folder(&self.destination)?;
        }
        names.sort_by_key(|name| name == CERTIFICATE);
        for name in names {
            fs::rename(self.making.path().join(&name), self.destination.join(&name))?;
        }
        sync_folder(&self.destination)
    }
}

/// A file in the making. Dropped without [`NewFile::finish`], it vanishes, and what was at its
/// place stays.
#[derive(Debug)]
pub struct NewFile {
    destination: PathBuf,
    file: tempfile::NamedTempFile,
}

impl NewFile {
    /// Begin a file that shall become `destination`.
    ///
    /// # Errors
    /// Nothing can be written there.
    pub fn begin(destination: &Path) -> Result<Self, Error> {
        let begin = || hidden(".leadscrew-", FILE_MODE).tempfile_in(parent(destination));
        let begun = regular::may_be_replaced(destination).and_then(|()| begin());
        let file = begun.map_err(|cause| Error::file("create", destination, cause))?;
        Ok(Self { destination: destination.to_owned(), file })
    }

    /// Where it is written.
    pub fn as_file(&self) -> &File {
        self.file.as_file()
    }

    /// It is whole: put it on the disk and under its name.
    ///
    /// # Errors
    /// The file system refuses; what was there is there still.
    pub fn finish(self) -> Result<(), Error> {
        let Self { destination, file } = self;
        let placed = || {
            file.as_file().sync_all()?;
            file.persist(&destination).map_err(|e| e.error)?;
            sync_folder(parent(&destination))
        };
        placed().map_err(|cause| Error::file("write", &destination, cause))
    }
}

/// Write one file so that a reader sees the old or the new one, never half of it.
///
/// # Errors
/// When the file system refuses, or no file is there; what is there is untouched then.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    regular::may_be_replaced(path).map_err(|cause| Error::file("write", path, cause))?;
    replace(path, bytes)
}

/// The same, whatever is there.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let written = || {
        let mut file = hidden(".leadscrew-", FILE_MODE).tempfile_in(parent(path))?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|e| e.error)?;
        sync_folder(parent(path))
    };
    written().map_err(|cause| Error::file("write", path, cause))
}

/// The folder that holds a path.
fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Permissions of new folders and files, from which the user's umask is taken.
const FOLDER_MODE: u32 = 0o777;
const FILE_MODE: u32 = 0o666;

/// A hidden temporary name. The permissions are those of any new file: temporary ones are for their
/// owner alone otherwise, and these are going to stay.
#[cfg_attr(not(unix), allow(unused_variables))]
fn hidden(prefix: &str, mode: u32) -> tempfile::Builder<'_, '_> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(mode));
    }
    builder
}

/// Put the names in a folder on the disk.
#[cfg(unix)]
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

/// Folders cannot be opened here; the system orders its own journal.
#[cfg(not(unix))]
pub(crate) fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listing(folder: &Path) -> Vec<String> {
        let mut names = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect::<Vec<_>>();
        names.sort();
        names
    }

    #[test]
    fn a_folder_appears_complete_or_not_at_all() {
        let home = tempfile::tempdir().unwrap();
        let out = home.path().join("out");
        let folder = Folder::begin(&out).unwrap();
        folder.write(CERTIFICATE, b"{}").unwrap();
        folder.write("report.html", b"<p>").unwrap();
        assert!(!out.exists());
        folder.finish().unwrap();
        assert_eq!(listing(home.path()), ["out"]);
        assert_eq!(listing(&out), [CERTIFICATE, "report.html"]);
    }

    #[test]
    fn a_run_that_fails_leaves_nothing_behind() {
        let home = tempfile::tempdir().unwrap();
        let folder = Folder::begin(&home.path().join("out")).unwrap();
        folder.write("report.html", b"<p>").unwrap();
        drop(folder);
        assert_eq!(listing(home.path()), Vec::<String>::new());
    }

    #[test]
    fn a_folder_that_is_there_keeps_what_others_put_into_it() {
        let home = tempfile::tempdir().unwrap();
        fs::write(home.path().join("notes.txt"), "mine").unwrap();
        fs::write(home.path().join(CERTIFICATE), "old").unwrap();
        let folder = Folder::begin(home.path()).unwrap();
        folder.write(CERTIFICATE, b"new").unwrap();
        folder.write("report.html", b"<p>").unwrap();
        assert_eq!(fs::read(home.path().join(CERTIFICATE)).unwrap(), b"old");
        folder.finish().unwrap();
        assert_eq!(listing(home.path()), [CERTIFICATE, "notes.txt", "report.html"]);
        assert_eq!(fs::read(home.path().join(CERTIFICATE)).unwrap(), b"new");
        assert_eq!(fs::read(home.path().join("notes.txt")).unwrap(), b"mine");
    }

    #[test]
    fn a_missing_parent_a_file_in_the_way_and_a_forbidden_place_are_named() {
        let home = tempfile::tempdir().unwrap();
        let missing = Folder::begin(&home.path().join("a/b")).unwrap_err().to_string();
        assert!(missing.ends_with("a/b: there is no such file or folder"), "{missing}");
        fs::write(home.path().join("file"), "").unwrap();
        let file = Folder::begin(&home.path().join("file")).unwrap_err().to_string();
        assert!(file.ends_with("file: there is a file of that name"), "{file}");
        let forbidden = Folder::begin(Path::new("/proc/out")).unwrap_err().to_string();
        assert!(forbidden.starts_with("cannot create the folder /proc/out: "), "{forbidden}");
    }

    #[test]
    #[cfg(unix)]
    fn others_may_read_the_results() {
        use std::os::unix::fs::PermissionsExt;
        let home = tempfile::tempdir().unwrap();
        let usual = home.path().join("usual");
        fs::create_dir(&usual).unwrap();
        fs::write(usual.join("file"), "").unwrap();
        let out = Folder::begin(&home.path().join("out")).unwrap().finish().unwrap();
        write_file(&out.join("file"), b"").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&out), mode(&usual));
        assert_eq!(mode(&out.join("file")), mode(&usual.join("file")));
    }

    #[test]
    fn a_file_is_replaced_whole() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("linuxcnc.var");
        write_file(&path, b"old").unwrap();
        write_file(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(listing(home.path()), ["linuxcnc.var"]);
        let pipe = home.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for place in [&pipe, Path::new("/dev/null")] {
            let sentence = write_file(place, b"new").unwrap_err().to_string();
            assert!(sentence.ends_with("and no file: name a file"), "{sentence}");
            assert!(NewFile::begin(place).is_err());
        }
        let sentence = write_file(&home.path().join("no/p.var"), b"").unwrap_err().to_string();
        assert!(sentence.ends_with("no/p.var: there is no such file or folder"), "{sentence}");
    }
}
