//! Rigid tapping as a mode: M29, and what ends it.
//!
//! ```text
//!            M29 S…            G84, G74               X… Y…
//!     Off ──────────► Ordered ──────────► Cycling ◄────────┐
//!      ▲  G84.2, G84.3                    │  │  └──────────┘
//!      ├──────────────────────────────────┼──┘ (to Cycling at once)
//!      └── G80, another motion ◄──────────┘
//! ```
//!
//! In rigid mode the cycle turns the spindle itself, so no M3 or M4 is asked for. Between M29 and
//! its cycle nothing may move, and the plane stays as it is until the mode ends.
//!
//! Source: Fanuc, operator's manual of series 0i, "Rigid tapping" (M29, G84.2, G84.3 and the alarms
//! PS0203 to PS0206).
use crate::{
    codes::{GGroup, MGroup},
    fault::{Outcome, error, refuse},
    modes::{Cycle, Modes, Motion, tapping::Rigid},
    words::Words,
};
use canon::Plane;

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

/// The tapping cycle that a motion is.
const fn tap_cycle(motion: Motion) -> Option<Cycle> {
    match motion {
        Motion::Cycle(cycle) if cycle.tap_sense().is_some() => Some(cycle),
        _ => None,
    }
}
