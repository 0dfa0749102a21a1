//! How things stand at the end of a stretch that was executed before, without executing it again.
//!
//! ```text
//!   then   s₀ ───── executed ─────► s₁          what it has asked for and set is noted
//!   now    t₀ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ► t₁          t₀ differs from s₀ in nothing that was asked for:
//!                                               t₁ is s₁, but for what differs and was not set
//! ```
//!
//! An axis that was named with G90 stands at t₁ where it stands at s₁; one that was only moved on with G91, as much
//! farther as at t₀ (but for the rounding of sums).
use crate::{
    Interpreter, Snapshot,
    asked::{Asked, of_name, of_number},
    names::{ARGUMENTS, Store},
    state::{FeedMode, Motion, State},
};
use std::collections::HashMap;

/// Named parameters.
type Names = HashMap<Box<str>, f64>;

impl Snapshot {
    /// How things stand at the end of a stretch that was executed from `before` to `after`, when it begins as things
    /// stand here; `None` if it has asked for what is different here. What was found is left out.
    #[must_use]
    pub fn carried(&self, before: &Self, after: &Self) -> Option<Self> {
        let asked = &after.executor.asked;
        if !asked.is_all_noted() || !self.is_at(before) {
            return None;
        }
        let (own, then) = (&self.executor, &before.executor);
        let state = own.state.carried(&then.state, &after.executor.state, asked)?;
        let store = own.store.carried(&then.store, &after.executor.store, asked)?;
        let fanuc = match (&self.fanuc, &before.fanuc, &after.fanuc) {
            (Some(own), Some(then), Some(after)) => {
                Some(Box::new(own.carried(then, after, asked)?))
            }
            (None, None, None) => None,
            _ => return None,
        };
        let mut new = after.clone().without_findings();
        (new.executor.store, new.executor.state, new.fanuc) = (store, state, fanuc);
        new.recount(self.executed().cast_signed() - before.executed().cast_signed());
        Some(new)
    }

    /// Whether this one's stretch may have looked for one of these blocks of its tape.
    pub fn jumps_to(&self, numbers: &[u32]) -> bool {
        self.executor.asked.jumps_to(numbers)
    }

    /// What this one's stretch and the one before it have asked for, as one.
    pub fn join(&mut self, before: &Self) {
        self.executor.asked.join(&before.executor.asked);
    }

    /// Whether the same block comes next, and what follows depends on nothing but state and parameters.
    fn is_at(&self, other: &Self) -> bool {
        let (own, then) = (&self.executor, &other.executor);
        self.positions == other.positions
            && (self.file, self.choosing, self.ended) == (other.file, other.choosing, other.ended)
            && (self.begun, self.percent) == (other.begun, other.percent)
            && self.frames == other.frames
            && self.repeats == other.repeats
            && own.recording.is_none()
            && then.recording.is_none()
            && (own.compensating, &own.contexts) == (then.compensating, &then.contexts)
            && own.tool_table == then.tool_table
            && own.tools == then.tools
    }
}

impl Interpreter<'_> {
    /// Whether how things stand here may be [carried](Snapshot::carried) over that stretch: a look that costs less than
    /// a snapshot.
    pub fn may_be_carried(&self, before: &Snapshot, after: &Snapshot) -> bool {
        let asked = &after.executor.asked;
        let (own, then) = (&self.executor, &before.executor);
        let front_end = match (&self.fanuc, &before.fanuc) {
            (Some(own), Some(then)) => own.maps_as(then),
            (own, then) => own.is_none() && then.is_none(),
        };
        asked.is_all_noted()
            && front_end
            && self.is_called_as(before)
            && own.compensating == then.compensating
            && own.state.carried(&then.state, &after.executor.state, asked).is_some()
    }
}

/// Fields of a state that differ, as they are there.
macro_rules! lend {
    ($own:ident, $before:ident, $to:ident, $($field:ident)+) => {
        $(if $own.$field != $before.$field {
            $to.$field = $own.$field;
        })+
    };
}

