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
//! The first move after G41 goes straight (or along an arc tangent to the offset one) from where the
//! tool stands to beside the programmed end; it must be longer than the radius. From then on every
//! move of the plane is held back until the next one tells where its end is to be. What is ordered
//! meanwhile (spindle, coolant, feed) waits behind it. Two directions that differ by less than
//! 0.05 rad (2.9°) count as one. With G40 the held move goes to its own end, and the next move must
//! be straight.
//!
//! On a lathe (G18) the tool's orientation 1 to 9 shifts all of it, so that the imagined tip, and
//! not the centre of the nose, is where the program says.
//!
//! Fanuc's start-up is another (type A, as its controls are delivered): the first move goes straight to where the tool
//! stands beside the *beginning of the move that follows*, at right angles to it, however short it is and at whatever angle
//! that one goes on. So a lead-in into a pocket's arc is possible from any side.
//!
//! A corner that the tool cannot reach without cutting into what was programmed before is an error.
//!
//! Source: LinuxCNC 2.9 manual, "Cutter compensation"; NISTIR 6556, appendix B; Fanuc, operator's manual of series 30i for
//! machining centres, "Tool movement in start-up" (type A, SUP of parameter 5003 is 0). Angles, shifts and
//! the order of what is held were measured on LinuxCNC's stand-alone interpreter.
pub(crate) mod lead_in;
pub(crate) mod push;

use crate::{
    call::{
        Call, Sink,
        out::{Out, Waiting},
    },
    codes::GGroup,
    fault::{Outcome, error, refuse, unknown::Unknown},
    geometry::{
        frame::Point,
        offset_curve::{Curve, Flat, Way, length, minus, plus, sweep_rad, times, turn_rad},
    },
    modes::{Modes, Motion, compensation::Compensation},
    state::{executor::Settings, tools::Tools},
    words::Words,
};
use canon::Plane;
use core::f64::consts::PI;
use diag::Diagnostic;

/// Directions nearer than this are one: neither an arc is put in nor an end moved.
const SAME_DIRECTION_RAD: f64 = 0.05;
/// Turns nearer to half a revolution than this go back the way they came.
const HALF_TURN_RAD: f64 = 0.05;
/// A way back from the corner that decides between two points as near, in radii.
const NEARER: f64 = 1e-3;

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

/// The tool goes on beside the last programmed point; the next move leads back onto the programmed way.
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
    let (diameter, orientation) = cutter(words, modes, tools, code)?;
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
        shift: times(orientation_shift(orientation), radius),
        at: None,
        last: None,
    });
    Ok(())
}

/// Diameter (program units) and orientation: of the words with G41.1 and G42.1, else of a tool.
fn cutter(words: &Words, modes: &Modes, tools: &mut Tools, code: u16) -> Outcome<(f64, u32)> {
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
        return Ok((diameter, orientation.unwrap_or(0)));
    }
    let number = match words.get(b'D') {
        Some(0.0) | None => modes.current_tool,
        Some(_) => tools.word(words, b'D')?,
    };
    let entry = tools.entry(number);
    let orientation = if modes.plane == Plane::ZX { entry.orientation } else { 0 };
    Ok((entry.diameter / modes.units.in_mm(), orientation))
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

/// A straight move with the tool beside it.
pub(crate) fn straight_beside<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    rapid: bool,
    to: &Point,
    out: &mut Out<'_, S>,
) -> Outcome {
    let [a, b, _] = modes.plane_axes();
    let way = Way { from: [modes.at[a], modes.at[b]], to: [to[a], to[b]], circle: None };
    let Some(compensation) = &modes.compensation else { return Ok(()) };
    let at = compensation.at;
    let distance = length(minus(way.to, way.from));
    let Some(at) = at else {
        return lead_in::begin_straight(words, modes, settings, &way, rapid, to, out);
    };
    if distance == 0.0 {
        push::push_line(modes, rapid, to, at, out);
        return Ok(());
    }
    let direction = way.direction(way.to);
    let through = compensation.beside(way.to, direction);
    let line = Curve::Line { from: through, through, direction };
    let from = corner(words, modes, &way, line, rapid, to, out)?;
    let Some(compensation) = &mut modes.compensation else { return Ok(()) };
    compensation.at = Some(through);
    compensation.last = Some(Curve::Line { from, through, direction });
    push::push_line(modes, rapid, to, through, out);
    Ok(())
}

/// An arc with the tool beside it.
pub(crate) fn arc_beside<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    to: &Point,
    centre: Flat,
    turns: i32,
    out: &mut Out<'_, S>,
) -> Outcome {
    let [a, b, _] = modes.plane_axes();
    let way =
        Way { from: [modes.at[a], modes.at[b]], to: [to[a], to[b]], circle: Some((centre, turns)) };
    let Some(compensation) = modes.compensation.clone() else { return Ok(()) };
    let programmed = length(minus(way.to, centre));
    let inside = compensation.side * f64::from(turns.signum()) > 0.0;
    let first = compensation.at.is_none();
    if programmed <= compensation.radius && inside {
        let text = format!(
            "the tool's radius, {:.4}, must be smaller than the arc's, {programmed:.4}",
            compensation.radius
        );
        return refuse("I0546", words.place.span, text);
    }
    let direction = way.direction(way.to);
    let end = compensation.beside(way.to, direction);
    let sweep = sweep_rad(way.from, way.to, centre, turns);
    let curve = if first && compensation.radius > 0.0 {
        let inwards = times(minus(centre, way.to), 1.0 / programmed);
        let centre =
            lead_in::entry_centre(words, modes, [way.from, end], inwards, inside, programmed)?;
        let sweep_rad = sweep_rad(way.from, end, centre, turns);
        Curve::Circle {
            from: way.from,
            centre,
            radius: length(minus(end, centre)),
            turns,
            sweep_rad,
        }
    } else {
        let radius = if inside {
            programmed - compensation.radius
        } else {
            programmed + compensation.radius
        };
        let from = compensation.beside(way.from, way.direction(way.from));
        let curve = Curve::Circle { from, centre, radius, turns, sweep_rad: sweep };
        let from = corner(words, modes, &way, curve, false, to, out)?;
        Curve::Circle { from, centre, radius, turns, sweep_rad: sweep }
    };
    let Curve::Circle { centre, .. } = curve else { return Ok(()) };
    let Some(compensation) = &mut modes.compensation else { return Ok(()) };
    compensation.at = Some(end);
    compensation.last = Some(curve);
    push::push_arc(modes, to, centre, turns, end, out);
    Ok(())
}

