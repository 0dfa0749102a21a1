//! A block of words: put in the shared language, then done, or taken down where a profile is.
use crate::{
    call::{Sink, out::Out},
    cycles::record,
    execute::After,
    fault::{Outcome, refuse},
    front_end::fanuc::{
        act::move_block,
        corner::cornered,
        state::{Fanuc, Once, Then},
        words::translate,
    },
    program::Program,
};

/// Do what the words say.
pub(crate) fn obey<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    out: &mut Out<'_, S>,
) -> Outcome<(Then, After)> {
    fanuc.once = Once::default();
    let then = translate(fanuc, &mut it.executor)?;
    if fanuc.called.is_some() && !matches!(then, Then::Call(_)) {
        let text = "a program's name goes with M98, G65 or G66: M98<NAME>";
        return refuse("I1049", it.block.span, text);
    }
    let moves = it.executor.words.any(crate::codes::AXES);
    if fanuc.once.corner.is_none() && moves {
        fanuc.taken = 0.0;
    }
    let after = match fanuc.once.corner {
        Some(corner) => cornered(fanuc, it, corner, out)?,
        None if it.executor.recording.is_some() => {
            record::record(&mut it.executor, out)?;
            if let (Some(arc), Some(recording)) =
                (fanuc.once.straight, it.executor.recording.as_mut())
            {
                recording.go_on_with(arc);
            }
            return Ok((Then::Next, After::Next));
        }
        None => move_block(fanuc, &mut it.executor, moves, out)?,
    };
    Ok((if moves && then == Then::Next { Then::Moved } else { then }, after))
}
