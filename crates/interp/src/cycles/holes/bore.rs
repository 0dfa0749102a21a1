//! Boring straight in: G85, G86, G88, G89.
//!
//! ```text
//!   G85   feed down, feed out                    G88   feed down, wait, stop the spindle, stop the program; out, turn
//!   G86   feed down, wait, stop, out fast, turn  G89   feed down, wait, feed out
//! ```
//!
//! LinuxCNC leaves the way out of G88 to the operator and goes on from the clear level as if he had
//! been there; here the axis is brought there after the stop, straight up, wherever he left it.
//!
//! Source: NISTIR 6556, sections 3.5.16.5, .6, .8 and .9; the order of the calls was measured on
//! LinuxCNC 2.9.
use crate::{
    call::{Call, CycleHole, Sense, Sink, out::Out},
    cycles::holes::pattern::{Pattern, at_level},
    modes::Modes,
};
use units::TurnDirection;

/// G85.
pub(crate) fn feed_out<S: Sink>(pattern: &Pattern, hole: &CycleHole, out: &mut Out<'_, S>) {
    out.say(&Call::Line(at_level(hole, pattern.r)));
    out.say(&Call::Rapid(at_level(hole, pattern.clear)));
}

/// G89.
pub(crate) fn wait_and_feed_out<S: Sink>(
    pattern: &Pattern,
    hole: &CycleHole,
    out: &mut Out<'_, S>,
) {
    out.say(&Call::Dwell(pattern.dwell));
    out.say(&Call::Line(at_level(hole, pattern.clear)));
}

/// G86.
pub(crate) fn stop_and_out<S: Sink>(
    modes: &Modes,
    pattern: &Pattern,
    hole: &CycleHole,
    out: &mut Out<'_, S>,
) {
    out.say(&Call::Dwell(pattern.dwell));
    out.say(&Call::SpindleStop);
    out.say(&Call::Rapid(at_level(hole, pattern.clear)));
    turn_again(modes, out);
}

/// G88.
pub(crate) fn out_by_hand<S: Sink>(
    modes: &Modes,
    pattern: &Pattern,
    hole: &CycleHole,
    out: &mut Out<'_, S>,
) {
    out.say(&Call::Dwell(pattern.dwell));
    out.say(&Call::SpindleStop);
    out.say(&Call::Stop);
    out.say(&Call::OutByHand(at_level(hole, pattern.clear)));
    turn_again(modes, out);
}

/// The spindle stops at angle 0, turning on in its sense.
pub(crate) fn hold_spindle<S: Sink>(modes: &Modes, out: &mut Out<'_, S>) {
    let (direction, mode) = match modes.spindle.turning {
        Some(Sense::Clockwise) => (TurnDirection::Forward, 2),
        _ => (TurnDirection::Backward, 3),
    };
    out.say(&Call::SpindleStop);
    out.say(&Call::SpindleOrient { angle: 0.0, direction, mode, longest: None });
}

/// It turns as it did before.
pub(crate) fn turn_again<S: Sink>(modes: &Modes, out: &mut Out<'_, S>) {
    if let Some(sense) = modes.spindle.turning {
        out.say(&Call::SpindleTurn(sense));
    }
}
