//! What lies where in the shared memory.
//!
//! ```text
//!   header   magic, version, what the component has, signs of life, sessions
//!   rings    set-ups, verdicts │ requests, replies │ steps │ said, records
//! ```
//!
//! A *session* is one control that leads the servo thread, from its set-up to its end. Messages
//! carry its number: what a control before has left in a ring is not taken for this one's.
use crate::ring::{Place, WORD};

/// First word: `LEADSCRW`.
pub(crate) const MAGIC: u64 = u64::from_be_bytes(*b"LEADSCRW");
/// Of this layout and of the messages in it. Both ends come from one build; another one is refused.
pub(crate) const VERSION: u64 = 8;

/// Words of the header.
pub(crate) mod head {
    /// [`super::MAGIC`], written when everything else is.
    pub(crate) const MAGIC: usize = 0;
    /// [`super::VERSION`].
    pub(crate) const VERSION: usize = 1;
    /// Checksum of the build: crate version and sizes of what crosses.
    pub(crate) const BUILD: usize = 2;
    /// What the component has: a bit for each axis, then spindles from bit 16.
    pub(crate) const HAS: usize = 3;
    /// Servo period, ns; 0 until the first one.
    pub(crate) const PERIOD: usize = 4;
    /// Number of this loading of the component.
    pub(crate) const LOADED: usize = 5;
    /// Key of the machine's name ([`super::machine_key`]); 0: the process does not know it.
    pub(crate) const MACHINE: usize = 6;
    /// Servo periods since the component was loaded: its sign of life.
    pub(crate) const PERIODS: usize = 8;
    /// Records that found no room.
    pub(crate) const UNOBSERVED: usize = 10;
    /// The session whose kernel ticks; 0: none.
    pub(crate) const SESSION: usize = 16;
    /// The engagement that the next three words are of; the servo thread writes them.
    pub(crate) const KEPT_OF: usize = 17;
    /// How the spindle turned last while an axis was tied to it: 1 with growing angle, 2 with
    /// falling, 0 not yet.
    pub(crate) const SENSE: usize = 18;
    /// How the drives came to rest without a control.
    pub(crate) const STOP: usize = 19;
    /// How far the axis was from its coupling at most, mm, as bits of a double.
    pub(crate) const ERROR_SINCE: usize = 20;
    /// The control's sign of life: its session, and a count in the lower half. One that asks for a
    /// session shows signs of life, too: they are none of a control before it.
    pub(crate) const ALIVE: usize = 24;
    /// The session that its control has ended.
    pub(crate) const ENDED: usize = 25;
    /// The session that was asked for last.
    pub(crate) const ASKED: usize = 26;
    /// Number of the last engagement of a tool; the control writes it, and the two that follow.
    pub(crate) const ENGAGEMENT: usize = 27;
    /// The tool that is in the work.
    pub(crate) const ENGAGED: usize = 28;
    /// How far the axis was from its coupling at most by the control's account, mm, as bits of a
    /// double.
    pub(crate) const ERROR_BEFORE: usize = 29;
    /// Stops that wait in no queue: the session, and flags in the lower half. The control sets
    /// them, the servo thread takes them.
    pub(crate) const STOPS: usize = 30;
    /// Words.
    pub(crate) const SIZE: usize = 32;
}

/// Steps that may wait in the rings of the control's process …
pub const STEPS_BEFORE: usize = 1024;
/// … and here in the usual course; all of the former fit in beside these when a request needs them
/// here.
pub const STEPS_USUAL: usize = 256;

const fn after(place: Place, slots: usize, words: usize) -> Place {
    Place { at: place.at + place.size(), slots, words }
}

pub(crate) const SET_UPS: Place = Place { at: head::SIZE, slots: 2, words: LONGEST_SET_UP / WORD };
pub(crate) const VERDICTS: Place = after(SET_UPS, 4, 2048 / WORD);
pub(crate) const REQUESTS: Place = after(VERDICTS, 16, 1024 / WORD);
pub(crate) const REPLIES: Place = after(REQUESTS, 16, LONGEST_RECORD / WORD);
pub(crate) const STEPS: Place = after(REPLIES, STEPS_BEFORE + STEPS_USUAL, LONGEST_STEP / WORD);
pub(crate) const SAID: Place = after(STEPS, 1024, 512 / WORD);
pub(crate) const RECORDS: Place = after(SAID, 2048, LONGEST_RECORD / WORD);

/// Bytes of the longest set-up: nine axes with as long tables of their errors as a file may have.
pub(crate) const LONGEST_SET_UP: usize = 131_072;
/// Bytes of the longest step: a tap with both strokes of its spindle.
pub(crate) const LONGEST_STEP: usize = 6144;
/// Bytes of the longest record or reply.
pub(crate) const LONGEST_RECORD: usize = 4096;

/// Words of it all.
pub(crate) const SIZE: usize = RECORDS.at + RECORDS.size();

/// What two builds must have in common: version and sizes of what crosses.
pub(crate) const BUILD: u64 = {
    let sizes = [
        size_of::<servo::Record>(),
        size_of::<servo::Replied>(),
        size_of::<servo::Said>(),
        size_of::<servo::SetUp>(),
        size_of::<kernel::Request>(),
        size_of::<motion::Step<motion::Inline>>(),
        SIZE,
    ];
    let mut sum = fnv1a(FNV_BASIS, env!("CARGO_PKG_VERSION").as_bytes());
    let mut at = 0;
    while at < sizes.len() {
        sum = fnv1a(sum, &sizes[at].to_le_bytes());
        at += 1;
    }
    sum
};

/// Text before the build in [`BUILD_MARK`].
pub const BUILD_WORDS: [u8; 16] = *b"leadscrew-build:";

/// The build as text within the component's file, so that one that does not fit is recognised
/// before it is loaded: [`BUILD_WORDS`], and sixteen hexadecimal digits.
pub const BUILD_MARK: [u8; 32] = {
    let mut mark = [0; 32];
    let mut at = 0;
    while at < 16 {
        mark[at] = BUILD_WORDS[at];
        let digit = (BUILD >> (60 - 4 * at)) as u8 & 15;
        mark[16 + at] = if digit < 10 { b'0' + digit } else { b'a' + digit - 10 };
        at += 1;
    }
    mark
};

/// Key of a machine's name, by which a control knows whether it is led here; never 0.
pub(crate) fn machine_key(name: &str) -> u64 {
    fnv1a(FNV_BASIS, name.as_bytes()).max(1)
}

const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

const fn fnv1a(mut sum: u64, bytes: &[u8]) -> u64 {
    let mut at = 0;
    while at < bytes.len() {
        sum = (sum ^ bytes[at] as u64).wrapping_mul(0x0000_0100_0000_01b3);
        at += 1;
    }
    sum
}

/// The name of the shared memory of a component. A HAL session ends at its IPC namespace, and so
/// does the memory: another session on this computer has another component of the same name.
pub fn memory_name(of: &str) -> String {
    let session = std::fs::read_link("/proc/self/ns/ipc").ok();
    let inode = session.as_deref().and_then(std::path::Path::to_str).and_then(|link| {
        let digits = link.strip_prefix("ipc:[")?.strip_suffix(']')?;
        digits.parse::<u64>().ok()
    });
    match inode {
        Some(inode) => format!("/leadscrew-{of}-{inode}"),
        None => format!("/leadscrew-{of}"),
    }
}
