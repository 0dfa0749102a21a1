//! Splines: G5 (cubic), G5.1 (quadratic), G5.2 … G5.3 (NURBS), all in G17.
//!
//! ```text
//!   G5 I J P Q     ●╌╌○ first control point: start + (I, J)        G5.1 I J  ○  start + (I, J)
//!                 start      ○╌╌● end                                       ╱ ╲
//!                            └ second: end + (P, Q)                        ●   ●
//!
//!   C(u) = Σ Nᵢ(u) wᵢ Pᵢ / Σ Nᵢ(u) wᵢ     Nᵢ B-splines of order L on a clamped uniform knot vector
//! ```
//!
//! All three are NURBS: G5 of order 4 with four points, G5.1 of order 3 with three. The machine
//! gets Bézier curves of the fifth degree ([`spline_pieces`](crate::motion::spline_pieces)): up to
//! that degree, and where all weights are alike, these are the curve itself; else they stay within
//! a nanometre of it.
//!
//! Source: LinuxCNC 2.9 manual, "G5", "G5.1", "G5.2 G5.3"; L. Piegl, W. Tiller, "The NURBS
//! Book", 2.2 and 4.2.
use crate::{
    call::{Call, ControlPoint, Sink, out::Out},
    codes,
    coordinates::target,
    fault::{Outcome, error, refuse},
    geometry::frame::Point,
    modes::{FeedMode, Modes, Motion, nurbs::Nurbs},
    motion,
    words::Words,
};
use canon::Plane;

/// Control points of one NURBS.
const MAX_POINTS: usize = 10_000;

/// G5 and G5.1.
pub(crate) fn spline<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    motion: Motion,
    out: &mut Out<'_, S>,
) -> Outcome {
    let span = words.place.span;
    let to = spline_end(words, modes)?;
    check_spline_feed(words, modes, out)?;
    let (start, end) = ([modes.at[0], modes.at[1]], [to[0], to[1]]);
    let plain = |at| ControlPoint { at, weight: 1.0 };
    let offset = |from: [f64; 2], by: [f64; 2]| [from[0] + by[0], from[1] + by[1]];
    let [i, j, p, q] = [b'I', b'J', b'P', b'Q'].map(|letter| words.get(letter));
    let first = match (i, j, modes.spline_leaves) {
        (Some(i), Some(j), _) => [i, j],
        (None, None, Some(before)) if motion == Motion::CubicSpline => before,
        _ => {
            let text = "a spline needs I and J, from its start to the first control point (G5 may leave both out after another G5)";
            return refuse("I0551", span, text);
        }
    };
    if motion == Motion::QuadraticSpline {
        let points = [plain(start), plain(offset(start, first)), plain(end)];
        modes.at = to;
        out.say(&Call::Spline { order: 3, points: &points });
        return Ok(());
    }
    let (Some(p), Some(q)) = (p, q) else {
        return refuse("I0552", span, "G5 needs P and Q, from its end to the second control point");
    };
    let points =
        [plain(start), plain(offset(start, first)), plain(offset(end, [p, q])), plain(end)];
    modes.spline_leaves = Some([-p, -q]);
    modes.at = to;
    out.say(&Call::Spline { order: 4, points: &points });
    Ok(())
}

/// G5.2 and the blocks after it: one control point each. What is wrong with one says nothing about
/// the others.
pub(crate) fn nurbs_point<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    let result = control_point(words, modes, out);
    if result.is_err() {
        let none = || Nurbs { order: 3, points: Vec::new(), faulty: true };
        modes.nurbs.get_or_insert_with(none).faulty = true;
        modes.motion = Motion::Nurbs;
    }
    result
}

fn control_point<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) -> Outcome {
    let span = words.place.span;
    if let Some(begin) = modes.nurbs.as_ref().and_then(|nurbs| nurbs.points.first())
        && modes.incremental
    {
        // all control points count from where the curve begins
        [modes.at[0], modes.at[1]] = begin.at;
    }
    if words.get(b'X').is_some() != words.get(b'Y').is_some() {
        return refuse("I0562", span, "a control point of a NURBS needs both X and Y");
    }
    let to = spline_end(words, modes)?;
    let Some(weight) = words.get(b'P').filter(|p| *p > 0.0) else {
        return refuse("I0553", span, "every control point of a NURBS needs P above 0, its weight");
    };
    check_spline_feed(words, modes, out)?;
    let order = words.whole(b'L', 20)?;
    let start = [modes.at[0], modes.at[1]];
    let nurbs = modes.nurbs.get_or_insert_with(|| Nurbs {
        order: 3,
        points: vec![ControlPoint { at: start, weight }],
        faulty: false,
    });
    if let Some(order) = order {
        if order < 2 {
            return refuse(
                "I0554",
                words.span(b'L'),
                "L is the order of the curve: 2 or more, 3 if left out",
            );
        }
        nurbs.order = order as usize;
    }
    if nurbs.points.len() >= MAX_POINTS {
        return refuse("I0555", span, format!("a NURBS has at most {MAX_POINTS} control points"));
    }
    if words.any(codes::set("XY")) {
        nurbs.points.push(ControlPoint { at: [to[0], to[1]], weight });
    }
    modes.at = to;
    Ok(())
}

/// G5.3.
pub(crate) fn nurbs_end<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    let span = words.place.span;
    let Some(nurbs) = modes.nurbs.take() else {
        return refuse("I0556", span, "G5.3 ends a NURBS, but none was begun by G5.2");
    };
    if nurbs.faulty {
        modes.motion = Motion::None;
        return Ok(());
    }
    if nurbs.points.len() < nurbs.order {
        let text = format!(
            "a NURBS of order {} needs as many control points, found {}",
            nurbs.order,
            nurbs.points.len()
        );
        return refuse("I0557", span, text);
    }
    out.say(&Call::Spline { order: nurbs.order, points: &nurbs.points });
    modes.motion = Motion::None;
    Ok(())
}

/// A NURBS that is not ended would not be cut at all.
pub(crate) fn check_nurbs_ended(words: &Words, modes: &mut Modes) -> Outcome {
    if modes.nurbs.take().is_some() {
        let fault = error("I0558", words.place.span, "the NURBS begun by G5.2 is not ended");
        return Err(fault.with_help("write G5.3 after its last control point").into());
    }
    Ok(())
}

fn spline_end(words: &Words, modes: &Modes) -> Outcome<Point> {
    let span = words.place.span;
    if modes.plane != Plane::XY {
        return refuse("I0559", span, "splines lie in the XY plane: write G17 before");
    }
    let to = target::destination(words, modes, false)?;
    if to[2..] != modes.at[2..] {
        return refuse("I0560", span, "a spline moves X and Y alone");
    }
    Ok(to)
}

fn check_spline_feed<S: Sink>(words: &Words, modes: &Modes, out: &mut Out<'_, S>) -> Outcome {
    if modes.feed_mode == FeedMode::InverseTime {
        return refuse("I0561", words.place.span, "splines need G94 or G95: G93 is in force");
    }
    motion::say_feed(words, modes, "a spline", || 0.0, out)
}
