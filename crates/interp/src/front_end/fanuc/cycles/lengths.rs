//! The words of a multiple cycle as lengths.
use crate::{
    front_end::fanuc::{
        state::{Fanuc, Said},
        words::read::scaled,
    },
    geometry::offset_curve::Flat,
    program::Program,
};

/// The word with this letter.
pub(crate) fn word(said: &[Said], letter: u8) -> Option<&Said> {
    said.iter().find(|said| said.letter == letter)
}

/// A word's length in the program's unit.
pub(crate) fn long(fanuc: &Fanuc, it: &Program<'_>, said: &[Said], letter: u8) -> Option<f64> {
    // P of G74 to G76 is a length too, and counts as Q does
    let as_length = |said: &Said| Said { letter: b'Q', ..*said };
    word(said, letter).map(|said| scaled(fanuc, &it.executor, &as_length(said)))
}

/// The same along X: a diameter becomes a radius.
pub(crate) fn across(fanuc: &Fanuc, it: &Program<'_>, said: &[Said], letter: u8) -> Option<f64> {
    let half = if it.executor.modes.diameter { 0.5 } else { 1.0 };
    long(fanuc, it, said, letter).map(|value| half * value)
}

/// Where X, Z, U, W lead, as [Z, X].
pub(crate) fn corner_of(fanuc: &Fanuc, it: &Program<'_>, said: &[Said]) -> Flat {
    let at = it.executor.modes.at;
    let step = it.executor.modes.incremental;
    let along = |value: Option<f64>, by: Option<f64>, now: f64| {
        value.map_or(now + by.unwrap_or(0.0), |value| if step { now + value } else { value })
    };
    let z = along(long(fanuc, it, said, b'Z'), long(fanuc, it, said, b'W'), at[2]);
    let x = along(across(fanuc, it, said, b'X'), across(fanuc, it, said, b'U'), at[0]);
    [z, x]
}
