//! G45 to G48: ways that a tool offset makes longer or shorter.
//!
//! ```text
//!   G45  way + D        G46  way − D        G47  way + 2·D        G48  way − 2·D
//! ```
//!
//! D is the radius of that offset, in the direction in which the axis goes; what is longer than the
//! way turns it round. It counts for each axis that the block names, and for I, J and K of a
//! quarter or three quarters of a circle. An increment of 0 is a way too: X0 goes along +X, X-0
//! along −X.
//!
//! Source: Fanuc, operator's manual of series 30i for machining centres, "Tool offset (G45 – G48)".
use crate::{
    codes::{GGroup, number::near_whole},
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        offsets::tool_offsets::{Part, ToolVariable, tool_value},
        state::{Fanuc, Said},
        words::sense::Sense,
    },
    modes::Motion,
    state::executor::Executor,
};

/// Lengthen the ways of the block's words.
pub(crate) fn lengthen(fanuc: &Fanuc, ex: &mut Executor, said: &[Said], sense: &Sense) -> Outcome {
    let span = ex.words.place.span;
    if ex.modes.compensating()
        || fanuc.mapping.changes()
        || fanuc.mapping.polar.is_some()
        || sense.cycle
    {
        let text = "G45 to G48 cannot be used in a cycle, nor while G16, G41, G42, G51, G51.1 or G68 is in force";
        let help = "write G80, G15, G40, G50, G50.1 or G69 before it";
        return Err(error("I1058", span, text).with_help(help).into());
    }
    let code = ex.words.g(GGroup::Motion);
    let motion = code.map_or(ex.modes.motion, Motion::from_code);
    let arc = matches!(motion, Motion::ArcClockwise | Motion::ArcCounterclockwise);
    if arc && ex.words.get(b'R').is_some() {
        let text = "G45 to G48 lengthen an arc by I, J and K: R cannot be used with them";
        return refuse("I1058", span, text);
    }
    let (radius, height) = (ex.words.take(b'D'), ex.words.take(b'H'));
    let number = match (radius, height) {
        (None, Some(number)) => number,
        _ => fanuc.kept.last(b'D'),
    };
    let Some(tool) = near_whole(number).and_then(|n| u32::try_from(n).ok()) else {
        let text = format!("expected the number of an offset after D, found {number}");
        return refuse("I1058", span, text);
    };
    let offset = match tool {
        0 => 0.0,
        _ => {
            tool_value(fanuc, ex, ToolVariable { tool, part: Part::Radius, wear: false })
                + tool_value(fanuc, ex, ToolVariable { tool, part: Part::Radius, wear: true })
        }
    };
    let by = f64::from(fanuc.once.longer) * offset;
    let distance = ex.words.g(GGroup::Distance);
    let incremental = distance.map_or(ex.modes.incremental, |code| code == 910);
    for axis in 0..3 {
        let letter = b"XYZ"[axis];
        let Some(word) = ex.words.get(letter) else { continue };
        let way = if incremental { word } else { word - ex.modes.at[axis] };
        let negative = said.iter().any(|s| s.letter == letter && s.value.is_sign_negative());
        let sense = match way {
            0.0 if !incremental => 0.0,
            0.0 if negative => -1.0,
            0.0 => 1.0,
            way => way.signum(),
        };
        put(ex, letter, word + sense * by)?;
    }
    for letter in *b"IJK" {
        let centre = ex.words.get(letter).filter(|centre| arc && *centre != 0.0);
        if let Some(centre) = centre {
            put(ex, letter, centre + centre.signum() * by)?;
        }
    }
    Ok(())
}

fn put(ex: &mut Executor, letter: u8, value: f64) -> Outcome {
    let span = ex.words.span(letter);
    ex.words.take(letter);
    ex.words.put(letter, value, span)
}
