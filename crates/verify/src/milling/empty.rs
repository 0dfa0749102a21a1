//! Feeds with an empty spindle that turns, where the program has selected a tool: nothing was cut.
//!
//! ```text
//!   T1 (op 3)   M3   G1 …  G1 …   M6 (op 9)
//!   selected ────────├──────────┤ in the spindle, or given up
//!                     one feature, not judged
//! ```
//!
//! A program that selects no tool asks for nothing that could be missing. Holes and threads are
//! judged by what they were to be.
use super::milled::Milled;
use crate::judged::Judged;
use crate::verdict::Verdict;
use crate::{Config, Contact};
use bus::{Sample, State};
use canon::{Op, OpKind};
use std::collections::VecDeque;
use units::Time;

/// A spindle that is slower than this stands, rev/s.
const STANDS: f64 = 0.1;

/// A tool that is called and not in the spindle yet.
#[derive(Clone, Copy, Debug)]
struct SelectedTool {
    number: u32,
    /// Line of its T.
    line: u32,
}

#[derive(Clone, Copy, Debug)]
struct EmptyCut {
    selected: SelectedTool,
    op: u32,
    line: u32,
    from: Time,
    to: Time,
}

/// Follows what is fed with an empty spindle.
#[derive(Clone, Debug, Default)]
pub(super) struct EmptySpindle {
    /// What T and M6 make of the tool that is called, by their ops: those that have not come yet.
    orders: VecDeque<(u32, Option<SelectedTool>)>,
    selected: Option<SelectedTool>,
    cut: Option<EmptyCut>,
    /// Time and turns of the spindle at the sample before.
    before: Option<(Time, f64)>,
}

impl EmptySpindle {
    /// The same program, at another beginning.
    pub(super) fn at_rest(self) -> Self {
        Self { selected: self.selected, ..Self::default() }
    }

    /// A feed that is not judged yet.
    pub(super) const fn is_under_way(&self) -> bool {
        self.cut.is_some()
    }

    /// What the program orders.
    pub(super) fn op(&mut self, index: u32, op: &Op) {
        match op.kind {
            OpKind::SelectTool { number } => {
                let line = op.span.line;
                let selected = (number > 0).then_some(SelectedTool { number, line });
                self.orders.push_back((index, selected));
            }
            OpKind::ChangeTool { .. } => self.orders.push_back((index, None)),
            _ => {}
        }
    }

    /// A servo period with no tool in the spindle.
    pub(super) fn sample(&mut self, sample: &Sample, config: &Config) -> Option<Judged<Milled>> {
        let op = sample.report.op;
        let (time, turns) = (sample.feedback.time, sample.spindle(0).value());
        let (then, turned) = self.before.replace((time, turns)).unwrap_or((time, turns));
        while let Some((_, selected)) = self.orders.pop_front_if(|(index, _)| *index <= op) {
            self.selected = selected;
        }
        let selected = self.selected?;
        let taken = match self.cut {
            Some(cut) if cut.selected.number != selected.number => self.close(config),
            _ => None,
        };
        let turns_now = (turns - turned).abs() > STANDS * (time - then).value() && time > then;
        if sample.report.state == State::Feed && turns_now {
            let line = sample.report.line;
            let cut = self.cut.get_or_insert(EmptyCut { selected, op, line, from: time, to: time });
            cut.to = time;
        }
        taken
    }

    /// A tool has come, or the program is over.
    pub(super) fn close(&mut self, config: &Config) -> Option<Judged<Milled>> {
        self.before = None;
        let EmptyCut { selected: SelectedTool { number, line: called }, op, line, from, to } =
            self.cut.take()?;
        let reason = format!(
            "no tool was in the spindle, and nothing was cut: line {called} selects T{number}, and no M6 brings it into the spindle"
        );
        Some(Judged {
            op,
            line,
            tool: None,
            time: from,
            duration: to - from,
            verdict: Verdict::NotJudged { reason },
            contact: Contact::default(),
            kind: Milled::nothing(config),
        })
    }
}
