//! Bytes of a plain file of a state folder: nothing else in its place is followed, waited for or
//! believed.
use super::Untrusted;
use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::path::Path;

/// Options under which no link is followed and no pipe is waited for.
pub(super) fn options() -> OpenOptions {
    let mut options = OpenOptions::new();
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed());
    }
    options
}

/// The bytes of a file, `largest` at most; `None`: there is no such file.
pub(super) fn read(path: &Path, largest: u64) -> Result<Option<Vec<u8>>, Untrusted> {
    match path.symlink_metadata() {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
        Ok(about) if about.is_symlink() => return Err(Untrusted::NoFile("a symbolic link")),
        Ok(about) if about.is_dir() => return Err(Untrusted::NoFile("a folder")),
        Ok(about) if !about.is_file() => return Err(Untrusted::NoFile("no plain file")),
        Ok(_) | Err(_) => {}
    }
    let unreadable = |e: io::Error| Untrusted::Unreadable(e.to_string());
    let file: File = options().read(true).open(path).map_err(unreadable)?;
    let about = file.metadata().map_err(unreadable)?;
    if !about.is_file() {
        return Err(Untrusted::NoFile("no plain file"));
    }
    if about.len() > largest {
        return Err(Untrusted::TooLarge { bytes: about.len(), largest });
    }
    let mut bytes = Vec::new();
    file.take(largest + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(Some(bytes))
}
