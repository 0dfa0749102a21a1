//! The first move after G41 and G42: from where the tool stands to beside the programmed end.
//!
//! ```text
//!            ╭── end, r beside the programmed end: the arc arrives along the programmed one
//!   way in  ╱
//!          ╱      n, inwards      its centre lies on the line through `end` along n:
//!   from  ●                       |from − (end + k·n)| = k
//! ```
use crate::{
    call::{Sink, out::Out},
    compensation::{push, stated::as_beside},
    dialect::rules::StartUp,
    fault::{Outcome, error},
    geometry::{
        frame::Point,
        offset_curve::{Curve, Flat, Way, dot, length, minus, plus, times},
    },
    modes::Modes,
    state::executor::Settings,
    words::Words,
};

/// Straight to beside the end, or to beside the beginning of what follows, as the dialect has it.
pub(super) fn begin_straight<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    way: &Way,
    rapid: bool,
    to: &Point,
    out: &mut Out<'_, S>,
) -> Outcome {
    let beside_next = settings.rules.start_up == StartUp::BesideNext;
    let Some(compensation) = &mut modes.compensation else { return Ok(()) };
    let (distance, radius) = (length(minus(way.to, way.from)), compensation.radius);
    if (beside_next || radius == 0.0) && distance == 0.0 {
        // along the tool alone: the next move of the plane starts up
        let end = minus(way.to, compensation.shift);
        push::push_line(modes, rapid, to, end, out);
        out.let_go();
        return Ok(());
    }
    if beside_next {
        let direction = way.direction(way.to);
        let end = compensation.beside(way.to, direction);
        compensation.at = Some(end);
        compensation.last = Some(Curve::StartUp { direction });
        push::push_line(modes, rapid, to, end, out);
        return Ok(());
    }
    if distance <= radius {
        let text = format!(
            "the first move after G41 or G42 must be longer than the tool's radius: {distance:.4} is not above {radius:.4}"
        );
        let fault = error("I0545", words.place.span, text);
        return Err(as_beside(Some(compensation), fault).into());
    }
    let direction = way.direction(way.to);
    let end = compensation.beside(way.to, direction);
    compensation.at = Some(end);
    compensation.last = Some(Curve::Line { from: way.from, through: end, direction });
    push::push_line(modes, rapid, to, end, out);
    Ok(())
}

/// Centre of the arc of the first move: it begins at a point and ends at another, where the centre
/// lies inwards.
pub(super) fn entry_centre(
    words: &Words,
    modes: &Modes,
    [from, end]: [Flat; 2],
    inwards: Flat,
    inside: bool,
    programmed: f64,
) -> Outcome<Flat> {
    let own = modes.compensation.as_ref().map_or(0.0, |c| c.radius);
    let chord = minus(from, end);
    let along = dot(chord, inwards);
    // |from − (end + k·n)| = k  ⇒  k = |from − end|² / (2 (from − end)·n)
    let radius = dot(chord, chord) / (2.0 * along);
    let text = if along < 1e-9 {
        // on the side of the centre: R cos φ < R − r
        let least = (1.0 - own / programmed).acos().to_degrees();
        format!(
            "the tool comes beside the end of the first arc after G41 or G42 only if the arc turns by more than {least:.2} and less than {:.2} degrees",
            360.0 - least
        )
    } else if !inside && radius <= own {
        format!(
            "the tool would come beside the end of this first arc along an arc of radius {radius:.4}: it must be above the tool's own, {own:.4}"
        )
    } else {
        return Ok(plus(end, times(inwards, radius)));
    };
    let help = "make the arc longer, or write a straight move before it";
    let fault = error("I0547", words.place.span, text).with_help(help);
    Err(as_beside(modes.compensation.as_ref(), fault).into())
}
