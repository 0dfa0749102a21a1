//! Codes that hold for their block alone: G10, G28, G30, G52, G92 and their kin, in one dispatch.

use crate::{
    auxiliary::tool_change,
    call::{Call, Sink, out::Out},
    codes::{GGroup, NON_STOP_CHANGE},
    coordinates::{
        offsets::{self, ADDED},
        target, tool_table,
    },
    cycles::polygon,
    fault::{Outcome, error, refuse},
    geometry::frame::{Frame, Point},
    modes::Modes,
    setup::Parameters,
    state::executor::Executor,
    words::Words,
};
/// G10, G28, G30, G52, G92 and their kin.
pub(crate) fn non_modal<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome {
    match ex.words.g(GGroup::NonModal) {
        Some(100) => set_offset(ex, out),
        Some(280) => offsets::go_to_reference(&ex.words, &mut ex.modes, &ex.store, 5161, out),
        Some(300) => offsets::go_to_reference(&ex.words, &mut ex.modes, &ex.store, 5181, out),
        Some(281) => {
            offsets::set_reference(&ex.modes, &mut ex.store, 5161);
            Ok(())
        }
        Some(301) => {
            offsets::set_reference(&ex.modes, &mut ex.store, 5181);
            Ok(())
        }
        Some(520) if !ex.words.any(crate::codes::AXES) => {
            refuse("I0619", ex.words.place.span, "G52 needs axis words: the offset to add")
        }
        Some(520) => {
            let added = target::with_words(&ex.words, &ex.modes, ex.modes.frame.added);
            offsets::set_added(&mut ex.modes, &mut ex.store, added, out);
            Ok(())
        }
        Some(920) => offsets::set_position(&ex.words, &mut ex.modes, &mut ex.store, out),
        Some(921) => {
            offsets::write_point(&ex.modes, &mut ex.store, ADDED, [0.0; 9]);
            offsets::suspend_added(&mut ex.modes, &mut ex.store, out);
            Ok(())
        }
        Some(922) => {
            offsets::suspend_added(&mut ex.modes, &mut ex.store, out);
            Ok(())
        }
        Some(923) => {
            let added = offsets::read_point(&ex.modes, &ex.store, ADDED);
            offsets::set_added(&mut ex.modes, &mut ex.store, added, out);
            Ok(())
        }
        Some(NON_STOP_CHANGE) => {
            tool_change::non_stop_move(&ex.words, &mut ex.modes, &ex.tools, out)
        }
        Some(502) => {
            polygon::polygon_end(&ex.words, &mut ex.modes, out);
            Ok(())
        }
        Some(512) => polygon::polygon(&ex.words, &mut ex.modes, &ex.tools, out),
        Some(513) => polygon::harmonic(&ex.words, &mut ex.modes),
        Some(514) => polygon::polygon_measure(&ex.words, &ex.modes, out),
        Some(530) if ex.words.g(GGroup::Motion).is_none() => lonely_g53(&ex.words, &ex.modes),
        _ => Ok(()),
    }
}

pub(crate) fn lonely_g53(words: &Words, modes: &Modes) -> Outcome {
    let moves = matches!(modes.motion, crate::modes::Motion::Rapid | crate::modes::Motion::Feed);
    if moves && words.any(crate::codes::AXES) {
        return Ok(());
    }
    refuse(
        "I0405",
        words.place.span,
        "G53 needs G0 or G1 and axis words: it is good for its own block only",
    )
}

/// G10 L2 (the offset itself) and L20 (this place shall be called what the words say).
pub(crate) fn set_offset<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome {
    let span = ex.words.place.span;
    let kind = match ex.words.whole(b'L', 9999)? {
        Some(kind @ (2 | 20)) => kind,
        Some(kind @ (0 | 1 | 10 | 11)) => return tool_table::set_tool(ex, kind, out),
        Some(kind) => tool_table::unknown_g10(&ex.words, kind)?,
        None => {
            return refuse(
                "I0616",
                span,
                "G10 needs L: 1, 10, 11 (tool table), 2 or 20 (work offset)",
            );
        }
    };
    let Some(p) = ex.words.whole(b'P', 9)? else {
        return refuse(
            "I0617",
            span,
            "G10 needs P: 1 to 9 for G54 to G59.3, 0 for the one in force",
        );
    };
    let system = if p == 0 { ex.modes.system } else { p as u8 };
    if ex.modes.compensating() && system == ex.modes.system {
        let text =
            "the work offset in force cannot be changed while cutter radius compensation is on";
        return Err(error("I0544", span, text).with_help("write G40 before").into());
    }
    let (mut origin, mut rotation) = offsets::offset_of(&ex.modes, &ex.store, usize::from(system));
    if kind == 2 {
        origin = target::with_words(&ex.words, &ex.modes, origin);
        rotation = ex.words.get(b'R').unwrap_or(rotation);
    } else {
        if ex.words.get(b'R').is_some() {
            let fault = error("I0618", ex.words.span(b'R'), "R has no effect with G10 L20");
            return Err(fault.with_help("G10 L2 R sets the rotation").into());
        }
        origin = origin_by_position(&ex.words, &ex.modes, origin, rotation);
    }
    let first = Parameters::work_offset(usize::from(system));
    offsets::write_point(&ex.modes, &mut ex.store, first, origin);
    ex.store.numbered.set(first + 9, rotation);
    offsets::add_external(&ex.modes, &ex.store, &ex.settings, &mut origin);
    if system == ex.modes.system {
        ex.modes.reframe(|frame| {
            frame.origin = origin;
            frame.rotate(rotation);
        });
        out.say(&Call::WorkOffset(system, origin));
        out.say(&Call::Rotation(rotation));
    } else {
        out.say(&Call::Note("setting coordinate system origin"));
    }
    Ok(())
}

/// The origin that a work offset must have for this place to be called what the words say.
pub(crate) fn origin_by_position(
    words: &Words,
    modes: &Modes,
    origin: Point,
    rotation: f64,
) -> Point {
    let machine = modes.frame.to_machine(&modes.at);
    let mut frame: Frame = modes.frame;
    frame.origin = origin;
    frame.rotate(rotation);
    let wanted = target::with_words(words, modes, frame.to_program(&machine));
    frame.origin = [0.0; 9];
    let without = frame.to_machine(&wanted);
    core::array::from_fn(|i| machine[i] - without[i])
}
