//! The everyday words of Brother's tapping centres: G77, G78 (synchronised tapping) and G100 (non-stop tool change).
//!
//! ```text
//!   G100 T2 X10 Y10 G43 Z30 H2 S3000 M3 L5      the tool comes (T2), S and M3, X and Y, then Z with its length;
//!        │                             └ next tool to be called, for the change after this one
//!        └ from here on the block is T2 M6, S3000 M3, G43 H2, G0 X10 Y10, G0 Z30
//!
//!   G77 X10 Y10 Z-15 R2 I1.0 S3000 L6000 Q5 P0.1 K2
//!                       │    │     │     │  │    └ repetitions
//!                       │    │     │     │  └ wait at the bottom, s
//!                       │    │     │     └ depth of each peck
//!                       │    │     └ speed of the way out, rev/min
//!                       │    └ speed of the tap; no M3 before: the cycle turns the spindle itself
//!                       └ I: pitch in mm; J: threads per inch; or F, as in G84
//! ```
//!
//! G78 is the same with a left-hand thread. The pitch means the same whatever G20 or G21 say. In this dialect G84 and G74
//! turn the spindle themselves as well: S in their block is enough.
//!
//! Source: the word lists of posts for these controls (Autodesk's for CNC-A00, -B00 and -C00), where they agree; what the
//! control's parameters choose (I and J of other cycles) is left to them. The posts for CNC-A00 have P in G77, the later ones
//! have not: it is read. D in G100 is the cutter offset of a G41 that follows, here always that of the tool itself.
use crate::{
    call::{Call, ReturnSpeed, Sink},
    codes::{AXES, GGroup, MGroup, NON_STOP_CHANGE, SYNCHRO_LEFT, SYNCHRO_RIGHT},
    execute::Executor,
    fault::{Outcome, error, refuse},
    rigid::TapWords,
    setup::Dialect,
    state::{Cycle, Motion},
};
use units::MM_PER_INCH;

/// A G word of this dialect's own, as a code of the table.
pub(crate) fn own_code(dialect: Dialect, value: f64) -> Option<u16> {
    if dialect != Dialect::Brother {
        return None;
    }
    match value {
        77.0 => Some(SYNCHRO_RIGHT),
        78.0 => Some(SYNCHRO_LEFT),
        100.0 => Some(NON_STOP_CHANGE),
        _ => None,
    }
}

impl Executor {
    /// I, J, L of G77 and G78.
    pub(crate) fn synchro_words(&self, cycle: Cycle, kept: Option<TapWords>) -> Outcome<TapWords> {
        let kept = kept.unwrap_or_default();
        let positive = |letter: u8, what: &str| match self.words.get(letter) {
            Some(value) if !(value.is_finite() && value > 0.0) => {
                let text = format!("{} is {what}, above 0, found {value}", letter as char);
                refuse("I0592", self.words.span(letter), text)
            }
            value => Ok(value),
        };
        let pitch = positive(b'I', "the pitch in mm")?;
        let threads = positive(b'J', "the number of threads per inch")?;
        let out = positive(b'L', "the speed of the way out in rev/min")?;
        if pitch.is_some() && threads.is_some() {
            let text = "the pitch is given by I (mm) or by J (threads per inch), not by both";
            return refuse("I0593", self.words.span(b'J'), text);
        }
        let lead_mm = pitch.or(threads.map(|threads| MM_PER_INCH / threads));
        // F in the block is a lead of its own
        let stated = self.words.get(b'F').is_none();
        let lead_mm = lead_mm.or(kept.lead_mm.filter(|_| stated));
        if lead_mm.is_none() && self.state.feed <= 0.0 {
            let code = crate::spelling::written(cycle.code());
            let text = format!("G{code} needs I, the pitch in mm, or J, the threads per inch");
            return refuse("I0594", self.words.place.span, text);
        }
        let return_speed = out.map_or(kept.return_speed, ReturnSpeed::Rpm);
        let peck = self.peck_word(kept.peck)?;
        Ok(TapWords { return_speed, peck, lead_mm, ..kept })
    }

    /// G100: the block's words as those of M6.
    pub(crate) fn non_stop_change(&mut self) -> Outcome {
        if self.words.g(GGroup::NonModal) != Some(NON_STOP_CHANGE) {
            return Ok(());
        }
        let span = self.words.place.span;
        if self.words.get(b'T').is_none() {
            let text = "G100 needs T, the tool to change to";
            return Err(error("I0595", span, text)
                .with_help("write G100 T2 X… Y… G43 Z… H2")
                .into());
        }
        if self.words.g(GGroup::Motion).is_some() || self.words.m(MGroup::Tool).is_some() {
            let text = "G100 changes the tool and moves by itself: no M6 and no motion beside it";
            return refuse("I0596", span, text);
        }
        if self.compensating {
            return self.no_compensation();
        }
        self.words.put_m(MGroup::Tool, 60);
        Ok(())
    }

    /// The move of G100, after tool, spindle and length are in force: X and Y first, then Z.
    pub(crate) fn non_stop_move<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        if matches!(self.state.motion, Motion::Cycle(_)) {
            (self.state.motion, self.state.sticky) = (Motion::None, None);
        }
        if let Some(next) = self.words.whole(b'L', 9999)? {
            self.state.selected_tool = next;
            self.state.selected_pocket = Some(self.pocket(next));
            self.say(sink, &Call::SelectTool(next));
        }
        if !self.words.any(AXES) {
            return Ok(());
        }
        let to = self.destination(false)?;
        let [_, _, n] = self.state.plane_axes();
        let mut over = to;
        over[n] = self.state.at[n];
        self.say(sink, &Call::Rapid(over));
        self.say(sink, &Call::Rapid(to));
        self.state.at = to;
        Ok(())
    }
}
