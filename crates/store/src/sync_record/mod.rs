//! The sync record: what must be known to take a tool out of its work after the control has died: a tap out of its hole, or one
//! that is tied to a spindle without being screwed to the work.
//!
//! ```text
//!   (θ, z) plane          z(θ) = z₀ + H·(θ − θ₀)          written before the tap touches the work,
//!      PS ●  θ₀, z₀                                       read by whoever comes after:
//!          ╲                                              encoders + record = where on the line
//!        PE ● bottom                                      the tap stands, and the way back
//!
//!   positioning ──► Inward ──► (bottom) Outward ──► Out     each arrow is a generation on the disk
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

use bytes::{Reader, Writer};
use std::fmt;
use units::{Angle, Lead, Length, Spin, Stiffness};

/// First bytes of every record.
const MAGIC: [u8; 4] = *b"LSYN";
/// Layout that this version writes and reads.
pub const VERSION: u16 = 2;
/// No record is longer.
pub const LONGEST: usize = 2048;
/// Longest name in it, bytes; longer ones are cut.
const LONGEST_NAME: usize = 255;
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
}

/// How far the tap has got.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stage {
    /// Going in, or about to.
    Inward = 1,
    /// Turned round at the bottom.
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

/// What the tool cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Cut {
    /// It taps: screwed to the work, it comes out along its thread.
    Tap = 1,
    /// A pass over a turned thread.
    Thread = 2,
    /// A cam is ground.
    Cam = 3,
    /// A polygon is turned.
    Polygon = 4,
    /// A gear is hobbed.
    Gear = 5,
}

impl Cut {
    const ALL: [Self; 5] = [Self::Tap, Self::Thread, Self::Cam, Self::Polygon, Self::Gear];

    /// For people: what the tool is doing.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tap => "tap",
            Self::Thread => "threading pass",
            Self::Cam => "cam grinding",
            Self::Polygon => "polygon turning",
            Self::Gear => "hobbing",
        }
    }

    /// An axis along a thread follows the spindle.
    const fn has_thread(self) -> bool {
        matches!(self, Self::Tap | Self::Thread)
    }
}

/// How a tool comes off work that it is not screwed to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Retreat {
    /// Bus index of the infeed axis.
    pub axis: u8,
    /// Its coordinate where the tool is clear of the work.
    pub clear: Length,
    /// That is on its positive side.
    pub outward: bool,
}

impl Retreat {
    /// How far a place is inside of where the tool is clear; negative outside.
    pub fn inside(&self, place: Length) -> Length {
        if self.outward { self.clear - place } else { place - self.clear }
    }
}

/// The coupled motion. Coordinates are those of the axes, at the spindle's gauge line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// What is cut.
    pub cut: Cut,
    /// What leads the tool off the work first; a tap has none.
    pub retreat: Option<Retreat>,
    /// Bus index of the axis along the thread; where there is none, of the infeed axis.
    pub axis: u8,
    /// Which spindle leads.
    pub spindle: u8,
    /// The tool in the spindle.
    pub tool: u32,
    /// Its nominal diameter.
    pub diameter: Length,
    /// θ₀: the spindle's angle, multi-turn, …
    pub theta0: Angle,
    /// … that belongs to this place of the axis.
    pub z0: Length,
    /// H: axis travel per positive turn of the spindle; zero where no thread is cut.
    pub lead: Lead,
    /// PS: where the way out ends.
    pub start: Length,
    /// PE: the programmed bottom.
    pub bottom: Length,
    /// Where the material is taken to begin.
    pub surface: Length,
    /// Highest planned speed, signed as on the way in.
    pub spin: Spin,
    /// Axial stiffness of the holder.
    pub stiffness: Stiffness,
}

impl Stroke {
    /// The hand of the thread: right-hand where turning clockwise leads into the work.
    pub fn is_right_hand(&self) -> bool {
        (self.bottom < self.start) == (self.lead < Lead::ZERO)
    }

    /// z(θ).
    pub fn position(&self, theta: Angle) -> Length {
        self.z0 + self.lead * (theta - self.theta0)
    }

    /// How far a place of the axis is inside of PS, along the way in; negative outside.
    pub fn inside(&self, z: Length) -> Length {
        if self.bottom < self.start { self.start - z } else { z - self.start }
    }
}

/// One generation of the record.
#[derive(Clone, Debug, PartialEq)]
pub struct SyncRecord {
    /// Whose.
    pub identity: Identity,
    /// At what work.
    pub place: Place,
    /// How far.
    pub stage: Stage,
    /// Along which line.
    pub stroke: Stroke,
}

