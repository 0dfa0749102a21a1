//! Rigid tapping as a mode, and the words of a tapping cycle.
//!
//! ```text
//!            M29 S…            G84, G74               X… Y…
//!     Off ──────────► Ordered ──────────► Cycling ◄────────┐
//!      ▲  G84.2, G84.3                    │  │  └──────────┘
//!      ├──────────────────────────────────┼──┘ (to Cycling at once)
//!      └── G80, another motion ◄──────────┘
//! ```
//!
//! In rigid mode the cycle turns the spindle itself, so no M3 or M4 is asked for. Between M29 and its
//! cycle nothing may move, and the plane stays as it is until the mode ends.
//!
//! | word | meaning | left out |
//! |---|---|---|
//! | `A` | spindle angle at which the thread begins at R, degrees | 0 |
//! | `J` | way out: up to 20 so many times S, above 20 rev/min | as fast as in |
//! | `I` | acceleration on the way out: up to 1 that share of what the drives give, above 1 rev/s² | all of it |
//! | `Q` | depth of each peck, above 0; Q0 ends it | all the way at once |
//!
//! Source: Fanuc, operator's manual of series 0i, "Rigid tapping" (M29, G84.2, G84.3 and the alarms
//! PS0203 to PS0206); J as a factor: Haas mill operator's manual, G84.
use crate::{
    call::ReturnSpeed,
    codes::{GGroup, MGroup},
    fault::{Outcome, error, refuse},
    modes::{
        Cycle, Modes, Motion,
        tapping::{Rigid, TapWords},
    },
    state::tools::Tools,
    words::Words,
};
use canon::{Plane, ReturnAcceleration, ToolKind};
use units::SpinAccel;

/// J up to this is a factor, above it a speed in rev/min.
const LARGEST_FACTOR: f64 = 20.0;
/// Least share of the acceleration: with less a tap would come out in minutes.
const LEAST_SHARE: f64 = 0.01;
/// More pecks than this in one thread are a slip of the pen.
const MAX_PECKS: f64 = 200.0;

/// M29, and what must not change in rigid mode; before the block's modes are set.
#[inline]
pub(crate) fn rigid_mode(words: &Words, modes: &mut Modes, motion: Option<Motion>) -> Outcome {
    if motion.is_some_and(|m| tap_cycle(m).is_none()) && modes.rigid == Rigid::Cycling {
        modes.rigid = Rigid::Off;
    }
    let span = words.place.span;
    if words.m(MGroup::Rigid).is_some() {
        if modes.spindle.constant_surface_speed {
            let text = "M29 needs S in revolutions per minute, but G96 is in force";
            return Err(error("I0531", span, text).with_help("write G97 S… before it").into());
        }
        if modes.spindle.speed <= 0.0 {
            return refuse("I0532", span, "M29 needs S, the speed of the taps that follow");
        }
        modes.rigid = Rigid::Ordered(span);
    }
    let plane = match words.g(GGroup::Plane) {
        Some(180) => Plane::ZX,
        Some(190) => Plane::YZ,
        Some(_) => Plane::XY,
        None => modes.plane,
    };
    let starts = motion.and_then(tap_cycle).is_some();
    if plane != modes.plane && modes.rigid != Rigid::Off && !(starts && fresh(words, modes)) {
        let text = "the plane cannot change in rigid tapping";
        let help = "end it with G80 first, or select the plane before M29";
        return Err(error("I0533", span, text).with_help(help).into());
    }
    Ok(())
}

/// M29 in this very block.
fn fresh(words: &Words, modes: &Modes) -> bool {
    modes.rigid == Rigid::Ordered(words.place.span)
}

/// What M29 waits for, and what ends it.
#[inline]
pub(crate) fn rigid_motion(words: &Words, modes: &mut Modes, motion: Motion) -> Outcome {
    let was = modes.rigid;
    modes.rigid = match (tap_cycle(motion), was) {
        (
            Some(Cycle::RigidRight | Cycle::RigidLeft | Cycle::SynchroRight | Cycle::SynchroLeft),
            _,
        )
        | (Some(_), Rigid::Ordered(_) | Rigid::Cycling) => Rigid::Cycling,
        (Some(_), Rigid::Off) | (None, _) => Rigid::Off,
    };
    match (motion, was) {
        (Motion::None, _) => Ok(()),
        (_, Rigid::Ordered(ordered)) if modes.rigid == Rigid::Off => {
            let code = crate::codes::spelling::written(motion.code());
            let text = format!("expected G84 or G74 after M29, found a move with G{code}");
            let fault = error("I0534", words.place.span, text)
                .with_label(ordered, "rigid tapping ordered here");
            Err(fault.with_help("move first, then write M29 in the block before the cycle").into())
        }
        _ => Ok(()),
    }
}

