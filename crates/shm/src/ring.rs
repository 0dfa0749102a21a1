//! A ring of messages in shared memory: one writer, one reader, neither waits, neither trusts the
//! other.
//!
//! ```text
//!   word 0          8        16
//!   │ written … │ taken … │ slot │ slot │ …          slot: session and length of the message, then its bytes
//! ```
//!
//! Each end keeps its own count and only *reads* the other's. A count that cannot be, or a length
//! beyond the slot, is damage: it is reported, and the reader goes on after everything that was
//! written.
use crate::mapping::Mapping;
use std::sync::Arc;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release};

/// Words before the slots.
const HEAD: usize = 16;
/// The reader's count, in a cache line of its own.
const TAKEN: usize = 8;
/// Bytes in a word.
pub(crate) const WORD: usize = 8;

/// Where a ring lies, and how large it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its first word.
    pub at: usize,
    /// Messages that it holds.
    pub slots: usize,
    /// Words of the longest message.
    pub words: usize,
}

impl Place {
    /// Words that it takes.
    pub const fn size(&self) -> usize {
        HEAD + self.slots * (1 + self.words)
    }

    /// Bytes of the longest message.
    pub const fn longest(&self) -> usize {
        self.words * WORD
    }

    const fn slot(&self, number: u64) -> usize {
        self.at + HEAD + (number % self.slots as u64) as usize * (1 + self.words)
    }
}

/// What the other end has written cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Damaged;

/// The end that writes.
#[derive(Debug)]
pub struct RingWriter {
    memory: Arc<Mapping>,
    place: Place,
    written: u64,
}

impl RingWriter {
    /// Goes on after what was written before, by whomever.
    pub fn new(memory: &Arc<Mapping>, place: Place) -> Self {
        let written = memory.words()[place.at].load(Acquire);
        Self { memory: Arc::clone(memory), place, written }
    }

    /// Messages that the reader has not taken; one that claims what cannot be has taken none.
    pub fn waiting(&self) -> usize {
        let taken = self.memory.words()[self.place.at + TAKEN].load(Acquire);
        let waiting = self.written.wrapping_sub(taken);
        if waiting > self.place.slots as u64 { self.place.slots } else { waiting as usize }
    }

    /// There is no room.
    pub fn is_full(&self) -> bool {
        self.waiting() >= self.place.slots
    }

    /// Append a message of a session; whether there was room for it.
    #[must_use]
    pub fn push(&mut self, session: u32, bytes: &[u8]) -> bool {
        if self.is_full() || bytes.len() > self.place.longest() {
            return false;
        }
        let slot = self.place.slot(self.written);
        let words = &self.memory.words()[slot..=slot + self.place.words];
        words[0].store(u64::from(session) << 32 | bytes.len() as u64, Relaxed);
        for (word, bytes) in words[1..].iter().zip(bytes.chunks(WORD)) {
            let mut value = [0; WORD];
            value[..bytes.len()].copy_from_slice(bytes);
            word.store(u64::from_le_bytes(value), Relaxed);
        }
        self.written = self.written.wrapping_add(1);
        self.memory.words()[self.place.at].store(self.written, Release);
        true
    }
}

/// The end that reads.
#[derive(Debug)]
pub struct RingReader {
    memory: Arc<Mapping>,
    place: Place,
    taken: u64,
}

impl RingReader {
    /// Begins after what was written before.
    pub fn new(memory: &Arc<Mapping>, place: Place) -> Self {
        let mut reader = Self { memory: Arc::clone(memory), place, taken: 0 };
        reader.skip();
        reader
    }

    fn written(&self) -> u64 {
        self.memory.words()[self.place.at].load(Acquire)
    }

    /// What was written is passed over.
    pub fn skip(&mut self) {
        self.has_taken(self.written());
    }

    fn has_taken(&mut self, taken: u64) {
        self.taken = taken;
        self.memory.words()[self.place.at + TAKEN].store(taken, Release);
    }

    /// Messages that wait; a writer that claims what cannot be has written one, so that taking it
    /// finds the damage.
    pub fn waiting(&self) -> usize {
        let waiting = self.written().wrapping_sub(self.taken);
        if waiting > self.place.slots as u64 { 1 } else { waiting as usize }
    }

    /// The next message, copied: its session and its bytes.
    ///
    /// # Errors
    /// What is written there cannot be; everything that was written is passed over.
    pub fn take<'b>(&mut self, into: &'b mut [u8]) -> Result<Option<(u32, &'b [u8])>, Damaged> {
        let waiting = self.written().wrapping_sub(self.taken);
        if waiting == 0 {
            return Ok(None);
        }
        let slot = self.place.slot(self.taken);
        let words = &self.memory.words()[slot..=slot + self.place.words];
        let head = words[0].load(Relaxed);
        let (session, length) = ((head >> 32) as u32, (head & u64::from(u32::MAX)) as usize);
        if waiting > self.place.slots as u64 || length > self.place.longest() || length > into.len()
        {
            self.skip();
            return Err(Damaged);
        }
        let into = &mut into[..length];
        for (bytes, word) in into.chunks_mut(WORD).zip(&words[1..]) {
            bytes.copy_from_slice(&word.load(Relaxed).to_le_bytes()[..bytes.len()]);
        }
        self.has_taken(self.taken.wrapping_add(1));
        Ok(Some((session, into)))
    }
}
