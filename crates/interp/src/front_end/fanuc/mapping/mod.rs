//! Polar coordinates, scaling, mirroring and rotation: from a block's coordinates to those of the
//! work offset.
//!
//! ```text
//!   words ──G16──► radius, angle ──G51──► c + k·(p − c) ──G68──► turned about c ──G51.1──► 2·m − p ──► move
//!                  to X, Y                k by axis               by R                      by axis
//! ```
//!
//! | code | words | ends with |
//! |---|---|---|
//! | G16 | the plane's first axis is a radius, its second an angle; about the work's zero (G90) or the place at hand (G91) | G15 |
//! | G51 | X Y Z centre, P factor in thousandths; or I J K a factor for each axis, negative to mirror | G50 |
//! | G68 | the plane's two axes centre, R degrees counter-clockwise | G69 |
//! | G51.1 | X Y Z where the mirror stands on that axis | G50.1 X Y Z |
//!
//! Without a centre the place where the tool stands is meant. The centre of a rotation is
//! scaled with the rest. Cutter radius, tool length and work offsets are added afterwards, so none
//! of this changes them; nor does it change Q of the drilling cycles. An arc that is mirrored turns
//! the other way, and G41 becomes G42.
//!
//! What a block adds with G91 is added to where the tool stands as these coordinates call the
//! place, so that a turned figure may begin anywhere.
//!
//! Source: Fanuc, operator's manual of series 30i for machining centres, "Polar coordinate
//! command", "Scaling", "Coordinate system rotation", "Programmable mirror image".
pub(crate) mod figure;
pub(crate) mod surface;

use crate::{
    codes::GGroup,
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        mapping::figure::{AXIS, CENTRE, Coordinates, Polar, Rotation, Scale},
        state::{Fanuc, Said},
    },
    modes::Motion,
    state::executor::Executor,
};
use canon::{Axis, Plane};
use diag::{Diagnostic, Span};

/// G15, G16, G50, G51, G50.1, G51.1, G68 and G69 of a block. Their words are taken away.
pub(crate) fn set_mapping(
    fanuc: &mut Fanuc,
    ex: &mut Executor,
    said: &[Said],
    code: u16,
) -> Outcome {
    let span = ex.words.place.span;
    let plane = plane(ex);
    let [a, b, _] = plane.axes().map(Axis::index);
    let before = fanuc.mapping.flips([a, b]);
    if ex.modes.compensating() && code != 150 {
        let text = "G50, G51, G68 and G69 cannot be written while G41 or G42 is in force";
        return Err(error("I1040", span, text).with_help("write G40 before them").into());
    }
    let here = [ex.modes.at[0], ex.modes.at[1], ex.modes.at[2]];
    match code {
        150 => fanuc.mapping.polar = None,
        160 => polar(fanuc, ex, here, [a, b]),
        500 => fanuc.mapping.scale = None,
        510 => scale(fanuc, ex, said, here)?,
        501 | 511 => mirror(fanuc, ex, code == 511)?,
        690 => fanuc.mapping.rotation = None,
        _ => rotate(fanuc, ex, said, here, [a, b])?,
    }
    if before != fanuc.mapping.flips([a, b]) {
        // the arc that is in force is one of the program's
        ex.modes.motion = match ex.modes.motion {
            Motion::ArcClockwise => Motion::ArcCounterclockwise,
            Motion::ArcCounterclockwise => Motion::ArcClockwise,
            other => other,
        };
    }
    Ok(())
}

fn polar(fanuc: &mut Fanuc, ex: &Executor, here: Coordinates, [a, b]: [usize; 2]) {
    let at = fanuc.mapping.backward(&here);
    let about_here = incremental(ex);
    let origin = if about_here { [at[a], at[b]] } else { [0.0; 2] };
    fanuc.mapping.polar = Some(Polar { origin, last: None });
}

fn scale(fanuc: &mut Fanuc, ex: &mut Executor, said: &[Said], here: Coordinates) -> Outcome {
    let span = ex.words.place.span;
    if fanuc.mapping.rotation.is_some() {
        let text = "G51 comes before G68: scaling cannot begin while a rotation is in force";
        return Err(error("I1041", span, text).with_help("write G69 before it").into());
    }
    fanuc.mapping.scale = None;
    let here = fanuc.mapping.backward(&here);
    let centre = core::array::from_fn(|i| ex.words.take(AXIS[i]).unwrap_or(here[i]));
    for letter in CENTRE {
        ex.words.take(letter);
    }
    ex.words.take(b'P');
    let factor = |letter: u8| {
        let word = said.iter().find(|said| said.letter == letter)?;
        Some(if word.counts { word.value / 1000.0 } else { word.value })
    };
    let own = CENTRE.map(factor);
    let factor = match factor(b'P') {
        Some(all) => [all; 3],
        None if own.iter().any(Option::is_some) => own.map(|factor| factor.unwrap_or(1.0)),
        None => {
            let text = "G51 needs P, the factor in thousandths, or I, J and K, one for each axis: P2000 doubles";
            return refuse("I1042", span, text);
        }
    };
    if factor.iter().any(|factor| *factor == 0.0 || !factor.is_finite()) {
        return refuse("I1042", span, "a scale of 0 leaves nothing: P1000 is the true size");
    }
    fanuc.mapping.scale = Some(Scale { centre, factor });
    Ok(())
}

