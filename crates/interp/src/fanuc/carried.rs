//! What this front end asks for of how things stood before a stretch of blocks, and how it stands behind one that
//! is not executed again: see [`asked`](crate::asked) and [`carry`](crate::Snapshot::carried).
use super::{Fanuc, Kind, Tape, figure, words::Said};
use crate::{
    Interpreter, Shift,
    asked::{Asked, of_number},
    execute::Executor,
    state::Motion,
    words::tenths,
};

impl Fanuc {
    pub(crate) fn set_tape(&mut self, tape: Option<Tape>) {
        self.tape = tape;
    }

    pub(crate) const fn take_tape(&mut self) -> Option<Tape> {
        self.tape.take()
    }

    /// The same, which will read its tape again when it is needed.
    pub(crate) fn without_tape(&mut self) -> Self {
        let tape = self.tape.take();
        let mut copy = self.clone();
        copy.said.clear(); // the last block's
        copy.inch = false;
        self.tape = tape;
        copy
    }

    /// Where its calls and its profile go back to, in the edited text; none if that is no more.
    pub(crate) fn shift(&mut self, shift: &Shift) -> Option<()> {
        if let Some(shape) = self.shape.as_mut() {
            shape.cycle = shift.byte(shape.cycle)?;
            shape.back = shape.back.map_or(Some(None), |back| shift.at(back).map(Some))?;
        }
        self.levels.iter_mut().try_for_each(|level| level.shift(shift))
    }

    /// Whether it was called from where that one was.
    pub(crate) fn is_called_as(&self, other: &Self) -> bool {
        self.levels == other.levels
    }

    /// Whether places mean the same.
    pub(crate) fn maps_as(&self, other: &Self) -> bool {
        self.mapping == other.mapping && self.surface == other.surface
    }

    /// What the block at hand will ask for, as far as this front end knows.
    pub(super) fn ask(&self, it: &mut Interpreter<'_>) {
        if !it.executor.words.heard {
            return;
        }
        if !self.is_plain(&it.executor) {
            it.executor.asked.more();
        }
        it.executor.asked.units |= self.counts_increments(&it.block);
    }

    /// Whether the block at hand is one that machining centres have by the thousand.
    fn is_plain(&self, ex: &Executor) -> bool {
        let plain = |said: &Said| match said.letter {
            b'G' => matches!(
                tenths(said.value),
                Some(0..=30 | 170..=190 | 730 | 800..=830 | 850 | 890..=910 | 980 | 990)
            ),
            b'M' => matches!(said.value, 98.0 | 99.0),
            b'F' | b'I'..=b'L' | b'P'..=b'R' | b'U'..=b'Z' => true,
            _ => false,
        };
        self.kind == Kind::Mill
            && self.called.is_none()
            && self.mapping == figure::Mapping::default()
            && self.surface.is_none()
            && self.modals.is_empty()
            && self.lathe_cycle.is_none()
            && self.taken == 0.0
            && ex.state.motion != Motion::Thread
            && self.said.iter().all(plain)
    }

    /// This front end behind the stretch from `before` to `after`, if that asked for nothing that is different here.
    pub(crate) fn carried(&self, before: &Self, after: &Self, asked: &Asked) -> Option<Self> {
        let mut new = after.clone();
        let mut then = before.clone();
        let both = self.variables.all().zip(before.variables.all());
        for ((number, value), _) in both.filter(|(own, then)| own != then) {
            if asked.touches(of_number(number)) {
                return None;
            }
            *new.variables.slot(number)? = value;
        }
        then.variables.clone_from(&self.variables);
        let line = |motion: Motion| matches!(motion, Motion::Rapid | Motion::Feed);
        if self.before_cycle != before.before_cycle {
            // G80 goes back to it
            if asked.cycle || !line(self.before_cycle) || !line(before.before_cycle) {
                return None;
            }
            then.before_cycle = self.before_cycle;
            if !asked.motion {
                new.before_cycle = self.before_cycle;
            }
        }
        new.kept.carry(&self.kept, &before.kept, asked);
        then.kept.words = self.kept.words;
        (new.length_mode, then.length_mode) = (self.length_mode, self.length_mode);
        (new.by, then.by) = (self.by, self.by);
        // what is found is not carried
        (new.warned_of_point, then.warned_of_point) = (self.warned_of_point, self.warned_of_point);
        (then == *self).then_some(new)
    }
}