/// Why a record is not believed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Untrusted {
    /// It begins with other bytes.
    Foreign,
    /// Another layout.
    Version(u16),
    /// Its end is missing.
    Torn {
        /// Bytes there.
        has: usize,
        /// Bytes that it says it has.
        needs: usize,
    },
    /// Something follows its end.
    Overlong {
        /// Bytes there.
        has: usize,
        /// Bytes that it says it has.
        needs: usize,
    },
    /// The checksum does not fit: a bit has changed.
    Changed,
    /// The checksum fits, and yet a field says what cannot be.
    Senseless(&'static str),
    /// Another machine's.
    OtherMachine {
        /// Whose it is.
        found: String,
        /// Whose it should be.
        expected: String,
    },
    /// The encoders have lost their reference since.
    OldEpoch {
        /// Epoch in which it was written.
        found: u64,
        /// The encoders' own.
        expected: u64,
    },
    /// In the place of the other generation.
    Swapped {
        /// What it says it is.
        generation: u64,
    },
    /// The two generations do not follow one another: one of them is from another time.
    Apart {
        /// The one,
        older: u64,
        /// and the other.
        newer: u64,
    },
    /// One generation is damaged, and the other says that nothing is in the work: the damaged one may be the newer.
    Unsure(Box<Untrusted>),
    /// One generation is missing, and the other says that nothing is in the work: the missing one may be the newer.
    Missing,
    /// The file system does not give it.
    Unreadable(String),
}

impl fmt::Display for Untrusted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("the sync record is foreign: its file does not begin as a record does"),
            Self::Version(found) => write!(
                f,
                "the sync record has layout {found}, and this version of Leadscrew reads layout {VERSION}: recover with the version that wrote it"
            ),
            Self::Torn { has, needs } => {
                write!(f, "the sync record is torn: {has} bytes are there of {needs}")
            }
            Self::Overlong { has, needs } => write!(
                f,
                "the sync record is followed by other bytes: {has} are there, and it ends after {needs}"
            ),
            Self::Changed => f.write_str("the sync record has changed since it was written: its checksum does not fit"),
            Self::Senseless(field) => {
                write!(f, "the sync record has its checksum right and yet says what cannot be: {field}")
            }
            Self::OtherMachine { found, expected } => {
                write!(f, "the sync record belongs to another machine: to {found}, and this is {expected}")
            }
            Self::OldEpoch { found, expected } => write!(
                f,
                "the sync record is stale: the encoders have lost their reference since it was written (epoch {found:016x}, now {expected:016x})"
            ),
            Self::Swapped { generation } => write!(
                f,
                "the generations of the sync record have been swapped: number {generation} lies in the other one's place"
            ),
            Self::Apart { older, newer } => write!(
                f,
                "the generations of the sync record do not belong together: number {older} beside number {newer}, so one is from another time"
            ),
            Self::Unsure(why) => write!(
                f,
                "one generation of the sync record says that no tap is in the work, but the other, which may be newer, is damaged: {why}"
            ),
            Self::Missing => f.write_str(
                "one generation of the sync record says that no tap is in the work, but the other, which may be newer, is missing",
            ),
            Self::Unreadable(why) => write!(f, "the sync record cannot be read: {why}"),
        }
    }
}

impl std::error::Error for Untrusted {}

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
        w.name(&self.place.program, LONGEST_NAME);
        for number in [self.place.checksum, self.place.op, self.place.line, self.place.hole] {
            w.u32(number);
        }
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
            s.start.value(),
            s.bottom.value(),
            s.surface.value(),
            s.spin.value(),
            s.stiffness.value(),
        ] {
            w.f64(value);
        }
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
        let place = Place {
            program: r.name()?,
            checksum: r.u32()?,
            op: r.u32()?,
            line: r.u32()?,
            hole: r.u32()?,
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
            start: Length::mm(r.f64()?),
            bottom: Length::mm(r.f64()?),
            surface: Length::mm(r.f64()?),
            spin: Spin::rev_per_s(r.f64()?),
            stiffness: Stiffness::n_per_mm(r.f64()?),
        };
        Some((Self { identity, place, stage, stroke }, generation))
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
        let lengths = [s.diameter, s.z0, s.start, s.bottom, s.surface, clear];
        if !lengths.iter().all(|l| l.is_finite() && l.value().abs() < 1e6) {
            return wrong("a length that is no length");
        }
        if !(s.theta0.is_finite() && s.spin.is_finite() && s.stiffness.is_finite()) {
            return wrong("an angle, speed or stiffness that is no number");
        }
        if (s.cut == Cut::Tap) == s.retreat.is_some() {
            return wrong("a way off the work that its tool has not, or has not the one it needs");
        }
        let lead = s.lead.value();
        if !lead.is_finite() || s.cut.has_thread() && !(1e-3..1e3).contains(&lead.abs()) {
            return wrong("a lead that no thread has");
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
