//! The first line of a file of state: what it is, its version, and the checksum of all that
//! follows.
//!
//! ```text
//!   # leadscrew tools 1, checksum 5d0c01b2
//!   [[tool]]
//!   number = 1 …
//! ```
//!
//! A file that was cut short, or in which a byte has changed, is found by it. Who edits a file by
//! hand writes `edited` in place of `checksum …`, and so says that the file is as it should be.
use std::fmt;

/// Something that is kept.
pub trait Datum: Sized {
    /// Name of its file.
    const FILE: &'static str;
    /// What it is, in one word.
    const KIND: &'static str;
    /// Layout that this version writes and reads.
    const VERSION: u32 = 1;
    /// Bytes that its file may have.
    const LARGEST: u64 = crate::SMALL_FILE_LIMIT;
    /// Its text.
    fn body(&self) -> String;
    /// It, from its text.
    ///
    /// # Errors
    /// What is wrong with the text, in words.
    fn parse(body: &str) -> Result<Self, String>;
}

/// Why a file is not believed: the rest of a sentence that begins with its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Untrusted {
    /// Something else is in its place.
    NoFile(&'static str),
    /// The file system does not give it.
    Unreadable(String),
    /// More bytes than such a file has.
    TooLarge {
        /// How many.
        bytes: u64,
        /// How many it may have.
        largest: u64,
    },
    /// Its first line is another one.
    Foreign(&'static str),
    /// Another layout.
    Version {
        /// That of the file.
        found: u32,
        /// That of this version.
        known: u32,
    },
    /// The checksum does not fit.
    Changed,
    /// The text says what cannot be.
    Senseless(String),
}

impl fmt::Display for Untrusted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFile(what) => write!(f, "is {what}, and a state folder holds plain files"),
            Self::Unreadable(why) => write!(f, "cannot be read ({why})"),
            Self::TooLarge { bytes, largest } => {
                write!(f, "has {bytes} bytes, where {largest} are the most")
            }
            Self::Foreign(kind) => {
                write!(f, "does not begin with the line `# leadscrew {kind} 1, checksum …`")
            }
            Self::Version { found, known } => write!(
                f,
                "has layout {found}, and this version of Leadscrew reads layout {known}"
            ),
            Self::Changed => f.write_str(
                "was cut short or changed since it was written (who has edited it writes `edited` in place of the checksum in its first line)",
            ),
            Self::Senseless(why) => write!(f, "says what cannot be ({why})"),
        }
    }
}

/// A datum that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Sealed<D> {
    /// It.
    pub value: D,
    /// A person has edited it.
    pub is_edited: bool,
}

/// A datum's file: its first line and its text.
pub fn sealed<D: Datum>(body: &str) -> String {
    let checksum = checksum(body);
    format!("# leadscrew {} {}, checksum {checksum}\n{body}", D::KIND, D::VERSION)
}

fn checksum(body: &str) -> String {
    format!("{:08x}", crc32fast::hash(body.as_bytes()))
}

/// What a file's bytes say.
///
/// # Errors
/// Why they are not to be believed.
pub fn open<D: Datum>(bytes: &[u8]) -> Result<Sealed<D>, Untrusted> {
    if bytes.len() as u64 > D::LARGEST {
        return Err(Untrusted::TooLarge { bytes: bytes.len() as u64, largest: D::LARGEST });
    }
    let foreign = Untrusted::Foreign(D::KIND);
    let head_end = bytes.iter().position(|b| *b == b'\n').ok_or_else(|| foreign.clone())?;
    let (head, body) = bytes.split_at(head_end);
    let head = std::str::from_utf8(head).map_err(|_| foreign.clone())?;
    let rest = head.strip_prefix("# leadscrew ").and_then(|rest| rest.strip_prefix(D::KIND));
    let (version, seal) = rest
        .and_then(|rest| rest.strip_prefix(' '))
        .and_then(|rest| rest.split_once(", "))
        .ok_or_else(|| foreign.clone())?;
    let version: u32 = version.parse().map_err(|_| foreign.clone())?;
    if version != D::VERSION {
        return Err(Untrusted::Version { found: version, known: D::VERSION });
    }
    let body = std::str::from_utf8(&body[1..]).map_err(|_| Untrusted::Changed)?;
    let is_edited = seal.trim_end() == "edited";
    if !is_edited && seal.strip_prefix("checksum ") != Some(&checksum(body)) {
        let is_seal = seal.starts_with("checksum ");
        return Err(if is_seal { Untrusted::Changed } else { foreign });
    }
    let value = D::parse(body).map_err(Untrusted::Senseless)?;
    Ok(Sealed { value, is_edited })
}
