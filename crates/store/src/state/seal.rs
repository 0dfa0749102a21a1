//! The first line of a file of state: what it is, its version, and the checksum of all that
//! follows.
//!
//! ```text
//!   # leadscrew tools 1, checksum 5d0c01b2
//!   # generation 12, 2026-11-29T17:02:37Z, folder 3fa29c0154aa, machine tapping-center
//!   [[tool]]
//!   number = 1 …
//! ```
//!
//! The second line says with which generation of the manifest it was written, when, and for which
//! machine; the checksum covers it. A file that was cut short, or in which a byte has changed, is
//! found by it. Who edits a file by hand writes `edited` in place of `checksum …`, and so says that
//! the file is as it should be.
use super::manifest::Origin;
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
    /// It was written for another machine, or in another folder.
    OtherOrigin {
        /// Where it was written: folder and machine.
        found: (String, String),
        /// Where it is read.
        own: (String, String),
    },
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
            Self::OtherOrigin { found: (folder, machine), own: (own, is) } => write!(
                f,
                "is of the machine `{machine}` (folder {folder}), and this is `{is}` (folder {own})"
            ),
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
    /// Where and when it was written; `None`: it does not say.
    pub origin: Option<Origin>,
}

/// A datum's file: its first lines and its text.
pub fn sealed<D: Datum>(origin: &Origin, body: &str) -> String {
    sealed_as(D::KIND, D::VERSION, Some(origin), body)
}

/// A file of this kind.
pub(super) fn sealed_as(kind: &str, version: u32, origin: Option<&Origin>, body: &str) -> String {
    let body = format!("{}{body}", origin.map(Origin::line).unwrap_or_default());
    let checksum = checksum(&body);
    format!("# leadscrew {kind} {version}, checksum {checksum}\n{body}")
}

fn checksum(body: &str) -> String {
    format!("{:08x}", crc32fast::hash(body.as_bytes()))
}

/// Where and when a file of any kind was written, if it is whole.
pub(super) fn origin(bytes: &[u8]) -> Option<Origin> {
    let (head, body) = std::str::from_utf8(bytes).ok()?.split_once('\n')?;
    let (_, sum) = head.split_once(", checksum ")?;
    let (origin, _) = Origin::split(body);
    origin.filter(|_| sum.trim_end() == checksum(body))
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
    let (origin, body) = Origin::split(body);
    let value = D::parse(body).map_err(Untrusted::Senseless)?;
    Ok(Sealed { value, is_edited, origin })
}
