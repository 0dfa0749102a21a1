//! Moves whose end is not settled, and the orders that wait behind them.
//!
//! ```text
//!   G1 X10   ─► held: where it ends depends on the next move
//!   M8       ─► waits behind it                   (MSG,…)  ─► said at once
//!   G1 Y10   ─► settles X10; both go on their way; Y10 is held
//! ```
use crate::{
    call::{Call, Sink},
    execute::Executor,
    frame::Point,
    offset_curve::{Flat, plus, times},
};

/// What waits until the end of a compensated move is settled.
#[derive(Clone, Debug)]
pub(crate) enum Held {
    Call(Call<'static>),
    Comment(Box<str>),
    Note(Box<str>),
}

impl Executor {
    pub(crate) fn push_line(&self, rapid: bool, to: &Point, end: Flat) {
        let to = self.beside(to, end);
        self.hold(Held::Call(if rapid { Call::Rapid(to) } else { Call::Line(to) }));
    }

    pub(crate) fn push_arc(&self, to: &Point, centre: Flat, turns: i32, end: Flat) {
        let shift = self.state.compensation.as_ref().map_or([0.0; 2], |c| c.shift);
        let to = self.beside(to, end);
        let centre = plus(centre, shift);
        self.hold(Held::Call(Call::Arc { plane: self.state.plane, to, centre, turns }));
    }

    fn beside(&self, to: &Point, end: Flat) -> Point {
        let [a, b, _] = self.state.plane_axes();
        let shift = self.state.compensation.as_ref().map_or([0.0; 2], |c| c.shift);
        let end = plus(end, shift);
        let mut to = *to;
        (to[a], to[b]) = (end[0], end[1]);
        to
    }

    fn hold(&self, held: Held) {
        self.held.borrow_mut().push((self.words.place, held));
    }

    /// Everything held goes on its way.
    pub(crate) fn let_go<S: Sink>(&self, sink: &mut S) {
        for (place, held) in self.held.borrow_mut().drain(..) {
            match &held {
                Held::Call(call) => sink.call(&place, call),
                Held::Comment(text) => sink.call(&place, &Call::Comment(text)),
                Held::Note(text) => sink.call(&place, &Call::Note(text)),
            }
        }
    }

    /// A call while moves are held back: those of the machine wait behind them, the rest does not.
    pub(crate) fn say_behind<S: Sink>(&self, sink: &mut S, call: &Call<'_>) {
        let waits = match *call {
            Call::Comment(text) => Held::Comment(text.into()),
            Call::Note(text) => Held::Note(text.into()),
            Call::FeedMode { per_revolution } => Held::Call(Call::FeedMode { per_revolution }),
            Call::FeedRate { rate, duration_s } => Held::Call(Call::FeedRate { rate, duration_s }),
            Call::Dwell(seconds) => Held::Call(Call::Dwell(seconds)),
            Call::SpindleSpeed(speed) => Held::Call(Call::SpindleSpeed(speed)),
            Call::SpindleMode(limit) => Held::Call(Call::SpindleMode(limit)),
            Call::SpindleTurn(sense) => Held::Call(Call::SpindleTurn(sense)),
            Call::SpindleStop => Held::Call(Call::SpindleStop),
            Call::SpindleOrient { angle, mode } => Held::Call(Call::SpindleOrient { angle, mode }),
            Call::WaitOriented(longest) => Held::Call(Call::WaitOriented(longest)),
            Call::Mist(on) => Held::Call(Call::Mist(on)),
            Call::Flood(on) => Held::Call(Call::Flood(on)),
            _ => return sink.call(&self.words.place, call),
        };
        if self.held.borrow().is_empty() {
            sink.call(&self.words.place, call);
        } else {
            self.hold(waits);
        }
    }

    /// G20 or G21 while moves are held back.
    pub(crate) fn scale_compensation(&mut self, factor: f64) {
        if let Some(compensation) = &mut self.state.compensation {
            compensation.scale(factor);
        }
        for (_, held) in self.held.borrow_mut().iter_mut() {
            let Held::Call(call) = held else { continue };
            match call {
                Call::Line(to) | Call::Rapid(to) => crate::frame::scale(to, factor),
                Call::Arc { to, centre, .. } => {
                    crate::frame::scale(to, factor);
                    *centre = times(*centre, factor);
                }
                Call::FeedRate { rate, .. } => *rate *= factor,
                _ => {}
            }
        }
    }
}
