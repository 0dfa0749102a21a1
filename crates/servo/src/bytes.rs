//! Values as bytes, and back, without taking memory.
//!
//! The bytes are postcard's: integers as short as they are, numbers as their eight bytes. Nothing
//! in them says what they are: both ends are built from the same source, which the layout's version
//! ensures.
use core::fmt;
use postcard::de_flavors::Flavor;
use serde::{Deserialize, Serialize};

/// Bytes that are no value of the type that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unreadable;

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a message says what cannot be")
    }
}

impl std::error::Error for Unreadable {}

/// The value as bytes at the buffer's start; how many. `None`: the buffer is too short, or the
/// value does not go to another process.
pub fn encode<T: Serialize>(value: &T, into: &mut [u8]) -> Option<usize> {
    postcard::to_slice(value, into).ok().map(|used| used.len())
}

/// The value that exactly these bytes are.
///
/// # Errors
/// They are none, something follows it, or one of its numbers is none.
pub fn decode<'de, T: Deserialize<'de>>(bytes: &'de [u8]) -> Result<T, Unreadable> {
    let mut reader = postcard::Deserializer::from_flavor(Numbers { left: bytes });
    let value = T::deserialize(&mut reader).map_err(|_| Unreadable)?;
    let left = reader.finalize().map_err(|_| Unreadable)?;
    if left.is_empty() { Ok(value) } else { Err(Unreadable) }
}

/// Bytes of which every eight that are taken at once are a number: no message has texts or bytes in
/// it.
struct Numbers<'de> {
    left: &'de [u8],
}

impl<'de> Flavor<'de> for Numbers<'de> {
    type Remainder = &'de [u8];
    type Source = &'de [u8];

    fn pop(&mut self) -> postcard::Result<u8> {
        let (first, left) =
            self.left.split_first().ok_or(postcard::Error::DeserializeUnexpectedEnd)?;
        self.left = left;
        Ok(*first)
    }

    fn try_take_n(&mut self, count: usize) -> postcard::Result<&'de [u8]> {
        let (taken, left) =
            self.left.split_at_checked(count).ok_or(postcard::Error::DeserializeUnexpectedEnd)?;
        if let Ok(number) = <[u8; 8]>::try_from(taken)
            && f64::from_le_bytes(number).is_nan()
        {
            return Err(postcard::Error::SerdeDeCustom);
        }
        self.left = left;
        Ok(taken)
    }

    fn finalize(self) -> postcard::Result<&'de [u8]> {
        Ok(self.left)
    }
}
