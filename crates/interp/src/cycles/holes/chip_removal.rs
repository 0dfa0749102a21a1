//! Chip removal on the way: the words U and E of the drilling and tapping cycles.
//!
//! ```text
//!   G81 X Y Z R P F U K E        G84 X Y Z R P F S U K E
//!                   │   └ E: after each repetition whose number is a multiple of it; absent or 0: never
//!                   └ U: speed, rev/min, against the cut; below S
//!
//!   initial ┬────●  ← the spindle goes on with it while the axes rise, move and come down
//!         R ┼ · ·│  ← here it is told to turn against its direction at U
//!    bottom ┴    │
//! ```
//!
//! Brother's dialect knows the words always, the others where the machine is set to it (`U` is the
//! name of an axis there). A machine's setting holds for cycles that do not say U. Repetitions are
//! counted from the block that names the cycle; blocks that repeat it by their position alone go on
//! counting.
//!
//! Source: Brother's description of the cycle, paragraphs 21 to 51; its text breaks off, and what
//! follows the reversal is deduced: forward again at S after drilling, at rest after a tap.
use crate::{
    call::out::Out, codes::spelling::Written, modes::Modes, state::executor::Settings, words::Words,
};
use crate::{
    call::{CycleHole, Sink},
    codes::{Letters, index, set},
    fault::{Outcome, error, refuse},
    modes::{Cycle, Motion},
    resolve::Resolver,
    setup::Chips,
};
use canon::{ChipRemoval, OpKind, SpindleOrder};
use diag::{Diagnostic, Span};
use units::{Length, Spin};

/// An interval beyond this is a slip of the pen.
const MAX_INTERVAL: u32 = 100_000;

/// Whether chips may be thrown off after it.
const fn throws_chips(cycle: Cycle) -> bool {
    matches!(cycle, Cycle::Drill | Cycle::DrillDwell) || cycle.tap_sense().is_some()
}

/// Letters that a cycle takes beside those of its code: the dialect's and the machine's.
pub(crate) fn letters_beside(settings: &Settings, motion: Option<Motion>) -> Letters {
    let Some(Motion::Cycle(cycle)) = motion else { return 0 };
    let rules = settings.rules;
    let mut letters = 1 << index(rules.repeats);
    if throws_chips(cycle) && (rules.chip_removal || settings.cycles.chip_removal.is_some()) {
        letters |= set("UE");
    }
    if rules.drilling_waits && cycle == Cycle::Drill {
        letters |= set("P");
    }
    letters
}

/// U and E of this block, or what the cycle kept, or the machine's setting.
pub(crate) fn chips<S: Sink>(
    words: &Words,
    modes: &Modes,
    settings: &Settings,
    cycle: Cycle,
    code: Written,
    kept: Option<Chips>,
    out: &mut Out<'_, S>,
) -> Outcome<Option<Chips>> {
    if !throws_chips(cycle) {
        return Ok(None);
    }
    let usual = kept.or(settings.cycles.chip_removal);
    let said = words.get(b'U');
    let every = words.whole(b'E', MAX_INTERVAL)?.or(usual.map(|u| u.every));
    let Some(rpm) = said.or(usual.map(|u| u.rpm)) else {
        if words.get(b'E').is_some_and(|e| e > 0.0) {
            let text = "E throws no chips off without U, the spindle speed that does";
            return refuse("I0563", words.span(b'E'), text);
        }
        return Ok(None);
    };
    let chips = Chips { rpm, every: every.unwrap_or(0) };
    if said.is_some() && every.is_none() {
        let text = "U throws no chips off without E: E1 does after every repetition, E2 after every second";
        out.remarks.push(Diagnostic::warning("I0564", words.span(b'U'), text));
    }
    chips_are_possible(words, modes, chips, cycle, code, said.is_some(), out)
}

/// Against S, which must be above U, and the sense, which must be known.
fn chips_are_possible<S: Sink>(
    words: &Words,
    modes: &Modes,
    chips: Chips,
    cycle: Cycle,
    code: Written,
    said: bool,
    out: &mut Out<'_, S>,
) -> Outcome<Option<Chips>> {
    let (span, spindle) = (words.span(b'U'), modes.spindle);
    if !(chips.rpm.is_finite() && chips.rpm >= 0.0) {
        let text = format!(
            "U is a spindle speed, 0 or more, found {}: its sense is against the cut",
            chips.rpm
        );
        return refuse("I0565", span, text);
    }
    if chips.rpm == 0.0 || chips.every == 0 {
        return Ok(Some(chips));
    }
    if spindle.constant_surface_speed {
        return refuse(
            "I0566",
            span,
            "chips are thrown off at U against S in revolutions per minute: write G97 S",
        );
    }
    if chips.rpm >= spindle.speed {
        let text = format!(
            "the speed that throws chips off must be below S{}, found {}",
            spindle.speed, chips.rpm
        );
        let below = (spindle.speed / 2.0).floor();
        if said {
            return Err(error("I0567", span, text).with_help(format!("U{below} works")).into());
        }
        let help = format!("the machine's setting is left out here; U{below} works");
        out.remarks.push(Diagnostic::warning("I0567", span, text).with_help(help));
        return Ok(None);
    }
    if spindle.turning.is_none() && cycle.tap_sense().is_none() {
        let text = format!(
            "G{code} with U turns the spindle against its direction, but it stands: write M3 or M4"
        );
        return refuse("I0568", span, text);
    }
    Ok(Some(chips))
}

/// Count a repetition: the speed against the cut if chips are thrown off after it.
pub(crate) fn throw_after_this(modes: &mut Modes, chips: Option<Chips>) -> Option<f64> {
    modes.repetition = modes.repetition.saturating_add(1);
    let chips = chips.filter(|c| c.rpm > 0.0 && c.every > 0)?;
    modes.repetition.is_multiple_of(chips.every).then_some(chips.rpm)
}

/// Chips are thrown off on the way out of a hole; afterwards the spindle has the cut's speed again,
/// or stands after a tap.
pub(crate) fn throw_chips(
    resolver: &mut Resolver,
    hole: &CycleHole,
    inwards: f64,
    then: Spin,
    span: Span,
) {
    let Some(rpm) = hole.throw_rpm else { return };
    let (axis, level) = (
        hole.plane.normal(),
        Length::mm(resolver.level(hole, hole.at[hole.plane.normal().index()])),
    );
    let throw = Spin::rpm(-inwards * rpm);
    let order = SpindleOrder::ThrowChips(ChipRemoval { throw, then, axis, level });
    resolver.push(span, OpKind::Spindle { spindle: 0, order });
}

/// From R on, on the rapid out of a drilled hole; the program's speed is in force again afterwards.
pub(crate) fn throw_chips_after_drilling(resolver: &mut Resolver, hole: &CycleHole, span: Span) {
    let sign = resolver.spindle_sign();
    throw_chips(resolver, hole, sign, Spin::rpm(sign * resolver.spindle.speed), span);
}
