//! Arcs: G2, G3 with a centre (I, J, K) or a radius (R), turns (P), helices.
//!
//! ```text
//!            e ● end                     centre from R:  m = (s + e)/2,  h = |e − s|/2
//!             ╱ ╲
//!            m───● c                     c = m ± √(R² − h²) · n,  n ⟂ (e − s)
//!             ╲ ╱                        R > 0: the shorter way round; R < 0: the longer
//!            s ● start
//! ```
//!
//! With a centre, both ends must be as far from it: they may differ by 0.02·√2 mm (0.002·√2 inch),
//! or by 0.1 % of the radius if that is more. A radius may be too short by 0.00127 mm (0.00005
//! inch), and is then taken as half the distance.
//!
//! Source: LinuxCNC 2.9 manual, "G2, G3 Arc Move"; tolerances measured on its stand-alone
//! interpreter.
use crate::{
    call::{Call, Sink, Units, out::Out},
    codes::set,
    compensation::beside,
    coordinates::target,
    fault::{Outcome, error, refuse},
    geometry::{frame::SAME_POINT, offset_curve},
    modes::{Modes, Motion},
    motion,
    words::Words,
};
use diag::Diagnostic;

/// Relative difference of the two radii that is let through.
const RELATIVE: f64 = 0.001;

/// Differences let through, in program units.
struct Tolerance {
    /// Of the two radii, however small they are.
    ends: f64,
}

impl Tolerance {
    const fn of(units: Units) -> Self {
        use core::f64::consts::SQRT_2;
        match units {
            Units::Millimetre => Self { ends: 0.02 * SQRT_2 },
            Units::Inch => Self { ends: 0.002 * SQRT_2 },
        }
    }
}

pub(crate) fn arc<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    motion: Motion,
    out: &mut Out<'_, S>,
) -> Outcome {
    let clockwise = motion == Motion::ArcClockwise;
    let code = if clockwise { "G2" } else { "G3" };
    let turns = match words.whole(b'P', 1_000_000)? {
        Some(0) => return refuse("I0409", words.span(b'P'), "P counts turns: 1 or more"),
        other => other.unwrap_or(1).cast_signed(),
    };
    let [a, b, n] = modes.plane_axes();
    if words.rules().needs_axis_words {
        names_its_end(words, modes, [a, b])?;
    }
    let to = target::destination(words, modes, false)?;
    let (start, end) = ([modes.at[a], modes.at[b]], [to[a], to[b]]);
    let centre = centre(words, modes, start, end, clockwise, false)?;
    let turns = if clockwise { -turns } else { turns };
    let length = || {
        let radius = (start[0] - centre[0]).hypot(start[1] - centre[1]);
        (radius * offset_curve::sweep_rad(start, end, centre, turns)).hypot(to[n] - modes.at[n])
    };
    motion::say_feed(words, modes, code, length, out)?;
    if modes.compensating() {
        beside::arc_beside(words, modes, &to, centre, turns, out)?;
        modes.at = to;
        return Ok(());
    }
    modes.at = to;
    out.say(&Call::Arc { plane: modes.plane, to, centre, turns });
    Ok(())
}

/// An arc of a control that has no full circle without X or Y.
fn names_its_end(words: &Words, modes: &Modes, plane: [usize; 2]) -> Outcome {
    const AXES: [&str; 3] = ["X", "Y", "Z"];
    let [first, second] = plane.map(|axis| AXES[axis]);
    if words.any(set(first) | set(second) | crate::codes::POLAR) {
        return Ok(());
    }
    let text = format!(
        "this arc has neither {first} nor {second}: Grbl and grblHAL refuse it (error 26, 31 or 32)"
    );
    let at = |axis: usize| if modes.incremental { 0.0 } else { modes.at[axis] };
    let [x, y] = plane.map(|axis| crate::codes::spelling::short(at(axis)));
    let help = format!("a full circle ends where it begins: {first}{x} {second}{y} works");
    Err(error("I0435", words.place.span, text).with_help(help).into())
}

/// By R, or by I, J, K. The end of a profile's arc may be given by U and W, which are no words any
/// more.
pub(crate) fn centre(
    words: &Words,
    modes: &Modes,
    start: [f64; 2],
    end: [f64; 2],
    clockwise: bool,
    in_profile: bool,
) -> Outcome<[f64; 2]> {
    match words.get(b'R') {
        Some(radius) => centre_by_radius(words, modes, radius, start, end, clockwise, in_profile),
        None => centre_by_offsets(words, modes, start, end),
    }
}

/// Letters of the centre's offsets along the plane's axes, and the one that has no place in it.
fn centre_letters(modes: &Modes) -> [u8; 3] {
    modes.plane_axes().map(|axis| b"IJK"[axis])
}

