//! Boring cycles in which the spindle stands while the tool passes: G87 and G88, and Fanuc's G76 and G87.
//!
//! ```text
//!   G87  back boring: the bit passes the bore beside its axis and cuts upwards, from below
//!
//!        R ┼──┐1 shift by I, J     6 ┌──┼      1  at R: stop at angle 0, aside by the shift
//!          │  │2                     │  │      2  down beside the axis to Z, 3 back onto it, turn
//!        K ┼ ·│· ┬ · counterbore     │5        4  feed up to K and back down to Z
//!        Z ┼  └3─┘4 ─────────────────┘         5  stop, aside, up, 6 back onto the axis, turn
//!
//!   G88  boring, out by hand: feed down, wait, stop the spindle, stop the program; then out and turn
//! ```
//!
//! LinuxCNC leaves the way out of G88 to the operator and goes on from the clear level as if he had been there;
//! here the axis is brought there after the stop, straight up, wherever he left it.
//!
//! Fanuc's cycles move aside by Q, along an axis that the machine has set:
//!
//! ```text
//!   G76  fine boring:  feed down to Z, wait, stop at angle 0, aside by Q, out fast, back, turn
//!   G87  back boring:  stop at angle 0, aside, down to R, back, turn, feed up to Z, wait, stop, aside, out, back, turn
//! ```
//!
//! Source: Fanuc, operator's manual of series 30i, "Canned cycles for drilling"; NISTIR 6556, section 3.5.16.7 and 3.5.16.8; the order of the calls was measured on LinuxCNC 2.9.
use crate::{
    call::{Call, Sense, Sink, out::Out},
    codes::spelling::short,
    fault::{Outcome, error, refuse},
    geometry::frame::Point,
    modes::{Cycle, Modes, tapping::Shift},
    state::executor::Settings,
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

/// Q of Fanuc's cycles: a point moved aside by it, whatever its sign.
fn aside(modes: &Modes, settings: &Settings, at: &Point, q: f64) -> Point {
    let [a, b, _] = modes.plane_axes();
    let crate::Aside { second, back } = settings.cycles.aside;
    let mut point = *at;
    point[if second { b } else { a }] += if back { -q.abs() } else { q.abs() };
    point
}

/// Fanuc's G76, from the bottom of the bore on.
pub(crate) fn fine_bore_out<S: Sink>(
    modes: &Modes,
    settings: &Settings,
    bottom: &Point,
    clear: &Point,
    q: f64,
    out: &mut Out<'_, S>,
) {
    hold_spindle(modes, out);
    out.say(&Call::Rapid(aside(modes, settings, bottom, q)));
    out.say(&Call::Rapid(aside(modes, settings, clear, q)));
    out.say(&Call::Rapid(*clear));
    turn_again(modes, out);
}

/// Fanuc's G87: from over the bore to its upper end `end`, beginning at `begin`.
pub(crate) fn bore_upwards<S: Sink>(
    modes: &Modes,
    settings: &Settings,
    over: &Point,
    [begin, end]: [f64; 2],
    (q, dwell): (f64, f64),
    out: &mut Out<'_, S>,
) {
    let [_, _, n] = modes.plane_axes();
    let (mut below, mut above) = (*over, *over);
    (below[n], above[n]) = (begin, end);
    hold_spindle(modes, out);
    out.say(&Call::Rapid(aside(modes, settings, over, q)));
    out.say(&Call::Rapid(aside(modes, settings, &below, q)));
    out.say(&Call::Rapid(below));
    turn_again(modes, out);
    out.say(&Call::Line(above));
    if dwell > 0.0 {
        out.say(&Call::Dwell(dwell));
    }
    fine_bore_out(modes, settings, &above, over, q, out);
}

/// Q, and for G87 the levels, of Fanuc's boring cycles.
pub(crate) fn check_fine_boring(
    words: &Words,
    modes: &Modes,
    cycle: Cycle,
    peck: Option<f64>,
) -> Outcome {
    let code = crate::codes::spelling::written(cycle.code());
    let span = words.place.span;
    if peck.is_none() {
        let text = format!("G{code} needs Q, how far the tool moves aside before it comes out");
        return refuse("I0590", span, text);
    }
    if cycle == Cycle::BoreUpwards && !modes.retract_to_initial {
        let text = "G87 comes out to the initial level and no lower: G99 is in force";
        return Err(error("I0591", span, text).with_help("write G98 in this block").into());
    }
    Ok(())
}

/// R and Z of Fanuc's G87: where it begins to bore, and the upper end.
pub(crate) fn upward_levels(
    words: &Words,
    modes: &Modes,
    r: f64,
    z: f64,
    initial: f64,
) -> Outcome<[f64; 2]> {
    let [begin, end] = if modes.incremental { [initial + r, initial + r + z] } else { [r, z] };
    if end < begin || initial < end {
        let [begin, end, initial] = [begin, end, initial].map(short);
        let text = format!(
            "G87 bores upwards from R to Z, below where it starts: R is {begin}, Z {end}, the start {initial}"
        );
        return refuse("I0519", words.place.span, text);
    }
    Ok([begin, end])
}

/// The spindle stops at angle 0, turning on in its sense.
pub(crate) fn hold_spindle<S: Sink>(modes: &Modes, out: &mut Out<'_, S>) {
    let mode = if modes.spindle.turning == Some(Sense::Clockwise) { 2 } else { 3 };
    out.say(&Call::SpindleStop);
    out.say(&Call::SpindleOrient { angle: 0.0, mode });
}

/// It turns as it did before.
pub(crate) fn turn_again<S: Sink>(modes: &Modes, out: &mut Out<'_, S>) {
    if let Some(sense) = modes.spindle.turning {
        out.say(&Call::SpindleTurn(sense));
    }
}
