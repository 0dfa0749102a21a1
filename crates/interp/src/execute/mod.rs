//! One block, executed: what is done in which order.
//!
//! ```text
//!   comments → F mode, F → S mode, S → T → M6 → M3 M4 M5 M19 → coolant → overrides → G4
//!     → plane → units → G40 → tool length → work offset → path control → G90 G91 → G98 G99
//!     → G10 G28 G30 G52 G92 → motion → M0 M1 M2 M30 M60
//! ```
//!
//! The order is the language's, not the text's: `G1 X1 M3 S500` starts the spindle first.
//! ```text
//!   begin       where a program begins
//!   non_modal   codes that hold for their block alone
//!   lenient     what other controls take in another way, or without effect
//!   forbidden   what cannot be ordered while the tool is kept beside the path
//!   refused     what follows from a block that was refused
//! ```
//!
//! Source: NISTIR 6556 table 8; LinuxCNC 2.9 manual, "Order of execution".
pub(crate) mod begin;
pub(crate) mod forbidden;
pub(crate) mod lenient;
pub(crate) mod non_modal;
pub(crate) mod refused;

use crate::{
    auxiliary::{self, switch, tool_change},
    call::{Call, Sink, out::Out},
    codes::{AXES, CENTRE, GGroup, MGroup, NON_STOP_CHANGE, POLAR},
    compensation,
    coordinates::{distances, offsets},
    cycles::{
        cam, hobbing,
        holes::{self, chip_removal, rigid},
        thread_cycle, turning,
    },
    fault::{Outcome, error, refuse},
    modes::{Modes, Motion},
    motion::{self, arcs, probe, splines, threads},
    state::executor::{Executor, Settings},
    words::{Stage, Words, eval::Values, names::Store},
};
use canon::Plane;
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

/// Read a block's words.
#[inline]
pub(crate) fn read(words: &mut Words, modes: &mut Modes, store: &Store, block: &Block) -> Outcome {
    modes.line = block.span.line;
    let values = Values { store, modes };
    words.read(block, &values)
}

/// Execute the words read.
#[inline]
pub(crate) fn execute<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome<After> {
    if cam::cam(&ex.words, &mut ex.modes, &ex.settings, out)?
        || hobbing::hobbing(&ex.words, &mut ex.modes, out)?
    {
        return stops(&ex.words, &mut ex.modes, &mut ex.store, &ex.settings, out);
    }
    if ex.settings.rules.dwells_by_s {
        lenient::dwell_by_s(ex)?;
    }
    let motion = motion(&ex.words, &ex.modes)?;
    if refused::motion_is_unknown(&ex.words, &ex.modes) {
        refused::follow(ex, out);
        return stops(&ex.words, &mut ex.modes, &mut ex.store, &ex.settings, out);
    }
    tool_change::non_stop_change(&mut ex.words, &ex.modes)?;
    obey(ex, motion, out)
}

#[inline]
fn obey<S: Sink>(
    ex: &mut Executor,
    motion: Option<Motion>,
    out: &mut Out<'_, S>,
) -> Outcome<After> {
    let before = ex.words.m(MGroup::Tool).map(|_| ex.modes.place());
    let modal = motion.map_or(0, letters_of);
    let beside = chip_removal::letters_beside(&ex.settings, motion);
    if ex.settings.rules.has_laser {
        lenient::remark_on_laser(ex);
    }
    if ex.words.outdone.is_some() {
        lenient::remark_on_outdone(ex);
    }
    if ex.settings.rules.needs_axis_words {
        lenient::block_number(&ex.words)?;
        lenient::remark_on_lacking(ex);
    }
    if let Some(span) = ex.words.ends_scaling {
        lenient::remark_on_scaling(ex, span);
    }
    if ex.settings.rules.idle != 0 {
        lenient::drop_idle(ex, modal | beside);
    }
    ex.words.check_letters(modal, beside)?;
    let words = &ex.words;
    if words.has_codes() || words.any(crate::codes::set("STF")) {
        if ex.modes.compensating() || words.g(GGroup::Compensation).is_some() {
            forbidden::check_compensated(&ex.words, &ex.modes, &ex.settings)?;
        }
        // of the lines of a long program many name their motion, and nothing else
        let modes = ex.words.has_modes();
        if modes || ex.words.any(crate::codes::set("STF$")) {
            ex.words.stage = Stage::Feed;
            switch::feed_mode(&ex.words, &mut ex.modes, out)?;
            ex.words.stage = Stage::Speed;
            switch::spindle_speed(&ex.words, &mut ex.modes, &ex.settings, out)?;
            ex.words.stage = Stage::Tools;
            auxiliary::tools_and_switches(ex, out)?;
        }
        ex.words.stage = Stage::Rigid;
        rigid::rigid_mode(&ex.words, &mut ex.modes, motion)?;
        if modes {
            ex.words.stage = Stage::Modes;
            change_modes(ex, out)?;
            ex.words.stage = Stage::NonModal;
            non_modal::non_modal(ex, out)?;
        }
    }
    ex.words.stage = Stage::Motion;
    if ex.settings.leaves.feed.is_some() {
        lenient::assume_feed(ex, motion, out);
    }
    if let Some(motion) = motion {
        rigid::rigid_motion(&ex.words, &mut ex.modes, motion)?;
        move_along(ex, motion, out)?;
    }
    ex.words.stage = Stage::Done;
    if let Some(before) = &before {
        ask_where(&mut ex.modes, &ex.settings, motion, before);
    }
    if ex.recording.is_some() {
        return Ok(After::Profile(ex.words.whole(b'Q', 999_999_999)?.unwrap_or(0)));
    }
    stops(&ex.words, &mut ex.modes, &mut ex.store, &ex.settings, out)
}

