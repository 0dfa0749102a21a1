//! Frames: a message with its number and its checksum.
use crate::Error;
use crate::message::Message;

/// The layout that is written and read.
pub const VERSION: u8 = 12;
/// Longest payload.
pub const LONGEST: usize = 16_384;

const MAGIC: [u8; 2] = *b"LS";
pub(crate) const HEAD: usize = 9;
pub(crate) const TAIL: usize = 4;

/// A message as a frame with this number, in place of what is in the buffer.
pub fn encode(message: &Message, sequence: u32, into: &mut Vec<u8>) {
    into.clear();
    into.extend_from_slice(&MAGIC);
    into.push(VERSION);
    into.extend_from_slice(&sequence.to_le_bytes());
    into.extend_from_slice(&[0; 2]);
    // what cannot be written leaves a payload that is no message
    *into = postcard::to_extend(message, std::mem::take(into)).unwrap_or_default();
    into.resize(into.len().max(HEAD), 0);
    let length = (into.len() - HEAD) as u16;
    into[HEAD - 2..HEAD].copy_from_slice(&length.to_le_bytes());
    let checksum = crc32fast::hash(into);
    into.extend_from_slice(&checksum.to_le_bytes());
}

/// What a frame's first bytes say: its number, how many bytes follow.
pub(crate) fn head(bytes: &[u8; HEAD]) -> Result<(u32, usize), Error> {
    let [l, s, version, a, b, c, d, length @ ..] = *bytes;
    if [l, s] != MAGIC {
        return Err(Error::Foreign);
    }
    if version != VERSION {
        return Err(Error::Version(version));
    }
    let length = u16::from_le_bytes(length);
    if usize::from(length) > LONGEST {
        return Err(Error::TooLong(length));
    }
    Ok((u32::from_le_bytes([a, b, c, d]), usize::from(length) + TAIL))
}

/// The message in a whole frame, and its number.
///
/// # Errors
/// What is wrong with the frame.
pub fn decode(frame: &[u8]) -> Result<(Message, u32), Error> {
    let (first, rest) = frame.split_first_chunk::<HEAD>().ok_or(Error::Torn)?;
    let (sequence, follow) = head(first)?;
    if rest.len() != follow {
        return Err(Error::Torn);
    }
    let (said, checksum) = frame.split_at(frame.len() - TAIL);
    if crc32fast::hash(said).to_le_bytes() != checksum {
        return Err(Error::Checksum);
    }
    match postcard::take_from_bytes::<Message>(&said[HEAD..]) {
        Ok((message, [])) if message.makes_sense() => Ok((message, sequence)),
        _ => Err(Error::Senseless),
    }
}
