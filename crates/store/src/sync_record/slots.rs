//! Two generations of the record on a disk, so that at every instant one of them is whole.
//!
//! ```text
//!   generation 1, 3, 5 …  sync-record.a         write:  sync-record.new, every byte
//!   generation 2, 4, 6 …  sync-record.b                 fsync the file
//!                                                       rename over the older generation
//!                                                       fsync the folder
//! ```
//!
//! A kill at any byte leaves the file `sync-record.new` in pieces, which is never read, and both
//! generations as they were. What is torn or changed in a generation has therefore been damaged
//! otherwise. Of two whole ones the newer counts. If one is damaged, the other is believed where it
//! says that a tap is in the work: the damaged one can then only be older, or say the same, or say
//! that the tap is out, which the encoders show. Where it says that nothing is in the work, the
//! damaged one may be newer and say the contrary: that is refused.
use super::{Identity, LONGEST, Stage, SyncRecord, Untrusted};
use crate::regular;
use crate::state::lock::FolderLock;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Where a generation is written before it counts.
const NEW: &str = "sync-record.new";

/// What is asked of a disk, in the order in which it is asked: so a crash can be tried at every
/// point.
pub trait Disk {
    /// Create a file anew, write the bytes, and put them on the disk.
    ///
    /// # Errors
    /// When the disk is full, read-only, or refuses otherwise.
    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()>;
    /// Give a file another name, in place of what has it now.
    ///
    /// # Errors
    /// When the file system refuses.
    fn rename(&mut self, from: &str, to: &str) -> io::Result<()>;
    /// Put the names on the disk.
    ///
    /// # Errors
    /// When the file system refuses.
    fn sync_names(&mut self) -> io::Result<()>;
    /// A file's bytes, the first [`LONGEST`] and one more; `None` if there is no such file.
    ///
    /// # Errors
    /// When the file system refuses.
    fn read(&self, name: &str) -> io::Result<Option<Vec<u8>>>;
}

/// A folder of a real disk, for one control at a time.
#[derive(Debug)]
pub struct StateFolder {
    path: PathBuf,
    /// Locked until the control ends, however it ends.
    _lock: FolderLock,
}

impl StateFolder {
    /// Open it, make it if it is missing.
    ///
    /// # Errors
    /// When it cannot be made, or another control has it open.
    pub fn open(path: &Path) -> Result<Self, crate::Error> {
        fs::create_dir_all(path).map_err(|cause| crate::Error::File {
            action: "create the state folder",
            path: path.to_owned(),
            cause,
        })?;
        Self::open_existing(path)
    }

    /// Open it where it is there: who only looks makes none.
    ///
    /// # Errors
    /// When there is none, or another control has it open.
    pub fn open_existing(path: &Path) -> Result<Self, crate::Error> {
        let lock = FolderLock::take(path)?;
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    /// The folder of a control that has its state open: one lock for both.
    pub fn of(state: &crate::state::StateFolder) -> Self {
        Self { path: state.path().to_owned(), _lock: state.lock() }
    }

    /// A folder whose lock this process has.
    pub const fn at(path: PathBuf, lock: FolderLock) -> Self {
        Self { path, _lock: lock }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Disk for StateFolder {
    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut file = regular::create(&self.path.join(name))?;
        file.write_all(bytes)?;
        file.flush()?;
        file.sync_all()
    }

    fn rename(&mut self, from: &str, to: &str) -> io::Result<()> {
        fs::rename(self.path.join(from), self.path.join(to))
    }

    fn sync_names(&mut self) -> io::Result<()> {
        crate::output::sync_folder(&self.path)
    }

    fn read(&self, name: &str) -> io::Result<Option<Vec<u8>>> {
        let file = match crate::open(&self.path.join(name)) {
            Ok(file) => file,
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(e),
        };
        let mut bytes = Vec::new();
        file.take(LONGEST as u64 + 1).read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    }
}

/// What the disk says.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The newest generation that is believed; `None`: there has never been one.
    pub record: Option<SyncRecord>,
    /// What is wrong with the other generation, though it does not matter.
    pub beside: Option<Untrusted>,
}

/// The two generations.
#[derive(Debug)]
pub struct Slots<D> {
    disk: D,
    /// Number of the newest; 0 while there is none.
    generation: u64,
}

/// The file of a generation.
const fn file_of(generation: u64) -> &'static str {
    if generation % 2 == 1 { "sync-record.a" } else { "sync-record.b" }
}

