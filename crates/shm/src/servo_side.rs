//! The servo thread's side: what the component reads and writes. Between [`ServoSide::new`] and its
//! drop nothing here takes memory, a lock or a system call.
use crate::layout::{self, LONGEST_RECORD, LONGEST_STEP, head};
use crate::mapping::Mapping;
use crate::retained::{self, TiedPeriod};
use crate::ring::{RingReader, RingWriter};
use kernel::Request;
use motion::{Inline, Step};
use rustix::io::Errno;
use servo::{Record, Replied, Rings, Said, SetUp, check_request, check_step, decode, encode};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::Arc;
use std::sync::atomic::Ordering::{AcqRel, Acquire, Release};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// The memory, as the component has made it.
#[derive(Debug)]
pub struct Made(Arc<Mapping>);

/// Memory of this name for a process that has these axes (a bit each) and this number of spindles,
/// and leads the machine of this name, where it knows that.
///
/// # Errors
/// The operating system's.
pub fn make(name: &str, axes: u16, spindles: u8, machine: Option<&str>) -> Result<Made, Errno> {
    let memory = Mapping::create(&layout::memory_name(name), layout::SIZE)?;
    let words = memory.words();
    words[head::VERSION].store(layout::VERSION, Relaxed);
    words[head::BUILD].store(layout::BUILD, Relaxed);
    words[head::LOADED].store(RandomState::new().build_hasher().finish(), Relaxed);
    words[head::HAS].store(u64::from(axes) | u64::from(spindles) << 16, Relaxed);
    words[head::MACHINE].store(machine.map_or(0, layout::machine_key), Relaxed);
    words[head::MAGIC].store(layout::MAGIC, Release);
    Ok(Made(Arc::new(memory)))
}

/// What asks for a session: read beside the servo thread, because a kernel takes memory when it is
/// made.
#[derive(Debug)]
pub struct SetUps {
    asked: RingReader,
    verdicts: RingWriter,
    bytes: Vec<u8>,
}

impl SetUps {
    /// Of this memory.
    pub fn new(made: &Made) -> Self {
        Self {
            asked: RingReader::new(&made.0, layout::SET_UPS),
            verdicts: RingWriter::new(&made.0, layout::VERDICTS),
            bytes: vec![0; layout::SET_UPS.longest()],
        }
    }

    /// The next one: its session, and what it needs or why that cannot be read.
    pub fn take(&mut self) -> Option<(u32, Result<SetUp, String>)> {
        match self.asked.take(&mut self.bytes) {
            Ok(None) => None,
            Ok(Some((session, bytes))) => {
                Some((session, decode(bytes).map_err(|why| why.to_string())))
            }
            Err(_) => Some((0, Err("the shared memory is damaged".into()))),
        }
    }

    /// Say why there is no session.
    pub fn refuse(&mut self, session: u32, why: &str) {
        let longest = layout::VERDICTS.longest().min(why.len());
        let cut = (0..=longest).rev().find(|at| why.is_char_boundary(*at)).unwrap_or(0);
        let _ = self.verdicts.push(session, &why.as_bytes()[..cut]); // who asked reads them, or is gone
    }
}

/// The rings of one session in the servo thread.
#[derive(Debug)]
pub struct ServoSide {
    memory: Arc<Mapping>,
    session: u32,
    requests: RingReader,
    replies: RingWriter,
    steps: RingReader,
    said: RingWriter,
    records: RingWriter,
    /// The control's sign of life, when it was looked at last, and for how long it has been the
    /// same.
    alive: u64,
    looked_ns: Option<i64>,
    silent_ns: i64,
    /// A message that cannot be: nothing of this control is believed from then on.
    is_damaged: bool,
    bytes: Box<[u8; LONGEST_STEP]>,
}

impl ServoSide {
    /// For a session; begins after what a control before has left.
    pub fn new(made: &Made, session: u32) -> Self {
        let memory = &made.0;
        Self {
            session,
            requests: RingReader::new(memory, layout::REQUESTS),
            replies: RingWriter::new(memory, layout::REPLIES),
            steps: RingReader::new(memory, layout::STEPS),
            said: RingWriter::new(memory, layout::SAID),
            records: RingWriter::new(memory, layout::RECORDS),
            alive: memory.words()[head::ALIVE].load(Acquire),
            looked_ns: None,
            silent_ns: 0,
            is_damaged: false,
            bytes: Box::new([0; LONGEST_STEP]),
            memory: Arc::clone(memory),
        }
    }

    fn word(&self, at: usize) -> &AtomicU64 {
        &self.memory.words()[at]
    }

    /// The session begins: its control may speak.
    pub fn begin(&self) {
        self.word(head::UNOBSERVED).store(0, Relaxed);
        self.word(head::SESSION).store(u64::from(self.session), Release);
    }

