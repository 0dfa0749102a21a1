//! Modes kept and restored: M70, M71, M72, M73.
//!
//! ```text
//!   M70  keep the modes of this level        M71  forget them
//!   M72  restore them                        M73  keep them, and restore them where the subprogram ends
//! ```
//!
//! Kept are units, plane, G90/G91 and their kin, feed and spindle with their modes, tool length
//! offset, work offset, G92 offset, path control, coolant and overrides; not the motion, and not
//! where the axes stand. Each subprogram has modes of its own to restore.
//!
//! Source: LinuxCNC 2.9 manual, "M70 Save Modal State" to "M73"; the order of restoring was
//! measured on its stand-alone interpreter.
use crate::{
    auxiliary::switch::{self, NO_SPEED_LIMIT},
    call::{Call, Corners, Sink, out::Out},
    codes::MGroup,
    compensation,
    coordinates::{distances, offsets},
    fault::{Outcome, error},
    modes::{FeedMode, Modes},
    state::executor::{Context, Executor, Settings},
    words::{Words, names::Store},
};

/// M70 … M73 of the block at hand.
pub(crate) fn context<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome {
    let Some(code) = ex.words.m(MGroup::State) else { return Ok(()) };
    let modes = Box::new(Modes { line: 0, ..ex.modes.clone() });
    let Some(context) = ex.contexts.last_mut() else { return Ok(()) };
    match code {
        70 => context.kept = Some(modes),
        71 => context.kept = None,
        72 => {
            if let Some(kept) = context.kept.clone() {
                return restore(&ex.words, &mut ex.modes, &mut ex.store, &ex.settings, &kept, out);
            }
            let text = "M72 has nothing to restore: no M70 or M73 came before it at this level";
            let fault = error("I0321", ex.words.place.span, text);
            return Err(fault.with_help("each subprogram keeps modes of its own").into());
        }
        _ => *context = Context { kept: Some(modes), automatic: true },
    }
    Ok(())
}

/// A subprogram begins.
pub(crate) fn enter_context(ex: &mut Executor) {
    ex.contexts.push(Context::default());
}

/// A subprogram ends.
pub(crate) fn leave_context<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome {
    let Some(context) = ex.contexts.pop() else { return Ok(()) };
    match context.kept.filter(|_| context.automatic) {
        Some(kept) => restore(&ex.words, &mut ex.modes, &mut ex.store, &ex.settings, &kept, out),
        None => Ok(()),
    }
}

fn restore<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    store: &mut Store,
    settings: &Settings,
    kept: &Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    if kept.units != modes.units {
        switch::set_units(modes, kept.units, out);
    }
    restore_spindle_mode(modes, kept, out);
    restore_feed(modes, kept, out);
    restore_spindle(modes, kept, out);
    if kept.plane != modes.plane {
        modes.plane = kept.plane;
        out.say(&Call::SelectPlane(kept.plane));
    }
    if kept.diameter != modes.diameter {
        distances::set_diameter(modes, kept.diameter, out);
    }
    restore_compensation(words, modes, kept, out)?;
    if kept.frame.tool != modes.frame.tool {
        modes.reframe(|frame| frame.tool = kept.frame.tool);
        out.say(&Call::ToolOffset(kept.frame.tool));
    }
    if kept.system != modes.system {
        offsets::change_system(modes, store, settings, kept.system, out);
    }
    if kept.corners != modes.corners || kept.merge != modes.merge {
        modes.corners = kept.corners;
        modes.merge = kept.merge;
        let merge = matches!(kept.corners, Corners::Continuous(_)).then_some(kept.merge);
        out.say(&Call::PathControl { corners: kept.corners, merge });
    }
    distances::set_distances(modes, kept.incremental, kept.absolute_centres, out);
    if kept.retract_to_initial != modes.retract_to_initial {
        distances::set_retract(modes, kept.retract_to_initial, out);
    }
    if kept.frame.added != modes.frame.added {
        offsets::set_added(modes, store, kept.frame.added, out);
    }
    restore_switches(modes, kept, out);
    Ok(())
}

fn restore_spindle_mode<S: Sink>(modes: &mut Modes, kept: &Modes, out: &mut Out<'_, S>) {
    let surface = kept.spindle.constant_surface_speed;
    if surface != modes.spindle.constant_surface_speed {
        let limit = if surface { kept.spindle.limit.min(NO_SPEED_LIMIT) } else { 0.0 };
        out.say(&Call::SpindleMode(limit));
        modes.spindle.constant_surface_speed = surface;
        modes.spindle.limit = kept.spindle.limit;
    }
}

fn restore_feed<S: Sink>(modes: &mut Modes, kept: &Modes, out: &mut Out<'_, S>) {
    let changed = kept.feed != modes.feed;
    if kept.feed_mode != modes.feed_mode {
        switch::set_feed_mode(modes, kept.feed_mode, out);
    }
    if changed && kept.feed_mode != FeedMode::InverseTime {
        out.say(&Call::FeedRate { rate: kept.feed, duration_s: None });
    }
    modes.feed = kept.feed;
}

fn restore_spindle<S: Sink>(modes: &mut Modes, kept: &Modes, out: &mut Out<'_, S>) {
    if kept.spindle.speed != modes.spindle.speed {
        out.say(&Call::SpindleSpeed(kept.spindle.speed));
    }
    if kept.spindle.turning != modes.spindle.turning {
        match kept.spindle.turning {
            None => out.say(&Call::SpindleStop),
            Some(sense) => out.say(&Call::SpindleTurn(sense)),
        }
    }
    modes.spindle = kept.spindle;
}

fn restore_compensation<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    kept: &Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    match (&kept.compensation, &modes.compensation) {
        (None, Some(_)) => {
            out.say(&Call::Note("cutter radius compensation off"));
            compensation::compensation_off(words, modes, out)
        }
        (Some(_), None) => {
            let text = "cutter radius compensation was on when the modes were kept, and cannot be begun again by restoring them";
            Err(error("I0322", words.place.span, text)
                .with_help("write G41 or G42 after the modes are restored")
                .into())
        }
        _ => Ok(()),
    }
}

fn restore_switches<S: Sink>(modes: &mut Modes, kept: &Modes, out: &mut Out<'_, S>) {
    let now = modes.clone();
    if (kept.mist, kept.flood) != (now.mist, now.flood) {
        set_coolant(modes, kept.mist, kept.flood, out);
    }
    if kept.feed_override != now.feed_override {
        out.say(&Call::FeedOverride(kept.feed_override));
    }
    if kept.speed_override != now.speed_override {
        out.say(&Call::SpeedOverride(kept.speed_override));
    }
    if kept.adaptive_feed != now.adaptive_feed {
        out.say(&Call::AdaptiveFeed(kept.adaptive_feed));
    }
    if kept.feed_hold != now.feed_hold {
        out.say(&Call::FeedHold(kept.feed_hold));
    }
    let modes = &mut *modes;
    modes.feed_override = kept.feed_override;
    modes.speed_override = kept.speed_override;
    modes.adaptive_feed = kept.adaptive_feed;
    modes.feed_hold = kept.feed_hold;
}

fn set_coolant<S: Sink>(modes: &mut Modes, mist: bool, flood: bool, out: &mut Out<'_, S>) {
    if !mist && !flood {
        out.say(&Call::Mist(false));
        out.say(&Call::Flood(false));
    } else {
        if mist != modes.mist {
            out.say(&Call::Mist(mist));
        }
        if flood != modes.flood {
            out.say(&Call::Flood(flood));
        }
    }
    (modes.mist, modes.flood) = (mist, flood);
}