/// What is in one generation's file.
type Slot = Option<Result<(SyncRecord, u64), Untrusted>>;

impl<D: Disk> Slots<D> {
    /// Look at what is there.
    ///
    /// # Errors
    /// Why it is not to be believed; nothing may move a tool in the work then.
    pub fn open(disk: D, identity: &Identity) -> Result<(Self, Kept), Untrusted> {
        let a = look(&disk, 1);
        let b = look(&disk, 2);
        let (newest, beside) = choose(a, b)?;
        let Some((record, generation)) = newest else {
            return Ok((Self { disk, generation: 0 }, Kept { record: None, beside }));
        };
        record.belongs_to(identity)?;
        Ok((Self { disk, generation }, Kept { record: Some(record), beside }))
    }

    /// Forget what is there, whatever it is: the operator has seen to it that no tap is in the
    /// work.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn discard(mut disk: D, out: &SyncRecord) -> io::Result<()> {
        let known = [look(&disk, 1), look(&disk, 2)];
        let number = |slot: &Slot| slot.as_ref().and_then(|s| s.as_ref().ok()).map(|s| s.1);
        let last = known.iter().filter_map(number).max().unwrap_or(0);
        // both generations anew, so that nothing old lies beside them
        let first = last.saturating_add(1);
        for generation in [first, first.saturating_add(1)] {
            put(&mut disk, out, generation)?;
        }
        Ok(())
    }

    /// The next generation, whole on the disk when this returns.
    ///
    /// # Errors
    /// When the disk is full, read-only, or refuses otherwise; what was there counts on.
    pub fn write(&mut self, record: &SyncRecord) -> io::Result<()> {
        put(&mut self.disk, record, self.generation + 1)?;
        self.generation += 1;
        Ok(())
    }

    /// Number of the newest.
    pub const fn generation(&self) -> u64 {
        self.generation
    }
}

fn put(disk: &mut impl Disk, record: &SyncRecord, generation: u64) -> io::Result<()> {
    disk.write(NEW, &record.encode(generation))?;
    disk.rename(NEW, file_of(generation))?;
    disk.sync_names()
}

/// One generation's file: of the odd numbers or of the even ones.
fn look(disk: &impl Disk, generation: u64) -> Slot {
    let bytes = match disk.read(file_of(generation)) {
        Ok(bytes) => bytes?,
        Err(e) => return Some(Err(Untrusted::Unreadable(e.to_string()))),
    };
    Some(SyncRecord::decode(&bytes).and_then(|(record, found)| {
        if found == 0 || file_of(found) != file_of(generation) {
            return Err(Untrusted::Swapped { generation: found });
        }
        Ok((record, found))
    }))
}

/// The newest generation, and what is wrong beside it.
#[allow(clippy::type_complexity)] // said once, here
fn choose(a: Slot, b: Slot) -> Result<(Option<(SyncRecord, u64)>, Option<Untrusted>), Untrusted> {
    match (a, b) {
        (None, None) => Ok((None, None)),
        (Some(Ok(a)), Some(Ok(b))) => {
            let (older, newer) = if a.1 < b.1 { (a, b) } else { (b, a) };
            if newer.1 - older.1 != 1 {
                return Err(Untrusted::Apart { older: older.1, newer: newer.1 });
            }
            Ok((Some(newer), None))
        }
        (Some(Ok(only)), None) | (None, Some(Ok(only))) => match only.0.stage {
            _ if only.1 == 1 => Ok((Some(only), None)),
            Stage::Inward | Stage::Outward => Ok((Some(only), Some(Untrusted::Missing))),
            Stage::Out | Stage::Recovered => Err(Untrusted::Missing),
        },
        (Some(Ok(whole)), Some(Err(why))) | (Some(Err(why)), Some(Ok(whole))) => {
            match (whole.0.stage, &why) {
                // a generation in the wrong place has been put there by hand
                (_, Untrusted::Swapped { .. }) => Err(why),
                (Stage::Inward | Stage::Outward, _) => Ok((Some(whole), Some(why))),
                (Stage::Out | Stage::Recovered, _) => Err(Untrusted::Unsure(Box::new(why))),
            }
        }
        (Some(Err(why)), _) | (None, Some(Err(why))) => Err(why),
    }
}
