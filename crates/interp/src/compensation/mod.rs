//! Cutter radius compensation: G40, G41, G41.1, G42, G42.1.
//!
//! ```text
//!   G41: the tool is on the left           outer corner: an arc about it      inner corner: where the
//!                                            ╭─ ─ ─ ─ →                       offset ways meet
//!    ─ ─ ─ ─ ─ ─ ─ ─ ▷  centre               │ ┏━━━━━━                         ━━━━━━━━━┓
//!    ━━━━━━━━━━━━━━━━▷  program              │ ┃                               ─ ─ ─ ┐ ┃
//!                                              ┃                                     ▽ ┃
//! ```
//!
//! The first move after G41 goes straight (or along an arc tangent to the offset one) from where
//! the tool stands to beside the programmed end; it must be longer than the radius. From then on
//! every move of the plane is held back until the next one tells where its end is to be. What is
//! ordered meanwhile (spindle, coolant, feed) waits behind it. Two directions that differ by less
//! than 0.05 rad (2.9°) count as one. With G40 the held move goes to its own end, and the next move
//! must be straight.
//!
//! On a lathe (G18) the tool's orientation 1 to 9 shifts all of it, so that the imagined tip, and
//! not the centre of the nose, is where the program says.
//!
//! Fanuc's start-up is another (type A, as its controls are delivered): the first move goes
//! straight to where the tool stands beside the *beginning of the move that follows*, at right
//! angles to it, however short it is and at whatever angle that one goes on. So a lead-in into a
//! pocket's arc is possible from any side.
//!
//! A corner that the tool cannot reach without cutting into what was programmed before is an error.
//!
//! ```text
//!   lead_in   the first move after G41 and G42
//!   beside    the moves that follow, and the corners between them
//!   push      moves held back until the next one settles their ends
//! ```
//!
//! Source: LinuxCNC 2.9 manual, "Cutter compensation"; NISTIR 6556, appendix B; Fanuc, operator's
//! manual of series 30i for machining centres, "Tool movement in start-up" (type A, SUP of
//! parameter 5003 is 0). Angles, shifts and the order of what is held were measured on LinuxCNC's
//! stand-alone interpreter.
pub(crate) mod beside;
pub(crate) mod lead_in;
pub(crate) mod push;
mod stated;

use crate::{
    call::{Call, Sink, out::Out},
    codes::GGroup,
    compensation::beside::settle,
    fault::{Outcome, error, refuse, unknown::Unknown},
    geometry::offset_curve::{Flat, times},
    modes::{Modes, Motion, compensation::Compensation},
    state::tools::Tools,
    words::Words,
};
use canon::Plane;
use diag::Diagnostic;

/// Shift of the centre for a lathe tool's orientation, in radii, along Z and X.
const fn orientation_shift(orientation: u32) -> Flat {
    match orientation {
        1 => [1.0, -1.0],
        2 => [-1.0, -1.0],
        3 => [-1.0, 1.0],
        4 => [1.0, 1.0],
        5 => [1.0, 0.0],
        6 => [0.0, -1.0],
        7 => [-1.0, 0.0],
        8 => [0.0, 1.0],
        _ => [0.0, 0.0],
    }
}

/// G40, G41, G42 of the block at hand.
pub(crate) fn compensation<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    tools: &mut Tools,
    out: &mut Out<'_, S>,
) -> Outcome {
    match words.g(GGroup::Compensation) {
        None => Ok(()),
        Some(code) => switch(words, modes, tools, code, out),
    }
}

/// One of them.
pub(crate) fn switch<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    tools: &mut Tools,
    code: u16,
    out: &mut Out<'_, S>,
) -> Outcome {
    if code != 400 {
        return compensation_on(words, modes, tools, code, out);
    }
    modes.unknown.clear(Unknown::COMPENSATION);
    compensation_off(words, modes, out)?;
    out.say(&Call::Note("cutter radius compensation off"));
    Ok(())
}

/// The tool goes on beside the last programmed point; the next move leads back onto the programmed
/// way.
pub(crate) fn compensation_off<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    let settled = settle(words, modes, None, out);
    let place = modes.place();
    if modes.compensation.take().is_some_and(|compensation| compensation.at.is_some()) {
        modes.left_beside = Some(modes.frame.to_machine(&place));
    }
    out.let_go();
    settled
}

fn compensation_on<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    tools: &mut Tools,
    code: u16,
    out: &mut Out<'_, S>,
) -> Outcome {
    let span = words.place.span;
    if let Some(on) = &modes.compensation {
        if words.rules().restates_modes && on.code == code && words.get(b'D').is_none() {
            return Ok(());
        }
        let fault = error("I0540", span, "cutter radius compensation is on already");
        return Err(fault.with_help("write G40 before it is changed").into());
    }
    if modes.plane == Plane::YZ {
        let text = "cutter radius compensation works in G17 and G18, but G19 is in force";
        return refuse("I0541", span, text);
    }
    let LedCutter { diameter, orientation, by_comment } =
        cutter(words, modes, tools, code, out.remarks)?;
    let left_side = matches!(code, 410 | 411) == (diameter >= 0.0);
    let radius = diameter.abs() / 2.0;
    let left_text = matches!(code, 410 | 411);
    out.say(&Call::Note(if left_text {
        "cutter radius compensation on left"
    } else {
        "cutter radius compensation on right"
    }));
    modes.compensation = Some(Compensation {
        code,
        side: if left_side { 1.0 } else { -1.0 },
        radius,
        by_comment,
        shift: times(orientation_shift(orientation), radius),
        at: None,
        last: None,
    });
    Ok(())
}

