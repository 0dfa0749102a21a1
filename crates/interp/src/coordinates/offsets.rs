//! Offsets: G10, G43, G49, G52, G54 … G59.3, G92, and the reference points of G28 and G30.
//!
//! Setting an offset moves nothing: the axes stand where they stand, and the program's name for
//! that place changes ([`Modes::reframe`](crate::modes::Modes::reframe)). Offsets are kept in the
//! program's units and in the numbered parameters (mm), as LinuxCNC does, so that `#5221` reads
//! G54's X.
use crate::{
    call::{Call, Sink, out::Out},
    codes::GGroup,
    compensation::compensation_off,
    coordinates::target,
    fault::{Outcome, refuse},
    geometry::frame::{self, Point},
    modes::{Modes, compensation::Compensation},
    setup::Parameters,
    state::{executor::Settings, tools::Tools},
    words::{Words, names::Store},
};

/// First parameter of the G92 offset, and the one that says whether it is on.
pub(crate) const ADDED: usize = 5211;
const ADDED_ON: usize = 5210;
/// Work offset in force.
const SYSTEM: usize = 5220;

/// Offsets as the parameters have them, at the beginning.
pub(crate) fn load_offsets(modes: &mut Modes, store: &mut Store, settings: &Settings) {
    let system = store.numbered.at(SYSTEM);
    let most = if has_external_offset(settings) { 108.0 } else { 9.0 };
    let system = if (1.0..=most).contains(&system) { system as u8 } else { 1 };
    if store.numbered.at(ADDED_ON) != 0.0 {
        modes.frame.added = read_point(modes, store, ADDED);
    }
    select_system(modes, store, settings, system);
}

/// Make a work offset the one in force.
pub(crate) fn select_system(modes: &mut Modes, store: &mut Store, settings: &Settings, system: u8) {
    let (mut origin, rotation) = offset_of(modes, store, usize::from(system));
    add_external(modes, store, settings, &mut origin);
    modes.system = system;
    store.numbered.set(SYSTEM, f64::from(system));
    modes.reframe(|frame| {
        frame.origin = origin;
        frame.rotate(rotation);
    });
}

fn has_external_offset(settings: &Settings) -> bool {
    settings.rules.external_offset
}

/// Fanuc's external work offset lies under all others.
pub(crate) fn add_external(modes: &Modes, store: &Store, settings: &Settings, origin: &mut Point) {
    if has_external_offset(settings) {
        let external = read_point(modes, store, Parameters::work_offset(0));
        for axis in 0..6 {
            origin[axis] += external[axis];
        }
    }
}

/// A work offset (0 is the external one) has other values now.
pub(crate) fn offset_changed<S: Sink>(
    modes: &mut Modes,
    store: &mut Store,
    settings: &Settings,
    system: usize,
    out: &mut Out<'_, S>,
) {
    if system == usize::from(modes.system) || system == 0 {
        select_system(modes, store, settings, modes.system);
        let origin = modes.frame.origin;
        out.say(&Call::WorkOffset(modes.system, origin));
    }
}

/// Offset (program units) and rotation (degrees) of a work offset.
pub(crate) fn offset_of(modes: &Modes, store: &Store, system: usize) -> (Point, f64) {
    let first = Parameters::work_offset(system);
    (read_point(modes, store, first), store.numbered.at(first + 9))
}

/// Nine parameters, lengths in program units.
pub(crate) fn read_point(modes: &Modes, store: &Store, first: usize) -> Point {
    let mut point = store.numbered.point(first);
    frame::scale(&mut point, 1.0 / modes.units.in_mm());
    point
}

pub(crate) fn write_point(modes: &Modes, store: &mut Store, first: usize, mut point: Point) {
    frame::scale(&mut point, modes.units.in_mm());
    store.numbered.set_point(first, &point);
}

/// G43, G43.1, G43.2, G49.
pub(crate) fn tool_length<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    tools: &mut Tools,
    out: &mut Out<'_, S>,
) -> Outcome {
    let Some(code) = words.g(GGroup::ToolLength) else { return Ok(()) };
    let mut tool = [0.0; 9];
    match code {
        430 => {
            let number = if words.get(b'H').is_some() {
                tools.word(words, b'H')?
            } else {
                modes.current_tool
            };
            tool = length_offset(modes, tools, number);
        }
        crate::codes::LENGTH_BACK => {
            let number = tools.word(words, b'H')?;
            tool = length_offset(modes, tools, number).map(|offset| -offset);
        }
        432 => {
            let more = additional_offset(words, modes, tools)?;
            for (sum, (kept, more)) in tool.iter_mut().zip(modes.frame.tool.iter().zip(more)) {
                *sum = kept + more;
            }
        }
        431 if words.rules().needs_axis_words && !words.any(crate::codes::AXES) => {
            let text =
                "G43.1 needs an axis word, the length itself: Grbl answers error 37 without one";
            return refuse("I0435", words.place.span, text);
        }
        431 => tool = target::with_words(words, modes, modes.frame.tool),
        _ => {}
    }
    modes.reframe(|frame| frame.tool = tool);
    out.say(&Call::ToolOffset(tool));
    Ok(())
}

