//! Threads that an insert turns in the air: all passes of one beside the bar.
use super::{Planner, ROUNDING};
use crate::findings::Cause;
use crate::words::{length, place, word};
use alloc::format;
use canon::Axis;
use diag::{Diagnostic, Span};

/// Ends of passes that are no farther from one another are those of one thread, which may be fed in
/// along a flank; mm.
const SAME: f64 = 0.5;

/// The passes of a thread so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passes {
    /// Of the first one.
    span: Span,
    /// Z of the tip where the last one ends.
    end: f64,
    /// How far off the bar the nearest of them went, and below zero, how deep in it; mm. Infinite:
    /// all stayed beside its ends.
    gap: f64,
}

impl Planner {
    /// A stretch of a pass, and [how far](crate::bar::Outline::gap) it kept off the bar.
    pub(super) fn turned_stretch(&mut self, gap: Option<f64>) {
        if let Some(contact) = &mut self.contact {
            let before = contact.gap.unwrap_or(f64::INFINITY);
            contact.gap = Some(before.min(gap.unwrap_or(f64::INFINITY)));
        }
    }

    /// A pass is over that ends at this Z of the axis.
    pub(in crate::planner) fn turned_pass(&mut self, span: Span, end: f64) {
        let length = self.tools.get(self.tool).map_or(0.0, |tool| tool.worn_length().value());
        let end = end - length;
        let Some(contact) = &mut self.contact else { return };
        let Some(gap) = contact.gap.take() else { return };
        match &mut contact.passes {
            Some(passes) if (passes.end - end).abs() <= SAME => {
                *passes = Passes { end, gap: passes.gap.min(gap), ..*passes };
            }
            _ => {
                self.judge_thread();
                let Some(contact) = &mut self.contact else { return };
                contact.passes = Some(Passes { span, end, gap });
            }
        }
    }

    /// No further pass of the thread comes.
    pub(in crate::planner) fn judge_thread(&mut self) {
        let Some(contact) = &mut self.contact else { return };
        let Some(Passes { span, gap, .. }) = contact.passes.take() else { return };
        let Some((outline, tool)) = contact.outline.as_ref().zip(self.tools.get(self.tool)) else {
            return;
        };
        if gap <= ROUNDING {
            return;
        }
        let frame = &self.frame;
        let off = if gap.is_finite() {
            let across = outline.axis[0] + frame.tool.linear[0].value();
            let surface = word(frame, Axis::X, across + outline.radius());
            format!("passes the bar, whose surface is at {surface}, {} off it", length(frame, gap))
        } else {
            let face = outline.face() + tool.worn_length().value();
            format!("stays before the bar's face at {}", place(frame, Axis::Z, face))
        };
        let said = [format!("{} {off}", tool.name()), ": nothing is cut here".into()];
        let cause = Cause { code: "M0366", which: [contact.mounted, 3, 0] };
        let help = "X of the last pass is the thread's root, below the bar's surface; [setup.stock] in the machine's file says how large the bar is";
        self.findings
            .merge(cause, gap, || (Diagnostic::warning("M0366", span, "").with_help(help), said));
    }
}
