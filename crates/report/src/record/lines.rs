//! What each line of the program took, and which operations stand in the program itself, not in a
//! file that it draws in.
use bus::{Sample, State};
use canon::{CamOrder, Op, OpKind};
use std::collections::{BTreeMap, BTreeSet};
use units::Time;

/// Lines whose time is added up; the later ones of a longer program have none.
const LINES: usize = 100_000;
/// Operations of other files that are remembered.
const ELSEWHERE: usize = 100_000;

/// Kinds of an operation that its state alone does not tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turning {
    /// The wheel cuts into a cam, or sparks out.
    Grinding,
    /// The work turns in the air, to be measured.
    InTheAir,
}

/// See the module's header.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines {
    seconds: BTreeMap<u32, f64>,
    elsewhere: BTreeSet<u32>,
    turning: BTreeMap<u32, Turning>,
    ground: bool,
}

impl Lines {
    pub(crate) fn op(&mut self, index: u32, op: &Op) {
        if op.span.file != 0 && self.elsewhere.len() < ELSEWHERE {
            self.elsewhere.insert(index);
        }
        let OpKind::Cam(order) = &op.kind else { return };
        match order {
            CamOrder::Select { .. } | CamOrder::Deselect => self.ground = false,
            CamOrder::Grind { .. } => self.ground = true,
            _ => {}
        }
        if matches!(order, CamOrder::Grind { .. } | CamOrder::SparkOut { .. }) {
            let kind = if self.ground { Turning::Grinding } else { Turning::InTheAir };
            self.turning.insert(index, kind);
        }
    }

    /// A period of this length.
    pub(crate) fn push(&mut self, sample: &Sample, period: Time) {
        let line = sample.report.line;
        let counts = line > 0 && sample.report.state != State::Ended;
        if !counts || self.is_elsewhere(sample.report.op) || period <= Time::ZERO {
            return;
        }
        if self.seconds.len() < LINES || self.seconds.contains_key(&line) {
            *self.seconds.entry(line).or_insert(0.0) += period.value();
        }
    }

    /// What the work turns for while the control waits for its turns; `None`: it is no such
    /// operation.
    pub(crate) fn turning(&self, sample: &Sample) -> Option<Turning> {
        let waits = matches!(
            sample.report.state,
            State::Dwell | State::Feed | State::Idle | State::Couple | State::Measure
        );
        if waits { self.turning.get(&sample.report.op).copied() } else { None }
    }

    /// An operation of a file that the program draws in: its line is that file's.
    pub(crate) fn is_elsewhere(&self, op: u32) -> bool {
        self.elsewhere.contains(&op)
    }

    /// Seconds that a line took; `None`: nothing moved for it.
    pub(crate) fn seconds(&self, line: u32) -> Option<f64> {
        self.seconds.get(&line).copied()
    }
}