fn mirror(fanuc: &mut Fanuc, ex: &mut Executor, on: bool) -> Outcome {
    let span = ex.words.place.span;
    if fanuc.mapping.rotation.is_some() || fanuc.mapping.scale.is_some() {
        let text = "G51.1 and G50.1 stand outside of scaling and rotation";
        return Err(error("I1041", span, text).with_help("write G69 and G50 before them").into());
    }
    let named = AXIS.map(|letter| ex.words.take(letter));
    if named.iter().all(Option::is_none) {
        if on {
            let text = "G51.1 needs an axis word: where the mirror stands, X0 for left and right";
            return refuse("I1043", span, text);
        }
        fanuc.mapping.mirror = [None; 3];
    }
    for (mirror, at) in fanuc.mapping.mirror.iter_mut().zip(named) {
        if at.is_some() {
            *mirror = at.filter(|_| on);
        }
    }
    Ok(())
}

fn rotate(
    fanuc: &mut Fanuc,
    ex: &mut Executor,
    said: &[Said],
    here: Coordinates,
    [a, b]: [usize; 2],
) -> Outcome {
    let span = ex.words.place.span;
    ex.words.take(b'R');
    let Some(word) = said.iter().find(|said| said.letter == b'R') else {
        return refuse("I1044", span, "G68 needs R, the angle in degrees, counter-clockwise");
    };
    let degrees = if word.counts && !fanuc.calculator { word.value / 1000.0 } else { word.value };
    if degrees.abs() > 360.0 {
        let text = format!("R is an angle from -360 to 360 degrees, found {degrees}");
        return refuse("I1044", word.span, text);
    }
    fanuc.mapping.rotation = None;
    let mut centre = fanuc.mapping.backward(&here);
    for axis in [a, b] {
        centre[axis] = ex.words.take(AXIS[axis]).unwrap_or(centre[axis]);
    }
    let centre = fanuc.mapping.scaled(&centre);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let centre = [centre[a], centre[b]];
    fanuc.mapping.rotation = Some(Rotation { axes: [a, b], centre, sin, cos, fresh: true });
    Ok(())
}

/// The block's words as the work has them.
pub(crate) fn map(fanuc: &mut Fanuc, ex: &mut Executor, cycle: bool) -> Outcome {
    if fanuc.mapping.polar.is_none() && !fanuc.mapping.changes() {
        return Ok(());
    }
    if let Some(found) = forbidden(ex) {
        if !fanuc.mapping.changes() {
            return Ok(()); // of G52, G92 and the like the words are no radius
        }
        let text = format!("{found} cannot be used while G51, G51.1 or G68 is in force");
        let fault = error("I1045", ex.words.place.span, text);
        return Err(fault.with_help("write G69, G50 or G50.1 before it").into());
    }
    let [a, b, n] = plane(ex).axes().map(Axis::index);
    if plane(ex) != ex.modes.plane {
        let text = "the plane cannot change while G16, G51, G51.1 or G68 is in force";
        let fault = error("I1045", ex.words.place.span, text);
        return Err(fault.with_help("write G15, G69, G50 or G50.1 before it").into());
    }
    let words = AXIS.map(|letter| ex.words.get(letter));
    let by = incremental(ex);
    if words.iter().all(Option::is_none) {
        return if cycle { map_levels(fanuc, ex, n, by) } else { map_arc(fanuc, ex, [a, b]) };
    }
    let here = [ex.modes.at[0], ex.modes.at[1], ex.modes.at[2]];
    let from = fanuc.mapping.backward(&here);
    let mut target = from;
    for i in 0..3 {
        if let Some(word) = words[i].filter(|_| !(cycle && i == n)) {
            target[i] = if by { from[i] + word } else { word };
        }
    }
    let in_plane = words[a].is_some() || words[b].is_some();
    if in_plane {
        if let Some(polar) = &mut fanuc.mapping.polar {
            let now = [from[a] - polar.origin[0], from[b] - polar.origin[1]];
            if cycle && by {
                if words[a].is_some() && words[b].is_some() && ex.words.get(b'L').is_some() {
                    let text = "holes of a radius and an angle that both grow lie on no circle and on no line";
                    let fault = error("I1062", ex.words.place.span, text);
                    let help = "write each hole in a block of its own, without K";
                    return Err(fault.with_help(help).into());
                }
                ex.words.step_turns_deg = words[b].unwrap_or(0.0);
            }
            [target[a], target[b]] = polar.place(now, [words[a], words[b]], by);
        } else {
            warn_of_one_word(fanuc, ex, [a, b], &words, &from, by);
        }
    }
    let to = fanuc.mapping.forward(&target);
    let mut put = |axis: usize| {
        let value = if by { to[axis] - here[axis] } else { to[axis] };
        let span = ex.words.span(AXIS[axis]);
        ex.words.take(AXIS[axis]);
        ex.words.put(AXIS[axis], value, span)
    };
    if in_plane {
        put(a)?;
        put(b)?;
    }
    if words[n].is_some() && !cycle {
        put(n)?;
    }
    if cycle { map_levels(fanuc, ex, n, by) } else { map_arc(fanuc, ex, [a, b]) }
}