/// Which motion this block asks for: its own code, or the one in force if there are axis words for
/// it.
#[inline]
pub(crate) fn motion(words: &Words, modes: &Modes) -> Outcome<Option<Motion>> {
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
    let arc = matches!(modes.motion, Motion::ArcClockwise | Motion::ArcCounterclockwise);
    let wanted = axes && !uses_axes || arc && words.any(CENTRE);
    Ok((wanted && modes.motion != Motion::None).then_some(modes.motion))
}

fn move_along<S: Sink>(ex: &mut Executor, motion: Motion, out: &mut Out<'_, S>) -> Outcome {
    let machine_coordinates = ex.words.g(GGroup::NonModal) == Some(530);
    if machine_coordinates && !matches!(motion, Motion::Rapid | Motion::Feed) {
        return refuse("I0401", ex.words.place.span, "G53 goes with G0 or G1 only");
    }
    if !matches!(motion, Motion::Cycle(_)) {
        ex.modes.sticky = None;
        ex.modes.initial = None;
    } else if motion != ex.modes.motion {
        ex.modes.sticky = None;
    }
    if ex.modes.compensating() && !motion.can_be_beside() && motion != Motion::None {
        return compensation::no_compensation(&ex.words);
    }
    if !matches!(motion, Motion::Nurbs | Motion::NurbsEnd) {
        splines::check_nurbs_ended(&ex.words, &mut ex.modes)?;
    }
    if motion != Motion::CubicSpline {
        ex.modes.spline_leaves = None;
    }
    if ex.modes.left_beside.is_some() {
        compensation::leave_compensation(&ex.words, &mut ex.modes, motion)?;
    }
    match motion {
        Motion::None => {
            cycle_off(&mut ex.modes, out);
            return Ok(());
        }
        Motion::Rapid | Motion::Feed => motion::straight(
            &ex.words,
            &mut ex.modes,
            &ex.settings,
            motion,
            machine_coordinates,
            out,
        )?,
        Motion::ArcClockwise | Motion::ArcCounterclockwise => {
            arcs::arc(&ex.words, &mut ex.modes, motion, out)?;
        }
        Motion::CubicSpline | Motion::QuadraticSpline => {
            splines::spline(&ex.words, &mut ex.modes, motion, out)?;
        }
        Motion::Nurbs => splines::nurbs_point(&ex.words, &mut ex.modes, out)?,
        Motion::NurbsEnd => return splines::nurbs_end(&ex.words, &mut ex.modes, out),
        Motion::Probe(digit) => {
            probe::probe(&ex.words, &mut ex.modes, &mut ex.store, &ex.settings, digit, out)?;
        }
        Motion::Thread => threads::thread(&ex.words, &mut ex.modes, &ex.settings, out)?,
        Motion::RigidTap => threads::rigid_tap(&ex.words, &ex.modes, out)?,
        Motion::ThreadCycle => thread_cycle::thread_cycle(&ex.words, &mut ex.modes, out)?,
        Motion::Turning(code) => return turning::turning(ex, code, out),
        Motion::Cycle(cycle) => {
            holes::cycle(&ex.words, &mut ex.modes, &ex.tools, &ex.settings, cycle, out)?;
        }
    }
    ex.modes.motion = motion;
    Ok(())
}