    /// Its control has ended it.
    pub fn is_ended(&self) -> bool {
        self.word(head::ENDED).load(Acquire) == u64::from(self.session)
    }

    /// The session is over.
    pub fn end(&self) {
        self.word(head::SESSION).store(0, Release);
    }

    /// A message was one that cannot be.
    pub const fn is_damaged(&self) -> bool {
        self.is_damaged
    }

    /// For how long the control has shown no sign of life by this time of a clock, ns, seen from a
    /// thread that looks each period.
    ///
    /// Not by a count of periods: a servo thread that was held up runs many at once. Nor by the
    /// clock alone: while a computer stands still, the control cannot show a sign of life either,
    /// so that from one look to the next two periods count at most.
    pub fn silence(&mut self, now_ns: i64, period_ns: u64) -> i64 {
        let alive = self.word(head::ALIVE).load(Acquire);
        let is_of_this = (alive >> 32) as u32 == self.session;
        let most = i64::try_from(period_ns).unwrap_or(i64::MAX).saturating_mul(2);
        let since = self.looked_ns.map_or(0, |looked| now_ns.saturating_sub(looked).min(most));
        self.looked_ns = Some(now_ns);
        if is_of_this && alive != self.alive {
            (self.alive, self.silent_ns) = (alive, 0);
        } else {
            self.silent_ns = self.silent_ns.saturating_add(since.max(0));
        }
        self.silent_ns
    }

    /// The same, as it was then.
    pub const fn silent_ns(&self) -> i64 {
        self.silent_ns
    }

    /// What was heard and commanded in a period.
    pub fn record(&mut self, record: &Record) {
        let Self { bytes, records, session, .. } = self;
        let written = encode(record, &mut bytes[..LONGEST_RECORD]);
        if !written.is_some_and(|length| records.push(*session, &bytes[..length])) {
            self.word(head::UNOBSERVED).fetch_add(1, Relaxed);
        }
    }
}

impl Made {
    /// The component's sign of life, and its period.
    pub fn period(&self, ns: u64) {
        self.0.words()[head::PERIOD].store(ns, Relaxed);
        self.0.words()[head::PERIODS].fetch_add(1, Release);
    }

    /// What is kept of a tool in the work, of this period.
    pub fn keep(&self, period: &TiedPeriod) {
        retained::keep(&self.0, period);
    }
}

impl Rings for ServoSide {
    type Storage = Inline;

    fn next_request(&mut self) -> Option<Request> {
        if self.is_damaged || self.replies.is_full() {
            return None;
        }
        let Self { requests, bytes, session, is_damaged, .. } = self;
        // as many as the ring holds: a control that goes on writing does not hold the servo thread
        for _ in 0..layout::REQUESTS.slots {
            let request = match requests.take(&mut bytes[..]) {
                Ok(None) => return None,
                Ok(Some((of, _))) if of != *session => continue, // a control's before this one
                Ok(Some((_, bytes))) => decode::<Request>(bytes).ok(),
                Err(_) => None,
            };
            match request.filter(|request| check_request(request).is_ok()) {
                None => *is_damaged = true,
                request => return request,
            }
            break;
        }
        None
    }

    fn reply(&mut self, replied: Replied) {
        let Self { bytes, replies, session, .. } = self;
        if let Some(length) = encode(&replied, &mut bytes[..LONGEST_RECORD]) {
            // there was room before the request was taken
            let _ = replies.push(*session, &bytes[..length]);
        }
    }

    fn next_step(&mut self) -> Option<Step<Inline>> {
        if self.is_damaged {
            return None;
        }
        let Self { steps, bytes, session, is_damaged, .. } = self;
        for _ in 0..layout::STEPS.slots {
            let step = match steps.take(&mut bytes[..]) {
                Ok(None) => return None,
                Ok(Some((of, _))) if of != *session => continue,
                Ok(Some((_, bytes))) => decode::<Step<Inline>>(bytes).ok(),
                Err(_) => None,
            };
            match step.filter(|step| check_step(step).is_ok()) {
                None => *is_damaged = true,
                step => return step,
            }
            break;
        }
        None
    }

    fn steps_waiting(&self) -> usize {
        self.steps.waiting()
    }

    fn release(&mut self, _: Step<Inline>) {}

    fn can_say(&self) -> bool {
        !self.said.is_full()
    }

    fn say(&mut self, said: Said) {
        let Self { bytes, session, .. } = self;
        if let Some(length) = encode(&said, &mut bytes[..]) {
            let _ = self.said.push(*session, &bytes[..length]); // there was room before
        }
    }

    fn stops(&mut self) -> u32 {
        let word = self.word(head::STOPS);
        // a period in which nothing is asked writes nothing
        let asked = if word.load(Relaxed) == 0 { 0 } else { word.swap(0, AcqRel) };
        if (asked >> 32) as u32 == self.session { asked as u32 } else { 0 }
    }
}
