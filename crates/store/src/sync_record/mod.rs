//! The sync record: what must be known to take a tool out of its work after the control has died: a
//! tap out of its hole, or one that is tied to a spindle without being screwed to the work.
//!
//! ```text
//!   (θ, z) plane          z(θ) = z₀ + H·(θ − θ₀)          written before the tap touches the work,
//!      PS ●  θ₀, z₀                                       read by the next start:
//!          ╲                                              encoders + record = where on the line
//!        PE ● bottom                                      the tap stands, and the way back
//!
//!   positioning ──► Inward ──► (braking) Outward ──► Out    each arrow is a generation on the disk
//! ```
//!
//! A record that is not certainly right is worse than none: axes would move a tap off its thread.
//! So it carries a checksum, a version, the machine's identity and the *epoch* of its encoders (a
//! new number each time a reference was lost), and every way of not being right has a sentence of
//! its own in [`Untrusted`].
//!
//! Layout, little-endian: `LSYN`, version u16, length u32 of the whole, generation u64,
//! [`SyncRecord`] as postcard writes it, CRC-32 of all before it. [`slots`] keeps two generations.
pub mod slots;
mod stroke;
mod untrusted;

use serde::{Deserialize, Serialize, Serializer};
pub use stroke::{Cut, Geared, Retreat, Stroke};
use units::Length;
pub use untrusted::Untrusted;

/// First bytes of every record.
const MAGIC: [u8; 4] = *b"LSYN";
/// Layout that this version writes and reads.
pub const VERSION: u16 = 7;
/// No record is longer.
pub const LONGEST: usize = 8192;
/// Longest name in it, bytes; longer ones are cut.
const LONGEST_NAME: usize = 1023;
/// A command of more words, or of more bytes in all, is not kept.
const MOST_WORDS: usize = 64;
const LONGEST_COMMAND: usize = 3000;
/// Magic, version, length, generation.
const HEAD: usize = 4 + 2 + 4 + 8;
/// The checksum.
const TAIL: usize = 4;

/// Which machine, and which state of its encoders.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Name in the machine's file.
    #[serde(serialize_with = "cut_name")]
    pub machine: String,
    /// Number of this very machine.
    pub serial: u64,
    /// Changes whenever an encoder loses its reference.
    pub epoch: u64,
}

/// Where in which program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// The program as the user named it.
    #[serde(serialize_with = "cut_name")]
    pub program: String,
    /// CRC-32 of its texts, those of the files that it calls among them.
    pub checksum: u32,
    /// Index of the operation.
    pub op: u32,
    /// Program line.
    pub line: u32,
    /// Which of the program's holes and threads, counted from 1 in the order in which they are cut.
    pub hole: u32,
    /// What was typed behind `leadscrew run`, but for where the machine simulator is and where to
    /// begin: all that is needed to go on.
    #[serde(serialize_with = "whole_command")]
    pub command: Vec<String>,
}

/// How far the tap has got.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stage {
    /// Going in, or about to: it has not turned back.
    Inward,
    /// About to turn back at the bottom, or on its way out.
    Outward,
    /// Out of the work: nothing to recover.
    Out,
    /// Taken out by a recovery: nothing to recover, and the hole is one whose tap was.
    Recovered,
}

impl Stage {
    /// A tap may be in the work.
    pub const fn is_in_work(self) -> bool {
        match self {
            Self::Inward | Self::Outward => true,
            Self::Out | Self::Recovered => false,
        }
    }
}

/// One generation of the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SyncRecord {
    /// Whose.
    pub identity: Identity,
    /// The number under which the machine itself keeps that this tool is in its work.
    pub engagement: u64,
    /// At what work.
    pub place: Place,
    /// How far.
    pub stage: Stage,
    /// Along which line.
    pub stroke: Stroke,
}

impl Identity {
    /// For people.
    fn name(&self) -> String {
        format!("{} number {:x}", self.machine, self.serial)
    }
}

