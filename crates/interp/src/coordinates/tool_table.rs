//! The tool table as the control sees it: G10 L1, L10 and L11 change it, G41 and G43 read it.
//!
//! The tools themselves stay what they are ([`ToolLibrary`](canon::ToolLibrary)); what a program
//! writes is only what the control believes about them.
//!
//! ```text
//!   L1    the words are the offsets themselves
//!   L10   with these offsets (and G43) this place is called what the words say, in the work offset in force
//!   L11   the same in G59.3
//! ```
//!
//! `R` nose radius, `I` and `J` front and back angle, `Q` orientation 0 to 9 (lathe tools).
//!
//! Source: LinuxCNC 2.9 manual, "G10 L1", "G10 L10", "G10 L11".
use crate::{
    call::{Call, Sink, out::Out},
    coordinates::{offsets, target},
    fault::{Outcome, error, refuse},
    geometry::frame::{self, Frame, Point},
    modes::Modes,
    state::executor::Executor,
    words::{Words, names::Store},
};

/// G59.3, which L11 measures in.
const FIXTURE: u8 = 9;

/// G10 L1, L10, L11; L0 reads the table anew, which is as the program has left it.
pub(crate) fn set_tool<S: Sink>(ex: &mut Executor, kind: u32, out: &mut Out<'_, S>) -> Outcome {
    if kind == 0 {
        if ex.modes.current_tool != 0 {
            let text = "G10 L0 reads the tool table anew: the spindle must be empty";
            return Err(error("I0621", ex.words.place.span, text)
                .with_help("write T0 M6 before it")
                .into());
        }
        out.say(&Call::ReloadTools);
        return Ok(());
    }
    if ex.words.get(b'P').is_none() {
        let text = format!("G10 L{kind} needs P, the number of a tool");
        return refuse("I0620", ex.words.place.span, text);
    }
    let number = ex.tools.word(&ex.words, b'P')?;
    if number == 0 {
        let text = "the empty spindle has no entry in the tool table: P is 1 or more";
        return refuse("I0620", ex.words.span(b'P'), text);
    }
    if !ex.words.any(crate::codes::AXES | crate::codes::set("RIJQ")) {
        let text = format!(
            "G10 L{kind} needs what it shall set: axis words, R (the radius), I, J (a lathe tool's angles) or Q (where it points)"
        );
        return refuse("I0622", ex.words.place.span, text);
    }
    let mut entry = ex.tools.entry(number);
    let mm = ex.modes.units.in_mm();
    if kind == 1 {
        frame::scale(&mut entry.offset, 1.0 / mm);
        entry.offset = target::with_words(&ex.words, &ex.modes, entry.offset);
    } else {
        entry.offset = offset_by_position(&ex.words, &ex.modes, &ex.store, kind, entry.offset);
    }
    frame::scale(&mut entry.offset, mm);
    if let Some(radius) = ex.words.get(b'R') {
        entry.diameter = 2.0 * radius * mm;
    }
    entry.front_angle = ex.words.get(b'I').unwrap_or(entry.front_angle);
    entry.back_angle = ex.words.get(b'J').unwrap_or(entry.back_angle);
    entry.orientation = ex.words.whole(b'Q', 9)?.unwrap_or(entry.orientation);
    ex.tools.written.write(entry);
    let rank = ex.tools.library.iter().position(|t| t.number == number).map_or(0, |i| i as u32 + 1);
    out.say(&Call::ToolTableEntry { rank, entry });
    let current = number == ex.modes.current_tool;
    if current {
        ex.modes.loaded = entry;
    }
    if current || ex.settings.stand_alone && ex.tools.pocket(number) == ex.modes.current_pocket {
        out.say(&Call::ToolTableEntry { rank: 0, entry });
    }
    Ok(())
}

/// The tool offset with which this place is called what the words say; program units.
fn offset_by_position(
    words: &Words,
    modes: &Modes,
    store: &Store,
    kind: u32,
    mut offset: Point,
) -> Point {
    frame::scale(&mut offset, 1.0 / modes.units.in_mm());
    let machine = modes.frame.to_machine(&modes.at);
    let mut frame: Frame = modes.frame;
    if kind == 11 {
        let (origin, rotation) = offsets::offset_of(modes, store, usize::from(FIXTURE));
        frame.origin = origin;
        frame.added = [0.0; 9];
        frame.rotate(rotation);
    }
    frame.tool = [0.0; 9];
    let wanted = target::with_words(words, modes, frame.to_program(&machine));
    let without = frame.to_machine(&wanted);
    for (axis, slot) in offset.iter_mut().enumerate() {
        if target::axis_word(words, modes, axis).is_some() || axis < 2 && frame.rotation() != 0.0 {
            *slot = machine[axis] - without[axis];
        }
    }
    offset
}

/// Refuse a number of a `G10 L` that is none.
pub(crate) fn unknown_g10(words: &Words, kind: u32) -> Outcome<u32> {
    let text = format!("G10 takes L0, L1, L2, L10, L11 or L20, found L{kind}");
    Err(error("I0615", words.span(b'L'), text).into())
}
