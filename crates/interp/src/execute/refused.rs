//! After a refusal nothing else is refused because of it: the block is followed as far as it can be
//! understood, what cannot be known any more is [`Unknown`] until the program says it again, and
//! diagnostics that ask for it are suppressed.
//!
//! ```text
//!   G1 G41 D99 X10 Y0      refused: no such tool          followed: G1, X10 Y0, compensation as if off
//!   G3 X20 I5              the arc begins where it was meant to begin: no error
//!   G0 X[1/0]              refused                         unknown: where X stands
//!   G2 X30 I5              says nothing: whether its ends fit is not known
//!   G0 X0                  X is known again
//! ```
//!
//! A finding that asks for what is unknown ([`needs`](crate::fault::unknown::needs)) is not told:
//! it would say again what the first refusal has said, or what is not so. One that says that
//! something is missing makes that unknown itself, so that it is told once and not in each of a
//! hundred lines.
use crate::{
    auxiliary::{self, switch},
    call::{Call, Sink, out::Out},
    codes::{self, AXES, CENTRE, GGroup, POLAR},
    compensation,
    coordinates::{distances, offsets, target},
    fault::unknown::{self, Unknown},
    modes::{Modes, Motion},
    state::executor::Executor,
    words::{Stage, Words},
};

/// After a block that could not be read: what it may have said is unknown.
pub(crate) fn forget_unreadable(modes: &mut Modes, text: &[u8]) {
    let letters = unknown::letters_of(text);
    modes.unknown.add(unknown::said_by(letters));
    let upper = text.to_ascii_uppercase();
    if upper.windows(2).any(|pair| pair == b"G9") {
        modes.unknown.add(Unknown::DISTANCE);
    }
    if text.contains(&b'#') {
        modes.unknown.add(Unknown::PARAMETERS);
    }
}

/// A parameter could not be set.
pub(crate) fn forget_parameters(modes: &mut Modes) {
    modes.unknown.add(Unknown::PARAMETERS);
}

/// A numbered block that is looked for is there, and cannot be read.
pub(crate) fn forget_blocks(modes: &mut Modes) {
    modes.unknown.add(Unknown::BLOCKS);
}

/// Whether it is no matter for this block which motion was in force.
pub(crate) fn names_its_motion(words: &Words, block: &gcode::Block) -> bool {
    words.place.span == block.span && words.g(GGroup::Motion).is_some()
}

/// Whether it is unknown what a block of axis words alone would do.
pub(crate) fn motion_is_unknown(words: &Words, modes: &Modes) -> bool {
    modes.unknown.has(Unknown::MOTION)
        && words.g(GGroup::Motion).is_none()
        && words.any(AXES | CENTRE | POLAR)
}

/// After a block was refused.
pub(crate) fn after_refusal<S: Sink>(
    ex: &mut Executor,
    code: &str,
    block: &gcode::Block,
    text: &[u8],
    out: &mut Out<'_, S>,
) {
    let read = ex.words.place.span == block.span;
    let needed = unknown::needs(code);
    let failed = ex.words.stage;
    let mut missing = needed & !(Unknown::PLACE | Unknown::DISTANCE);
    if read {
        missing |= match failed {
            Stage::Feed => Unknown::FEED,
            Stage::Speed => Unknown::SPEED,
            Stage::Tools => Unknown::TOOL,
            _ => 0,
        };
        if needed & Unknown::PLACE != 0 {
            // a word may be missing that says where it ends
            missing |= Unknown::PLACE & !unknown::said_by(ex.words.letters_present());
        }
    }
    let grinds = ex.modes.cam || read && ex.words.g(GGroup::Cam).is_some();
    if read && ex.recording.is_none() && !grinds {
        if needed & Unknown::COMPENSATION != 0 {
            give_up_compensation(&mut ex.modes, out);
        }
        if code == "I0533" {
            ex.words.forget_g(GGroup::Plane); // this is what was refused
        }
        follow(ex, out);
    }
    let unread = match (read, failed) {
        (false, _) => unknown::letters_of(text),
        (true, Stage::Words) if ex.settings.rules.reads_up_to_fault => unknown::letters_of(text),
        (true, _) => ex.words.unread,
    };
    let of_computed =
        if ex.modes.unknown.has(Unknown::PARAMETERS) { unknown::computed(block) } else { 0 };
    ex.modes.unknown.add(unknown::said_by(unread | of_computed) | missing);
    out.sink.suppress(ex.modes.unknown);
}

/// After a block was executed: what it has said is known again.
pub(crate) fn settle_unknown<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    block: &gcode::Block,
    out: &mut Out<'_, S>,
) {
    if words.place.span != block.span {
        return; // O-words, jumps: no words were read
    }
    let mut known = 0;
    let mut says = |is: bool, what: u32| known |= if is { what } else { 0 };
    says(words.get(b'F').is_some(), Unknown::FEED);
    says(words.get(b'S').is_some(), Unknown::SPEED);
    says(words.get(b'T').is_some(), Unknown::TOOL);
    says(words.m(codes::MGroup::Spindle).is_some(), Unknown::SENSE);
    says(words.g(GGroup::Motion).is_some(), Unknown::MOTION);
    says(words.g(GGroup::Plane).is_some(), Unknown::PLANE);
    says(words.g(GGroup::Compensation).is_some(), Unknown::COMPENSATION);
    says(words.g(GGroup::Distance).is_some(), Unknown::DISTANCE);
    let absolute = !(modes.incremental || modes.unknown.has(Unknown::DISTANCE));
    for (axis, letter) in b"XYZABCUVW".iter().enumerate() {
        // as written: Fanuc's maps add words
        says(block.word(*letter).is_some() && absolute, 1 << axis);
    }
    modes.unknown.clear(known);
    if modes.unknown.has(Unknown::PARAMETERS) {
        modes.unknown.add(unknown::said_by(unknown::computed(block)));
    }
    out.sink.suppress(modes.unknown);
}