/// After a tool change the machine is asked where it stands, beside its way or not. A machine knows
/// its offsets; what answers LinuxCNC's stand-alone interpreter knows the words of the last move
/// only.
fn ask_where(
    modes: &mut Modes,
    settings: &Settings,
    motion: Option<Motion>,
    before: &crate::geometry::frame::Point,
) {
    if settings.stand_alone && motion.is_none_or(|motion| motion == Motion::None) {
        modes.at = *before;
    } else {
        modes.at = modes.place();
    }
    modes.left_beside = None;
}

fn cycle_off<S: Sink>(modes: &mut Modes, out: &mut Out<'_, S>) {
    hobbing::hobbing_end(modes, out);
    out.say(&Call::Note("motion mode set to none"));
    modes.motion = Motion::None;
}

/// Plane, units, offsets and the other modes, in order.
fn change_modes<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome {
    distances::plane(&ex.words, &mut ex.modes, out);
    switch::units(&ex.words, &mut ex.modes, out);
    distances::diameter(&ex.words, &mut ex.modes, out);
    compensation::compensation(&ex.words, &mut ex.modes, &mut ex.tools, out)?;
    offsets::tool_length(&ex.words, &mut ex.modes, &mut ex.tools, out)?;
    offsets::work_offset(&ex.words, &mut ex.modes, &mut ex.store, &ex.settings, out);
    switch::path_control(&ex.words, &mut ex.modes, out)?;
    distances::distances(&ex.words, &mut ex.modes, out);
    Ok(())
}

fn stops<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    store: &mut Store,
    settings: &Settings,
    out: &mut Out<'_, S>,
) -> Outcome<After> {
    match words.m(MGroup::Stop) {
        Some(2 | 30) => {
            if let Err(fault) = splines::check_nurbs_ended(words, modes) {
                out.remarks.push(*fault); // the program ends all the same
            }
            compensation::compensation_off(words, modes, out)?;
        }
        Some(0 | 1 | 60) => out.let_go(),
        _ => {}
    }
    match words.m(MGroup::Stop) {
        None => {}
        Some(0) => out.say(&Call::Stop),
        Some(1) => out.say(&Call::OptionalStop),
        Some(60) => {
            out.say(&Call::PalletShuttle);
            out.say(&Call::Stop);
        }
        Some(98) => {
            let Some(number) = words.whole(b'P', 999_999_999)? else {
                return refuse(
                    "I0302",
                    words.place.span,
                    "M98 needs P, the number of the subprogram",
                );
            };
            let repeats = words.whole(b'L', 1_000_000)?.unwrap_or(1);
            return Ok(After::Call(number, repeats));
        }
        Some(99) => return Ok(After::Return),
        Some(end) => {
            end_program(modes, store, settings, end == 30, out);
            return Ok(After::End);
        }
    }
    Ok(After::Next)
}

/// M2, M30: modes go back to where a program begins.
pub(crate) fn end_program<S: Sink>(
    modes: &mut Modes,
    store: &mut Store,
    settings: &Settings,
    rewind: bool,
    out: &mut Out<'_, S>,
) {
    offsets::select_system(modes, store, settings, 1);
    let frame = modes.frame;
    out.say(&Call::WorkOffset(1, frame.origin));
    out.say(&Call::Rotation(frame.rotation()));
    if modes.plane != Plane::XY {
        modes.plane = Plane::XY;
        out.say(&Call::SelectPlane(Plane::XY));
    }
    out.say(&Call::FeedMode { per_revolution: false });
    out.say(&Call::FeedRate { rate: 0.0, duration_s: None });
    if !modes.feed_override {
        out.say(&Call::FeedOverride(true));
    }
    modes.spindle.turning = None;
    out.say(&Call::SpindleStop);
    out.say(&Call::SpindleMode(0.0));
    if modes.mist {
        out.say(&Call::Mist(false));
    }
    if modes.flood {
        out.say(&Call::Flood(false));
    }
    if rewind {
        out.say(&Call::PalletShuttle);
    }
    out.say(&Call::End);
}

/// The letters that a motion in force takes from a block without its code.
fn letters_of(motion: Motion) -> crate::codes::Letters {
    match motion {
        Motion::None => 0,
        motion => crate::codes::g_code(motion.code()).map_or(0, |code| code.letters),
    }
}
