//! Tapping: G84, G74, G84.2, G84.3. The words of the cycle, and the one [`canon::Tap`] that it
//! orders for each hole.
//!
//! ```text
//!   G84, G84.2   lead = F/S (G94), F (G95), else the tap's pitch: right-hand; starts at the angle A
//!   G74, G84.3   the same, left-hand
//!   G77, G78     lead = I, or 25.4/J: Brother's, right-hand and left-hand
//! ```
//!
//! | word | meaning | left out |
//! |---|---|---|
//! | `A` | spindle angle at which the thread begins at R, degrees | 0 |
//! | `J` | way out: up to 20 so many times S, above 20 rev/min | as fast as in |
//! | `I` | acceleration on the way out: up to 1 that share of what the drives give, above 1 rev/s² | all of it |
//! | `Q` | depth of each peck, above 0; Q0 ends it | all the way at once |
//!
//! A tap starts at the same spindle angle every time, so that a hole can be tapped again in its own
//! thread; in a clutch holder nothing ties it to the spindle and no angle is asked. Whether the
//! lead is the tap's own is judged before motion, where the tool is known.
//!
//! Source: Fanuc, operator's manual of series 0i, "Rigid tapping"; J as a factor: Haas mill
//! operator's manual, G84.
use crate::{
    call::{CycleTap, ReturnSpeed, Sense},
    codes::spelling::Written,
    cycles::holes::chip_removal,
    fault::{Outcome, error, refuse},
    modes::{
        Cycle, Modes,
        tapping::{Rigid, TapWords},
    },
    resolve::{Resolver, lead::meant_lead, position},
    state::{executor::Settings, tools::Tools},
    words::Words,
};
use canon::{Holder, OpKind, ReturnAcceleration, Tap, ToolKind};
use diag::{Diagnostic, Span};
use units::{Angle, Lead, Length, Spin, SpinAccel, Time};

/// J up to this is a factor, above it a speed in rev/min.
const LARGEST_FACTOR: f64 = 20.0;
/// Least share of the acceleration: with less a tap would come out in minutes.
const LEAST_SHARE: f64 = 0.01;
/// More pecks than this in one thread are a slip of the pen.
const MAX_PECKS: f64 = 200.0;
/// An F of an earlier block whose lead is this much off the tap's own (as a fraction) was not meant
/// for it.
const LEAD_TOLERANCE: f64 = 0.01;

/// No F is in force, but the tap in the spindle has a pitch.
pub(crate) fn lead_is_the_taps(modes: &Modes, tools: &Tools, cycle: Cycle) -> bool {
    let tool = tools.library.get(modes.current_tool);
    cycle.tap_sense().is_some()
        && modes.feed == 0.0
        && modes.feed_mode != crate::modes::FeedMode::InverseTime
        && tool.is_some_and(|t| matches!(t.kind, ToolKind::Tap(_)))
}

/// A, I, J, Q of this block, or those that the cycle kept.
pub(crate) fn tap_words(words: &Words, kept: Option<TapWords>) -> Outcome<TapWords> {
    let kept = kept.unwrap_or_default();
    let return_speed = match words.get(b'J') {
        None => kept.return_speed,
        Some(factor) if factor > 0.0 && factor <= LARGEST_FACTOR => ReturnSpeed::Times(factor),
        Some(rpm) if rpm > LARGEST_FACTOR => ReturnSpeed::Rpm(rpm),
        Some(other) => {
            let text = format!(
                "J is the speed of the way out: up to {LARGEST_FACTOR} times S, or rev/min above that, found {other}"
            );
            return refuse("I0535", words.span(b'J'), text);
        }
    };
    let peck = peck_word(words, kept.peck)?;
    let start_angle_deg = words.get(b'A').unwrap_or(kept.start_angle_deg);
    if start_angle_deg.abs() > 1e6 {
        let text = format!("A is an angle within a turn, 0 to 360, found {start_angle_deg}");
        return refuse("I0537", words.span(b'A'), text);
    }
    let return_acceleration = return_acceleration(words, kept.return_acceleration)?;
    let lead_mm = None;
    Ok(TapWords { start_angle_deg, return_speed, return_acceleration, peck, lead_mm })
}