impl State {
    fn carried(&self, before: &Self, after: &Self, asked: &Asked) -> Option<Self> {
        let mut then = self.lend(before, before.clone());
        (then.at, then.line, then.motion) = (self.at, self.line, self.motion);
        if then != *self || !self.is_unasked(before, asked) {
            return None;
        }
        if self.doubts.changes_what_is_done() {
            return None; // what is followed after a refusal asks for anything
        }
        let mut new = self.lend(before, after.clone());
        if !asked.motion && self.motion != before.motion {
            new.motion = self.motion;
        }
        if asked.moves {
            new.initial = after.initial; // what moves ends the series
        }
        for axis in (0..9).filter(|axis| self.at[*axis] != before.at[*axis]) {
            if asked.asks_place(axis) {
                return None;
            }
            if !asked.names(axis) {
                new.at[axis] += self.at[axis] - before.at[axis];
            }
        }
        let [_, _, n] = new.plane_axes();
        if asked.holes && (self.level() != before.level() || self.at[n] != before.at[n]) {
            if asked.moves {
                return None;
            }
            let (r, initial) = (after.sticky?.r, self.initial?);
            new.at[n] = if self.retract_to_initial { initial.max(r) } else { r };
        }
        Some(new)
    }

    /// Whether nothing was asked for that is different, axes apart.
    fn is_unasked(&self, before: &Self, asked: &Asked) -> bool {
        let turns = |it: &Self| {
            let pockets = (it.current_pocket, it.selected_pocket);
            (it.spindle, it.loaded, it.current_tool, it.selected_tool, pockets)
        };
        let levels = asked.initial || asked.retract || asked.holes && asked.moves;
        (!asked.plane || self.plane == before.plane)
            && (!asked.units || self.units == before.units)
            && (!asked.spindle || turns(self) == turns(before))
            && (!levels || self.level() == before.level())
            && self.feeds_as(before, asked)
    }

    /// Between which levels holes are made.
    const fn level(&self) -> (Option<f64>, bool) {
        (self.initial, self.retract_to_initial)
    }

    /// Whether lines are fed as they were, or fast: where there is an F, they come to the same places.
    fn feeds_as(&self, before: &Self, asked: &Asked) -> bool {
        let lines = |it: &Self| matches!(it.motion, Motion::Rapid | Motion::Feed);
        let other = self.motion != before.motion;
        if other && !(lines(self) && lines(before)) {
            return false;
        }
        if !other && self.feed == before.feed {
            return true;
        }
        // F0 would be a fault of those that are fed
        self.feed > 0.0 && before.feed > 0.0 && !asked.feed && self.feed_mode == FeedMode::PerMinute
    }

    /// Another state with what is different here from what was before.
    fn lend(&self, before: &Self, mut to: Self) -> Self {
        lend!(self, before, to, frame system units plane feed spindle corners merge mist flood);
        lend!(self, before, to, feed_override speed_override adaptive_feed feed_hold loaded);
        lend!(self, before, to, current_tool selected_tool current_pocket selected_pocket);
        lend!(self, before, to, initial retract_to_initial);
        to
    }
}

impl Store {
    fn carried(&self, before: &Self, after: &Self, asked: &Asked) -> Option<Self> {
        if self.saved.len() != before.saved.len() || self.local.len() != before.local.len() {
            return None;
        }
        let mut new = after.clone();
        let called = !self.saved.is_empty();
        if called && self.saved[1..] != before.saved[1..] {
            return None;
        }
        for number in self.numbered.differing(&before.numbered) {
            if asked.touches(of_number(number)) || called && number <= ARGUMENTS {
                return None;
            }
            if number > ARGUMENTS {
                new.numbered.set(number, self.numbered.at(number));
            }
        }
        // those of the main program come back when its calls are over
        for number in 1..=ARGUMENTS {
            let value = self.of_main(number);
            if value == before.of_main(number) {
                continue;
            }
            if asked.touches(of_number(number)) {
                return None;
            }
            match new.saved.first_mut() {
                Some(saved) => saved[number - 1] = value,
                None => _ = new.numbered.set(number, value),
            }
        }
        for i in 0..=self.local.len() {
            let (own, then) = (self.scope(i)?, before.scope(i)?);
            if own == then {
                continue;
            }
            // of a subprogram: it may be over
            if i > 1 && asked.calls {
                return None;
            }
            let new = if i == 0 { &mut new.global } else { new.local.get_mut(i - 1)? };
            lend_names(own, then, new, asked)?;
        }
        Some(new)
    }

    /// Names of all levels, and those of each.
    fn scope(&self, i: usize) -> Option<&Names> {
        if i == 0 { Some(&self.global) } else { self.local.get(i - 1) }
    }
}

/// Named parameters that differ, as they are there; none if one was asked for.
fn lend_names(own: &Names, then: &Names, new: &mut Names, asked: &Asked) -> Option<()> {
    for name in own.keys().chain(then.keys()) {
        if own.get(name) == then.get(name) {
            continue;
        }
        if asked.touches(of_name(name)) {
            return None;
        }
        match own.get(name) {
            Some(value) => _ = new.insert(name.clone(), *value),
            None => _ = new.remove(name),
        }
    }
    Some(())
}
