//! Blocks that tapes of machining centres have by the thousand: lines and arcs, and nothing that changes the meaning
//! of another word; calls of subprograms. They are put in the shared language in fewer steps than all others, with the
//! same outcome.
use crate::{
    call::{Sink, out::Out},
    codes::{AXES, g_code, number::tenths},
    execute,
    fault::Outcome,
    front_end::fanuc::{
        state::{Callee, Fanuc, Once, Said, Then},
        words::sense::Sense,
    },
    modes::{FeedMode, Motion},
    state::executor::Executor,
};

impl Fanuc {
    /// Whether the block at hand is one of them.
    pub(crate) fn only_moves(&self, ex: &Executor) -> bool {
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
        let named = self.said.iter().find_map(|said| code(said).filter(|code| *code <= 30));
        let is_arc = match named {
            Some(code) => matches!(code, 20 | 30),
            None => !matches!(ex.modes.motion, Motion::Rapid | Motion::Feed),
        };
        let has_circle = self.said.iter().any(|said| matches!(said.letter, b'I'..=b'K' | b'R'));
        motion
            && (has_circle || !is_arc)
            && self.kind.is_mill()
            && self.surface.is_none()
            && self.called.is_none()
            && ex.recording.is_none()
            && self.said.iter().all(only_moves)
    }

    /// Do what it says; whether it moves.
    pub(crate) fn move_only<S: Sink>(
        &mut self,
        ex: &mut Executor,
        out: &mut Out<'_, S>,
    ) -> Outcome<bool> {
        self.once = Once::default();
        let said = core::mem::take(&mut self.said);
        let result = self.put_move(ex, &said);
        self.said = said;
        result?;
        let moves = ex.words.any(AXES);
        if moves {
            self.taken = 0.0;
        }
        execute::execute(ex, out)?;
        self.group_one(&mut ex.modes.motion);
        Ok(moves)
    }

    /// What a block says that calls a subprogram by its number, or ends one, and does nothing else.
    pub(crate) fn only_calls(&self, ex: &Executor) -> Option<Then> {
        let usual = self.kind.is_mill()
            && self.surface.is_none()
            && self.called.is_none()
            && ex.recording.is_none();
        let order = |said: &Said| (said.letter, said.value);
        match self.said.as_slice() {
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

    fn put_move(&mut self, ex: &mut Executor, said: &[Said]) -> Outcome {
        self.warn_of_points(ex, said);
        let per_revolution = ex.modes.feed_mode == FeedMode::PerRevolution;
        for word in said {
            let value = match word.letter {
                b'G' => continue,
                b'F' => self.feed(word, &Sense { per_revolution, ..Sense::default() }),
                _ => self.scaled(ex, word),
            };
            ex.words.put(word.letter, value, word.span)?;
        }
        for word in said {
            if let Some(code) = code(word).and_then(g_code) {
                ex.words.take_code(code, word.span)?;
            }
        }
        self.map(ex, false)
    }
}

/// A motion, plane or way to count, in tenths.
fn code(said: &Said) -> Option<u16> {
    let code = (said.letter == b'G').then(|| tenths(said.value))??;
    matches!(code, 0 | 10 | 20 | 30 | 170 | 180 | 190 | 900 | 910).then_some(code)
}
