//! Probing: G38.2 … G38.5.
//!
//! ```text
//!   G38.2 G38.4   an alarm if the probe does not change on the way     G38.3 G38.5   none
//!   G38.2 G38.3   until contact                                        G38.4 G38.5   until the end of contact
//! ```
//!
//! Where the probe touches, only the machine knows. While a program is run [`Live`](crate::Live) is
//! told: `#5061` to `#5069` are then that place in the program's coordinates, `#5070` is 1 (0
//! without contact), and the axes stand where they have come to rest. Before that, in a check, a
//! rule stands for it: **contact comes at the programmed end point**.
//!
//! LinuxCNC's stand-alone interpreter, to which listings are compared, has a rule of its own: the
//! axes then stand 0.01 inch (0.254 mm) back towards the start, and `#5070` is 0.
//!
//! Source: LinuxCNC 2.9 manual, "G38.n Straight Probe"; the last rule was measured on its
//! stand-alone interpreter.
use crate::{
    call::{Call, Sink, Units, out::Out},
    coordinates::target,
    fault::{Outcome, refuse},
    geometry::frame::{Point, same},
    modes::{FeedMode, Modes},
    resolve::Resolver,
    state::executor::Settings,
    words::{Words, names::Store},
};
use canon::{Feed, OpKind, Probe};
use diag::{Diagnostic, Span};

/// First parameter of the place of contact, and the one that says whether there was one.
const CONTACT: usize = 5061;
const TOUCHED: usize = 5070;
/// How far back from the contact the axes then stand: 0.01 inch.
const BACK_INCH: f64 = 0.01;
/// A shorter way is none.
const SHORTEST: f64 = 1e-9;

/// G38.2 … G38.5.
pub(crate) fn probe<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    store: &mut Store,
    settings: &Settings,
    digit: u16,
    out: &mut Out<'_, S>,
) -> Outcome {
    let span = words.place.span;
    if !words.any(crate::codes::AXES | crate::codes::POLAR) {
        return refuse("I0570", span, "probing needs an axis word: where to");
    }
    if modes.feed_mode != FeedMode::PerMinute || modes.feed <= 0.0 {
        let text = "probing needs a feed per minute: write G94 and F above 0";
        return refuse("I0571", span, text);
    }
    let to = target::destination(words, modes, false)?;
    let from = modes.at;
    let length = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
    let required = matches!(digit, 2 | 4);
    if required && length < SHORTEST {
        let text = "probing needs a way along X, Y or Z: this one ends where it begins";
        return refuse("I0572", span, text);
    }
    if !same(&from, &to) {
        store.asked = store.asked.wrapping_add(1); // where nothing moves nothing is asked
    }
    out.say(&Call::Probe { to, until_contact: digit <= 3, required });
    came_to(store, &to, length >= SHORTEST && !settings.stand_alone);
    modes.at = to;
    if settings.stand_alone {
        let back = match modes.units {
            Units::Inch => BACK_INCH,
            Units::Millimetre => BACK_INCH * units::MM_PER_INCH,
        };
        for i in (0..3).filter(|_| length > 0.0) {
            modes.at[i] = to[i] - (to[i] - from[i]) * back / length;
        }
    }
    Ok(())
}

/// The probe has changed at a place of the program, or the move has come to its end there.
pub(crate) fn came_to(store: &mut Store, at: &Point, changed: bool) {
    store.numbered.set_point(CONTACT, at);
    store.numbered.set(TOUCHED, f64::from(u8::from(changed)));
}

/// G38: along a line, however far.
pub(crate) fn operation(
    resolver: &mut Resolver,
    program: &crate::Point,
    (until_contact, required): (bool, bool),
    span: Span,
) {
    let to = resolver.machine(program);
    let from = resolver.at;
    if !resolver.arrives(&to, span) {
        return;
    }
    resolver.check_stroke(&from, &to, span);
    let text = "where the probe touches is known when the program runs: here it is taken to touch at the programmed end point";
    resolver.report(Diagnostic::note("I0713", span, text));
    let Feed::PerTime(feed) = resolver.feed(&from, &to, span) else {
        let text =
            "probing needs a way along X, Y or Z: a turn of a rotary axis alone cannot be probed";
        return resolver.report(Diagnostic::error("I0573", span, text));
    };
    let to = crate::resolve::position(&to);
    resolver.push(span, OpKind::Probe(Probe { to, feed, until_contact, required }));
}
