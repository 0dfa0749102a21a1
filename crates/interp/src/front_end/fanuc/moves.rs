//! Blocks that tapes of machining centres have by the thousand: lines and arcs, and nothing that
//! changes the meaning of another word; calls of subprograms. They are put in the shared language
//! in fewer steps than all others, with the same outcome.
use crate::{
    call::{Sink, out::Out},
    codes::{AXES, g_code, number::tenths},
    execute,
    fault::Outcome,
    front_end::fanuc::{
        act::group_one,
        mapping::map,
        state::{Callee, Fanuc, Once, Said, Then},
        words::{
            read::{feed, scaled, warn_of_points},
            sense::Sense,
        },
    },
    modes::{FeedMode, Motion},
    state::executor::Executor,
};

/// Whether the block at hand is one of them.
#[inline]
pub(crate) fn only_moves(fanuc: &Fanuc, ex: &Executor) -> bool {
    let motion = matches!(
        ex.modes.motion,
        Motion::Rapid | Motion::Feed | Motion::ArcClockwise | Motion::ArcCounterclockwise
    );
    let only_moves = |said: &Said| match said.letter {
        b'X'..=b'Z' | b'I'..=b'K' | b'R' | b'F' => true,
        b'G' => code(said).is_some(),
        _ => false,
    };
    // an arc without its circle is another matter
    let named = fanuc.said.iter().find_map(|said| code(said).filter(|code| *code <= 30));
    let is_arc = match named {
        Some(code) => matches!(code, 20 | 30),
        None => !matches!(ex.modes.motion, Motion::Rapid | Motion::Feed),
    };
    let has_circle = fanuc.said.iter().any(|said| matches!(said.letter, b'I'..=b'K' | b'R'));
    motion
        && (has_circle || !is_arc)
        && fanuc.kind.is_mill()
        && fanuc.surface.is_none()
        && fanuc.called.is_none()
        && ex.recording.is_none()
        && fanuc.said.iter().all(only_moves)
}

/// Do what it says; whether it moves.
#[inline]
pub(crate) fn move_only<S: Sink>(
    fanuc: &mut Fanuc,
    ex: &mut Executor,
    out: &mut Out<'_, S>,
) -> Outcome<bool> {
    fanuc.once = Once::default();
    let said = core::mem::take(&mut fanuc.said);
    let result = put_move(fanuc, ex, &said);
    fanuc.said = said;
    result?;
    let moves = ex.words.any(AXES);
    if moves {
        fanuc.taken = 0.0;
    }
    execute::execute(ex, out)?;
    group_one(fanuc, &mut ex.modes.motion);
    Ok(moves)
}

/// What a block says that calls a subprogram by its number, or ends one, and does nothing else.
pub(crate) fn only_calls(fanuc: &Fanuc, ex: &Executor) -> Option<Then> {
    let usual = fanuc.kind.is_mill()
        && fanuc.surface.is_none()
        && fanuc.called.is_none()
        && ex.recording.is_none();
    let order = |said: &Said| (said.letter, said.value);
    match fanuc.said.as_slice() {
        [one] if usual && order(one) == (b'M', 99.0) => Some(Then::Return(None)),
        [one, number] if usual && order(one) == (b'M', 98.0) && number.letter == b'P' => {
            let program = number.value;
            let plain = program.fract() == 0.0 && (1.0..10_000.0).contains(&program);
            let program = plain.then_some(program as u32)?;
            let program = Some(program);
            Some(Then::Call(Callee { program, in_file: false, times: 1, start: None }))
        }
        _ => None,
    }
}

#[inline]
fn put_move(fanuc: &mut Fanuc, ex: &mut Executor, said: &[Said]) -> Outcome {
    warn_of_points(fanuc, ex, said);
    let per_revolution = ex.modes.feed_mode == FeedMode::PerRevolution;
    for word in said {
        let value = match word.letter {
            b'G' => continue,
            b'F' => feed(fanuc, word, &Sense { per_revolution, ..Sense::default() }),
            _ => scaled(fanuc, ex, word),
        };
        ex.words.put(word.letter, value, word.span)?;
    }
    for word in said {
        if let Some(code) = code(word).and_then(g_code) {
            ex.words.take_code(code, word.span)?;
        }
    }
    map(fanuc, ex, false)
}

/// A motion, plane or way to count, in tenths.
#[inline]
fn code(said: &Said) -> Option<u16> {
    let code = (said.letter == b'G').then(|| tenths(said.value))??;
    matches!(code, 0 | 10 | 20 | 30 | 170 | 180 | 190 | 900 | 910).then_some(code)
}
