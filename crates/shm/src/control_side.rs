//! The control's side: finds the component, asks for a session, and speaks with its kernel.
use crate::layout::{self, LONGEST_RECORD, LONGEST_STEP, STEPS_USUAL, head};
use crate::mapping::Mapping;
use crate::retained::RetainedMemory;
use crate::ring::{RingReader, RingWriter};
use kernel::Request;
use motion::{Step, Storage};
use rustix::io::Errno;
use servo::{Record, Replied, Said, SetUp, decode, encode};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release};
use units::Time;

/// Why there is no session.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No component has made the memory.
    #[error(
        "nothing named {0} leads drives here: loadrt leadscrew in the HAL session of this user, or leadscrew drives --name {0}"
    )]
    NotLoaded(String),
    /// Another process leads it.
    #[error("another control leads the drives of {0}: end that one first")]
    Taken(String),
    /// It is that of another build.
    #[error(
        "what leads the drives of {0} is of another version of Leadscrew: load or start the one that belongs to this control"
    )]
    OtherBuild(String),
    /// The operating system refuses.
    #[error("the shared memory of {0}: {1}")]
    System(String, Errno),
    /// The component refuses, and says why.
    #[error("what leads the drives refuses: {0}")]
    Refused(String),
}

/// The component, and the session with it once there is one.
#[derive(Debug)]
pub struct ControlSide {
    memory: Arc<Mapping>,
    session: u32,
    set_ups: RingWriter,
    verdicts: RingReader,
    requests: RingWriter,
    replies: RingReader,
    steps: RingWriter,
    said: RingReader,
    records: RingReader,
    last: Option<Record>,
    bytes: Box<[u8]>,
}

impl ControlSide {
    /// The component of this name, for this process alone.
    ///
    /// # Errors
    /// Why it is not to be had.
    pub fn find(name: &str) -> Result<Self, Error> {
        let named = || name.to_owned();
        let memory = match Mapping::open(&layout::memory_name(name), layout::SIZE) {
            Ok(Some(memory)) => Arc::new(memory),
            Ok(None) => return Err(Error::OtherBuild(named())),
            Err(Errno::NOENT) => return Err(Error::NotLoaded(named())),
            Err(Errno::WOULDBLOCK) => return Err(Error::Taken(named())),
            Err(why) => return Err(Error::System(named(), why)),
        };
        let word = |at: usize| memory.words()[at].load(Acquire);
        let (magic, version) = (word(head::MAGIC), word(head::VERSION));
        if (magic, version, word(head::BUILD)) != (layout::MAGIC, layout::VERSION, layout::BUILD) {
            return Err(Error::OtherBuild(named()));
        }
        Ok(Self {
            session: 0,
            set_ups: RingWriter::new(&memory, layout::SET_UPS),
            verdicts: RingReader::new(&memory, layout::VERDICTS),
            requests: RingWriter::new(&memory, layout::REQUESTS),
            replies: RingReader::new(&memory, layout::REPLIES),
            steps: RingWriter::new(&memory, layout::STEPS),
            said: RingReader::new(&memory, layout::SAID),
            records: RingReader::new(&memory, layout::RECORDS),
            last: None,
            bytes: vec![0; LONGEST_STEP.max(layout::SET_UPS.longest())].into(),
            memory,
        })
    }

    fn word(&self, at: usize) -> &AtomicU64 {
        &self.memory.words()[at]
    }

    /// What the component keeps of a tool in the work.
    pub fn retained(&self) -> RetainedMemory {
        RetainedMemory::new(&self.memory)
    }

    /// False where the process knows which machine it leads, and that is another one.
    pub fn may_lead(&self, machine: &str) -> bool {
        let key = self.word(head::MACHINE).load(Relaxed);
        key == 0 || key == layout::machine_key(machine)
    }

    /// A bit for each axis that it has.
    pub fn axes(&self) -> u16 {
        self.word(head::HAS).load(Relaxed) as u16
    }

    /// Spindles that it has.
    pub fn spindles(&self) -> u8 {
        (self.word(head::HAS).load(Relaxed) >> 16) as u8
    }

    /// Its servo period; `None`: its function has not been called yet.
    pub fn period(&self) -> Option<Time> {
        match self.word(head::PERIOD).load(Acquire) {
            0 => None,
            ns => Some(Time::s(ns as f64 / 1e9)),
        }
    }

    /// Servo periods since it was loaded: while this does not grow, nothing moves it.
    pub fn periods(&self) -> u64 {
        self.word(head::PERIODS).load(Acquire)
    }

