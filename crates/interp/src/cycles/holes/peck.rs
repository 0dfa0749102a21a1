//! Drilling in pecks: G73, which breaks the chip, and G83, which comes out of the hole.
//!
//! ```text
//!   R ┼ ● ↓   ┌─┐     G83: after each Q out to R, back in fast to a little above the depth before
//!     │   ↓ ┌─┘ ↓     G73: after each Q back by that little, and on
//!   Z ┴   ┘     ┘
//! ```
//!
//! Source: NISTIR 6556, section 3.5.16.4; LinuxCNC 2.9 manual, "G73", "G83".
use crate::{
    call::{Call, CycleHole, Sink, Units, out::Out},
    codes::spelling::{Written, short},
    cycles::holes::pattern::{Pattern, at_level},
    fault::{Outcome, refuse},
    modes::{Cycle, Modes},
    state::executor::Settings,
    words::Words,
};

/// How far above the last depth the rapid back into the hole ends, and how far G73 backs off: 0.010
/// inch.
const CLEARANCE_INCH: f64 = 0.010;
/// More pecks than this in one hole are a slip of the pen, and more in all holes of a block: each
/// is held until the block is over.
const MAX_PECKS: f64 = 10_000.0;
const MAX_PECKS_OF_BLOCK: f64 = 100_000.0;

/// Q of the block, or the one kept.
pub(crate) fn check_word(words: &Words, code: Written, peck: Option<f64>) -> Outcome {
    match peck {
        None => {
            refuse("I0508", words.place.span, format!("G{code} needs Q, the depth of each peck"))
        }
        Some(q) if q <= 0.0 => refuse(
            "I0509",
            words.span(b'Q'),
            format!("Q is the depth of each peck, above 0, found {q}"),
        ),
        Some(_) => Ok(()),
    }
}

/// A peck so small that it is a slip of the pen.
pub(crate) fn check_depth(words: &Words, peck: f64, depth: f64) -> Outcome {
    if depth / peck > MAX_PECKS {
        let text = format!(
            "Q{peck} would make more than {MAX_PECKS} pecks: at least {} is needed",
            short(depth / MAX_PECKS)
        );
        return refuse("I0511", words.span(b'Q'), text);
    }
    Ok(())
}

/// Pecks are moves that are held in memory until their block is over.
pub(crate) fn check_block(
    words: &Words,
    settings: &Settings,
    repeats: u32,
    pattern: &Pattern,
) -> Outcome {
    if !matches!(pattern.cycle, Cycle::ChipBreak | Cycle::Peck) {
        return Ok(());
    }
    let letter = settings.rules.repeats;
    let pecks = f64::from(repeats) * ((pattern.r - pattern.bottom) / pattern.peck).ceil();
    if pecks > MAX_PECKS_OF_BLOCK {
        let name = letter as char;
        let text = format!(
            "{name}{repeats} of these holes would make {pecks} pecks in one block: at most {MAX_PECKS_OF_BLOCK} are made; \
             a larger Q or a smaller {name} works"
        );
        return refuse("I0511", words.span(letter), text);
    }
    Ok(())
}

/// All pecks but the last.
pub(crate) fn in_pecks<S: Sink>(
    modes: &Modes,
    pattern: &Pattern,
    hole: &CycleHole,
    out: &mut Out<'_, S>,
) {
    let clearance = match modes.units {
        Units::Inch => CLEARANCE_INCH,
        Units::Millimetre => CLEARANCE_INCH * units::MM_PER_INCH,
    };
    let mut depth = pattern.r - pattern.peck;
    while depth > pattern.bottom {
        out.say(&Call::Line(at_level(hole, depth)));
        if pattern.cycle == Cycle::Peck {
            out.say(&Call::Rapid(at_level(hole, pattern.r)));
        }
        out.say(&Call::Rapid(at_level(hole, depth + clearance)));
        depth -= pattern.peck;
    }
}
