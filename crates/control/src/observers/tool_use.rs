//! What each tool cuts, counted by the operations that are executed: for its life in the tool
//! table.
//!
//! ```text
//!   op planned ─► which tool it uses once ─► its first cutting period: a use
//!   each cutting period ─► time, and the way of X, Y and Z
//! ```
use bus::{Sample, State};
use canon::{Op, ToolLibrary, ToolUse, UseCount};
use std::collections::BTreeMap;
use units::{Length, Time};

/// See the module's header.
#[derive(Clone, Debug, Default)]
pub struct ToolUseCount {
    uses: UseCount,
    /// Operations that are a use of a tool and have not been begun.
    ahead: BTreeMap<u32, u32>,
    /// Since the last time that it was taken.
    used: BTreeMap<u32, ToolUse>,
    last: Option<(Time, [Length; 3])>,
}

impl ToolUseCount {
    /// Nothing is counted yet; this tool is in the spindle.
    pub fn with(tool: u32) -> Self {
        Self { uses: UseCount::with(tool), ..Self::default() }
    }

    /// What was cut since this was asked last, by the tool's number.
    pub fn take(&mut self) -> BTreeMap<u32, ToolUse> {
        core::mem::take(&mut self.used)
    }

    /// What was cut since this was taken last, by the tool's number.
    pub fn so_far(&self) -> &BTreeMap<u32, ToolUse> {
        &self.used
    }

    /// An operation is planned.
    pub(super) fn op(&mut self, index: u32, op: &Op) {
        if let Some(tool) = self.uses.counts(op) {
            self.ahead.insert(index, tool);
        }
    }

    /// A servo period.
    pub(super) fn sample(&mut self, sample: &Sample) {
        let at = [0, 1, 2].map(|axis| sample.command.axes[axis].position.of_linear());
        let now = sample.feedback.time;
        let Some((then, from)) = self.last.replace((now, at)) else { return };
        let cuts = matches!(
            sample.report.state,
            State::Feed | State::TapIn | State::TapBottom | State::TapOut
        );
        if !cuts {
            return;
        }
        while let Some(first) = self.ahead.first_entry()
            && *first.key() <= sample.report.op
        {
            self.used.entry(first.remove()).or_default().uses += 1;
        }
        let Some(tool @ 1..) = sample.feedback.tool else { return };
        let square = |(to, from): (Length, Length)| (to - from).value().powi(2);
        let way = at.into_iter().zip(from).map(square).sum::<f64>().sqrt();
        let more = ToolUse { uses: 0, time: now - then, length: Length::mm(way) };
        self.used.entry(tool).or_default().add(&more);
    }
}

/// Add what was cut to the lives of the tools.
pub fn use_up(tools: &mut ToolLibrary, used: &BTreeMap<u32, ToolUse>) {
    for (number, more) in used {
        if let Some(tool) = tools.get(*number) {
            let mut tool = tool.clone();
            tool.life.used.add(more);
            tools.insert(tool);
        }
    }
}