    /// Periods of the session of which no record came.
    pub fn unobserved(&self) -> u64 {
        self.word(head::UNOBSERVED).load(Relaxed)
    }

    /// Ask for a session.
    ///
    /// # Errors
    /// It was not even taken.
    pub fn ask(&mut self, set_up: &SetUp) -> Result<(), Error> {
        let before = self.word(head::ASKED).load(Acquire) as u32;
        self.session = before.wrapping_add(1).max(1);
        let asked = u64::from(self.session);
        self.word(head::ASKED).store(asked, Release);
        let refused = || Error::Refused("a set-up does not fit into its ring".into());
        let length = encode(set_up, &mut self.bytes).ok_or_else(refused)?;
        if self.set_ups.push(self.session, &self.bytes[..length]) { Ok(()) } else { Err(refused()) }
    }

    /// The session has begun; not yet.
    ///
    /// # Errors
    /// It will not, and why.
    pub fn has_begun(&mut self) -> Result<bool, Error> {
        while let Ok(Some((session, text))) = self.verdicts.take(&mut self.bytes) {
            if session == self.session {
                return Err(Error::Refused(String::from_utf8_lossy(text).into_owned()));
            }
        }
        Ok(self.is_ours())
    }

    /// The component's kernel is this session's.
    pub fn is_ours(&self) -> bool {
        self.session != 0 && self.word(head::SESSION).load(Acquire) == u64::from(self.session)
    }

    /// The end of the session: the kernel is let go, and stops what moves before that.
    pub fn end(&self) {
        self.word(head::ENDED).store(u64::from(self.session), Release);
    }

    /// A sign of life of this session.
    pub fn beat(&self) {
        let count = (self.word(head::ALIVE).load(Relaxed) as u32).wrapping_add(1);
        self.word(head::ALIVE).store(u64::from(self.session) << 32 | u64::from(count), Release);
    }

    /// Stops for the next servo period, beside all rings.
    pub fn stop(&self, flags: u32) {
        if flags != 0 {
            let joined = |before: u64| {
                // what a control before has left is not of this session
                let kept = if (before >> 32) as u32 == self.session { before as u32 } else { 0 };
                Some(u64::from(self.session) << 32 | u64::from(kept | flags))
            };
            let _ = self.word(head::STOPS).fetch_update(Release, Relaxed, joined); // it never declines
        }
    }

    /// As many steps wait on the other side as do in the usual course.
    pub fn has_enough_steps(&self) -> bool {
        self.steps.waiting() >= STEPS_USUAL
    }

    /// Send a step; whether there was room.
    pub fn send_step<S: Storage>(&mut self, step: &Step<S>) -> bool
    where
        Step<S>: serde::Serialize,
    {
        let Some(length) = encode(step, &mut self.bytes[..LONGEST_STEP]) else { return false };
        self.steps.push(self.session, &self.bytes[..length])
    }

    /// Send a request; whether there was room, and it is one that goes to another process.
    pub fn send_request(&mut self, request: &Request) -> bool {
        let Some(length) = encode(request, &mut self.bytes) else { return false };
        self.requests.push(self.session, &self.bytes[..length])
    }

    /// What came of a request.
    pub fn reply(&mut self) -> Option<Replied> {
        next(&mut self.replies, self.session, &mut self.bytes[..LONGEST_RECORD])
    }

    /// What the kernel has said.
    pub fn said(&mut self) -> Option<Said> {
        next(&mut self.said, self.session, &mut self.bytes)
    }

    /// Records that wait.
    pub fn records_waiting(&self) -> usize {
        self.records.waiting()
    }

    /// The next period.
    pub fn record(&mut self) -> Option<Record> {
        let record = next(&mut self.records, self.session, &mut self.bytes[..LONGEST_RECORD])?;
        self.last = Some(record);
        Some(record)
    }

    /// The last period that [`ControlSide::record`] has answered.
    pub const fn picture(&self) -> Option<&Record> {
        self.last.as_ref()
    }
}

/// The next message of this session that can be read: what cannot is lost, as if there had been no
/// room for it.
fn next<T: for<'de> serde::Deserialize<'de>>(
    ring: &mut RingReader,
    session: u32,
    bytes: &mut [u8],
) -> Option<T> {
    loop {
        match ring.take(bytes) {
            Ok(None) => return None,
            Ok(Some((of, bytes))) if of == session => {
                if let Ok(value) = decode(bytes) {
                    return Some(value);
                }
            }
            Ok(Some(_)) | Err(_) => {}
        }
    }
}
