//! One control a folder: the file `lock` is locked as long as a control lives, and holds its
//! process id; and, once a state was kept in the folder, a line that says so, from which a folder
//! whose files are gone is told from a new one.
use super::plain;
use crate::Error;
use std::fs::{File, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// The file that is locked.
const LOCK: &str = "lock";
/// How often, and how long apart, a second control looks for the first one's process id, which is
/// written a moment after the lock is taken.
const LOOKS: u32 = 10;
const APART: Duration = Duration::from_millis(5);

/// Says that a state was kept in the folder.
const KEEPS: &str = "keeps a state";

/// A lock on a folder, until its last copy is dropped or the process ends, however it ends.
#[derive(Clone, Debug)]
pub struct FolderLock {
    file: Arc<Locked>,
    had_state: bool,
}

#[derive(Debug)]
struct Locked(File);

impl Drop for Locked {
    fn drop(&mut self) {
        // a child process that is just being started has a copy of the file, with which the lock
        // would live on
        let _ = self.0.unlock();
    }
}

impl FolderLock {
    /// Lock a folder that is there.
    ///
    /// # Errors
    /// Another control has it locked, whose process is named; the folder is missing or cannot be
    /// written.
    pub fn take(folder: &Path) -> Result<Self, Error> {
        let failed = |action| move |cause| Error::file(action, folder, cause);
        // not truncated before it is locked: until then it is the other control's
        let mut file = plain::options()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(folder.join(LOCK))
            .map_err(failed("write to the state folder"))?;
        is_plain(&file).map_err(failed("write to the state folder"))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::Error(cause)) => return Err(failed("lock the state folder")(cause)),
            Err(TryLockError::WouldBlock) => {
                let who = holder(&mut file).map_or(String::new(), |id| format!(", process {id},"));
                let why = format!("another Leadscrew{who} is controlling this machine");
                return Err(failed("lock the state folder")(io::Error::other(why)));
            }
        }
        let mut before = String::new();
        let read = (&file).take(64).read_to_string(&mut before);
        let had_state = read.is_ok() && before.lines().nth(1) == Some(KEEPS);
        write(&file, had_state).map_err(failed("write to the state folder"))?;
        Ok(Self { file: Arc::new(Locked(file)), had_state })
    }

    /// A state was kept in the folder before it was locked.
    pub const fn had_state(&self) -> bool {
        self.had_state
    }

    /// From now on the folder is one in which a state was kept.
    pub(super) fn keeps_state(&mut self) -> io::Result<()> {
        if !self.had_state {
            write(&self.file.0, true)?;
            self.file.0.sync_all()?;
            self.had_state = true;
        }
        Ok(())
    }
}

fn write(mut file: &File, has_state: bool) -> io::Result<()> {
    let mark = if has_state { format!("{KEEPS}\n") } else { String::new() };
    let text = format!("{}\n{mark}", std::process::id());
    file.rewind()?;
    file.write_all(text.as_bytes())?;
    file.set_len(text.len() as u64)
}

/// A file of this folder alone: what is written into it is written nowhere else.
fn is_plain(file: &File) -> io::Result<()> {
    let about = file.metadata()?;
    #[cfg(unix)]
    let is_alone = std::os::unix::fs::MetadataExt::nlink(&about) == 1;
    #[cfg(not(unix))]
    let is_alone = true;
    if about.is_file() && is_alone {
        return Ok(());
    }
    Err(io::Error::other("its file `lock` is no plain file of its own: remove it"))
}

/// The process id in a lock's file.
fn holder(file: &mut File) -> Option<u32> {
    for look in 0..LOOKS {
        if look > 0 {
            std::thread::sleep(APART);
        }
        let mut text = String::new();
        file.rewind().ok()?;
        file.take(64).read_to_string(&mut text).ok()?;
        if let Some(id) = text.split_once('\n').and_then(|(id, _)| id.parse().ok()) {
            return Some(id);
        }
    }
    None
}
