//! Fanuc's boring cycles in which the tool moves aside by Q, along an axis that the machine has
//! set: G76 and G87.
//!
//! ```text
//!   G76  fine boring:  feed down to Z, wait, stop at angle 0, aside by Q, out fast, back, turn
//!   G87  back boring:  stop at angle 0, aside, down to R, back, turn, feed up to Z, wait, stop, aside, out, back, turn
//! ```
//!
//! Source: Fanuc, operator's manual of series 30i, "Canned cycles for drilling".
use crate::{
    call::{Call, Sink, out::Out},
    codes::spelling::short,
    cycles::holes::bore::{hold_spindle, turn_again},
    fault::{Outcome, error, refuse},
    geometry::frame::Point,
    modes::{Cycle, Modes},
    state::executor::Settings,
    words::Words,
};

/// Cycles that begin where the bore ends.
pub(crate) const fn bores_upwards(cycle: Cycle) -> bool {
    matches!(cycle, Cycle::BoreUpwards)
}

/// Q of Fanuc's cycles: a point moved aside by it, whatever its sign.
fn aside(modes: &Modes, settings: &Settings, at: &Point, q: f64) -> Point {
    let [a, b, _] = modes.plane_axes();
    let crate::Aside { second, back } = settings.cycles.aside;
    let mut point = *at;
    point[if second { b } else { a }] += if back { -q.abs() } else { q.abs() };
    point
}

/// Fanuc's G76, from the bottom of the bore on.
pub(crate) fn out<S: Sink>(
    modes: &Modes,
    settings: &Settings,
    bottom: &Point,
    clear: &Point,
    q: f64,
    out: &mut Out<'_, S>,
) {
    hold_spindle(modes, out);
    out.say(&Call::Rapid(aside(modes, settings, bottom, q)));
    out.say(&Call::Rapid(aside(modes, settings, clear, q)));
    out.say(&Call::Rapid(*clear));
    turn_again(modes, out);
}

/// Fanuc's G87: from over the bore to its upper end `end`, beginning at `begin`.
pub(crate) fn bore_upwards<S: Sink>(
    modes: &Modes,
    settings: &Settings,
    over: &Point,
    [begin, end]: [f64; 2],
    (q, dwell): (f64, f64),
    out: &mut Out<'_, S>,
) {
    let [_, _, n] = modes.plane_axes();
    let (mut below, mut above) = (*over, *over);
    (below[n], above[n]) = (begin, end);
    hold_spindle(modes, out);
    out.say(&Call::Rapid(aside(modes, settings, over, q)));
    out.say(&Call::Rapid(aside(modes, settings, &below, q)));
    out.say(&Call::Rapid(below));
    turn_again(modes, out);
    out.say(&Call::Line(above));
    if dwell > 0.0 {
        out.say(&Call::Dwell(dwell));
    }
    self::out(modes, settings, &above, over, q, out);
}

/// Q, and for G87 the levels, of Fanuc's boring cycles.
pub(crate) fn check_fine_boring(
    words: &Words,
    modes: &Modes,
    cycle: Cycle,
    peck: Option<f64>,
) -> Outcome {
    let code = crate::codes::spelling::written(cycle.code());
    let span = words.place.span;
    if peck.is_none() {
        let text = format!("G{code} needs Q, how far the tool moves aside before it comes out");
        return refuse("I0590", span, text);
    }
    if cycle == Cycle::BoreUpwards && !modes.retract_to_initial {
        let text = "G87 comes out to the initial level and no lower: G99 is in force";
        return Err(error("I0591", span, text).with_help("write G98 in this block").into());
    }
    Ok(())
}

/// R and Z of Fanuc's G87: where it begins to bore, and the upper end.
pub(crate) fn upward_levels(
    words: &Words,
    modes: &Modes,
    r: f64,
    z: f64,
    initial: f64,
) -> Outcome<[f64; 2]> {
    let [begin, end] = if modes.incremental { [initial + r, initial + r + z] } else { [r, z] };
    if end < begin || initial < end {
        let [begin, end, initial] = [begin, end, initial].map(short);
        let text = format!(
            "G87 bores upwards from R to Z, below where it starts: R is {begin}, Z {end}, the start {initial}"
        );
        return refuse("I0519", words.place.span, text);
    }
    Ok([begin, end])
}
