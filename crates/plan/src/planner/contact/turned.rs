//! Threads that an insert turns in the air: all passes of one beside the bar.
use super::say::name;
use super::{Planner, ROUNDING};
use crate::findings::Cause;
use crate::words::{length, place, word};
use alloc::format;
use canon::Axis;
use diag::{Diagnostic, Span};

/// Ends of passes that are no farther from one another are those of one thread, mm.
const SAME: f64 = 0.1;

/// The passes of a thread so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passes {
    /// Of the first one.
    span: Span,
    /// Z of the tip where it ends.
    end: f64,
    /// How far off the bar the nearest of them went, and below zero, how deep in it; mm. `None`: all stayed beside its ends.
    gap: Option<f64>,
}

impl Planner {
    /// A pass that ends at this Z of the tip, and [how far](crate::bar::Outline::gap) it kept off the bar.
    pub(super) fn turned_pass(&mut self, span: Span, end: f64, gap: Option<f64>) {
        let Some(contact) = &mut self.contact else { return };
        match &mut contact.passes {
            Some(passes) if (passes.end - end).abs() <= SAME => {
                passes.gap = [passes.gap, gap].into_iter().flatten().reduce(f64::min);
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
        let Some(passes) = contact.passes.take() else { return };
        let Some((outline, tool)) = contact.outline.as_ref().zip(self.tools.get(self.tool)) else {
            return;
        };
        if passes.gap.is_some_and(|gap| gap <= ROUNDING) {
            return;
        }
        let frame = &self.frame;
        let across = outline.axis[0] + frame.tool.linear[0].value();
        let off = passes.gap.map_or_else(
            || {
                let face = outline.face() + tool.worn_length().value();
                format!("stays before the bar's face at {}", place(frame, Axis::Z, face))
            },
            |gap| {
                let surface = word(frame, Axis::X, across + outline.radius());
                format!(
                    "passes the bar, whose surface is at {surface}, {} off it",
                    length(frame, gap)
                )
            },
        );
        let said = [format!("{} {off}", name(tool)), ": nothing is cut here".into()];
        let by = passes.gap.unwrap_or_default();
        let cause = Cause { code: "M0366", which: [contact.mounted, 3, 0] };
        let help = "X of the last pass is the thread's root, below the bar's surface; [setup.stock] in the machine's file says how large the bar is";
        self.findings.merge(cause, by, || {
            (Diagnostic::warning("M0366", passes.span, "").with_help(help), said)
        });
    }
}