/// Settle the end of the move held back by what follows it; where the next one begins.
fn corner<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    next: &Way,
    curve: Curve,
    rapid: bool,
    to: &Point,
    out: &mut Out<'_, S>,
) -> Outcome<Flat> {
    let Some(compensation) = modes.compensation.clone() else { return Ok(next.from) };
    let at = compensation.at.unwrap_or(next.from);
    let Some(last) = compensation.last else { return Ok(at) };
    if compensation.radius == 0.0 {
        // the tool is on the way itself, which has its own corners
        settle(words, modes, None, out)?;
        return Ok(next.from);
    }
    // The offset end lies beside the corner: there the last move has the corner's direction.
    let before = last.direction(at);
    let after = next.direction(next.from);
    if matches!(last, Curve::StartUp { .. }) {
        let beside = compensation.beside(next.from, after);
        settle(words, modes, Some(beside), out)?;
        return Ok(beside);
    }
    let turn = turn_rad(before, after);
    let half_turn = turn.abs() > PI - HALF_TURN_RAD;
    let inner = if half_turn {
        // Back the way it came: between two bumps the tool stops short, else it goes round.
        compensation.bulge(&last) + compensation.bulge(&curve) > 0.0
    } else {
        turn * compensation.side > 0.0
    };
    if turn.abs() < SAME_DIRECTION_RAD {
        if last.turns_back(at) {
            remark(
                words,
                "this corner comes too soon after the one before it: the tool goes back a little and cuts into the part",
                out,
            );
        }
        out.let_go();
        return Ok(at);
    }
    if !inner {
        if half_turn && turn * compensation.side > 1e-9 {
            remark(
                words,
                "this move goes back almost the way it came, with the part between: the tool goes round the corner and cuts into the part",
                out,
            );
        }
        settle(words, modes, None, out)?;
        let round = compensation.beside(next.from, after);
        go_round(modes, &compensation, next.from, round, rapid, to, out);
        return Ok(round);
    }
    // Of two points as near, the one that the tool comes to before the corner; so too on the way straight back.
    let back =
        if half_turn { last.radius() + curve.radius() } else { NEARER * compensation.radius };
    let near = minus(next.from, times(before, back));
    let Some(met) = last.meets(&curve, near) else {
        if let Some(compensation) = &mut modes.compensation {
            compensation.last = None;
        }
        return Err(unreachable(words, modes).into());
    };
    settle(words, modes, Some(met), out)?;
    Ok(met)
}

fn remark<S: Sink>(words: &Words, text: &str, out: &mut Out<'_, S>) {
    out.remarks.push(Diagnostic::warning("I0549", words.place.span, text));
}

fn unreachable(words: &Words, modes: &Modes) -> Diagnostic {
    let radius = modes.compensation.as_ref().map_or(0.0, |c| c.radius);
    let text =
        format!("a tool of radius {radius:.4} does not fit into the inner corner before this move");
    error("I0548", words.place.span, text)
        .with_help("it would cut into what was programmed before: take a smaller tool, or make the corner wider")
}

/// The held move ends here (or where it was to end); then everything held goes on its way.
fn settle<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    end: Option<Flat>,
    out: &mut Out<'_, S>,
) -> Outcome {
    let Some(compensation) = &mut modes.compensation else { return Ok(()) };
    let shift = compensation.shift;
    if let (Some(last), Some(at)) = (compensation.last, compensation.at)
        && last.turns_back(end.unwrap_or(at))
    {
        compensation.last = None; // said once
        return Err(unreachable(words, modes).into());
    }
    if let Some(end) = end {
        let shifted = plus(end, shift);
        let [a, b, _] = modes.plane_axes();
        for (_, held) in out.held.iter_mut() {
            if let Waiting::Call(Call::Line(to) | Call::Rapid(to) | Call::Arc { to, .. }) = held {
                (to[a], to[b]) = (shifted[0], shifted[1]);
            }
        }
    }
    out.let_go();
    Ok(())
}

/// An arc about an outer corner; a rapid cuts it short.
fn go_round<S: Sink>(
    modes: &Modes,
    compensation: &Compensation,
    corner: Flat,
    end: Flat,
    rapid: bool,
    next: &Point,
    out: &mut Out<'_, S>,
) {
    let [a, b, n] = modes.plane_axes();
    let (end, centre) = (plus(end, compensation.shift), plus(corner, compensation.shift));
    let mut to = *next;
    (to[a], to[b], to[n]) = (end[0], end[1], modes.at[n]);
    let call = if rapid {
        Call::Rapid(to)
    } else {
        let turns = if compensation.side > 0.0 { -1 } else { 1 };
        Call::Arc { plane: modes.plane, to, centre, turns }
    };
    out.say_now(&call);
}
