//! Compensated moves, held back until the next one settles their ends.

use crate::{
    call::{Call, Sink, out::Out},
    geometry::{
        frame::Point,
        offset_curve::{Flat, plus},
    },
    modes::Modes,
};
pub(crate) fn push_line<S: Sink>(
    modes: &Modes,
    rapid: bool,
    to: &Point,
    end: Flat,
    out: &mut Out<'_, S>,
) {
    let to = beside(modes, to, end);
    out.hold(if rapid { Call::Rapid(to) } else { Call::Line(to) });
}

pub(crate) fn push_arc<S: Sink>(
    modes: &Modes,
    to: &Point,
    centre: Flat,
    turns: i32,
    end: Flat,
    out: &mut Out<'_, S>,
) {
    let shift = modes.compensation.as_ref().map_or([0.0; 2], |c| c.shift);
    let to = beside(modes, to, end);
    let centre = plus(centre, shift);
    out.hold(Call::Arc { plane: modes.plane, to, centre, turns });
}

pub(crate) fn beside(modes: &Modes, to: &Point, end: Flat) -> Point {
    let [a, b, _] = modes.plane_axes();
    let shift = modes.compensation.as_ref().map_or([0.0; 2], |c| c.shift);
    let end = plus(end, shift);
    let mut to = *to;
    (to[a], to[b]) = (end[0], end[1]);
    to
}
