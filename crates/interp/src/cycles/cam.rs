//! Cam grinding: the neutral codes G150 to G155, and the words of Toyoda's grinders that mean the
//! same.
//!
//! ```text
//!   toyoda               neutral                 what it orders
//!   G51 P1234 [R30]      G151 P1234 [R30]        follow profile 1234, turned by 30° on the shaft; P0 ends it
//!   G52, G53, G55        G152, G153, G155        forget samples, take samples, compute and keep the phase error
//!   G50                  G150                    compensate what is sent
//!   G01 X-0.1 F R S      G154 X-0.1 F R S        grind: X all told, F a turn at a rate of R a turn, work at S rpm
//!   G04 S P              G154 S P                turn on P times: spark out, or idle in the air
//! ```
//!
//! In cam mode X is what the wheel takes off, so it is negative whatever G90 or G91 say. R is F if
//! it is not stated, and S stays in force from one grinding block to the next.
//!
//! Source: JPH0622778B2, figures 8 and 9.
use crate::{
    call::{Call, CamCall, Sink, out::Out},
    codes::GGroup,
    fault::{Outcome, refuse},
    modes::{Modes, Motion},
    resolve::Resolver,
    state::executor::Settings,
    words::Words,
};
use canon::{CamOrder, OpKind};
use diag::{Diagnostic, Span};
use units::{Angle, Lead, Length, Spin};

/// The code that selects a profile, in tenths.
const SELECT: u16 = 1510;
/// Most turns of one spark-out.
const MOST_TURNS: u32 = 10_000;

/// The cam code of the block at hand, in tenths, if it has one.
#[inline]
fn cam_code(words: &Words, modes: &Modes, settings: &Settings) -> Option<u16> {
    if let Some(code) = words.g(GGroup::Cam) {
        return Some(code);
    }
    if !settings.rules.grinds_by_feed || !modes.cam {
        return None;
    }
    let dwell = words.g(GGroup::NonModal) == Some(40);
    let code = words.g(GGroup::Motion).map(Motion::from_code);
    let feed = code == Some(Motion::Feed) || code.is_none() && modes.motion == Motion::Feed;
    (dwell || feed && words.get(b'X').is_some()).then_some(1540)
}

/// Execute the block if it is one of cam grinding. Whether it was.
#[inline]
pub(crate) fn cam<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    out: &mut Out<'_, S>,
) -> Outcome<bool> {
    let Some(code) = cam_code(words, modes, settings) else { return Ok(false) };
    let allowed = crate::codes::g_code(code).map_or(0, |code| code.letters);
    let sampled = words.g(GGroup::NonModal) == Some(40);
    if words.g(GGroup::Cam).is_some() && !sampled {
        words.check_letters(0, allowed)?;
    }
    let call = match code {
        1500 => CamCall::Compensate,
        SELECT => select(words)?,
        1520 => CamCall::ResetSampling,
        1530 => CamCall::StartSampling,
        1550 => CamCall::StorePhase,
        _ => grind(words, modes)?,
    };
    let place = words.place.span;
    if !modes.cam && !matches!(call, CamCall::Select(..) | CamCall::Deselect) {
        let [code, select] = [code, SELECT].map(|code| settings.rules.writes(code));
        let text = format!("G{code} needs a profile: write G{select} P… before it");
        return refuse("I1101", place, text);
    }
    modes.cam = !matches!(call, CamCall::Deselect);
    modes.motion = Motion::None;
    out.say(&Call::Cam(call));
    if call == CamCall::StartSampling && words.g(GGroup::NonModal) == Some(40) {
        // G53 G04 S P: the turns that are sampled stand in the same block
        let turns = grind(words, modes)?;
        out.say(&Call::Cam(turns));
    }
    Ok(true)
}

fn select(words: &Words) -> Outcome<CamCall> {
    let place = words.place.span;
    match words.whole(b'P', 999_999)? {
        None => {
            refuse("I1102", place, "expected P, the number of the profile (P0 ends cam grinding)")
        }
        Some(0) => Ok(CamCall::Deselect),
        Some(number) => Ok(CamCall::Select(number, words.get(b'R').unwrap_or(0.0))),
    }
}

fn grind(words: &Words, modes: &mut Modes) -> Outcome<CamCall> {
    if let Some(rpm) = words.get(b'S') {
        modes.cam_rpm = rpm;
    }
    let rpm = modes.cam_rpm;
    if rpm.is_nan() || rpm <= 0.0 {
        let text = format!("expected S, the speed of the work in rpm, above 0, found {rpm}");
        return refuse("I1103", words.span(b'S'), text);
    }
    let Some(x) = words.get(b'X') else {
        return match words.whole(b'P', MOST_TURNS)? {
            Some(turns) if turns > 0 => Ok(CamCall::SparkOut(turns, rpm)),
            _ => refuse(
                "I1104",
                words.place.span,
                "expected X, what to take off, or P, whole turns to spark out",
            ),
        };
    };
    if x.is_nan() || x >= 0.0 {
        let text = format!("expected X below 0, towards the work, found X{x}");
        return refuse("I1105", words.span(b'X'), text);
    }
    let per_turn = words.get(b'F').unwrap_or(0.0);
    if per_turn.is_nan() || per_turn <= 0.0 {
        let text = format!("expected F, the infeed of each turn, above 0, found {per_turn}");
        return refuse("I1106", words.span(b'F'), text);
    }
    let rate = words.get(b'R').unwrap_or(per_turn);
    if rate.is_nan() || rate < per_turn {
        let text = format!(
            "R{rate} a turn cannot make an infeed of F{per_turn} within the turn: R{per_turn} works"
        );
        return refuse("I1107", words.span(b'R'), text);
    }
    Ok(CamCall::Grind { stock: -x, per_turn, rate, rpm })
}

/// In machine coordinates and mm.
pub(crate) fn operation(resolver: &mut Resolver, call: CamCall, span: Span) {
    let mm = |value: f64| Length::mm(value * resolver.mm());
    let order = match call {
        CamCall::Select(profile, degrees) => {
            let zero = resolver.machine(&[0.0; 9]);
            let (centre, zero) = (Length::mm(zero[0]), Length::mm(zero[2]));
            if resolver.frame.rotation() != 0.0 {
                let text =
                    "the work offset is turned about Z: a cam is ground along X of the machine";
                resolver.report(Diagnostic::error("I1108", span, text));
            }
            CamOrder::Select { profile, phase: Angle::deg(degrees), centre, zero }
        }
        CamCall::Deselect => CamOrder::Deselect,
        CamCall::Compensate => CamOrder::Compensate,
        CamCall::ResetSampling => CamOrder::ResetSampling,
        CamCall::StartSampling => CamOrder::StartSampling,
        CamCall::StorePhase => CamOrder::StorePhase,
        CamCall::Grind { stock, per_turn, rate, rpm } => CamOrder::Grind {
            stock: mm(stock),
            per_turn: mm(per_turn),
            rate: Lead::mm_per_rev(rate * resolver.mm()),
            spin: Spin::rpm(rpm),
        },
        CamCall::SparkOut(turns, rpm) => CamOrder::SparkOut { spin: Spin::rpm(rpm), turns },
    };
    resolver.push(span, OpKind::Cam(order));
}
