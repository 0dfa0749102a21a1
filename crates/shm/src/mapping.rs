//! Memory that two processes share: words that each may read and write at any time.
//!
//! The other process is not trusted, and may write anything at any moment. So nothing but atomic
//! words is ever read from here: a word is a whole number whatever was written, and a copy of some
//! words cannot be undefined, only senseless.
use rustix::fs::{FlockOperation, Mode, flock, fstat, ftruncate};
use rustix::io::Errno;
use rustix::mm::{MapFlags, ProtFlags, mmap, munmap};
use rustix::shm::{OFlags, open, unlink};
use std::fmt;
use std::os::fd::OwnedFd;
use std::ptr::{NonNull, null_mut};
use std::sync::atomic::AtomicU64;

/// Words of shared memory.
pub struct Mapping {
    words: NonNull<AtomicU64>,
    count: usize,
    /// Its lock ends with it.
    _file: OwnedFd,
    /// To be unlinked at the end, by who made it.
    made: Option<String>,
}

// SAFETY: the memory is mapped until the value is dropped, whichever thread that is in, and is only
// ever used as atomic words.
#[allow(unsafe_code)]
unsafe impl Send for Mapping {}
// SAFETY: as above; what is shared are atomics.
#[allow(unsafe_code)]
unsafe impl Sync for Mapping {}

impl fmt::Debug for Mapping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Mapping of {} words", self.count)
    }
}

impl Mapping {
    /// New memory of this name, of zeros, for this user alone; what has had the name before goes on
    /// without it.
    ///
    /// # Errors
    /// The operating system's.
    pub fn create(name: &str, count: usize) -> Result<Self, Errno> {
        let make =
            || open(name, OFlags::CREATE | OFlags::EXCL | OFlags::RDWR, Mode::RUSR | Mode::WUSR);
        let file = match make() {
            Err(Errno::EXIST) => {
                unlink(name)?;
                make()?
            }
            other => other?,
        };
        ftruncate(&file, (count * size_of::<AtomicU64>()) as u64)?;
        let mut mapping = Self::map(file, count)?;
        mapping.made = Some(name.to_owned());
        for word in mapping.words() {
            word.store(0, std::sync::atomic::Ordering::Relaxed); // its pages are there from now on
        }
        Ok(mapping)
    }

    /// The memory of this name, for this process alone beside the one that made it; `None`: it is
    /// not of that many words.
    ///
    /// # Errors
    /// The operating system's; [`Errno::WOULDBLOCK`]: another process has it.
    pub fn open(name: &str, count: usize) -> Result<Option<Self>, Errno> {
        let file = open(name, OFlags::RDWR, Mode::empty())?;
        if fstat(&file)?.st_size as u64 != (count * size_of::<AtomicU64>()) as u64 {
            return Ok(None);
        }
        flock(&file, FlockOperation::NonBlockingLockExclusive)?;
        Self::map(file, count).map(Some)
    }

    #[allow(unsafe_code)]
    fn map(file: OwnedFd, count: usize) -> Result<Self, Errno> {
        let (length, access) = (count * size_of::<AtomicU64>(), ProtFlags::READ | ProtFlags::WRITE);
        // SAFETY: a new mapping where the system chooses: it overlaps nothing that exists.
        let at = unsafe { mmap(null_mut(), length, access, MapFlags::SHARED, &file, 0)? };
        let words = NonNull::new(at.cast()).ok_or(Errno::NOMEM)?;
        Ok(Self { words, count, _file: file, made: None })
    }

    /// All of them.
    #[allow(unsafe_code)]
    pub fn words(&self) -> &[AtomicU64] {
        // SAFETY: `count` words are mapped for reading and writing from there on (the file was made
        // as long, or found as long), at the start of a page, as long as `self` lives; any bits are
        // a valid word; other processes write them at any time, which atomics may be.
        unsafe { std::slice::from_raw_parts(self.words.as_ptr(), self.count) }
    }
}

impl Drop for Mapping {
    #[allow(unsafe_code)]
    fn drop(&mut self) {
        // SAFETY: mapped by `map`, so long, and nothing refers to it any more: `words` borrows
        // `self`.
        let _ = unsafe { munmap(self.words.as_ptr().cast(), self.count * size_of::<AtomicU64>()) };
        if let Some(name) = &self.made {
            let _ = unlink(name.as_str()); // another one may have taken the name
        }
    }
}
