//! Why a record is not believed: each way of not being right has a sentence of its own.
use super::VERSION;
use std::fmt;

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
    /// One generation is damaged, and the other says that nothing is in the work: the damaged one
    /// may be the newer.
    Unsure(Box<Untrusted>),
    /// One generation is missing, and the other says that nothing is in the work: the missing one
    /// may be the newer.
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
