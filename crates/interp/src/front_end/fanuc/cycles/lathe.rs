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
use crate::{
    call::{Call, Sink, out::Out},
    codes::GGroup,
    coordinates::{distances, target},
    execute::{self, After},
    fault::{Outcome, refuse},
    front_end::fanuc::{state::Fanuc, words},
    geometry::frame::Point,
    modes::{FeedMode, Motion},
    motion::{self, threads::along_path},
    state::executor::Executor,
};
use canon::Plane;

/// Deeper than any hole: a peck of all of it.
const WHOLE: f64 = 1e6;

/// Whether the block makes holes.
pub(crate) fn drills(ex: &Executor) -> bool {
    let code = ex.words.g(GGroup::Motion);
    let motion = code.map_or(ex.modes.motion, Motion::from_code);
    matches!(motion, Motion::Cycle(_)) && ex.words.any(crate::codes::AXES)
}

/// What holds before the first block.
pub(crate) fn begin<S: Sink>(fanuc: &Fanuc, ex: &mut Executor, out: &mut Out<'_, S>) {
    ex.modes.retract_to_initial = true;
    ex.modes.motion = Motion::Rapid;
    if !fanuc.is_lathe() {
        return;
    }
    ex.modes.plane = Plane::ZX;
    ex.modes.diameter = true;
    ex.modes.feed_mode = FeedMode::PerRevolution;
    out.say(&Call::SelectPlane(Plane::ZX));
    out.say(&Call::FeedMode { per_revolution: true });
}

/// G83, G84, G85: a hole along Z, whatever plane is in force. R counts from the initial level, W
/// from R.
pub(crate) fn drill<S: Sink>(
    fanuc: &Fanuc,
    ex: &mut Executor,
    out: &mut Out<'_, S>,
) -> Outcome<After> {
    let initial = ex.modes.initial.unwrap_or(ex.modes.at[2]);
    if fanuc.kind.variant().levels_are_places {
        level_is_a_place(ex, initial)?;
    } else if !ex.modes.incremental {
        let span = ex.words.span(b'R');
        let level = ex.words.take(b'R').map(|r| initial + r);
        let level = level.or(ex.modes.sticky.map(|kept| kept.r)).unwrap_or(initial);
        ex.words.put(b'R', level, span)?;
        if fanuc.once.by_w {
            let depth = ex.words.take(b'Z').unwrap_or(0.0) - ex.modes.at[2];
            ex.words.put(b'Z', level + depth, span)?;
        }
    }
    let code = ex.words.g(GGroup::Motion);
    let motion = code.map_or(ex.modes.motion, Motion::from_code);
    let pecks = motion == Motion::Cycle(crate::modes::Cycle::Peck);
    if pecks && ex.words.get(b'Q').is_none() && ex.modes.sticky.is_none() {
        ex.words.put(b'Q', WHOLE, ex.words.place.span)?; // in one go
    }
    let plane = core::mem::replace(&mut ex.modes.plane, Plane::XY);
    let after = execute::execute(ex, out);
    ex.modes.plane = plane;
    after
}

/// R of Haas' lathes: a place along Z, or where the tool stands.
fn level_is_a_place(ex: &mut Executor, initial: f64) -> Outcome {
    if ex.words.get(b'R').is_some() || ex.modes.incremental {
        return Ok(());
    }
    let level = ex.modes.sticky.map_or(initial, |kept| kept.r);
    ex.words.put(b'R', level, ex.words.place.span)
}

/// A block of a cycle in force: its other words first, then the four moves.
pub(crate) fn lathe_move<S: Sink>(
    fanuc: &mut Fanuc,
    ex: &mut Executor,
    code: u16,
    out: &mut Out<'_, S>,
) -> Outcome<After> {
    let start = ex.modes.at;
    if let Some(code) = ex.words.g(GGroup::Distance) {
        let absolute_centres = ex.modes.absolute_centres;
        distances::set_distances(&mut ex.modes, code == 910, absolute_centres, out);
    }
    let mut corner = target::destination(&ex.words, &ex.modes, false)?;
    let span = ex.words.place.span;
    let kept = fanuc.corner;
    for (letter, axis) in [(b'X', 0), (b'Z', 2)] {
        if let Some((before, _)) = kept.filter(|_| ex.words.get(letter).is_none()) {
            corner[axis] = before[axis];
        }
    }
    // older controls call the taper I, of facing K
    let older = if code == 790 { b'K' } else { b'I' };
    let taper = ex.words.take(b'R').or_else(|| ex.words.take(older));
    let taper = taper.unwrap_or(kept.map_or(0.0, |(_, taper)| taper));
    fanuc.corner = Some((corner, taper));
    if let Some(stray) = b"YABCV".iter().find(|letter| ex.words.get(**letter).is_some()) {
        let text = format!("{} has no effect: the cycle moves X and Z", *stray as char);
        return refuse("I0112", ex.words.span(*stray), text);
    }
    for letter in *b"XZ" {
        ex.words.take(letter);
    }
    ex.modes.motion = Motion::None;
    let after = execute::execute(ex, out)?;
    if code == 780 {
        let Some(lead) = fanuc.lead.filter(|lead| *lead > 0.0) else {
            return Err(words::no_lead(span).into());
        };
        if ex.modes.spindle.turning.is_none() {
            return refuse(
                "I0427",
                span,
                "a thread needs a turning spindle: write M3 or M4, and S, before it",
            );
        }
        let [first, second, third] = path(&start, &corner, taper, 0);
        out.say(&Call::Rapid(first));
        out.say(&Call::SyncStart(along_path(lead, &first, &second)));
        out.say(&Call::Line(second));
        out.say(&Call::SyncStop);
        out.say(&Call::Rapid(third));
    } else {
        motion::check_feed(&ex.words, &ex.modes, "the cycle")?;
        let [first, second, third] = path(&start, &corner, taper, if code == 770 { 0 } else { 2 });
        out.say(&Call::Rapid(first));
        out.say(&Call::Line(second));
        out.say(&Call::Line(third));
    }
    out.say(&Call::Rapid(start));
    Ok(after)
}

/// The corners of the way, the first of them reached along `axis` (0 is X, 2 is Z); the fourth is
/// the start.
fn path(start: &Point, corner: &Point, taper: f64, axis: usize) -> [Point; 3] {
    let mut first = *start;
    first[axis] = corner[axis] + taper;
    let mut third = *start;
    third[2 - axis] = corner[2 - axis];
    [first, *corner, third]
}
