//! The sync record: what must be known to take a tool out of its work after the control has died: a tap out of its hole, or one
//! that is tied to a spindle without being screwed to the work.
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
//! A record that is not certainly right is worse than none: axes would move a tap off its thread. So it
//! carries a checksum, a version, the machine's identity and the *epoch* of its encoders (a new number each time a
//! reference was lost), and every way of not being right has a sentence of its own in [`Untrusted`].
//!
//! Layout, little-endian: `LSYN`, version u16, length u32 of the whole, generation u64, fields as in
//! [`SyncRecord`] (f64 for quantities, u16 + UTF-8 for names), CRC-32 of all before it. [`slots`] keeps two generations.
mod bytes;
pub mod slots;
mod stroke;
mod untrusted;

use bytes::{Reader, Writer};
pub use stroke::{Cut, Geared, Retreat, Stroke};
use units::{Angle, Lead, LeadGrowth, Length, Spin, Stiffness};
pub use untrusted::Untrusted;

/// First bytes of every record.
const MAGIC: [u8; 4] = *b"LSYN";
/// Layout that this version writes and reads.
pub const VERSION: u16 = 6;
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
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Name in the machine's file.
    pub machine: String,
    /// Number of this very machine.
    pub serial: u64,
    /// Changes whenever an encoder loses its reference.
    pub epoch: u64,
}

/// Where in which program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The program as the user named it.
    pub program: String,
    /// CRC-32 of its text.
    pub checksum: u32,
    /// Index of the operation.
    pub op: u32,
    /// Program line.
    pub line: u32,
    /// Which of the program's holes and threads, counted from 1 in the order in which they are cut.
    pub hole: u32,
    /// What was typed behind `leadscrew run`, but for where the machine simulator is and where to begin: all that is needed to go on.
    pub command: Vec<String>,
}

/// How far the tap has got.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stage {
    /// Going in, or about to: it has not turned back.
    Inward = 1,
    /// About to turn back at the bottom, or on its way out.
    Outward = 2,
    /// Out of the work: nothing to recover.
    Out = 3,
    /// Taken out by a recovery: nothing to recover, and the hole is one whose tap was.
    Recovered = 4,
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
#[derive(Clone, Debug, PartialEq)]
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
        let mut w = Writer::default();
        w.bytes(&MAGIC);
        w.u16(VERSION);
        w.u32(0);
        w.u64(generation);
        w.name(&self.identity.machine, LONGEST_NAME);
        w.u64(self.identity.serial);
        w.u64(self.identity.epoch);
        w.u64(self.engagement);
        w.name(&self.place.program, LONGEST_NAME);
        for number in [self.place.checksum, self.place.op, self.place.line, self.place.hole] {
            w.u32(number);
        }
        w.words(&self.place.command);
        w.u8(self.stage as u8);
        let s = &self.stroke;
        w.u8(s.cut as u8);
        let retreat = s.retreat.unwrap_or(Retreat { axis: 0, clear: Length::ZERO, outward: false });
        w.u8(u8::from(s.retreat.is_some()) | u8::from(retreat.outward) << 1);
        w.u8(retreat.axis);
        w.f64(retreat.clear.value());
        w.u8(s.axis);
        w.u8(s.spindle);
        w.u32(s.tool);
        for value in [
            s.diameter.value(),
            s.theta0.value(),
            s.z0.value(),
            s.lead.value(),
            s.growth.value(),
            s.start.value(),
            s.bottom.value(),
            s.surface.value(),
            s.spin.value(),
            s.stiffness.value(),
            s.travel.value(),
            s.thread_length.value(),
        ] {
            w.f64(value);
        }
        w.geared(s.geared.as_ref());
        let mut bytes = w.finish();
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
        let mut head = Reader::new(&bytes[start..]);
        let (Some(version), Some(length)) = (head.u16(), head.u32()) else {
            return Err(torn(HEAD + TAIL));
        };
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
        let mut body = Reader::new(&said[HEAD - 8..]);
        let read = Self::fields(&mut body).ok_or(Untrusted::Senseless("a field is missing"))?;
        if !body.is_empty() {
            return Err(Untrusted::Senseless("it has fields that nobody knows"));
        }
        read.0.makes_sense()?;
        Ok(read)
    }

    fn fields(r: &mut Reader<'_>) -> Option<(Self, u64)> {
        let generation = r.u64()?;
        let identity = Identity { machine: r.name()?, serial: r.u64()?, epoch: r.u64()? };
        let engagement = r.u64()?;
        let place = Place {
            program: r.name()?,
            checksum: r.u32()?,
            op: r.u32()?,
            line: r.u32()?,
            hole: r.u32()?,
            command: r.words()?,
        };
        let stage = match r.u8()? {
            1 => Stage::Inward,
            2 => Stage::Outward,
            3 => Stage::Out,
            4 => Stage::Recovered,
            _ => return None,
        };
        let number = r.u8()?;
        let cut = Cut::ALL.into_iter().find(|cut| *cut as u8 == number)?;
        let flags = r.u8()?;
        let (infeed, clear) = (r.u8()?, Length::mm(r.f64()?));
        let retreat = Retreat { axis: infeed, clear, outward: flags & 2 != 0 };
        let stroke = Stroke {
            cut,
            retreat: (flags & 1 != 0).then_some(retreat),
            axis: r.u8()?,
            spindle: r.u8()?,
            tool: r.u32()?,
            diameter: Length::mm(r.f64()?),
            theta0: Angle::rev(r.f64()?),
            z0: Length::mm(r.f64()?),
            lead: Lead::mm_per_rev(r.f64()?),
            growth: LeadGrowth::mm_per_rev2(r.f64()?),
            start: Length::mm(r.f64()?),
            bottom: Length::mm(r.f64()?),
            surface: Length::mm(r.f64()?),
            spin: Spin::rev_per_s(r.f64()?),
            stiffness: Stiffness::n_per_mm(r.f64()?),
            travel: Length::mm(r.f64()?),
            thread_length: Length::mm(r.f64()?),
            geared: r.geared()?,
        };
        Some((Self { identity, engagement, place, stage, stroke }, generation))
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
    /// [`Untrusted::OtherMachine`] or [`Untrusted::OldEpoch`]. A record that says that nothing is in the work does not
    /// depend on the encoders' reference.
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

#[cfg(test)]
mod tests;
