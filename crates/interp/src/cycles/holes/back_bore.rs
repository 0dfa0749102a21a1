//! Back boring: G87. The bit passes the bore beside its axis and cuts upwards, from below.
//!
//! ```text
//!        R ┼──┐1 shift by I, J     6 ┌──┼      1  at R: stop at angle 0, aside by the shift
//!          │  │2                     │  │      2  down beside the axis to Z, 3 back onto it, turn
//!        K ┼ ·│· ┬ · counterbore     │5        4  feed up to K and back down to Z
//!        Z ┼  └3─┘4 ─────────────────┘         5  stop, aside, up, 6 back onto the axis, turn
//! ```
//!
//! Source: NISTIR 6556, section 3.5.16.7; the order of the calls was measured on LinuxCNC 2.9.
use crate::{
    call::{Call, Sink, out::Out},
    codes::spelling::short,
    cycles::holes::bore::{hold_spindle, turn_again},
    fault::{Outcome, refuse},
    geometry::frame::Point,
    modes::{Cycle, Modes, tapping::Shift},
    words::Words,
};

/// Letters of the shift and of the counterbore, by axis.
const LETTERS: [u8; 3] = *b"IJK";

/// I, J and K of G87, or those that the cycle kept.
pub(crate) fn shift_words(
    words: &Words,
    cycle: Cycle,
    kept: Option<Shift>,
) -> Outcome<Option<Shift>> {
    if cycle != Cycle::BackBore {
        return Ok(None);
    }
    let mut shift = [0.0; 3];
    for (axis, letter) in LETTERS.into_iter().enumerate() {
        let Some(value) = words.get(letter).or(kept.map(|kept| kept[axis])) else {
            let text = format!(
                "G87 needs I, J and K: how far aside the tool passes, and where the counterbore ends; {} is missing",
                letter as char
            );
            return refuse("I0518", words.place.span, text);
        };
        shift[axis] = value;
    }
    Ok(Some(shift))
}

/// Where the counterbore ends, which is above where it begins.
pub(crate) fn counterbore(
    words: &Words,
    modes: &Modes,
    shift: Option<Shift>,
    bottom: f64,
) -> Outcome<f64> {
    let [_, _, n] = modes.plane_axes();
    let Some(shift) = shift else { return Ok(bottom) };
    let end = if modes.incremental { bottom + shift[n] } else { shift[n] };
    if end < bottom {
        let letter = LETTERS[n] as char;
        let (bottom, end) = (short(bottom), short(end));
        let text = format!(
            "G87 bores upwards: {letter} must be at or above the depth {bottom}, found {end}"
        );
        return refuse("I0519", words.place.span, text);
    }
    Ok(end)
}

/// G87: the tool stands over the hole at R.
pub(crate) fn back_bore<S: Sink>(
    modes: &Modes,
    at: &Point,
    levels: [f64; 3],
    shift: Shift,
    out: &mut Out<'_, S>,
) {
    let [a, b, n] = modes.plane_axes();
    let [bottom, counterbore, clear] = levels;
    let point = |aside: bool, level: f64| {
        let mut point = *at;
        if aside {
            point[a] += shift[a];
            point[b] += shift[b];
        }
        point[n] = level;
        point
    };
    out.say(&Call::Rapid(point(true, at[n])));
    hold_spindle(modes, out);
    out.say(&Call::Rapid(point(true, bottom)));
    out.say(&Call::Rapid(point(false, bottom)));
    turn_again(modes, out);
    out.say(&Call::Line(point(false, counterbore)));
    out.say(&Call::Line(point(false, bottom)));
    hold_spindle(modes, out);
    out.say(&Call::Rapid(point(true, bottom)));
    out.say(&Call::Rapid(point(true, clear)));
    out.say(&Call::Rapid(point(false, clear)));
    turn_again(modes, out);
}