/// Q of this block, or the one kept; Q0 ends it.
pub(crate) fn peck_word(words: &Words, kept: Option<f64>) -> Outcome<Option<f64>> {
    match words.get(b'Q') {
        None => Ok(kept),
        Some(0.0) => Ok(None),
        Some(depth) if depth > 0.0 => Ok(Some(depth)),
        Some(other) => {
            let text = format!("Q is the depth of each peck, above 0, found {other}");
            refuse("I0536", words.span(b'Q'), text)
        }
    }
}

/// I of this block.
fn return_acceleration(words: &Words, kept: ReturnAcceleration) -> Outcome<ReturnAcceleration> {
    match words.get(b'I') {
        None => Ok(kept),
        Some(1.0) => Ok(ReturnAcceleration::AsSet),
        Some(share) if (LEAST_SHARE..1.0).contains(&share) => Ok(ReturnAcceleration::Share(share)),
        Some(limit) if limit > 1.0 => Ok(ReturnAcceleration::Limit(SpinAccel::rev_per_s2(limit))),
        Some(other) => {
            let text = format!(
                "I is the acceleration of the way out: {LEAST_SHARE} to 1 of what the drives give, or rev/s² \
                 above that, found {other}"
            );
            refuse("I0539", words.span(b'I'), text)
        }
    }
}

/// A peck so small that it is a slip of the pen.
pub(crate) fn check_pecks(words: &Words, tap: &TapWords, stroke: f64) -> Outcome {
    match tap.peck {
        Some(peck) if stroke / peck > MAX_PECKS => {
            let least = stroke / MAX_PECKS;
            let text = format!(
                "Q{peck} would make more than {MAX_PECKS} pecks: at least {least} is needed"
            );
            refuse("I0538", words.span(b'Q'), text)
        }
        _ => Ok(()),
    }
}

/// Whether the spindle turns as this thread needs it, or the cycle turns it.
pub(crate) fn check_spindle(
    words: &Words,
    modes: &Modes,
    settings: &Settings,
    (cycle, sense): (Cycle, Sense),
    code: Written,
) -> Outcome {
    let span = words.place.span;
    let by_cycle = settings.rules.taps_turn_spindle;
    let turned = by_cycle && modes.spindle.speed > 0.0;
    let rigid = modes.rigid != Rigid::Off || turned;
    match (sense, modes.spindle.turning) {
        _ if cycle.is_synchro() && turned => Ok(()),
        (_, None) if by_cycle && !rigid => {
            let text = format!("G{code} needs S, the speed of the tap, in its block or before it");
            refuse("I0597", span, text)
        }
        (_, None) if rigid => Ok(()),
        (sense, None) => {
            let start = if sense == Sense::Clockwise { "M3" } else { "M4" };
            let text = format!("G{code} needs a turning spindle: write {start} and S before it");
            let fault = error("I0512", span, text);
            Err(fault.with_help("or M29 and S: the cycle turns it then").into())
        }
        (Sense::Clockwise, Some(Sense::Counterclockwise)) => {
            let text = format!("G{code} taps right-hand threads and needs M3, but M4 is in force");
            let fault = error("I0513", span, text);
            Err(fault.with_help("G74 taps left-hand threads with M4").into())
        }
        (Sense::Counterclockwise, Some(Sense::Clockwise)) => {
            let text = format!("G{code} taps left-hand threads and needs M4, but M3 is in force");
            let fault = error("I0514", span, text);
            Err(fault.with_help("G84 taps right-hand threads with M3").into())
        }
        _ => Ok(()),
    }
}

