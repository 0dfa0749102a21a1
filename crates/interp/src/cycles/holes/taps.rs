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
    geometry::frame::Point,
    resolve::{Resolver, position},
};
use canon::{Axis, Holder, OpKind, ReturnAcceleration, Tap, ToolKind};
use diag::{Diagnostic, Span};
use units::{Angle, Lead, Length, Spin, Time};

/// An F of an earlier block whose lead is this much off the tap's own (as a fraction) was not meant for it.
const LEAD_TOLERANCE: f64 = 0.01;

impl Resolver {
    pub(crate) fn tap(&mut self, tap: &CycleTap, span: Span) {
        let hole = &tap.hole;
        if !self.plane_is_straight(hole.plane, span) {
            return;
        }
        let Some(lead_mm) = self.programmed_lead(tap, span) else { return };
        let axis = hole.plane.normal();
        let sign = if tap.sense == Sense::Clockwise { 1.0 } else { -1.0 };
        let surface = Self::surface(hole.at[axis.index()], hole.bottom);
        let start = self.machine(&hole.at);
        self.rapid(&start, span);
        self.say_path(span);
        let mut end = start;
        end[axis.index()] = self.level(hole, hole.bottom);
        self.check_stroke(&start, &end, span);
        let spin = Spin::rpm(self.spindle.speed);
        self.push(
            span,
            OpKind::Tap(Tap {
                axis,
                start: position(&start),
                bottom: Length::mm(end[axis.index()]),
                surface: Length::mm(self.level(hole, surface)),
                zero: Length::mm(self.level(hole, 0.0)),
                own_zero: self.own_zero().map(|at| at.along(axis).of_linear()),
                lead: Lead::mm_per_rev(sign * lead_mm),
                spin,
                return_spin: match tap.return_speed {
                    ReturnSpeed::Times(factor) => spin * factor,
                    ReturnSpeed::Rpm(rpm) => Spin::rpm(rpm),
                },
                return_acceleration: tap.return_acceleration,
                dwell: Time::s(tap.dwell_s),
                start_angle: self
                    .clutch_lead()
                    .is_none()
                    .then_some(Angle::deg(tap.start_angle_deg)),
                peck: tap.peck.map(|depth| Length::mm(depth * self.mm())),
            }),
        );
        self.throw_chips(hole, sign, Spin::ZERO, span);
        let mut clear = start;
        clear[axis.index()] = self.level(hole, hole.clear);
        self.rapid(&clear, span);
    }

    /// Lead of the mounted tap, without sign, if a clutch holder holds it.
    fn clutch_lead(&self) -> Option<f64> {
        match &self.tools.get(self.tool)?.kind {
            ToolKind::Tap(tap) if matches!(tap.holder, Holder::Clutch { .. }) => {
                Some(tap.lead.value().abs())
            }
            _ => None,
        }
    }

    /// F/S, or F with G95, or the pitch of the tap in the spindle where no F is in force.
    fn programmed_lead(&mut self, tap: &CycleTap, span: Span) -> Option<f64> {
        if self.spindle.surface.is_some() {
            let text =
                "a tap needs a speed in revolutions per minute, but G96 is in force: write G97 S…";
            self.report(Diagnostic::error("I0708", span, text));
            return None;
        }
        if self.spindle.speed <= 0.0 {
            let text = "a tap needs a spindle speed: write S above 0 before it";
            self.report(Diagnostic::error("I0703", span, text));
            return None;
        }
        if tap.lead_mm.is_some() {
            return tap.lead_mm;
        }
        let by_feed = self.lead_by_feed();
        let is_other =
            |own: f64| by_feed.is_some_and(|lead| (lead - own).abs() > LEAD_TOLERANCE * own);
        if !tap.feed_stated && self.clutch_lead().is_some_and(is_other) {
            return self.clutch_lead();
        }
        by_feed.or_else(|| self.lead_of_the_tap(span))
    }

    /// The pitch of the tap in the spindle, said once for each tool.
    fn lead_of_the_tap(&mut self, span: Span) -> Option<f64> {
        let tool = self.tools.get(self.tool)?;
        let ToolKind::Tap(tap) = &tool.kind else { return None };
        let (number, lead) = (tool.number, tap.lead.value().abs());
        if self.pitch_said != Some(number) {
            let text = format!(
                "no F is in force: the lead is that of T{number} ({}), {lead} mm per revolution",
                tap.designation
            );
            self.pitch_said = Some(number);
            self.report(Diagnostic::note("I0712", span, text));
        }
        Some(lead)
    }

    pub(crate) fn rigid_tap(
        &mut self,
        to: &Point,
        lead: f64,
        return_factor: f64,
        sense: Sense,
        span: Span,
    ) {
        let (start, end) = (self.at, self.machine(to));
        let moved: Vec<usize> = (0..9).filter(|i| (end[*i] - start[*i]).abs() > 1e-9).collect();
        let axis = match moved[..] {
            [i @ (0..=2 | 6..=8)] => Axis::ALL[i],
            [] => {
                self.report(Diagnostic::error(
                    "I0709",
                    span,
                    "this tap has no depth: it ends where it starts",
                ));
                return;
            }
            _ => return self.crooked(&moved, span),
        };
        if self.spindle.speed <= 0.0 || self.spindle.surface.is_some() {
            let text = "a tap needs a spindle speed in revolutions per minute: write G97 and S above 0 before it";
            self.report(Diagnostic::error("I0703", span, text));
            return;
        }
        let i = axis.index();
        let inwards_negative = end[i] < start[i];
        let right_hand = (sense == Sense::Clockwise) == inwards_negative;
        let lead = Lead::mm_per_rev(if right_hand { lead } else { -lead } * self.mm());
        let program = self.frame.to_program(&start)[i];
        let zero = program + Self::surface(program, to[i] * self.mm()) - program;
        let surface = start[i] + (zero - program);
        let spin = Spin::rpm(self.spindle.speed);
        self.check_stroke(&start, &end, span);
        self.say_path(span);
        self.push(
            span,
            OpKind::Tap(Tap {
                axis,
                start: position(&start),
                bottom: Length::mm(end[i]),
                surface: Length::mm(surface),
                zero: Length::mm(start[i] - program),
                own_zero: self.own_zero().map(|at| at.along(axis).of_linear()),
                lead,
                spin,
                return_spin: spin * return_factor,
                return_acceleration: ReturnAcceleration::AsSet,
                dwell: Time::ZERO,
                start_angle: Some(Angle::ZERO),
                peck: None,
            }),
        );
    }

    fn crooked(&mut self, moved: &[usize], span: Span) {
        let names: Vec<_> = moved.iter().map(|i| Axis::ALL[*i].letter().to_string()).collect();
        let text =
            format!("a tap moves along one axis, but this one would move {}", names.join(" and "));
        let help = "move to the hole with G0 first, then tap with the axis word alone";
        self.report(Diagnostic::error("I0705", span, text).with_help(help));
    }
}
