//! One block, executed: what is done in which order.
//!
//! ```text
//!   comments → F mode, F → S mode, S → T → M6 → M3 M4 M5 M19 → coolant → overrides → G4
//!     → plane → units → G40 → tool length → work offset → path control → G90 G91 → G98 G99
//!     → G10 G28 G30 G52 G92 → motion → M0 M1 M2 M30 M60
//! ```
//!
//! The order is the language's, not the text's: `G1 X1 M3 S500` starts the spindle first.
//! Source: NISTIR 6556 table 8; LinuxCNC 2.9 manual, "Order of execution".
use crate::{
    call::{Call, Place, Sink},
    codes::{AXES, CENTRE, GGroup, MGroup, NON_STOP_CHANGE, POLAR},
    context::Context,
    dialect::rules::Rules,
    eval::Values,
    fault::{Outcome, error, refuse},
    held::Held,
    names::Store,
    profile::Recording,
    refused::Stage,
    setup::{Cycles, MissingTools, Setup, UserCode},
    state::{Motion, State},
    tool_table::ToolTable,
    words::Words,
};
use canon::{Plane, ToolLibrary};
use core::cell::RefCell;
use diag::Diagnostic;
use gcode::Block;

/// What happens after a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum After {
    /// The next one.
    Next,
    /// M2, M30.
    End,
    /// M98: the subprogram's number and how often.
    Call(u32, u32),
    /// M99.
    Return,
    /// G70 to G72: the subprogram with the profile.
    Profile(u32),
}

/// The interpreter without its text: modal state, parameters, the words at hand.
#[derive(Clone)]
pub(crate) struct Executor {
    pub(crate) state: State,
    pub(crate) store: Store,
    pub(crate) words: Words,
    pub(crate) tools: ToolLibrary,
    pub(crate) missing_tools: MissingTools,
    /// What the tool table says, where a program has changed it.
    pub(crate) tool_table: ToolTable,
    /// Modes kept by M70 and M73, innermost subprogram last.
    pub(crate) contexts: Vec<Context>,
    /// Whether moves go beside the programmed ones, and what is held back meanwhile.
    pub(crate) compensating: bool,
    pub(crate) held: RefCell<Vec<(Place, Held)>>,
    /// What the dialect has of its own.
    pub(crate) rules: &'static Rules,
    pub(crate) stand_alone: bool,
    pub(crate) user_codes: Vec<UserCode>,
    /// The machine's settings for cycles.
    pub(crate) cycles: Cycles,
    /// A profile being taken down.
    pub(crate) recording: Option<Box<Recording>>,
    /// Warnings and notes of the block at hand.
    pub(crate) remarks: Vec<Diagnostic>,
}

impl Executor {
    pub(crate) fn new(setup: &Setup) -> Self {
        let mut new = Self {
            state: State::new(),
            store: Store::new(setup.parameters.clone()),
            words: Words::new(setup.dialect.rules()),
            tools: setup.tools.clone(),
            missing_tools: setup.missing_tools,
            tool_table: ToolTable::default(),
            contexts: vec![Context::default()],
            compensating: false,
            held: RefCell::default(),
            rules: setup.dialect.rules(),
            stand_alone: setup.stand_alone,
            user_codes: setup.user_codes.clone(),
            cycles: setup.cycles,
            recording: None,
            remarks: Vec::new(),
        };
        // where none was called yet LinuxCNC's stand-alone interpreter believes in the first pocket
        new.state.current_pocket = u32::from(setup.stand_alone);
        new.state.retract_to_initial = new.rules.starts_at_initial_level;
        new.load_offsets();
        let machine = crate::frame::machine_point(&setup.start);
        new.state.at = new.state.frame.to_program(&machine);
        new
    }