/// Its operation, with the moves before and after it.
pub(crate) fn operation(resolver: &mut Resolver, tap: &CycleTap, span: Span) {
    let hole = &tap.hole;
    if !resolver.plane_is_straight(hole.plane, span) {
        return;
    }
    let Some(lead_mm) = programmed_lead(resolver, tap, span) else { return };
    let axis = hole.plane.normal();
    let sign = if tap.sense == Sense::Clockwise { 1.0 } else { -1.0 };
    let surface = Resolver::surface(hole.at[axis.index()], hole.bottom);
    let start = resolver.machine(&hole.at);
    resolver.rapid(&start, span);
    resolver.say_path(span);
    let mut end = start;
    end[axis.index()] = resolver.level(hole, hole.bottom);
    resolver.check_stroke(&start, &end, span);
    let spin = Spin::rpm(resolver.spindle.speed);
    resolver.push(
        span,
        OpKind::Tap(Tap {
            axis,
            start: position(&start),
            bottom: Length::mm(end[axis.index()]),
            surface: Length::mm(resolver.level(hole, surface)),
            zero: Length::mm(resolver.level(hole, 0.0)),
            own_zero: resolver.own_zero().map(|at| at.along(axis).of_linear()),
            lead: Lead::mm_per_rev(sign * lead_mm),
            spin,
            return_spin: match tap.return_speed {
                ReturnSpeed::Times(factor) => spin * factor,
                ReturnSpeed::Rpm(rpm) => Spin::rpm(rpm),
            },
            return_acceleration: tap.return_acceleration,
            dwell: Time::s(tap.dwell_s),
            start_angle: clutch_lead(resolver).is_none().then_some(Angle::deg(tap.start_angle_deg)),
            peck: tap.peck.map(|depth| Length::mm(depth * resolver.mm())),
        }),
    );
    chip_removal::throw_chips(resolver, hole, sign, Spin::ZERO, span);
    let mut clear = start;
    clear[axis.index()] = resolver.level(hole, hole.clear);
    resolver.rapid(&clear, span);
}

/// Lead of the mounted tap, without sign, if a clutch holder holds it.
fn clutch_lead(resolver: &Resolver) -> Option<f64> {
    match &resolver.tools.get(resolver.tool)?.kind {
        ToolKind::Tap(tap) if matches!(tap.holder, Holder::Clutch { .. }) => {
            Some(tap.lead.value().abs())
        }
        _ => None,
    }
}

/// F/S, or F with G95, or the pitch of the tap in the spindle where no F is in force.
fn programmed_lead(resolver: &mut Resolver, tap: &CycleTap, span: Span) -> Option<f64> {
    if resolver.spindle.surface.is_some() {
        let text =
            "a tap needs a speed in revolutions per minute, but G96 is in force: write G97 S…";
        resolver.report(Diagnostic::error("I0708", span, text));
        return None;
    }
    if resolver.spindle.speed <= 0.0 {
        let text = "a tap needs a spindle speed: write S above 0 before it";
        resolver.report(Diagnostic::error("I0703", span, text));
        return None;
    }
    if tap.lead_mm.is_some() {
        return tap.lead_mm;
    }
    let by_feed = resolver.lead_by_feed();
    let word = ('F', resolver.feed_of_a_mm());
    let by_feed = by_feed.map(|lead| meant_lead(resolver, lead, word, span));
    let is_other = |own: f64| by_feed.is_some_and(|lead| (lead - own).abs() > LEAD_TOLERANCE * own);
    if !tap.feed_stated && clutch_lead(resolver).is_some_and(is_other) {
        return clutch_lead(resolver);
    }
    by_feed.or_else(|| lead_of_the_tap(resolver, span))
}

/// The pitch of the tap in the spindle, said once for each tool.
fn lead_of_the_tap(resolver: &mut Resolver, span: Span) -> Option<f64> {
    let tool = resolver.tools.get(resolver.tool)?;
    let ToolKind::Tap(tap) = &tool.kind else { return None };
    let (number, lead) = (tool.number, tap.lead.value().abs());
    if resolver.pitch_said != Some(number) {
        let text = format!(
            "no F is in force: the lead is that of T{number} ({}), {} {} per revolution",
            tap.designation,
            crate::codes::spelling::short(lead / resolver.units.in_mm()),
            resolver.units.symbol()
        );
        resolver.pitch_said = Some(number);
        resolver.report(Diagnostic::note("I0712", span, text));
    }
    Some(lead)
}
