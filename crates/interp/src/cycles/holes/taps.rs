//! Tapping calls to one [`canon::Tap`] each.
//!
//! ```text
//!   G84, G84.2   lead = F/S (G94), F (G95), else the tap's pitch: right-hand; starts at the angle A
//!   G74, G84.3   the same, left-hand
//!   G77, G78     lead = I, or 25.4/J: Brother's, right-hand and left-hand
//!   G33.1        lead = K;  right-hand if M3 goes into the negative direction of its axis; starts at 0°
//! ```
//!
//! A tap starts at the same spindle angle every time, so that a hole can be tapped again in its own
//! thread; in a clutch holder nothing ties it to the spindle and no angle is asked. Whether the lead is the tap's own is judged before motion, where the tool is known.
use crate::{
    call::{CycleTap, ReturnSpeed, Sense},
    cycles::holes::chips,
    resolve::{Resolver, position},
};
use canon::{Holder, OpKind, Tap, ToolKind};
use diag::{Diagnostic, Span};
use units::{Angle, Lead, Length, Spin, Time};

/// An F of an earlier block whose lead is this much off the tap's own (as a fraction) was not meant for it.
const LEAD_TOLERANCE: f64 = 0.01;

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
    chips::throw_chips(resolver, hole, sign, Spin::ZERO, span);
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
            "no F is in force: the lead is that of T{number} ({}), {lead} mm per revolution",
            tap.designation
        );
        resolver.pitch_said = Some(number);
        resolver.report(Diagnostic::note("I0712", span, text));
    }
    Some(lead)
}
