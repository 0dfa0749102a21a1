//! Modes kept and restored: M70, M71, M72, M73.
//!
//! ```text
//!   M70  keep the modes of this level        M71  forget them
//!   M72  restore them                        M73  keep them, and restore them where the subprogram ends
//! ```
//!
//! Kept are units, plane, G90/G91 and their kin, feed and spindle with their modes, tool length offset,
//! work offset, G92 offset, path control, coolant and overrides; not the motion, and not where the axes
//! stand. Each subprogram has modes of its own to restore.
//!
//! Source: LinuxCNC 2.9 manual, "M70 Save Modal State" to "M73"; the order of restoring was measured on
//! its stand-alone interpreter.
use crate::{
    call::{Call, Corners, Sink},
    codes::MGroup,
    execute::Executor,
    fault::{Outcome, error},
    state::{FeedMode, State},
    switch::NO_SPEED_LIMIT,
};

/// The modes kept at one level.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Context {
    kept: Option<Box<State>>,
    /// M73.
    automatic: bool,
}

impl Executor {
    /// M70 … M73 of the block at hand.
    pub(crate) fn context<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let Some(code) = self.words.m(MGroup::State) else { return Ok(()) };
        let state = Box::new(State { line: 0, ..self.state.clone() });
        let Some(context) = self.contexts.last_mut() else { return Ok(()) };
        match code {
            70 => context.kept = Some(state),
            71 => context.kept = None,
            72 => {
                if let Some(kept) = context.kept.clone() {
                    return self.restore(&kept, sink);
                }
                let text = "M72 has nothing to restore: no M70 or M73 came before it at this level";
                let fault = error("I0321", self.words.place.span, text);
                return Err(fault.with_help("each subprogram keeps modes of its own").into());
            }
            _ => *context = Context { kept: Some(state), automatic: true },
        }
        Ok(())
    }

    /// A subprogram begins.
    pub(crate) fn enter_context(&mut self) {
        self.contexts.push(Context::default());
    }

    /// A subprogram ends.
    pub(crate) fn leave_context<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let Some(context) = self.contexts.pop() else { return Ok(()) };
        match context.kept.filter(|_| context.automatic) {
            Some(kept) => self.restore(&kept, sink),
            None => Ok(()),
        }
    }

    fn restore<S: Sink>(&mut self, kept: &State, sink: &mut S) -> Outcome {
        if kept.units != self.state.units {
            self.set_units(kept.units, sink);
        }
        self.restore_spindle_mode(kept, sink);
        self.restore_feed(kept, sink);
        self.restore_spindle(kept, sink);
        if kept.plane != self.state.plane {
            self.state.plane = kept.plane;
            self.say(sink, &Call::SelectPlane(kept.plane));
        }
        if kept.diameter != self.state.diameter {
            self.set_diameter(kept.diameter, sink);
        }
        self.restore_compensation(kept, sink)?;
        if kept.frame.tool != self.state.frame.tool {
            self.state.reframe(|frame| frame.tool = kept.frame.tool);
            self.say(sink, &Call::ToolOffset(kept.frame.tool));
        }
        if kept.system != self.state.system {
            self.change_system(kept.system, sink);
        }
        if kept.corners != self.state.corners || kept.merge != self.state.merge {
            self.state.corners = kept.corners;
            self.state.merge = kept.merge;
            let merge = matches!(kept.corners, Corners::Continuous(_)).then_some(kept.merge);
            self.say(sink, &Call::PathControl { corners: kept.corners, merge });
        }
        self.set_distances(kept.incremental, kept.absolute_centres, sink);
        if kept.retract_to_initial != self.state.retract_to_initial {
            self.set_retract(kept.retract_to_initial, sink);
        }
        if kept.frame.added != self.state.frame.added {
            self.set_added(kept.frame.added, sink);
        }
        self.restore_switches(kept, sink);
        Ok(())
    }

    fn restore_spindle_mode<S: Sink>(&mut self, kept: &State, sink: &mut S) {
        let surface = kept.spindle.constant_surface_speed;
        if surface != self.state.spindle.constant_surface_speed {
            let limit = if surface { kept.spindle.limit.min(NO_SPEED_LIMIT) } else { 0.0 };
            self.say(sink, &Call::SpindleMode(limit));
            self.state.spindle.constant_surface_speed = surface;
            self.state.spindle.limit = kept.spindle.limit;
        }
    }

    fn restore_feed<S: Sink>(&mut self, kept: &State, sink: &mut S) {
        let changed = kept.feed != self.state.feed;
        if kept.feed_mode != self.state.feed_mode {
            self.set_feed_mode(kept.feed_mode, sink);
        }
        if changed && kept.feed_mode != FeedMode::InverseTime {
            self.say(sink, &Call::FeedRate { rate: kept.feed, duration_s: None });
        }
        self.state.feed = kept.feed;
    }

    fn restore_spindle<S: Sink>(&mut self, kept: &State, sink: &mut S) {
        if kept.spindle.speed != self.state.spindle.speed {
            self.say(sink, &Call::SpindleSpeed(kept.spindle.speed));
        }
        if kept.spindle.turning != self.state.spindle.turning {
            match kept.spindle.turning {
                None => self.say(sink, &Call::SpindleStop),
                Some(sense) => self.say(sink, &Call::SpindleTurn(sense)),
            }
        }
        self.state.spindle = kept.spindle;
    }

    fn restore_compensation<S: Sink>(&mut self, kept: &State, sink: &mut S) -> Outcome {
        match (&kept.compensation, &self.state.compensation) {
            (None, Some(_)) => {
                self.say(sink, &Call::Note("cutter radius compensation off"));
                self.compensation_off(sink)
            }
            (Some(_), None) => {
                let text = "cutter radius compensation was on when the modes were kept, and cannot be begun again by restoring them";
                Err(error("I0322", self.words.place.span, text)
                    .with_help("write G41 or G42 after the modes are restored")
                    .into())
            }
            _ => Ok(()),
        }
    }

    fn restore_switches<S: Sink>(&mut self, kept: &State, sink: &mut S) {
        let now = self.state.clone();
        if (kept.mist, kept.flood) != (now.mist, now.flood) {
            self.set_coolant(kept.mist, kept.flood, sink);
        }
        if kept.feed_override != now.feed_override {
            self.say(sink, &Call::FeedOverride(kept.feed_override));
        }
        if kept.speed_override != now.speed_override {
            self.say(sink, &Call::SpeedOverride(kept.speed_override));
        }
        if kept.adaptive_feed != now.adaptive_feed {
            self.say(sink, &Call::AdaptiveFeed(kept.adaptive_feed));
        }
        if kept.feed_hold != now.feed_hold {
            self.say(sink, &Call::FeedHold(kept.feed_hold));
        }
        let state = &mut self.state;
        state.feed_override = kept.feed_override;
        state.speed_override = kept.speed_override;
        state.adaptive_feed = kept.adaptive_feed;
        state.feed_hold = kept.feed_hold;
    }

    fn set_coolant<S: Sink>(&mut self, mist: bool, flood: bool, sink: &mut S) {
        if !mist && !flood {
            self.say(sink, &Call::Mist(false));
            self.say(sink, &Call::Flood(false));
        } else {
            if mist != self.state.mist {
                self.say(sink, &Call::Mist(mist));
            }
            if flood != self.state.flood {
                self.say(sink, &Call::Flood(flood));
            }
        }
        (self.state.mist, self.state.flood) = (mist, flood);
    }
}
