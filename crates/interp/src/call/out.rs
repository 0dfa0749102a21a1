//! Where an interpretation's calls go: to the listener, or behind moves whose end is not settled.
//!
//! ```text
//!   G1 X10   ─► held: where it ends depends on the next move
//!   M8       ─► waits behind it                   (MSG,…)  ─► said at once
//!   G1 Y10   ─► settles X10; both go on their way; Y10 is held
//! ```
use crate::{
    call::{Call, Place, Sink},
    geometry::offset_curve::times,
};
use diag::Diagnostic;

/// What waits until the end of a compensated move is settled.
#[derive(Clone, Debug)]
pub(crate) enum Waiting {
    Call(Call<'static>),
    Comment(Box<str>),
    Note(Box<str>),
}

/// Everything held, with the block that ordered it.
pub(crate) type Held = Vec<(Place, Waiting)>;

/// The listener, and what is held back from it.
pub(crate) struct Out<'a, S> {
    pub(crate) sink: &'a mut S,
    pub(crate) held: &'a mut Held,
    /// Warnings and notes of the block at hand.
    pub(crate) remarks: &'a mut Vec<Diagnostic>,
    /// The block that orders.
    pub(crate) place: Place,
}

impl<S: Sink> Out<'_, S> {
    /// One call of the block at hand.
    #[inline]
    pub(crate) fn say(&mut self, call: &Call<'_>) {
        if self.held.is_empty() {
            self.sink.call(&self.place, call);
        } else {
            self.say_behind(call);
        }
    }

    /// A call at once, whatever is held.
    pub(crate) fn say_now(&mut self, call: &Call<'_>) {
        self.sink.call(&self.place, call);
    }

    pub(crate) fn hold(&mut self, call: Call<'static>) {
        self.held.push((self.place, Waiting::Call(call)));
    }

    /// Everything held goes on its way.
    pub(crate) fn let_go(&mut self) {
        for (place, held) in self.held.drain(..) {
            match &held {
                Waiting::Call(call) => self.sink.call(&place, call),
                Waiting::Comment(text) => self.sink.call(&place, &Call::Comment(text)),
                Waiting::Note(text) => self.sink.call(&place, &Call::Note(text)),
            }
        }
    }

    /// A call while moves are held back: those of the machine wait behind them, the rest does not.
    fn say_behind(&mut self, call: &Call<'_>) {
        let waits = match *call {
            Call::Comment(text) => Waiting::Comment(text.into()),
            Call::Note(text) => Waiting::Note(text.into()),
            Call::FeedMode { per_revolution } => Waiting::Call(Call::FeedMode { per_revolution }),
            Call::FeedRate { rate, duration_s } => {
                Waiting::Call(Call::FeedRate { rate, duration_s })
            }
            Call::Dwell(seconds) => Waiting::Call(Call::Dwell(seconds)),
            Call::SpindleSpeed(speed) => Waiting::Call(Call::SpindleSpeed(speed)),
            Call::SpindleMode(limit) => Waiting::Call(Call::SpindleMode(limit)),
            Call::SpindleTurn(sense) => Waiting::Call(Call::SpindleTurn(sense)),
            Call::SpindleStop => Waiting::Call(Call::SpindleStop),
            Call::SpindleOrient { angle, direction, mode, longest } => {
                Waiting::Call(Call::SpindleOrient { angle, direction, mode, longest })
            }
            Call::Mist(on) => Waiting::Call(Call::Mist(on)),
            Call::Flood(on) => Waiting::Call(Call::Flood(on)),
            _ => return self.sink.call(&self.place, call),
        };
        self.held.push((self.place, waits));
    }

    /// G20 or G21 while moves are held back.
    pub(crate) fn scale(&mut self, factor: f64) {
        for (_, held) in self.held.iter_mut() {
            let Waiting::Call(call) = held else { continue };
            match call {
                Call::Line(to) | Call::Rapid(to) => crate::geometry::frame::scale(to, factor),
                Call::Arc { to, centre, .. } => {
                    crate::geometry::frame::scale(to, factor);
                    *centre = times(*centre, factor);
                }
                Call::FeedRate { rate, .. } => *rate *= factor,
                _ => {}
            }
        }
    }
}
