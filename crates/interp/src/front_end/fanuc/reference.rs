//! Reference points: G27, which asks whether the axes stand at the first one, and G29, the way back
//! from there.
//!
//! G27 is a rapid move. What counts is where the axes stand then, with all offsets: as on the
//! machine, offsets are cancelled before it, or the words allow for them.
//!
//! Source: Fanuc, operator's manual of series 30i, "Reference position".
use crate::{
    call::{Call, Sink, out::Out},
    coordinates::target,
    execute::{self, After},
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        state::{Fanuc, Said},
        words::read::per_unit,
    },
    modes::Motion,
    state::executor::Executor,
};

/// First parameter of the reference point.
const REFERENCE: usize = 5161;
/// The letters of the axes.
const AXES: [u8; 9] = *b"XYZABCUVW";

/// The axes that the block names.
pub(crate) fn named(ex: &Executor) -> [bool; 9] {
    AXES.map(|letter| ex.words.get(letter).is_some())
}

/// After the move of G27.
pub(crate) fn at_reference(fanuc: &Fanuc, ex: &Executor, named: [bool; 9]) -> Outcome {
    let span = ex.words.place.span;
    if named.iter().all(|named| !named) {
        let text = "G27 needs axis words: the reference point as this program calls it";
        return refuse("I1055", span, text);
    }
    let here = ex.modes.frame.to_machine(&ex.modes.place());
    let mut reference = ex.store.numbered.point(REFERENCE);
    crate::geometry::frame::scale(&mut reference, 1.0 / ex.modes.units.in_mm());
    let near = 0.5 / per_unit(fanuc, b'X', fanuc.inch);
    let beside = |i: &usize| named[*i] && (here[*i] - reference[*i]).abs() > near;
    let written = |point: &crate::Point| {
        let word = |i| {
            let value = crate::codes::spelling::short(fanuc.shown(i, point[i]));
            format!("{}{value}", AXES[i] as char)
        };
        (0..9).filter(beside).map(word).collect::<Vec<_>>().join(" ")
    };
    if !(0..9).any(|i| beside(&i)) {
        return Ok(());
    }
    let mut by_axis = here;
    for i in (0..9).filter(beside) {
        by_axis[i] = reference[i];
    }
    let text = format!(
        "G27 leads to {} of the machine, the reference point is at {}",
        written(&here),
        written(&reference)
    );
    let right = ex.modes.frame.to_program(&by_axis);
    let help = format!(
        "with the offsets in force that is {} here; G28 goes there by itself",
        written(&right)
    );
    Err(error("I1055", span, text).with_help(help).into())
}

/// G29: by the point where G28 came by, to where the words lead.
pub(crate) fn back_from_reference<S: Sink>(
    fanuc: &Fanuc,
    ex: &mut Executor,
    out: &mut Out<'_, S>,
) -> Outcome<After> {
    let Some(by) = fanuc.by else {
        let text = "G29 comes back from the reference point: no G28 or G30 went there before";
        return refuse("I1053", ex.words.place.span, text);
    };
    let by = ex.modes.frame.to_program(&by);
    let mut corner = ex.modes.at;
    for axis in 0..9 {
        if ex.words.get(b"XYZABCUVW"[axis]).is_some() {
            corner[axis] = by[axis];
        }
    }
    ex.modes.at = corner;
    out.say(&Call::Rapid(corner));
    let (motion, to) = (ex.modes.motion, target::destination(&ex.words, &ex.modes, false)?);
    for letter in *b"XYZABCUVW" {
        ex.words.take(letter);
    }
    ex.modes.motion = Motion::None;
    let after = execute::execute(ex, out)?;
    ex.modes.at = to;
    ex.modes.motion = motion;
    out.say(&Call::Rapid(to));
    Ok(after)
}

/// P of G30: there is a second reference point.
pub(crate) fn second(word: &Said) -> Outcome {
    if word.value == 2.0 {
        return Ok(());
    }
    let text = format!(
        "G30 P{} is not known: the machine has G28's reference point and G30 P2's",
        word.value
    );
    refuse("I1052", word.span, text)
}
