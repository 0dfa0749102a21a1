//! Hobbing: the work geared to the hob's spindle.
//!
//! ```text
//!   M3 S300              the hob turns, at the program's S
//!   G81 T40 L1 Q2 P20    40 teeth, 1 start, module 2 mm (G20: teeth per inch of pitch diameter), helix 20° right hand
//!   G1 Z-30 F12          the work turns once more for each lead of the helix that Z travels
//!   G80                  the work stops
//! ```
//!
//! A G81 with T, L or Q and without an axis word is hobbing; with an axis word it is the drilling
//! cycle. The signs: L below zero turns the work against the hob, P below zero is a left-hand
//! helix.
//!
//! Source: G81 T L Q P of Fanuc's hobbing function (electronic gear box); DIN 3960 for lead and
//! pitch circle.
use crate::{
    call::{Call, HobOrder, Sink, out::Out},
    codes::{AXES, GGroup, POLAR, set},
    compensation,
    fault::{Outcome, refuse},
    modes::Modes,
    resolve::{Resolver, position},
    words::Words,
};
use canon::{Hob, OpKind};
use diag::Span;
use units::{Angle, Length};

/// Teeth of a gear.
const TEETH: (u32, u32) = (2, 10_000);
/// Starts of a hob.
const MOST_STARTS: i64 = 20;
/// Module, mm.
const MODULE_MM: (f64, f64) = (0.05, 100.0);
/// Steepest helix, degrees.
const STEEPEST_DEG: f64 = 80.0;
/// The hob's spindle, and that of the work.
const SPINDLES: [u8; 2] = [0, 1];

/// Execute the block if it begins hobbing. Whether it did.
#[inline]
pub(crate) fn hobbing<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    out: &mut Out<'_, S>,
) -> Outcome<bool> {
    let told = [b'T', b'L', b'Q'].map(|letter| words.get(letter));
    let drills = words.any(AXES | POLAR);
    if words.g(GGroup::Motion) != Some(810) || drills || told.iter().all(Option::is_none) {
        return Ok(false);
    }
    let span = words.place.span;
    if !words.is_alone(set("TLQP")) {
        let text = "G81 T L Q P gears the work to the hob: write it in a block of its own";
        return refuse("I0823", span, text);
    }
    if modes.compensating() {
        return compensation::no_compensation(words).map(|()| true);
    }
    let [Some(teeth), Some(starts), Some(size)] = told else {
        let text = "hobbing needs T teeth, L starts of the hob and Q the module: G81 T40 L1 Q2 works; drilling needs an axis word";
        return refuse("I0821", span, text);
    };
    let whole = crate::codes::number::near_whole;
    let (fewest, most) = TEETH;
    let Some(teeth) =
        whole(teeth).and_then(|n| u32::try_from(n).ok()).filter(|n| (fewest..=most).contains(n))
    else {
        let text = format!("expected {fewest} to {most} teeth, found T{teeth}");
        return refuse("I0822", words.span(b'T'), text);
    };
    let Some(starts) =
        whole(starts).filter(|n| *n != 0 && n.abs() <= MOST_STARTS).map(|n| n as i32)
    else {
        let text = format!(
            "expected 1 to {MOST_STARTS} starts of the hob (below zero: the work turns against it), found L{starts}"
        );
        return refuse("I0822", words.span(b'L'), text);
    };
    let inches = modes.units == crate::call::Units::Inch;
    let module_mm = if inches { 25.4 / size } else { size };
    if !(MODULE_MM.0..=MODULE_MM.1).contains(&module_mm) {
        let text = format!(
            "expected a module from {} to {} mm, found Q{size}{}",
            MODULE_MM.0,
            MODULE_MM.1,
            if inches { " (diametral pitch)" } else { "" }
        );
        return refuse("I0822", words.span(b'Q'), text);
    }
    let helix_deg = words.get(b'P').unwrap_or(0.0);
    if helix_deg.abs() > STEEPEST_DEG {
        let text =
            format!("expected a helix of up to {STEEPEST_DEG}° either way, found P{helix_deg}");
        return refuse("I0822", words.span(b'P'), text);
    }
    modes.hobbing = true;
    modes.motion = crate::modes::Motion::None;
    let asked = modes.gear;
    out.say(&Call::Hob(&HobOrder { teeth, starts, module_mm, helix_deg, asked }));
    Ok(true)
}

/// G80 ends hobbing, if it was begun.
pub(crate) fn hobbing_end<S: Sink>(modes: &mut Modes, out: &mut Out<'_, S>) {
    if core::mem::take(&mut modes.hobbing) {
        out.say(&Call::HobEnd);
    }
}

/// From the program's words to the operation.
pub(crate) fn operation(resolver: &mut Resolver, order: &HobOrder, span: Span) {
    let hob = Hob {
        hob: SPINDLES[0],
        work: SPINDLES[1],
        teeth: order.teeth,
        starts: order.starts,
        module: Length::mm(order.module_mm),
        helix: Angle::deg(order.helix_deg),
        zero: position(&resolver.machine(&[0.0; 9])),
        own_zero: resolver.own_zero(),
        asked: order.asked,
    };
    resolver.push(span, OpKind::Hob(hob));
}
