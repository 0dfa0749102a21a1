//! Non-stop tool change: the word G100 of Brother's controls, tool, spindle and way in one block.
//!
//! ```text
//!   G100 T2 X10 Y10 G43 Z30 H2 S3000 M3 L5      the tool comes (T2), S and M3, X and Y, then Z with its length;
//!        │                             └ next tool to be called, for the change after this one
//!        └ from here on the block is T2 M6, S3000 M3, G43 H2, G0 X10 Y10, G0 Z30
//! ```
//!
//! Source: the word lists of posts for these controls (Autodesk's for CNC-A00, -B00 and -C00), where they agree. D is the
//! cutter offset of a G41 that follows, here always that of the tool itself.
use crate::{
    call::{Call, Sink},
    codes::{AXES, GGroup, MGroup, NON_STOP_CHANGE},
    execute::Executor,
    fault::{Outcome, error, refuse},
    state::Motion,
};

impl Executor {
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
