//! The words of a corner: `,C` and `,R`, and those of a lathe that need no comma.
use crate::{
    fault::{Outcome, refuse},
    front_end::fanuc::{
        state::{Corner, Fanuc, Said},
        words::sense::Sense,
    },
};

/// Whether this word of a G1 is a corner, though no comma is before it.
pub(crate) fn is_corner(fanuc: &Fanuc, word: &Said, sense: &Sense) -> bool {
    let letter = match word.letter {
        b'C' => fanuc.c_is_a_chamfer,
        b'R' | b'I' | b'K' => true,
        _ => false,
    };
    letter && fanuc.is_lathe() && sense.feed && fanuc.lathe_cycle.is_none()
}

pub(crate) fn corner_word(fanuc: &mut Fanuc, word: &Said, value: f64) -> Outcome {
    let round = word.letter.eq_ignore_ascii_case(&b'R');
    if fanuc.once.corner.is_some() {
        return refuse("I1054", word.span, "a corner is cut off or rounded, not both");
    }
    if value == 0.0 {
        return Ok(());
    }
    if value < 0.0 && word.letter.is_ascii_lowercase() {
        let text = format!("a corner's size is above 0, found {value}");
        return refuse("I1054", word.span, text);
    }
    fanuc.once.corner = Some(Corner { round, size: value.abs(), span: word.span });
    Ok(())
}