    pub(crate) fn values(&self) -> Values<'_> {
        Values { store: &self.store, state: &self.state }
    }

    #[inline]
    pub(crate) fn say<S: Sink>(&self, sink: &mut S, call: &Call<'_>) {
        if self.compensating {
            self.say_behind(sink, call);
        } else {
            sink.call(&self.words.place, call);
        }
    }

    /// What is said before the first block.
    pub(crate) fn begin<S: Sink>(&self, sink: &mut S) {
        let frame = &self.state.frame;
        self.say(sink, &Call::UseUnits(self.state.units));
        self.say(sink, &Call::WorkOffset(self.state.system, frame.origin));
        self.say(sink, &Call::AddedOffset(frame.added));
        self.say(sink, &Call::Rotation(frame.rotation()));
        self.say(sink, &Call::FeedReference);
        self.say(sink, &Call::Reset);
    }

    /// Read a block's words.
    pub(crate) fn read(&mut self, block: &Block) -> Outcome {
        self.state.line = block.span.line;
        let values = Values { store: &self.store, state: &self.state };
        self.words.read(block, &values)
    }

    /// Execute the words read.
    pub(crate) fn execute<S: Sink>(&mut self, sink: &mut S) -> Outcome<After> {
        if self.cam(sink)? || self.hobbing(sink)? {
            return self.stops(sink);
        }
        let motion = self.motion()?;
        if self.motion_is_in_doubt() {
            self.follow(sink);
            return self.stops(sink);
        }
        self.non_stop_change()?;
        self.obey(motion, sink)
    }

    fn obey<S: Sink>(&mut self, motion: Option<Motion>, sink: &mut S) -> Outcome<After> {
        let before = self.words.m(MGroup::Tool).map(|_| self.state.place());
        self.words.check_letters(motion.map_or(0, letters_of), self.letters_beside(motion))?;
        let words = &self.words;
        if words.has_codes() || words.any(crate::codes::set("STF")) {
            if self.compensating || words.g(GGroup::Compensation).is_some() {
                self.check_compensated()?;
            }
            // of the lines of a long program many name their motion, and nothing else
            let modes = self.words.has_modes();
            if modes || self.words.any(crate::codes::set("STF$")) {
                self.words.stage = Stage::Feed;
                self.feed_mode(sink)?;
                self.words.stage = Stage::Speed;
                self.spindle_speed(sink)?;
                self.words.stage = Stage::Tools;
                self.tools_and_switches(sink)?;
            }
            self.words.stage = Stage::Rigid;
            self.rigid_mode(motion)?;
            if modes {
                self.words.stage = Stage::Modes;
                self.modes(sink)?;
                self.words.stage = Stage::NonModal;
                self.non_modal(sink)?;
            }
        }
        self.words.stage = Stage::Motion;
        if let Some(motion) = motion {
            self.rigid_motion(motion)?;
            self.move_along(motion, sink)?;
        }
        self.words.stage = Stage::Done;
        if let Some(before) = &before {
            self.ask_where(motion, before);
        }
        if self.recording.is_some() {
            return Ok(After::Profile(self.words.whole(b'Q', 999_999_999)?.unwrap_or(0)));
        }
        self.stops(sink)
    }

    /// Which motion this block asks for: its own code, or the one in force if there are axis words for it.
    pub(crate) fn motion(&self) -> Outcome<Option<Motion>> {
        let words = &self.words;
        let axes = words.any(AXES | POLAR);
        let uses_axes = matches!(
            words.g(GGroup::NonModal),
            Some(100 | 280 | 300 | 513 | 520 | 920 | NON_STOP_CHANGE)
        ) || matches!(words.g(GGroup::ToolLength), Some(431 | 432));
        if let Some(code) = words.g(GGroup::Motion) {
            let motion = Motion::from_code(code);
            if axes && uses_axes && motion != Motion::None {
                let text = "two codes of this block both want the axis words";
                let help = "write the offset or reference code in a block of its own";
                return Err(error("I0111", words.place.span, text).with_help(help).into());
            }
            return Ok(Some(motion));
        }
        let arc = matches!(self.state.motion, Motion::ArcClockwise | Motion::ArcCounterclockwise);
        let wanted = axes && !uses_axes || arc && words.any(CENTRE);
        Ok((wanted && self.state.motion != Motion::None).then_some(self.state.motion))
    }

    fn move_along<S: Sink>(&mut self, motion: Motion, sink: &mut S) -> Outcome {
        let machine_coordinates = self.words.g(GGroup::NonModal) == Some(530);
        if machine_coordinates && !matches!(motion, Motion::Rapid | Motion::Feed) {
            return refuse("I0401", self.words.place.span, "G53 goes with G0 or G1 only");
        }
        if !matches!(motion, Motion::Cycle(_)) {
            self.state.sticky = None;
            self.state.initial = None;
        } else if motion != self.state.motion {
            self.state.sticky = None;
        }
        if self.compensating && !motion.can_be_beside() && motion != Motion::None {
            return self.no_compensation();
        }
        if !matches!(motion, Motion::Nurbs | Motion::NurbsEnd) {
            self.check_nurbs_ended()?;
        }
        if motion != Motion::CubicSpline {
            self.state.spline_leaves = None;
        }
        if self.state.left_beside.is_some() {
            self.leave_compensation(motion)?;
        }
        match motion {
            Motion::None => {
                self.cycle_off(sink);
                return Ok(());
            }
            Motion::Rapid | Motion::Feed => self.straight(motion, machine_coordinates, sink)?,
            Motion::ArcClockwise | Motion::ArcCounterclockwise => self.arc(motion, sink)?,
            Motion::CubicSpline | Motion::QuadraticSpline => self.spline(motion, sink)?,
            Motion::Nurbs => self.nurbs_point(sink)?,
            Motion::NurbsEnd => return self.nurbs_end(sink),
            Motion::Probe(digit) => self.probe(digit, sink)?,
            Motion::Thread => self.thread(sink)?,
            Motion::RigidTap => self.rigid_tap(sink)?,
            Motion::ThreadCycle => self.thread_cycle(sink)?,
            Motion::Turning(code) => return self.turning(code, sink),
            Motion::Cycle(cycle) => self.cycle(cycle, sink)?,
        }
        self.state.motion = motion;
        Ok(())
    }

    /// After a tool change the machine is asked where it stands, beside its way or not. A machine knows its
    /// offsets; what answers LinuxCNC's stand-alone interpreter knows the words of the last move only.
    fn ask_where(&mut self, motion: Option<Motion>, before: &crate::frame::Point) {
        if self.stand_alone && motion.is_none_or(|motion| motion == Motion::None) {
            self.state.at = *before;
        } else {
            self.state.at = self.state.place();
        }
        self.state.left_beside = None;
    }

    fn cycle_off<S: Sink>(&mut self, sink: &mut S) {
        self.hobbing_end(sink);
        self.say(sink, &Call::Note("motion mode set to none"));
        self.state.motion = Motion::None;
    }

    /// Plane, units, offsets and the other modes, in order.
    fn modes<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        self.plane(sink);
        self.units(sink);
        self.diameter(sink);
        self.compensation(sink)?;
        self.tool_length(sink)?;
        self.work_offset(sink);
        self.path_control(sink)?;
        self.distances(sink);
        Ok(())
    }

    /// G17, G18, G19.
    pub(crate) fn plane<S: Sink>(&mut self, sink: &mut S) {
        if let Some(code) = self.words.g(GGroup::Plane) {
            self.state.plane = match code {
                180 => Plane::ZX,
                190 => Plane::YZ,
                _ => Plane::XY,
            };
            self.say(sink, &Call::SelectPlane(self.state.plane));
        }
    }

    /// G7, G8.
    pub(crate) fn diameter<S: Sink>(&mut self, sink: &mut S) {
        let diameter = self.words.g(GGroup::Diameter).map(|code| code == 70);
        if let Some(diameter) = diameter.filter(|d| *d != self.state.diameter) {
            self.set_diameter(diameter, sink);
        }
    }

    /// G90 G91, G90.1 G91.1, G98 G99.
    pub(crate) fn distances<S: Sink>(&mut self, sink: &mut S) {
        let words = &self.words;
        let incremental = words.g(GGroup::Distance).map_or(self.state.incremental, |c| c == 910);
        let absolute_centres =
            words.g(GGroup::ArcDistance).map_or(self.state.absolute_centres, |c| c == 901);
        let retract = words.g(GGroup::Retract);
        self.set_distances(incremental, absolute_centres, sink);
        if let Some(code) = retract {
            self.set_retract(code == 980, sink);
        }
    }

    /// Where they differ from what is in force.
    pub(crate) fn set_distances<S: Sink>(
        &mut self,
        incremental: bool,
        absolute_centres: bool,
        sink: &mut S,
    ) {
        if incremental != self.state.incremental {
            self.state.incremental = incremental;
            let note = if incremental {
                "distance mode changed to incremental"
            } else {
                "distance mode changed to absolute"
            };
            self.say(sink, &Call::Note(note));
        }
        if absolute_centres != self.state.absolute_centres {
            self.state.absolute_centres = absolute_centres;
            let note = if absolute_centres {
                "IJK distance mode changed to absolute"
            } else {
                "IJK distance mode changed to incremental"
            };
            self.say(sink, &Call::Note(note));
        }
    }

    /// G7 (true), G8.
    pub(crate) fn set_diameter<S: Sink>(&mut self, diameter: bool, sink: &mut S) {
        self.state.diameter = diameter;
        let note = if diameter {
            "Lathe diameter mode changed to diameter"
        } else {
            "Lathe diameter mode changed to radius"
        };
        self.say(sink, &Call::Note(note));
    }

    /// G98 (true), G99.
    pub(crate) fn set_retract<S: Sink>(&mut self, to_initial: bool, sink: &mut S) {
        self.state.retract_to_initial = to_initial;
        let note =
            if to_initial { "retract mode set to old_z" } else { "retract mode set to r_plane" };
        self.say(sink, &Call::Note(note));
    }

    fn stops<S: Sink>(&mut self, sink: &mut S) -> Outcome<After> {
        match self.words.m(MGroup::Stop) {
            Some(2 | 30) => {
                if let Err(fault) = self.check_nurbs_ended() {
                    self.remarks.push(*fault); // the program ends all the same
                }
                self.compensation_off(sink)?;
            }
            Some(0 | 1 | 60) => self.let_go(sink),
            _ => {}
        }
        match self.words.m(MGroup::Stop) {
            None => {}
            Some(0) => self.say(sink, &Call::Stop),
            Some(1) => self.say(sink, &Call::OptionalStop),
            Some(60) => {
                self.say(sink, &Call::PalletShuttle);
                self.say(sink, &Call::Stop);
            }
            Some(98) => {
                let Some(number) = self.words.whole(b'P', 999_999_999)? else {
                    return refuse(
                        "I0302",
                        self.words.place.span,
                        "M98 needs P, the number of the subprogram",
                    );
                };
                let repeats = self.words.whole(b'L', 1_000_000)?.unwrap_or(1);
                return Ok(After::Call(number, repeats));
            }
            Some(99) => return Ok(After::Return),
            Some(end) => {
                self.end(end == 30, sink);
                return Ok(After::End);
            }
        }
        Ok(After::Next)
    }

    /// M2, M30: modes go back to where a program begins.
    pub(crate) fn end<S: Sink>(&mut self, rewind: bool, sink: &mut S) {
        self.select_system(1);
        let frame = self.state.frame;
        self.say(sink, &Call::WorkOffset(1, frame.origin));
        self.say(sink, &Call::Rotation(frame.rotation()));
        if self.state.plane != Plane::XY {
            self.state.plane = Plane::XY;
            self.say(sink, &Call::SelectPlane(Plane::XY));
        }
        self.say(sink, &Call::FeedMode { per_revolution: false });
        self.say(sink, &Call::FeedRate { rate: 0.0, duration_s: None });
        if !self.state.feed_override {
            self.say(sink, &Call::FeedOverride(true));
        }
        self.state.spindle.turning = None;
        self.say(sink, &Call::SpindleStop);
        self.say(sink, &Call::SpindleMode(0.0));
        if self.state.mist {
            self.say(sink, &Call::Mist(false));
        }
        if self.state.flood {
            self.say(sink, &Call::Flood(false));
        }
        if rewind {
            self.say(sink, &Call::PalletShuttle);
        }
        self.say(sink, &Call::End);
    }
}

/// The letters that a motion in force takes from a block without its code.
fn letters_of(motion: Motion) -> crate::codes::Letters {
    match motion {
        Motion::None => 0,
        motion => crate::codes::g_code(motion.code()).map_or(0, |code| code.letters),
    }
}
