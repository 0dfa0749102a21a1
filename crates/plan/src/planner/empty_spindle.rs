//! A cut with no tool in the spindle, though the program has selected one.
//!
//! ```text
//!   T1          selected: it is brought to the changer, and no more
//!   S5000 M3                       M6 would put it into the spindle
//!   G1 Z-2 F300                    fed, the spindle turns, and it is empty: said once a tool
//! ```
//!
//! Of a program that selects no tool the spindle's nose is looked at, where it meets the stock
//! ([`contact`](super::contact)). Holes and taps with no tool have findings of their own.
use super::{Job, Planner};
use alloc::format;
use diag::{Diagnostic, Span};

/// A tool that T has selected and no M6 has brought yet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SelectedTool {
    number: u32,
    /// The block of the T.
    span: Span,
    /// It was said that it is missing.
    said: bool,
}

impl SelectedTool {
    pub(super) const fn number(&self) -> u32 {
        self.number
    }

    /// Line of the T.
    pub(super) const fn line(&self) -> u32 {
        self.span.line
    }
}

impl Planner {
    /// T: the tool is brought to the changer.
    pub(super) fn select_tool(&mut self, span: Span, number: u32) {
        if number == 0 {
            self.selected = None;
        } else if self.selected.is_none_or(|selected| selected.number != number) {
            self.selected = Some(SelectedTool { number, span, said: false });
        }
    }

    /// A cut while the spindle turns.
    pub(super) fn judge_tool_is_there(&mut self, job: &Job) {
        let Some(selected) = self.selected.as_mut().filter(|s| self.tool == 0 && !s.said) else {
            return;
        };
        selected.said = true;
        let SelectedTool { number, span, .. } = *selected;
        let text = format!(
            "this cuts with no tool: line {} selects T{number}, and no M6 brings it into the spindle",
            span.line
        );
        let finding = Diagnostic::warning("M0373", job.span, text)
            .with_label(span, format!("T{number} is selected here"))
            .with_help(format!("write T{number} M6 in place of T{number}"));
        self.findings.add(finding);
    }
}
