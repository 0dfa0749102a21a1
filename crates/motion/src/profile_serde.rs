//! A profile as data: the pieces that it has, and never more than it has room for.
use crate::{Instant, MAX_PHASES, Phase, Profile};
use core::fmt;
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Elements before the pieces: how many pieces, the end, whether it is cut.
const HEAD: usize = 3;

impl Serialize for Profile {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut tuple = to.serialize_tuple(HEAD + self.pieces().len())?;
        tuple.serialize_element(&(self.pieces().len() as u8))?;
        tuple.serialize_element(&self.end())?;
        tuple.serialize_element(&self.is_cut())?;
        for piece in self.pieces() {
            tuple.serialize_element(piece)?;
        }
        tuple.end()
    }
}

impl<'de> Deserialize<'de> for Profile {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        // a format that knows no lengths asks for as many elements as the first one says
        from.deserialize_tuple(HEAD + MAX_PHASES, Pieces)
    }
}

struct Pieces;

impl<'de> Visitor<'de> for Pieces {
    type Value = Profile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at most {MAX_PHASES} phases of a profile")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Profile, A::Error> {
        let missing = || A::Error::custom("a profile ends too soon");
        let count: u8 = seq.next_element()?.ok_or_else(missing)?;
        if usize::from(count) > MAX_PHASES {
            return Err(A::Error::custom("a profile has more phases than there is room for"));
        }
        let end: Instant = seq.next_element()?.ok_or_else(missing)?;
        let is_cut: bool = seq.next_element()?.ok_or_else(missing)?;
        let mut profile = Profile::EMPTY;
        for _ in 0..count {
            let piece: Phase = seq.next_element()?.ok_or_else(missing)?;
            if !profile.push(piece) {
                return Err(missing());
            }
        }
        Ok(profile.ending_at(end).marked_cut(is_cut))
    }
}