/// What is led beside the way.
struct LedCutter {
    /// Program units.
    diameter: f64,
    /// Of a lathe's tool; 0: its centre is led.
    orientation: u32,
    /// The offset whose radius a comment states.
    by_comment: Option<u32>,
}

/// What is led beside the way: by the words with G41.1 and G42.1, else a tool.
fn cutter(
    words: &Words,
    modes: &Modes,
    tools: &mut Tools,
    code: u16,
    remarks: &mut Vec<Diagnostic>,
) -> Outcome<LedCutter> {
    if matches!(code, 411 | 421) {
        let Some(diameter) = words.get(b'D') else {
            let text = format!(
                "G{} needs D, the cutter's diameter",
                crate::codes::spelling::written(code)
            );
            return refuse("I0542", words.place.span, text);
        };
        let orientation = words.whole(b'L', 9)?;
        if orientation.is_some() && modes.plane != Plane::ZX {
            let text = "L is the orientation of a lathe tool: it needs G18";
            return refuse("I0543", words.span(b'L'), text);
        }
        let orientation = orientation.unwrap_or(0);
        return Ok(LedCutter { diameter, orientation, by_comment: None });
    }
    let number = match words.get(b'D') {
        Some(0.0) | None => modes.current_tool,
        Some(_) => tools.word(words, b'D')?,
    };
    if let Some(comment) = tools.wear_alone(number) {
        let text = stated::on_the_way(words, number, code, comment);
        if tools.reported.insert(number) {
            remarks.push(text);
        }
        return Ok(LedCutter { diameter: 0.0, orientation: 0, by_comment: None });
    }
    let entry = tools.entry(number);
    if !tools.states_diameter(number) {
        let unstated = unstated(words, modes, number, code);
        if unstated.is_error() {
            return Err(unstated.into());
        }
        remarks.push(unstated);
    }
    let orientation = if modes.plane == Plane::ZX { entry.orientation } else { 0 };
    let diameter = entry.diameter / modes.units.in_mm();
    let by_comment = tools.by_comment(number).map(|comment| {
        let is_turned = modes.plane == Plane::ZX || words.rules().turret;
        stated::by_comment(words, (number, code), diameter / 2.0, comment, is_turned)
    });
    let is_by_comment = by_comment.is_some();
    let by_example = tools
        .by_example(number)
        .map(|tool| stated::by_example(words, (number, code), diameter / 2.0, tool));
    if let Some(said) = by_comment.or(by_example).filter(|_| tools.reported.insert(number)) {
        remarks.push(said);
    }
    Ok(LedCutter { diameter, orientation, by_comment: is_by_comment.then_some(number) })
}

/// Nothing states the radius by which a tool is led beside its way: a mill is refused; a lathe's
/// tool is led on the programmed way, as with a nose of no radius, and that is said.
fn unstated(words: &Words, modes: &Modes, number: u32, code: u16) -> Diagnostic {
    let g = crate::codes::spelling::written(code);
    let span = if words.get(b'D').is_some() { words.span(b'D') } else { words.place.span };
    if modes.plane == Plane::ZX || words.rules().turret {
        let text = format!(
            "G{g} leads T{number} on the programmed way, as if its nose had no radius: nothing states the radius"
        );
        return Diagnostic::warning("I0574", span, text).with_help(
            "the tool table states it, or G10 before; cones and arcs are cut beside where they will be",
        );
    }
    let text = format!(
        "G{g} leads T{number} its radius beside the way, and nothing states the radius: no tool table, no comment of the program"
    );
    error("I0574", span, text).with_help(format!(
        "a comment states it, as in (T{number} D=12. FLAT END MILL), or the tool table; if the way is already that of the tool's centre, a comment (D{number} WEAR) says so"
    ))
}

pub(crate) fn no_compensation(words: &Words) -> Outcome {
    let text = "this move cannot be made beside its way: only G0, G1, G2 and G3 can, while G41 or G42 is in force";
    Err(error("I0544", words.place.span, text).with_help("write G40 before it").into())
}

/// The first move after G40 leads back onto the programmed way: not along an arc.
pub(crate) fn leave_compensation(words: &Words, modes: &mut Modes, motion: Motion) -> Outcome {
    if matches!(motion, Motion::ArcClockwise | Motion::ArcCounterclockwise) {
        let text =
            "the move after G40 leads the tool back to the programmed way: it must be straight";
        return Err(error("I0550", words.place.span, text)
            .with_help("write G0 or G1 before the arc")
            .into());
    }
    if motion != Motion::None {
        modes.left_beside = None;
    }
    Ok(())
}
