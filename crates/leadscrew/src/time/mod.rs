//! How long a program takes, by the planner that would run it, and what it asks of the axes.
//!
//! Times are added up from the planner's own steps: motion, spindle ramps, waits, tool changes.
//! Peaks are taken from the setpoints as a drive would get them: differences at the servo period.
mod estimate;
mod longest;
mod peaks;
mod shares;
mod without_jerk;

pub use estimate::{Estimate, estimate};
pub use longest::Timed;
pub use peaks::{Peak, Peaks};
pub use shares::{Added, Shares};
pub use without_jerk::WithoutJerk;

use control::config;
use control::job::Session;
use longest::Longest;
use plan::{Step, StepKind};
use std::collections::BTreeMap;
use units::Time;

/// Operations that are listed if not all are: the longest.
const LONGEST: usize = 10;

/// What was added up.
pub struct Times {
    all: Added,
    tool: u32,
    by_tool: BTreeMap<u32, Shares>,
    by_operation: Longest,
    peaks: Peaks,
    /// Steps that the planner made.
    pub steps: u64,
    /// Time in motion if no axis had a limit of jerk; `None`: none has one.
    pub without_jerk: Option<Time>,
}

impl Times {
    /// Of nothing yet, for this session; `operations`: how many of them are kept, `None` is the ten
    /// longest.
    pub fn new(session: &Session, operations: Option<usize>) -> Self {
        Self {
            all: Added::new(config::planner(&session.machine)),
            tool: session.tool(),
            by_tool: BTreeMap::new(),
            by_operation: Longest::new(operations.unwrap_or(LONGEST)),
            peaks: Peaks::new(session.machine.control.period.value()),
            steps: 0,
            without_jerk: None,
        }
    }

    /// One more step.
    pub fn step(&mut self, step: &Step) {
        let time = self.all.step(step);
        if let StepKind::ChangeTool { tool: number, .. } = step.kind {
            self.tool = number;
        }
        self.by_tool.entry(self.tool).or_default().add(&step.kind, time);
        self.by_operation.add(step.op, step.line, time);
        self.peaks.step(&step.kind);
        self.steps += 1;
    }

    /// Of the whole program.
    pub const fn shares(&self) -> &Shares {
        &self.all.shares
    }

    /// From beginning to end.
    pub fn total(&self) -> Time {
        self.all.shares.total()
    }

    /// With each tool, by its number.
    pub fn by_tool(&self) -> impl ExactSizeIterator<Item = (u32, &Shares)> {
        self.by_tool.iter().map(|(tool, shares)| (*tool, shares))
    }

    /// The operations that take the longest, in the order of the program: index, line, time.
    pub fn longest(&self) -> Vec<Timed> {
        self.by_operation.all()
    }

    /// The highest speed, acceleration and jerk of each axis that moves.
    pub const fn peaks(&self) -> &Peaks {
        &self.peaks
    }
}
