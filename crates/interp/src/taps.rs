//! Tapping calls to one [`canon::Tap`] each.
//!
//! ```text
//!   G84, G74   lead = F/S (G94), F (G95);  + for G84, − for G74;  starts at the spindle's zero angle
//!   G33.1      lead = K;  + if M3 goes into the negative direction of its axis
//! ```
//!
//! A G84 starts at the same spindle angle every time, so that a hole can be tapped again in its own
//! thread; G33.1 starts wherever the spindle stands, as LinuxCNC's does.
use crate::{
    call::{CycleHole, Sense},
    frame::Point,
    resolve::{Resolver, position},
};
use canon::{Axis, OpKind, Tap, ToolKind};
use diag::{Diagnostic, Span};
use units::{Angle, Lead, Length, Spin, Time};

/// A programmed lead this much off the tap's own (as a fraction) is remarked on.
const LEAD_TOLERANCE: f64 = 0.01;

impl Resolver {
    pub(crate) fn tap(&mut self, hole: &CycleHole, sense: Sense, dwell_s: f64, span: Span) {
        if !self.plane_is_straight(hole.plane, span) {
            return;
        }
        let Some(lead_mm) = self.programmed_lead(span) else { return };
        let axis = hole.plane.normal();
        let sign = if sense == Sense::Clockwise { 1.0 } else { -1.0 };
        let surface = Self::surface(hole.at[axis.index()], hole.bottom);
        let start = self.machine(&hole.at);
        let lead = Lead::mm_per_rev(sign * lead_mm);
        self.check_lead(lead, span);
        self.rapid(&start, span);
        self.say_path(span);
        let spin = Spin::rpm(self.spindle.speed);
        self.push(
            span,
            OpKind::Tap(Tap {
                axis,
                start: position(&start),
                bottom: Length::mm(self.level(hole, hole.bottom)),
                surface: Length::mm(self.level(hole, surface)),
                lead,
                spin,
                return_spin: spin,
                dwell: Time::s(dwell_s),
                start_angle: Some(Angle::ZERO),
            }),
        );
        let mut clear = start;
        clear[axis.index()] = self.level(hole, hole.clear);
        self.rapid(&clear, span);
    }

    /// F/S, or F with G95.
    fn programmed_lead(&mut self, span: Span) -> Option<f64> {
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
        Some(self.lead_by_feed())
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
        self.check_lead(lead, span);
        let program = self.frame.to_program(&start)[i];
        let zero = program + Self::surface(program, to[i] * self.mm()) - program;
        let surface = start[i] + (zero - program);
        let spin = Spin::rpm(self.spindle.speed);
        self.say_path(span);
        self.push(
            span,
            OpKind::Tap(Tap {
                axis,
                start: position(&start),
                bottom: Length::mm(end[i]),
                surface: Length::mm(surface),
                lead,
                spin,
                return_spin: spin * return_factor,
                dwell: Time::ZERO,
                start_angle: Some(Angle::ZERO),
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

    /// Compare a lead with that of the mounted tap.
    fn check_lead(&mut self, lead: Lead, span: Span) {
        let Some(tool) = self.tools.get(self.tool) else { return };
        let found = lead.value();
        let remark = match &tool.kind {
            ToolKind::Tap(tap) => {
                let own = tap.lead.value();
                if (found - own).abs() <= LEAD_TOLERANCE * own.abs() {
                    return;
                }
                let wanted = own.abs() * self.spindle.speed;
                let text = format!(
                    "the programmed lead is {found:.4} mm, but T{} ({}) has {own} mm",
                    tool.number, tap.designation
                );
                let warning = Diagnostic::warning("I0710", span, text);
                if own.signum() == found.signum() {
                    warning.with_help(format!(
                        "at S{} the feed would be {wanted:.1} mm/min",
                        self.spindle.speed
                    ))
                } else {
                    warning.with_help("its hand is the other one: G84 and M3 for right-hand taps, G74 and M4 for left-hand ones")
                }
            }
            _ if tool.stand_in => return,
            _ => {
                let text = format!("T{} is no tap: {}", tool.number, tool.description);
                Diagnostic::warning("I0711", span, text)
            }
        };
        self.report(remark);
    }
}
