//! Frames: a message with its number and its checksum.
use crate::Error;
use crate::bytes::{Reader, Writer};
use crate::message::Message;

/// The layout that is written and read.
pub const VERSION: u8 = 7;
/// Longest payload.
pub const LONGEST: usize = 16_384;

const MAGIC: [u8; 2] = *b"LS";
pub(crate) const HEAD: usize = 10;
pub(crate) const TAIL: usize = 4;

/// A message as a frame with this number, in place of what is in the buffer.
pub fn encode(message: &Message, sequence: u32, into: &mut Vec<u8>) {
    into.clear();
    into.extend_from_slice(&MAGIC);
    let mut w = Writer(into);
    w.u8(VERSION);
    w.u8(message.kind());
    w.u32(sequence);
    w.u16(0);
    message.write(&mut w);
    let length = (into.len() - HEAD) as u16;
    into[8..HEAD].copy_from_slice(&length.to_le_bytes());
    let checksum = crc32fast::hash(into);
    into.extend_from_slice(&checksum.to_le_bytes());
}

/// What a frame's first bytes say: its kind, its number, how many bytes follow.
pub(crate) fn head(bytes: &[u8; HEAD]) -> Result<(u8, u32, usize), Error> {
    if bytes[..2] != MAGIC {
        return Err(Error::Foreign);
    }
    if bytes[2] != VERSION {
        return Err(Error::Version(bytes[2]));
    }
    let mut r = Reader(&bytes[3..]);
    let (Some(kind), Some(sequence), Some(length)) = (r.u8(), r.u32(), r.u16()) else {
        return Err(Error::Foreign);
    };
    if usize::from(length) > LONGEST {
        return Err(Error::TooLong(length));
    }
    Ok((kind, sequence, usize::from(length) + TAIL))
}

/// The message in a whole frame, and its number.
///
/// # Errors
/// What is wrong with the frame.
pub fn decode(frame: &[u8]) -> Result<(Message, u32), Error> {
    let (first, rest) = frame.split_first_chunk::<HEAD>().ok_or(Error::Torn)?;
    let (kind, sequence, follow) = head(first)?;
    if rest.len() != follow {
        return Err(Error::Torn);
    }
    let (said, checksum) = frame.split_at(frame.len() - TAIL);
    if crc32fast::hash(said).to_le_bytes() != checksum {
        return Err(Error::Checksum);
    }
    let mut r = Reader(&said[HEAD..]);
    let message = Message::read(kind, &mut r).ok_or(Error::Senseless)?;
    if !r.0.is_empty() {
        return Err(Error::Senseless);
    }
    Ok((message, sequence))
}