fn centre_by_offsets(
    words: &Words,
    modes: &Modes,
    start: [f64; 2],
    end: [f64; 2],
) -> Outcome<[f64; 2]> {
    let [first, second, none] = centre_letters(modes);
    let span = words.place.span;
    let may_be_zero = words.rules().idle & set("K") != 0;
    if words.get(none).is_some_and(|value| value != 0.0 || !may_be_zero) {
        let text = format!(
            "{} has no effect: arcs of this plane have their centre at {} and {}",
            none as char, first as char, second as char
        );
        return refuse("I0410", words.span(none), text);
    }
    let offsets = [first, second].map(|letter| words.get(letter));
    let centre = match (offsets, modes.absolute_centres) {
        ([None, None], _) => {
            let text = format!(
                "an arc needs its centre ({} and {}) or its radius (R)",
                first as char, second as char
            );
            return refuse("I0411", span, text);
        }
        ([Some(x), Some(y)], true) => [x, y],
        (_, true) => {
            let missing = if offsets[0].is_none() { first } else { second } as char;
            return refuse(
                "I0412",
                span,
                format!(
                    "{missing} is missing: with G90.1 both coordinates of the centre are needed"
                ),
            );
        }
        ([x, y], false) => [start[0] + x.unwrap_or(0.0), start[1] + y.unwrap_or(0.0)],
    };
    let radius = (start[0] - centre[0]).hypot(start[1] - centre[1]);
    let other = (end[0] - centre[0]).hypot(end[1] - centre[1]);
    if radius < SAME_POINT || other < SAME_POINT {
        return refuse(
            "I0413",
            span,
            "the arc's centre lies on one of its ends: its radius would be zero",
        );
    }
    let tolerance = Tolerance::of(modes.units);
    let off = (radius - other).abs();
    if off > tolerance.ends && off > RELATIVE * radius.max(other) {
        return Err(uneven(words, modes, start, end, centre).into());
    }
    Ok(centre)
}

/// The centre is not as far from one end as from the other; the nearest one that is, for the help.
fn uneven(
    words: &Words,
    modes: &Modes,
    start: [f64; 2],
    end: [f64; 2],
    centre: [f64; 2],
) -> Diagnostic {
    let from = |p: [f64; 2]| (p[0] - centre[0]).hypot(p[1] - centre[1]);
    let (radius, other) = (from(start), from(end));
    let text = format!(
        "the arc's ends are {radius:.4} and {other:.4} from its centre: they differ by {:.4}",
        (radius - other).abs()
    );
    let chord = [end[0] - start[0], end[1] - start[1]];
    let length_squared = chord[0] * chord[0] + chord[1] * chord[1];
    let middle = [start[0].midpoint(end[0]), start[1].midpoint(end[1])];
    // On the chord's bisector every point is as far from one end as from the other.
    let along = (centre[0] - middle[0]) * chord[0] + (centre[1] - middle[1]) * chord[1];
    let fits: [f64; 2] =
        core::array::from_fn(|i| centre[i] - along / length_squared.max(1e-300) * chord[i]);
    let [first, second, _] = centre_letters(modes).map(char::from);
    let (shown, meant) = if modes.absolute_centres {
        (fits, "coordinates, because G90.1 is in force")
    } else {
        ([fits[0] - start[0], fits[1] - start[1]], "distances from the start of the arc")
    };
    let (x, y) = (shown[0] + 0.0, shown[1] + 0.0);
    error("I0414", words.place.span, text).with_help(format!(
        "{first}{x:.4} {second}{y:.4} would fit; {first} and {second} are {meant}"
    ))
}

fn centre_by_radius(
    words: &Words,
    modes: &Modes,
    radius: f64,
    start: [f64; 2],
    end: [f64; 2],
    clockwise: bool,
    in_profile: bool,
) -> Outcome<[f64; 2]> {
    let span = words.place.span;
    if words.any(crate::codes::CENTRE) {
        return refuse(
            "I0415",
            span,
            "an arc takes its centre (I, J, K) or its radius (R), not both",
        );
    }
    let axes = modes.plane_axes();
    let named =
        target::axis_word(words, modes, axes[0]).or(target::axis_word(words, modes, axes[1]));
    let polar = words.any(crate::codes::POLAR);
    if named.is_none() && !polar && !in_profile {
        return refuse(
            "I0416",
            span,
            "an arc with R needs its end: a full circle is written with its centre",
        );
    }
    let chord = [end[0] - start[0], end[1] - start[1]];
    let half = chord[0].hypot(chord[1]) / 2.0;
    if half < SAME_POINT {
        return refuse(
            "I0417",
            span,
            "an arc with R must not end where it begins: write its centre for a full circle",
        );
    }
    let size = radius.abs();
    if size < half - words.rules().short_radius[usize::from(modes.units == Units::Inch)] {
        let text = format!("R{radius} is too small to reach the end: at least {half:.4} is needed");
        return refuse("I0418", words.span(b'R'), text);
    }
    let height = (size * size - half * half).max(0.0).sqrt();
    // The centre lies to the right of the chord for a clockwise arc of less than half a turn.
    let side = if clockwise == (radius > 0.0) { -1.0 } else { 1.0 };
    let along = side * height / (2.0 * half);
    let middle = [start[0].midpoint(end[0]), start[1].midpoint(end[1])];
    Ok([middle[0] - chord[1] * along, middle[1] + chord[0] * along])
}