/// No F is in force, but the tap in the spindle has a pitch.
pub(crate) fn lead_is_the_taps(modes: &Modes, tools: &Tools, cycle: Cycle) -> bool {
    let tool = tools.library.get(modes.current_tool);
    cycle.tap_sense().is_some()
        && modes.feed == 0.0
        && modes.feed_mode != crate::modes::FeedMode::InverseTime
        && tool.is_some_and(|t| matches!(t.kind, ToolKind::Tap(_)))
}

/// A, I, J, Q of this block, or those that the cycle kept.
pub(crate) fn tap_words(words: &Words, kept: Option<TapWords>) -> Outcome<TapWords> {
    let kept = kept.unwrap_or_default();
    let return_speed = match words.get(b'J') {
        None => kept.return_speed,
        Some(factor) if factor > 0.0 && factor <= LARGEST_FACTOR => ReturnSpeed::Times(factor),
        Some(rpm) if rpm > LARGEST_FACTOR => ReturnSpeed::Rpm(rpm),
        Some(other) => {
            let text = format!(
                "J is the speed of the way out: up to {LARGEST_FACTOR} times S, or rev/min above that, found {other}"
            );
            return refuse("I0535", words.span(b'J'), text);
        }
    };
    let peck = peck_word(words, kept.peck)?;
    let start_angle_deg = words.get(b'A').unwrap_or(kept.start_angle_deg);
    if start_angle_deg.abs() > 1e6 {
        let text = format!("A is an angle within a turn, 0 to 360, found {start_angle_deg}");
        return refuse("I0537", words.span(b'A'), text);
    }
    let return_acceleration = return_acceleration(words, kept.return_acceleration)?;
    let lead_mm = None;
    Ok(TapWords { start_angle_deg, return_speed, return_acceleration, peck, lead_mm })
}

/// Q of this block, or the one kept; Q0 ends it.
pub(crate) fn peck_word(words: &Words, kept: Option<f64>) -> Outcome<Option<f64>> {
    match words.get(b'Q') {
        None => Ok(kept),
        Some(0.0) => Ok(None),
        Some(depth) if depth > 0.0 => Ok(Some(depth)),
        Some(other) => {
            let text = format!("Q is the depth of each peck, above 0, found {other}");
            refuse("I0536", words.span(b'Q'), text)
        }
    }
}

/// I of this block.
fn return_acceleration(words: &Words, kept: ReturnAcceleration) -> Outcome<ReturnAcceleration> {
    match words.get(b'I') {
        None => Ok(kept),
        Some(1.0) => Ok(ReturnAcceleration::AsSet),
        Some(share) if (LEAST_SHARE..1.0).contains(&share) => Ok(ReturnAcceleration::Share(share)),
        Some(limit) if limit > 1.0 => Ok(ReturnAcceleration::Limit(SpinAccel::rev_per_s2(limit))),
        Some(other) => {
            let text = format!(
                "I is the acceleration of the way out: {LEAST_SHARE} to 1 of what the drives give, or rev/s² \
                 above that, found {other}"
            );
            refuse("I0539", words.span(b'I'), text)
        }
    }
}

/// A peck so small that it is a slip of the pen.
pub(crate) fn check_pecks(words: &Words, tap: &TapWords, stroke: f64) -> Outcome {
    match tap.peck {
        Some(peck) if stroke / peck > MAX_PECKS => {
            let least = stroke / MAX_PECKS;
            let text = format!(
                "Q{peck} would make more than {MAX_PECKS} pecks: at least {least} is needed"
            );
            refuse("I0538", words.span(b'Q'), text)
        }
        _ => Ok(()),
    }
}

/// The tapping cycle that a motion is.
const fn tap_cycle(motion: Motion) -> Option<Cycle> {
    match motion {
        Motion::Cycle(cycle) if cycle.tap_sense().is_some() => Some(cycle),
        _ => None,
    }
}
