//! Where the axis words of a block lead.
//!
//! In G17 the place of X and Y can be taken by a distance from the origin (`@`) and an angle (`^`,
//! degrees): with G90 the one that is missing stays, with G91 both are added to those of the place
//! where the move begins.

use crate::{
    codes::{self, POLAR},
    fault::{Outcome, error, refuse},
    geometry::frame::Point,
    modes::Modes,
    words::Words,
};
use canon::Plane;
/// A word of an axis; diameters become radii.
#[inline]
pub(crate) fn axis_word(words: &Words, modes: &Modes, axis: usize) -> Option<f64> {
    let value = words.get(b"XYZABCUVW"[axis])?;
    Some(if axis == 0 && modes.diameter { value / 2.0 } else { value })
}

/// A point with the block's axis words put in.
pub(crate) fn with_words(words: &Words, modes: &Modes, mut point: Point) -> Point {
    for (axis, slot) in point.iter_mut().enumerate() {
        if let Some(value) = axis_word(words, modes, axis) {
            *slot = value;
        }
    }
    point
}

/// Where the block's axis words lead.
#[inline]
pub(crate) fn destination(
    words: &Words,
    modes: &Modes,
    machine_coordinates: bool,
) -> Outcome<Point> {
    if machine_coordinates {
        if words.any(POLAR) {
            return refuse("I0430", words.place.span, "@ and ^ cannot be used with G53");
        }
        if modes.incremental && !words.rules().machine_place_in_increments {
            let fault = error(
                "I0406",
                words.place.span,
                "G53 takes machine coordinates, but G91 is in force",
            );
            return Err(fault.with_help("write G90 before it").into());
        }
        let machine = with_words(words, modes, modes.frame.to_machine(&modes.at));
        return Ok(modes.frame.to_program(&machine));
    }
    let mut to = modes.at;
    for (axis, slot) in to.iter_mut().enumerate() {
        if let Some(value) = axis_word(words, modes, axis) {
            *slot = if modes.incremental { *slot + value } else { value };
        }
    }
    if words.any(POLAR) {
        [to[0], to[1]] = polar(words, modes)?;
    }
    Ok(to)
}

/// X and Y by distance and angle.
pub(crate) fn polar(words: &Words, modes: &Modes) -> Outcome<[f64; 2]> {
    let span = words.place.span;
    if modes.plane != Plane::XY {
        return refuse("I0431", span, "@ and ^ stand for X and Y: they need G17");
    }
    if words.any(codes::set("XY")) {
        return refuse("I0432", span, "a point is given by X and Y or by @ and ^, not by both");
    }
    let [x, y] = [modes.at[0], modes.at[1]];
    let (radius, angle) = (x.hypot(y), y.atan2(x).to_degrees());
    let [distance, turn] = [b'@', b'^'].map(|letter| words.get(letter));
    if radius == 0.0 && (modes.incremental || turn.is_none()) {
        let fault = error("I0433", span, "the move begins at the origin, which has no angle");
        return Err(fault.with_help("write @ and ^ with G90").into());
    }
    let (radius, angle) = if modes.incremental {
        (radius + distance.unwrap_or(0.0), angle + turn.unwrap_or(0.0))
    } else {
        (distance.unwrap_or(radius), turn.unwrap_or(angle))
    };
    let (sin, cos) = angle.to_radians().sin_cos();
    Ok([radius * cos, radius * sin])
}
