//! What these controls accept beside another word of a block, and the shared language refuses.
//!
//! ```text
//!   G0 G91 G28 Z0     the reference point takes the axis words, G0 is in force afterwards
//!   G2 X10 Y5         an arc without centre and radius goes straight
//!   G3                no axis, no move: the arc is in force for the blocks that follow
//!   G80 Z20           the motion from before the cycle takes the axis words
//!   G91 G28 Z0 G90    of two codes of one group the last acts
//!   G53 M5            no axis, no move
//!   G91 G53 Z0        Fanuc ignores G53 under G91, Haas goes to the machine's zero, Mitsubishi moves by the word
//!   G1 Z-10. A150.    on a lathe: X where a line at that angle to Z comes to
//!   G42 H19 X5        the offset of the tool's radius, where no D stands
//! ```
//!
//! Source: Fanuc, operator's manuals of series 30i and 0i; parameter manual of series 30i, 3403#5
//! (CIR), which is 0 as delivered.
use crate::front_end::fanuc::{
    mapping::incremental,
    state::Fanuc,
    words::sense::{Sense, in_force},
};
use crate::{
    codes::{AXES, CENTRE, GGroup, POLAR, set},
    dialect::fanuc::variant::MachinePlace,
    fault::{Outcome, refuse},
    modes::Motion,
    state::executor::Executor,
};
use diag::Diagnostic;

/// The block's words as the shared language takes them.
pub(crate) fn accept(fanuc: &mut Fanuc, ex: &mut Executor, sense: &Sense) -> Outcome {
    let words = &mut ex.words;
    let axes = words.any(AXES | POLAR);
    let non_modal = words.g(GGroup::NonModal);
    if non_modal == Some(530) && !axes {
        words.forget_g(GGroup::NonModal);
    }
    if non_modal == Some(530) && axes && incremental(ex) {
        machine_place_by_increments(fanuc, ex);
    }
    let words = &mut ex.words;
    if let Some(code @ 0..=30) = words.g(GGroup::Motion)
        && axes
        && matches!(non_modal, Some(280 | 300))
    {
        words.forget_g(GGroup::Motion);
        ex.modes.motion = Motion::from_code(code);
    }
    if matches!(words.g(GGroup::Compensation), Some(410 | 420))
        && !words.any(set("D"))
        && words.g(GGroup::ToolLength).is_none()
        && let (span, Some(number)) = (words.span(b'H'), words.take(b'H'))
    {
        words.put(b'D', number, span)?;
    }
    if ex.words.g(GGroup::Motion) == Some(800)
        && axes
        && non_modal.is_none()
        && !ex.modes.hobbing
        && let before @ (Motion::Rapid | Motion::Feed) = fanuc.before_cycle
    {
        ex.words.forget_g(GGroup::Motion);
        ex.words.take_g(f64::from(before.code()) / 10.0, ex.words.place.span)?;
    }
    if fanuc.is_lathe() && sense.feed && ex.recording.is_none() {
        by_angle(ex)?;
    }
    straight_arc(fanuc, ex, sense)
}

/// G53 where words are increments.
fn machine_place_by_increments(fanuc: &mut Fanuc, ex: &mut Executor) {
    match fanuc.kind.variant().g53_by_increments {
        MachinePlace::Absolute => {
            ex.words.forget_g(GGroup::Distance);
            ex.modes.incremental = false;
            fanuc.once.back_to_increments = true;
        }
        MachinePlace::Incremental => ex.words.forget_g(GGroup::NonModal),
        MachinePlace::Ignored => {
            let named = b"XYZABCUVW".iter().filter_map(|letter| ex.words.get(*letter));
            if !named.clone().all(|value| value == 0.0) {
                return; // it is refused: nothing says how far that goes
            }
            let span = ex.words.place.span;
            for letter in *b"XYZABCUVW" {
                ex.words.take(letter);
            }
            ex.words.forget_g(GGroup::NonModal);
            let text = "G53 has no effect while G91 is in force: nothing moves";
            let help = "write G90 before it to go to the machine's zero";
            ex.remarks.push(Diagnostic::warning("I1066", span, text).with_help(help));
        }
    }
}

/// An arc that says nothing of its circle.
fn straight_arc(fanuc: &mut Fanuc, ex: &mut Executor, sense: &Sense) -> Outcome {
    let arc = match ex.words.g(GGroup::Motion) {
        Some(code @ (20 | 30)) => Motion::from_code(code),
        Some(_) => return Ok(()),
        None => in_force(ex),
    };
    if ex.words.g(GGroup::Motion).is_some()
        && !ex.words.any(AXES | CENTRE | set("R"))
        && ex.words.g(GGroup::NonModal).is_none()
    {
        fanuc.once.straight = Some(arc);
        ex.words.forget_g(GGroup::Motion);
        return Ok(());
    }
    let is_arc = matches!(arc, Motion::ArcClockwise | Motion::ArcCounterclockwise);
    let moves = ex.words.any(AXES) && ex.words.g(GGroup::NonModal).is_none();
    if !is_arc || !moves || sense.cycle || ex.words.any(CENTRE | set("R")) {
        return Ok(());
    }
    let span = ex.words.place.span;
    fanuc.once.straight = Some(arc);
    ex.words.forget_g(GGroup::Motion);
    ex.words.take_g(1.0, span)?;
    let letters = ex.modes.plane_axes().map(|axis| char::from(b"IJK"[axis]));
    let text = format!(
        "this arc has neither centre ({} and {}) nor radius (R), and goes straight",
        letters[0], letters[1]
    );
    ex.remarks.push(
        Diagnostic::warning("I0419", span, text)
            .with_help("write G1 if that is meant; other controls stop here with an alarm"),
    );
    Ok(())
}

/// `G1 X A` or `G1 Z A` on a lathe: the other coordinate, where a line at that angle leads, counted
/// from +Z.
fn by_angle(ex: &mut Executor) -> Outcome {
    let (x, z) = (ex.words.get(b'X'), ex.words.get(b'Z'));
    if x.is_some() == z.is_some() {
        return Ok(());
    }
    let span = ex.words.span(b'A');
    let Some(degrees) = ex.words.take(b'A') else { return Ok(()) };
    let (sin, cos) = degrees.to_radians().sin_cos();
    let diameter = if ex.modes.diameter { 2.0 } else { 1.0 };
    let from = [ex.modes.at[0], ex.modes.at[2]];
    let by = incremental(ex);
    let way = |word: f64, from: f64| if by { word } else { word - from };
    let (letter, along, across, divisor) = match (x, z) {
        (Some(x), _) => (b'Z', way(x / diameter, from[0]), cos, sin),
        (_, z) => (b'X', way(z.unwrap_or(0.0), from[1]), sin, cos),
    };
    if divisor.abs() < 1e-9 {
        let text = format!(
            "a line at {degrees}\u{b0} to Z never comes there: {} is missing",
            char::from(letter)
        );
        return refuse("I1069", span, text);
    }
    let other = along * across / divisor;
    let (from, factor) = if letter == b'X' { (from[0], diameter) } else { (from[1], 1.0) };
    ex.words.put(letter, factor * if by { other } else { from + other }, span)
}
