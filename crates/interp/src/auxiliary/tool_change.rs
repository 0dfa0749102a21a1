//! Non-stop tool change: the word G100 of Brother's controls, tool, spindle and way in one block.
//!
//! ```text
//!   G100 T2 X10 Y10 G43 Z30 H2 S3000 M3 L5      the tool comes (T2), S and M3, X and Y, then Z with its length;
//!        │                             └ next tool to be called, for the change after this one
//!        └ from here on the block is T2 M6, S3000 M3, G43 H2, G0 X10 Y10, G0 Z30
//! ```
//!
//! Source: the word lists of posts for these controls (Autodesk's for CNC-A00, -B00 and -C00),
//! where they agree. D is the cutter offset of a G41 that follows, here always that of the tool
//! itself.
use crate::{
    call::{Call, Sink, out::Out},
    codes::{AXES, GGroup, MGroup, NON_STOP_CHANGE},
    compensation,
    coordinates::target,
    fault::{Outcome, error, refuse},
    modes::{Modes, Motion},
    state::tools::Tools,
    words::Words,
};

/// G100: the block's words as those of M6.
pub(crate) fn non_stop_change(words: &mut Words, modes: &Modes) -> Outcome {
    if words.g(GGroup::NonModal) != Some(NON_STOP_CHANGE) {
        return Ok(());
    }
    let span = words.place.span;
    if words.get(b'T').is_none() {
        let text = "G100 needs T, the tool to change to";
        return Err(error("I0595", span, text).with_help("write G100 T2 X… Y… G43 Z… H2").into());
    }
    if words.g(GGroup::Motion).is_some() || words.m(MGroup::Tool).is_some() {
        let text = "G100 changes the tool and moves by itself: no M6 and no motion beside it";
        return refuse("I0596", span, text);
    }
    if modes.compensating() {
        return compensation::no_compensation(words);
    }
    words.put_m(MGroup::Tool, 60);
    Ok(())
}

/// The move of G100, after tool, spindle and length are in force: X and Y first, then Z.
pub(crate) fn non_stop_move<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    tools: &Tools,
    out: &mut Out<'_, S>,
) -> Outcome {
    if matches!(modes.motion, Motion::Cycle(_)) {
        (modes.motion, modes.sticky) = (Motion::None, None);
    }
    if let Some(next) = words.whole(b'L', 9999)? {
        modes.selected_tool = next;
        modes.selected_pocket = Some(tools.pocket(next));
        out.say(&Call::SelectTool(next));
    }
    if !words.any(AXES) {
        return Ok(());
    }
    let to = target::destination(words, modes, false)?;
    let [_, _, n] = modes.plane_axes();
    let mut over = to;
    over[n] = modes.at[n];
    out.say(&Call::Rapid(over));
    out.say(&Call::Rapid(to));
    modes.at = to;
    Ok(())
}
