//! Probing: G38.2 … G38.5.
//!
//! Where the probe will touch, only the machine knows. Here a rule stands for it: **contact comes at
//! the programmed end point**. `#5061` to `#5069` are that point, in the program's coordinates; the
//! axes then stand 0.01 inch (0.254 mm) back towards the start, and `#5070` is 0, as in LinuxCNC's
//! stand-alone interpreter.
//!
//! Source: LinuxCNC 2.9 manual, "G38.n Straight Probe"; the rule was measured on its stand-alone interpreter.
use crate::{
    call::{Call, Sink, Units},
    fault::{Outcome, refuse},
    modes::{FeedMode, Modes},
    names::Store,
    out::Out,
    target,
    words::Words,
};

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
    let back = match modes.units {
        Units::Inch => BACK_INCH,
        Units::Millimetre => BACK_INCH * units::MM_PER_INCH,
    };
    let length = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
    let must_touch = matches!(digit, 2 | 4);
    if must_touch && length < SHORTEST {
        let text = "probing needs a way along X, Y or Z: this one ends where it begins";
        return refuse("I0572", span, text);
    }
    out.say(&Call::Probe(to));
    store.numbered.set_point(CONTACT, &to);
    store.numbered.set(TOUCHED, 0.0);
    modes.at = to;
    for i in (0..3).filter(|_| length > 0.0) {
        modes.at[i] = to[i] - (to[i] - from[i]) * back / length;
    }
    Ok(())
}