/// What the block says as far as it is understood, without complaints: modes, and where it leads.
pub(crate) fn follow<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) {
    let failed = ex.words.stage;
    let known = ex.modes.unknown;
    out.sink.suppress(Unknown::ALL);
    if failed <= Stage::Words {
        _ = switch::feed_mode(&ex.words, &mut ex.modes, out);
    }
    if failed <= Stage::Feed {
        _ = switch::spindle_speed(&ex.words, &mut ex.modes, &ex.settings, out);
    }
    if failed <= Stage::Speed {
        _ = auxiliary::tools_and_switches(ex, out);
    } else if failed == Stage::Tools {
        _ = switch::spindle(&ex.words, &mut ex.modes, out);
        switch::coolant(&ex.words, &mut ex.modes, out);
    }
    if failed <= Stage::Modes {
        follow_modes(ex, failed, out);
    }
    if failed <= Stage::Motion {
        follow_motion(&ex.words, &mut ex.modes, out);
    }
    ex.words.stage = Stage::Done;
    ex.modes.unknown.add(known.0);
    out.sink.suppress(ex.modes.unknown);
}

fn follow_modes<S: Sink>(ex: &mut Executor, failed: Stage, out: &mut Out<'_, S>) {
    distances::plane(&ex.words, &mut ex.modes, out);
    switch::units(&ex.words, &mut ex.modes, out);
    distances::diameter(&ex.words, &mut ex.modes, out);
    let side = ex.words.g(GGroup::Compensation);
    if failed < Stage::Modes || side == Some(400) {
        _ = compensation::compensation(&ex.words, &mut ex.modes, &mut ex.tools, out);
    }
    if side.is_some_and(|code| code != 400) && ex.modes.compensation.is_none() {
        ex.modes.unknown.add(Unknown::COMPENSATION);
    }
    _ = offsets::tool_length(&ex.words, &mut ex.modes, &mut ex.tools, out);
    offsets::work_offset(&ex.words, &mut ex.modes, &mut ex.store, &ex.settings, out);
    _ = switch::path_control(&ex.words, &mut ex.modes, out);
    distances::distances(&ex.words, &mut ex.modes, out);
}

/// Refused compensation is as if off, until it is called again.
fn give_up_compensation<S: Sink>(modes: &mut Modes, out: &mut Out<'_, S>) {
    if modes.compensation.take().is_some() {
        out.let_go();
    }
    modes.left_beside = None;
    modes.unknown.add(Unknown::COMPENSATION);
}

/// The place where the block leads to, and the motion that it puts in force; a tap comes back to
/// where it began.
fn follow_motion<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) {
    let named = words.g(GGroup::Motion).map(Motion::from_code);
    let motion = named.unwrap_or(modes.motion);
    if matches!(words.g(GGroup::NonModal), Some(280 | 300)) {
        modes.unknown.add(Unknown::PLACE);
        return;
    }
    if matches!(motion, Motion::Cycle(_)) && named.is_some() {
        (modes.sticky, modes.initial) = (None, None);
        modes.unknown.add(Unknown::MOTION);
    }
    if named.is_some() {
        modes.motion = motion;
    }
    if !words.any(AXES | POLAR) || is_set_by_axes(words) {
        return;
    }
    if named.is_none() && words.unread & codes::set("G") != 0 {
        // the words of an unknown code: it may move, or not
        modes.unknown.add(unknown::said_by(words.letters_present() & (AXES | POLAR)));
        return;
    }
    let machine_coordinates = words.g(GGroup::NonModal) == Some(530);
    let Ok(mut to) = target::destination(words, modes, machine_coordinates) else {
        modes.unknown.add(Unknown::PLACE);
        return;
    };
    if matches!(motion, Motion::Cycle(_)) {
        // along the plane's axes alone: of other letters a cycle has meanings of its own
        let [a, b, _] = modes.plane_axes();
        let (x, y) = (to[a], to[b]);
        to = modes.at;
        (to[a], to[b]) = (x, y);
    }
    if modes.compensating() {
        give_up_compensation(modes, out);
    }
    modes.nurbs = None;
    modes.left_beside = None;
    if to != modes.at && motion != Motion::RigidTap {
        let feeds = !matches!(motion, Motion::Rapid | Motion::None | Motion::Cycle(_));
        let line = feeds && modes.feed > 0.0;
        modes.at = to;
        out.say(&if line { Call::Line(to) } else { Call::Rapid(to) });
    }
}

/// The axis words are an offset's, not a move's.
fn is_set_by_axes(words: &Words) -> bool {
    matches!(words.g(GGroup::NonModal), Some(100 | 513 | 520 | 920))
        || matches!(words.g(GGroup::ToolLength), Some(431 | 432))
}
