//! What these controls accept beside another word of a block, and the shared language refuses.
//!
//! ```text
//!   G0 G91 G28 Z0     the reference point takes the axis words, G0 is in force afterwards
//!   G2 X10 Y5         an arc without centre and radius goes straight
//!   G53 M5            no axis, no move
//!   G42 H19 X5        the offset of the tool's radius, where no D stands
//! ```
//!
//! Source: Fanuc, operator's manuals of series 30i and 0i; parameter manual of series 30i, 3403#5 (CIR), which is 0 as delivered.
use super::{
    sense::{Sense, in_force},
    state::Fanuc,
};
use crate::{
    codes::{AXES, CENTRE, GGroup, POLAR, set},
    executor::Executor,
    fault::Outcome,
    modes::Motion,
};
use diag::Diagnostic;

impl Fanuc {
    /// The block's words as the shared language takes them.
    pub(super) fn accept(&mut self, ex: &mut Executor, sense: &Sense) -> Outcome {
        let words = &mut ex.words;
        let axes = words.any(AXES | POLAR);
        let non_modal = words.g(GGroup::NonModal);
        if non_modal == Some(530) && !axes {
            words.forget_g(GGroup::NonModal);
        }
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
        self.straight_arc(ex, sense)
    }

    /// An arc that says nothing of its circle.
    fn straight_arc(&mut self, ex: &mut Executor, sense: &Sense) -> Outcome {
        let arc = match ex.words.g(GGroup::Motion) {
            Some(code @ (20 | 30)) => Motion::from_code(code),
            Some(_) => return Ok(()),
            None => in_force(ex),
        };
        let is_arc = matches!(arc, Motion::ArcClockwise | Motion::ArcCounterclockwise);
        let moves = ex.words.any(AXES) && ex.words.g(GGroup::NonModal).is_none();
        if !is_arc || !moves || sense.cycle || ex.words.any(CENTRE | set("R")) {
            return Ok(());
        }
        let span = ex.words.place.span;
        self.once.straight = Some(arc);
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
}
