//! Synchronised tapping by its pitch: the words of Brother's G77 and G78.
//!
//! ```text
//!   G77 X10 Y10 Z-15 R2 I1.0 S3000 L6000 Q5 P0.1 K2
//!                       │    │     │     │  │    └ repetitions
//!                       │    │     │     │  └ wait at the bottom, s
//!                       │    │     │     └ depth of each peck
//!                       │    │     └ speed of the way out, rev/min
//!                       │    └ speed of the tap; no M3 before: the cycle turns the spindle itself
//!                       └ I: pitch in mm; J: threads per inch; or F, as in G84
//! ```
//!
//! G78 is the same with a left-hand thread. The pitch means the same whatever G20 or G21 say.
//!
//! Source: the word lists of posts for these controls (Autodesk's for CNC-A00, -B00 and -C00),
//! where they agree. The posts for CNC-A00 have P in G77, the later ones have not: it is read.
use crate::{
    call::ReturnSpeed,
    cycles::holes::tap,
    fault::{Outcome, refuse},
    modes::{Cycle, Modes, tapping::TapWords},
    words::Words,
};
use units::MM_PER_INCH;

/// I, J, L of G77 and G78.
pub(crate) fn synchro_words(
    words: &Words,
    modes: &Modes,
    cycle: Cycle,
    kept: Option<TapWords>,
) -> Outcome<TapWords> {
    let kept = kept.unwrap_or_default();
    let positive = |letter: u8, what: &str| match words.get(letter) {
        Some(value) if !(value.is_finite() && value > 0.0) => {
            let text = format!("{} is {what}, above 0, found {value}", letter as char);
            refuse("I0592", words.span(letter), text)
        }
        value => Ok(value),
    };
    let pitch = positive(b'I', "the pitch in mm")?;
    let threads = positive(b'J', "the number of threads per inch")?;
    let out = positive(b'L', "the speed of the way out in rev/min")?;
    if pitch.is_some() && threads.is_some() {
        let text = "the pitch is given by I (mm) or by J (threads per inch), not by both";
        return refuse("I0593", words.span(b'J'), text);
    }
    let lead_mm = pitch.or(threads.map(|threads| MM_PER_INCH / threads));
    // F in the block is a lead of its own
    let stated = words.get(b'F').is_none();
    let lead_mm = lead_mm.or(kept.lead_mm.filter(|_| stated));
    if lead_mm.is_none() && modes.feed <= 0.0 {
        let code = crate::codes::spelling::written(cycle.code());
        let text = format!("G{code} needs I, the pitch in mm, or J, the threads per inch");
        return refuse("I0594", words.place.span, text);
    }
    let return_speed = out.map_or(kept.return_speed, ReturnSpeed::Rpm);
    let peck = tap::peck_word(words, kept.peck)?;
    Ok(TapWords { return_speed, peck, lead_mm, ..kept })
}