/// Depth and R of a cycle.
fn map_levels(fanuc: &Fanuc, ex: &mut Executor, n: usize, by: bool) -> Outcome {
    let factor = fanuc.mapping.factor(n);
    if factor < 0.0 {
        let text = format!("{} is mirrored: a cycle cannot drill upwards", AXIS[n] as char);
        return refuse("I1046", ex.words.place.span, text);
    }
    for letter in [AXIS[n], b'R'] {
        let Some(value) = ex.words.get(letter) else { continue };
        let mut level = [0.0; 3];
        level[n] = value;
        let value = if by { factor * value } else { fanuc.mapping.forward(&level)[n] };
        let span = ex.words.span(letter);
        ex.words.take(letter);
        ex.words.put(letter, value, span)?;
    }
    Ok(())
}

/// Centre or radius of an arc, which way round, and on which side the cutter is.
fn map_arc(fanuc: &Fanuc, ex: &mut Executor, [a, b]: [usize; 2]) -> Outcome {
    if fanuc.mapping.flips([a, b]) {
        ex.words.exchange_g(GGroup::Motion, 20, 30);
        ex.words.exchange_g(GGroup::Compensation, 410, 420);
    }
    let motion = ex.words.g(GGroup::Motion).map_or(ex.modes.motion, Motion::from_code);
    if !matches!(motion, Motion::ArcClockwise | Motion::ArcCounterclockwise) {
        return Ok(());
    }
    let centre = CENTRE.map(|letter| ex.words.get(letter));
    let radius = ex.words.get(b'R');
    if centre.iter().all(Option::is_none) && radius.is_none() {
        return Ok(());
    }
    let [along, across] = [a, b].map(|axis| fanuc.mapping.factor(axis).abs());
    if (along - across).abs() > 1e-9 * along.max(across) {
        let [x, y] = [a, b].map(|axis| AXIS[axis] as char);
        let text = format!(
            "an arc scaled by {along} along {x} and by {across} along {y} is no arc: Fanuc cuts no ellipse either"
        );
        return refuse("I1047", ex.words.place.span, text);
    }
    if let Some(radius) = radius {
        let span = ex.words.span(b'R');
        ex.words.take(b'R');
        ex.words.put(b'R', radius * along, span)?;
    }
    if centre[a].is_some() || centre[b].is_some() {
        let to = fanuc.mapping.distance(&centre.map(|word| word.unwrap_or(0.0)));
        for axis in [a, b] {
            let span = ex.words.span(CENTRE[axis]);
            ex.words.take(CENTRE[axis]);
            ex.words.put(CENTRE[axis], to[axis], span)?;
        }
    }
    Ok(())
}

/// The first place after G68 that names one axis of two.
fn warn_of_one_word(
    fanuc: &mut Fanuc,
    ex: &mut Executor,
    axes: [usize; 2],
    words: &[Option<f64>; 3],
    from: &Coordinates,
    by: bool,
) {
    let Some(rotation) = &mut fanuc.mapping.rotation else { return };
    if !core::mem::take(&mut rotation.fresh) || by {
        return;
    }
    let Some(axis) = axes.into_iter().find(|axis| words[*axis].is_none()) else { return };
    let (letter, value) = (AXIS[axis] as char, (from[axis] * 1e4).round() / 1e4 + 0.0);
    let text = format!(
        "{letter} is not named in the first move after G68: it is where the tool stands, {letter}{value} in the turned coordinates"
    );
    let span: Span = ex.words.place.span;
    let finding = Diagnostic::warning("I1048", span, text);
    ex.remarks.push(finding.with_help("name both axes of the plane in the first move after G68"));
}

/// The block's plane, which is in force when its words are read.
fn plane(ex: &Executor) -> Plane {
    match ex.words.g(GGroup::Plane) {
        Some(170) => Plane::XY,
        Some(180) => Plane::ZX,
        Some(190) => Plane::YZ,
        _ => ex.modes.plane,
    }
}

/// Whether the block's words are increments.
pub(crate) fn incremental(ex: &Executor) -> bool {
    ex.words.g(GGroup::Distance).map_or(ex.modes.incremental, |code| code == 910)
}

/// What in this block stands outside of these coordinates.
fn forbidden(ex: &Executor) -> Option<String> {
    let other = ex.words.g(GGroup::NonModal).filter(|code| !matches!(code, 40 | 100));
    let code = other.or(ex.words.g(GGroup::WorkOffset))?;
    Some(format!("G{}", crate::codes::spelling::written(code)))
}
