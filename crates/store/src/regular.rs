//! Regular files, and nothing else in their place: the one way in which files are opened that are
//! written, and those that are read on a control's own account.
//!
//! ```text
//!   what lies there ──is it a file?──► open, without waiting ──is it still one?──► File
//! ```
//!
//! A named pipe would keep its writer, or its reader, until another program comes to its other
//! end: perhaps for ever. A device may do anything when it is opened, so it is looked at before;
//! and what was opened is looked at again, since it may have been put there meanwhile.
use std::fs::{File, Metadata, OpenOptions};
use std::io;
use std::path::Path;

/// What a file is opened for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Access {
    Read,
    Create,
    Append,
    AppendToExisting,
}

/// Opens a file to read it.
///
/// # Errors
/// There is none, it is no regular file, or the file system refuses.
pub fn open(path: &Path) -> io::Result<File> {
    open_for(Access::Read, path)
}

/// Creates a file, or empties the one that is there, to write it.
///
/// # Errors
/// As [`open`].
pub fn create(path: &Path) -> io::Result<File> {
    open_for(Access::Create, path)
}

/// Opens a file to write at its end; creates it where there is none.
///
/// # Errors
/// As [`open`].
pub fn append(path: &Path) -> io::Result<File> {
    open_for(Access::Append, path)
}

/// Opens a file that is there to write at its end.
///
/// # Errors
/// As [`open`].
pub fn append_to_existing(path: &Path) -> io::Result<File> {
    open_for(Access::AppendToExisting, path)
}

/// Refuses a place at which a new file would take the place of a device, a pipe or a socket.
///
/// # Errors
/// Such a one is there.
pub(crate) fn may_be_replaced(path: &Path) -> io::Result<()> {
    match path.metadata() {
        Ok(about) if !about.is_file() && !about.is_dir() => {
            let why = "it is a device, a pipe or a socket, and no file: name a file";
            Err(io::Error::other(why))
        }
        Ok(_) | Err(_) => Ok(()),
    }
}

/// Refuses an open file that is none.
///
/// # Errors
/// It is no regular file.
pub(crate) fn must_be_regular(file: &File) -> io::Result<()> {
    check(Access::Append, &file.metadata()?)
}

fn open_for(access: Access, path: &Path) -> io::Result<File> {
    if let Ok(about) = path.metadata() {
        check(access, &about)?;
    }
    let file = options(access).open(path)?;
    check(access, &file.metadata()?)?;
    Ok(file)
}

fn options(access: Access) -> OpenOptions {
    let mut options = OpenOptions::new();
    match access {
        Access::Read => options.read(true),
        Access::Create => options.write(true).create(true).truncate(true),
        Access::Append => options.append(true).create(true),
        Access::AppendToExisting => options.append(true),
    };
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags((OFlags::NONBLOCK | OFlags::NOCTTY).bits().cast_signed());
    }
    options
}

/// Says what it is, if it is no regular file. A folder is refused by the file system, in its own
/// words.
fn check(access: Access, about: &Metadata) -> io::Result<()> {
    if about.is_file() || about.is_dir() || is_full_disk(about) {
        return Ok(());
    }
    let what = match (is_named_pipe(about), access) {
        (true, Access::Read) => {
            "it is a named pipe, which waits for a writer, and no file; what another program writes is read from standard input, by the name -"
        }
        (true, _) => "it is a named pipe, which waits for a reader, and no file: remove it",
        (false, Access::Read) => "it is a device or a socket, and no file",
        (false, _) => "it is a device or a socket, and no file: remove it",
    };
    Err(io::Error::other(what))
}

#[cfg(unix)]
fn is_named_pipe(about: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&about.file_type())
}

#[cfg(not(unix))]
const fn is_named_pipe(_: &Metadata) -> bool {
    false
}

/// Linux's device `full`, which refuses all that is written as a full disk does and keeps nothing:
/// an operator, or a test, has such a disk by a link to it.
#[cfg(target_os = "linux")]
fn is_full_disk(about: &Metadata) -> bool {
    use std::os::unix::fs::{FileTypeExt as _, MetadataExt as _};
    about.file_type().is_char_device() && about.rdev() == rustix::fs::makedev(1, 7)
}

#[cfg(not(target_os = "linux"))]
const fn is_full_disk(_: &Metadata) -> bool {
    false
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;
    use std::os::unix::net::UnixListener;

    type Way = (&'static str, fn(&Path) -> io::Result<File>);
    const WAYS: [Way; 4] = [
        ("open", open),
        ("create", create),
        ("append", append),
        ("append to existing", append_to_existing),
    ];

    #[test]
    fn what_is_no_file_is_refused_at_once_in_every_way() {
        let home = tempfile::tempdir().unwrap();
        let at = |name: &str| home.path().join(name);
        let made = std::process::Command::new("mkfifo").arg(at("pipe")).status();
        assert!(made.unwrap().success());
        symlink(at("pipe"), at("link to a pipe")).unwrap();
        let _listener = UnixListener::bind(at("socket")).unwrap();
        symlink("/dev/null", at("link to a device")).unwrap();
        symlink("/dev/tty", at("link to a terminal")).unwrap();
        for name in ["pipe", "link to a pipe", "socket", "link to a device", "link to a terminal"] {
            for (way, opened) in WAYS {
                let why = opened(&at(name)).expect_err(name).to_string();
                assert!(why.contains("and no file"), "{way} {name}: {why}");
                assert_eq!(why.contains("named pipe"), name.contains("pipe"), "{way} {name}");
            }
        }
        std::fs::create_dir(at("folder")).unwrap();
        for (way, opened) in &WAYS[1..] {
            assert!(opened(&at("folder")).is_err(), "{way}");
        }
    }

    /// A pipe that has both ends would take what is written.
    #[test]
    fn a_pipe_that_another_program_holds_open_is_refused_too() {
        let home = tempfile::tempdir().unwrap();
        let pipe = home.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let held = OpenOptions::new().read(true).write(true).open(&pipe).unwrap();
        assert!(must_be_regular(&held).is_err());
        for (way, opened) in WAYS {
            assert!(opened(&pipe).is_err(), "{way}");
        }
    }

    #[test]
    fn a_file_is_opened_also_by_a_link() {
        use std::io::{Read as _, Write as _};
        let home = tempfile::tempdir().unwrap();
        let (file, link) = (home.path().join("file"), home.path().join("link"));
        assert!(append_to_existing(&file).is_err());
        append(&file).unwrap().write_all(b"long enough").unwrap();
        symlink(&file, &link).unwrap();
        create(&link).unwrap().write_all(b"a").unwrap();
        append_to_existing(&link).unwrap().write_all(b"b").unwrap();
        let mut text = String::new();
        open(&file).unwrap().read_to_string(&mut text).unwrap();
        assert_eq!(text, "ab");
    }
}
