//! The lathe's own: what holds at the beginning, and the cycles of four moves.
//!
//! ```text
//!   G77 (A: G90)  turning        4        G79 (A: G94)  facing: first along Z, then along X
//!                            ┌◄──────● start
//!                          3 ▲       ▼ 1 rapid
//!                            └──◄────┘      G78 (A: G92)  threading: 2 follows the spindle
//!                               2 feed      R (or I): the taper, as a radius, of where 2 begins
//! ```
//!
//! The cycle is modal: a block with X, Z, U or W makes the next pass from the same start.
use super::{Fanuc, words};
use crate::{
    call::{Call, Sink},
    codes::GGroup,
    execute::{After, Executor},
    fault::{Outcome, refuse},
    frame::Point,
    state::{FeedMode, Motion},
    threads::along_path,
};
use canon::Plane;

/// Deeper than any hole: a peck of all of it.
const WHOLE: f64 = 1e6;

/// Whether the block makes holes.
pub(super) fn drills(ex: &Executor) -> bool {
    let code = ex.words.g(GGroup::Motion);
    let motion = code.map_or(ex.state.motion, Motion::from_code);
    matches!(motion, Motion::Cycle(_)) && ex.words.any(crate::codes::AXES)
}

impl Fanuc {
    /// What holds before the first block.
    pub(crate) fn begin<S: Sink>(&self, ex: &mut Executor, sink: &mut S) {
        ex.state.retract_to_initial = true;
        ex.state.motion = Motion::Rapid;
        if !self.is_lathe() {
            return;
        }
        ex.state.plane = Plane::ZX;
        ex.state.diameter = true;
        ex.state.feed_mode = FeedMode::PerRevolution;
        ex.say(sink, &Call::SelectPlane(Plane::ZX));
        ex.say(sink, &Call::FeedMode { per_revolution: true });
    }

    /// G83, G84, G85: a hole along Z, whatever plane is in force. R counts from the initial level, W from R.
    pub(super) fn drill<S: Sink>(&self, ex: &mut Executor, sink: &mut S) -> Outcome<After> {
        let initial = ex.state.initial.unwrap_or(ex.state.at[2]);
        if !ex.state.incremental {
            let span = ex.words.span(b'R');
            let level = ex.words.take(b'R').map(|r| initial + r);
            let level = level.or(ex.state.sticky.map(|kept| kept.r)).unwrap_or(initial);
            ex.words.put(b'R', level, span)?;
            if self.once.by_w {
                let depth = ex.words.take(b'Z').unwrap_or(0.0) - ex.state.at[2];
                ex.words.put(b'Z', level + depth, span)?;
            }
        }
        let code = ex.words.g(GGroup::Motion);
        let motion = code.map_or(ex.state.motion, Motion::from_code);
        let pecks = motion == Motion::Cycle(crate::state::Cycle::Peck);
        if pecks && ex.words.get(b'Q').is_none() && ex.state.sticky.is_none() {
            ex.words.put(b'Q', WHOLE, ex.words.place.span)?; // in one go
        }
        let plane = core::mem::replace(&mut ex.state.plane, Plane::XY);
        let after = ex.execute(sink);
        ex.state.plane = plane;
        after
    }

    /// A block of a cycle in force: its other words first, then the four moves.
    pub(super) fn lathe_move<S: Sink>(
        &mut self,
        ex: &mut Executor,
        code: u16,
        sink: &mut S,
    ) -> Outcome<After> {
        let start = ex.state.at;
        if let Some(code) = ex.words.g(GGroup::Distance) {
            ex.set_distances(code == 910, ex.state.absolute_centres, sink);
        }
        let mut corner = ex.destination(false)?;
        let span = ex.words.place.span;
        let kept = self.corner;
        for (letter, axis) in [(b'X', 0), (b'Z', 2)] {
            if let Some((before, _)) = kept.filter(|_| ex.words.get(letter).is_none()) {
                corner[axis] = before[axis];
            }
        }
        // older controls call the taper I, of facing K
        let older = if code == 790 { b'K' } else { b'I' };
        let taper = ex.words.take(b'R').or_else(|| ex.words.take(older));
        let taper = taper.unwrap_or(kept.map_or(0.0, |(_, taper)| taper));
        self.corner = Some((corner, taper));
        if let Some(stray) = b"YABCV".iter().find(|letter| ex.words.get(**letter).is_some()) {
            let text = format!("{} has no effect: the cycle moves X and Z", *stray as char);
            return refuse("I0112", ex.words.span(*stray), text);
        }
        for letter in *b"XZ" {
            ex.words.take(letter);
        }
        ex.state.motion = Motion::None;
        let after = ex.execute(sink)?;
        if code == 780 {
            let Some(lead) = self.lead.filter(|lead| *lead > 0.0) else {
                return Err(words::no_lead(span).into());
            };
            if ex.state.spindle.turning.is_none() {
                return refuse(
                    "I0427",
                    span,
                    "a thread needs a turning spindle: write M3 or M4, and S, before it",
                );
            }
            let [first, second, third] = path(&start, &corner, taper, 0);
            ex.say(sink, &Call::Rapid(first));
            ex.say(sink, &Call::SyncStart(along_path(lead, &first, &second)));
            ex.say(sink, &Call::Line(second));
            ex.say(sink, &Call::SyncStop);
            ex.say(sink, &Call::Rapid(third));
        } else {
            ex.say_feed("the cycle", || 0.0, &mut crate::call::Silence)?;
            let [first, second, third] =
                path(&start, &corner, taper, if code == 770 { 0 } else { 2 });
            ex.say(sink, &Call::Rapid(first));
            ex.say(sink, &Call::Line(second));
            ex.say(sink, &Call::Line(third));
        }
        ex.say(sink, &Call::Rapid(start));
        Ok(after)
    }
}

/// The corners of the way, the first of them reached along `axis` (0 is X, 2 is Z); the fourth is the start.
fn path(start: &Point, corner: &Point, taper: f64, axis: usize) -> [Point; 3] {
    let mut first = *start;
    first[axis] = corner[axis] + taper;
    let mut third = *start;
    third[2 - axis] = corner[2 - axis];
    [first, *corner, third]
}