impl SyncRecord {
    /// Its bytes, as this generation.
    pub fn encode(&self, generation: u64) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend([0; 4]);
        bytes.extend(generation.to_le_bytes());
        // what cannot be written leaves a record without fields, which no reader believes
        let mut bytes = postcard::to_extend(self, bytes).unwrap_or_default();
        bytes.resize(bytes.len().max(HEAD), 0);
        let length = (bytes.len() + TAIL) as u32;
        bytes[6..10].copy_from_slice(&length.to_le_bytes());
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// The record in some bytes, and its generation.
    ///
    /// # Errors
    /// Why they are not to be believed.
    pub fn decode(bytes: &[u8]) -> Result<(Self, u64), Untrusted> {
        let start = bytes.len().min(MAGIC.len());
        if bytes[..start] != MAGIC[..start] {
            return Err(Untrusted::Foreign);
        }
        let torn = |needs| Untrusted::Torn { has: bytes.len(), needs };
        let Some((head, _)) = bytes.split_first_chunk::<HEAD>() else {
            return Err(torn(HEAD + TAIL));
        };
        let [_, _, _, _, v0, v1, l0, l1, l2, l3, generation @ ..] = *head;
        let version = u16::from_le_bytes([v0, v1]);
        let length = u32::from_le_bytes([l0, l1, l2, l3]);
        if version != VERSION {
            return Err(Untrusted::Version(version));
        }
        let needs = length as usize;
        if !(HEAD + TAIL..=LONGEST).contains(&needs) {
            return Err(Untrusted::Changed); // no length that this version writes
        }
        if bytes.len() < needs {
            return Err(torn(needs));
        }
        if bytes.len() > needs {
            return Err(Untrusted::Overlong { has: bytes.len(), needs });
        }
        let (said, checksum) = bytes.split_at(needs - TAIL);
        if checksum != crc32fast::hash(said).to_le_bytes() {
            return Err(Untrusted::Changed);
        }
        match postcard::take_from_bytes::<Self>(&said[HEAD..]) {
            Ok((read, [])) => {
                read.makes_sense()?;
                let generation = u64::from_le_bytes(generation);
                // a longer name, more words, a number with more bytes than it needs: no writer of
                // this version's writes that
                if read.encode(generation) != bytes {
                    return Err(Untrusted::Senseless("it is not as this version would write it"));
                }
                Ok((read, generation))
            }
            Ok(_) => Err(Untrusted::Senseless("it has fields that no record has")),
            Err(_) => Err(Untrusted::Senseless("a field is missing or is none")),
        }
    }

    /// Numbers that no tool can have.
    fn makes_sense(&self) -> Result<(), Untrusted> {
        let s = &self.stroke;
        let wrong = |field| Err(Untrusted::Senseless(field));
        if usize::from(s.axis) >= bus::AXES || usize::from(s.spindle) >= bus::SPINDLES {
            return wrong("an axis or spindle that no machine has");
        }
        let infeed = s.retreat.map_or(0, |retreat| retreat.axis);
        if usize::from(infeed) >= bus::AXES {
            return wrong("an infeed axis that no machine has");
        }
        let clear = s.retreat.map_or(Length::ZERO, |retreat| retreat.clear);
        let lengths =
            [s.diameter, s.z0, s.start, s.bottom, s.surface, s.travel, s.thread_length, clear];
        if !lengths.iter().all(|l| l.is_finite() && l.value().abs() < 1e6) {
            return wrong("a length that is no length");
        }
        if !(s.theta0.is_finite() && s.spin.is_finite() && s.stiffness.is_finite()) {
            return wrong("an angle, speed or stiffness that is no number");
        }
        if (s.cut == Cut::Tap) == s.retreat.is_some() {
            return wrong("a way off the work that its tool has not, or has not the one it needs");
        }
        if s.geared.as_ref().is_some_and(|geared| !geared.makes_sense()) {
            return wrong("a gear that no machine has");
        }
        let lead = s.lead.value();
        if !lead.is_finite() || s.cut.has_thread() && !(1e-3..1e3).contains(&lead.abs()) {
            return wrong("a lead that no thread has");
        }
        if !(s.growth.is_finite() && s.growth.value().abs() < 1e3) {
            return wrong("a lead that grows as none does");
        }
        if s.cut.has_thread() && s.start == s.bottom {
            return wrong("a stroke of no length");
        }
        Ok(())
    }

    /// Whether it is about this machine and its encoders as they are.
    ///
    /// # Errors
    /// [`Untrusted::OtherMachine`] or [`Untrusted::OldEpoch`]. A record that says that nothing is
    /// in the work does not depend on the encoders' reference.
    pub fn belongs_to(&self, identity: &Identity) -> Result<(), Untrusted> {
        let own = &self.identity;
        if own.machine != identity.machine || own.serial != identity.serial {
            let (found, expected) = (own.name(), identity.name());
            return Err(Untrusted::OtherMachine { found, expected });
        }
        if own.epoch != identity.epoch && self.stage.is_in_work() {
            let (found, expected) = (own.epoch, identity.epoch);
            return Err(Untrusted::OldEpoch { found, expected });
        }
        Ok(())
    }
}

/// A name cut to so many bytes, between two characters.
fn cut_name<S: Serializer>(name: &str, to: S) -> Result<S::Ok, S::Error> {
    let end = (0..=name.len().min(LONGEST_NAME)).rev().find(|at| name.is_char_boundary(*at));
    to.serialize_str(&name[..end.unwrap_or(0)])
}

/// None of its words, where they are too many to be kept.
fn whole_command<S: Serializer>(words: &[String], to: S) -> Result<S::Ok, S::Error> {
    let fits = words.len() <= MOST_WORDS
        && words.iter().map(String::len).sum::<usize>() <= LONGEST_COMMAND
        && words.iter().all(|word| word.len() <= LONGEST_NAME);
    to.collect_seq(if fits { words } else { &[] })
}

#[cfg(test)]
mod tests;
