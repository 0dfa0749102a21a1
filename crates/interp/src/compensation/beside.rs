//! Moves while the tool is kept beside the path: how each is moved aside, and what is done at the
//! corner before it.
use crate::{
    call::{
        Call, Sink,
        out::{Out, Waiting},
    },
    compensation::{lead_in, push, stated::as_beside},
    fault::{Outcome, error},
    geometry::{
        frame::Point,
        offset_curve::{Curve, Flat, Way, length, minus, plus, sweep_rad, times, turn_rad},
    },
    modes::{Modes, compensation::Compensation},
    state::executor::Settings,
    words::Words,
};
use core::f64::consts::PI;
use diag::Diagnostic;

/// Directions nearer than this are one: neither an arc is put in nor an end moved.
const SAME_DIRECTION_RAD: f64 = 0.05;
/// Turns nearer to half a revolution than this go back the way they came.
const HALF_TURN_RAD: f64 = 0.05;
/// A way back from the corner that decides between two points as near, in radii.
const NEARER: f64 = 1e-3;

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
        let fault = error("I0546", words.place.span, text);
        return Err(as_beside(Some(&compensation), fault).into());
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
    // Of two points as near, the one that the tool comes to before the corner; so too on the way
    // straight back.
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

/// The held move ends here (or where it was to end); then everything held goes on its way.
pub(crate) fn settle<S: Sink>(
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

fn unreachable(words: &Words, modes: &Modes) -> Diagnostic {
    let radius = modes.compensation.as_ref().map_or(0.0, |c| c.radius);
    let text =
        format!("a tool of radius {radius:.4} does not fit into the inner corner before this move");
    let fault = error("I0548", words.place.span, text).with_help(
        "it would cut into what was programmed before: take a smaller tool, or make the corner wider",
    );
    as_beside(modes.compensation.as_ref(), fault)
}

fn remark<S: Sink>(words: &Words, text: &str, out: &mut Out<'_, S>) {
    out.remarks.push(Diagnostic::warning("I0549", words.place.span, text));
}