/// What the table says of a tool, in program units.
fn length_offset(modes: &Modes, tools: &Tools, number: u32) -> Point {
    let mut tool = tools.entry(number).offset;
    frame::scale(&mut tool, 1.0 / modes.units.in_mm());
    tool
}

/// G43.2: of a tool, or of the axis words.
fn additional_offset(words: &Words, modes: &Modes, tools: &mut Tools) -> Outcome<Point> {
    let by_words = words.any(crate::codes::AXES);
    match (words.get(b'H').is_some(), by_words) {
        (true, false) => {
            let number = tools.word(words, b'H')?;
            Ok(length_offset(modes, tools, number))
        }
        (false, true) => Ok(target::with_words(words, modes, [0.0; 9])),
        (both, _) => {
            let found = if both { "both" } else { "neither" };
            let text = format!(
                "G43.2 needs H, the number of a tool, or axis words with the offset itself; found {found}"
            );
            refuse("I0612", words.place.span, text)
        }
    }
}

/// Number of a work offset by its code: 540 is 1.
pub(crate) const fn system_of(code: u16) -> u8 {
    match code {
        591..=593 => (code - 584) as u8,
        _ => ((code - 530) / 10) as u8,
    }
}

/// G54 … G59.3.
pub(crate) fn work_offset<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    store: &mut Store,
    settings: &Settings,
    out: &mut Out<'_, S>,
) {
    let Some(code) = words.g(GGroup::WorkOffset) else { return };
    let system = system_of(code);
    if system == modes.system {
        out.say(&Call::Note("continuing to use same coordinate system"));
        return;
    }
    change_system(modes, store, settings, system, out);
}

/// Another work offset, and say so.
pub(crate) fn change_system<S: Sink>(
    modes: &mut Modes,
    store: &mut Store,
    settings: &Settings,
    system: u8,
    out: &mut Out<'_, S>,
) {
    select_system(modes, store, settings, system);
    let frame = modes.frame;
    out.say(&Call::WorkOffset(system, frame.origin));
    out.say(&Call::AddedOffset(frame.added));
    out.say(&Call::Rotation(frame.rotation()));
}

/// G92: this place shall be called what the words say.
pub(crate) fn set_position<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    store: &mut Store,
    out: &mut Out<'_, S>,
) -> Outcome {
    if !words.any(crate::codes::AXES) {
        return refuse(
            "I0613",
            words.place.span,
            "G92 needs axis words: what this place shall be called",
        );
    }
    let wanted = target::with_words(words, modes, modes.at);
    let mut added = modes.frame.added;
    for i in 0..9 {
        added[i] += modes.at[i] - wanted[i];
    }
    set_added(modes, store, added, out);
    Ok(())
}

pub(crate) fn set_added<S: Sink>(
    modes: &mut Modes,
    store: &mut Store,
    added: Point,
    out: &mut Out<'_, S>,
) {
    write_point(modes, store, ADDED, added);
    store.numbered.set(ADDED_ON, 1.0);
    modes.reframe(|frame| frame.added = added);
    out.say(&Call::AddedOffset(added));
}

pub(crate) fn suspend_added<S: Sink>(modes: &mut Modes, store: &mut Store, out: &mut Out<'_, S>) {
    store.numbered.set(ADDED_ON, 0.0);
    modes.reframe(|frame| frame.added = [0.0; 9]);
    out.say(&Call::AddedOffset([0.0; 9]));
}

/// G28, G30: by the point of the words (or from where it stands) to the reference point.
pub(crate) fn go_to_reference<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    store: &Store,
    first: usize,
    out: &mut Out<'_, S>,
) -> Outcome {
    let mut by = target::destination(words, modes, false)?;
    let all = !words.any(crate::codes::AXES);
    let moved = |modes: &Modes, axis| all || target::axis_word(words, modes, axis).is_some();
    // the axes that are named end their compensation on the way to the intermediate point; the
    // others stay beside the path
    let paused = modes.compensation.clone();
    if paused.is_some() {
        compensation_off(words, modes, out)?;
        let place = modes.place();
        for axis in (0..9).filter(|axis| !moved(modes, *axis)) {
            by[axis] = place[axis];
        }
        modes.left_beside = None;
    }
    out.say(&Call::Rapid(by));
    let reference = modes.frame.to_program(&read_point(modes, store, first));
    let mut to = by;
    for axis in (0..9).filter(|axis| moved(modes, *axis)) {
        to[axis] = reference[axis];
    }
    modes.at = to;
    out.say(&Call::Rapid(to));
    // behind it the next move of the plane starts up
    modes.compensation = paused.map(|paused| Compensation { at: None, last: None, ..paused });
    Ok(())
}

/// G28.1, G30.1: this place is the reference point from now on.
pub(crate) fn set_reference(modes: &Modes, store: &mut Store, first: usize) {
    let machine = modes.frame.to_machine(&modes.at);
    write_point(modes, store, first, machine);
}
