//! What the planned time is made of.
use plan::{Clock, MachineLimits, Step, StepKind};
use units::Time;

/// What takes time, in the order of the report.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shares {
    /// Moves at feed.
    pub feed: Time,
    /// Rapids.
    pub rapid: Time,
    /// Taps.
    pub tap: Time,
    /// Turned threads.
    pub thread: Time,
    /// Turns of the work that are counted: a cam ground or measured, spark-out.
    pub turn: Time,
    /// Waiting for spindles, drives and couplings.
    pub wait: Time,
    /// Dwells.
    pub dwell: Time,
    /// Tool changes.
    pub tool_change: Time,
}

impl Shares {
    /// A step that takes so long.
    pub fn add(&mut self, step: &StepKind, time: Time) {
        let share = match step {
            StepKind::Move(order) if order.rapid => &mut self.rapid,
            StepKind::Follow(order) if order.piece.rapid => &mut self.rapid,
            StepKind::Move(_) | StepKind::Follow(_) | StepKind::Probe { .. } => &mut self.feed,
            StepKind::Tap(_) => &mut self.tap,
            StepKind::Thread(_) => &mut self.thread,
            StepKind::Revolve { .. } => &mut self.turn,
            StepKind::Dwell(_) => &mut self.dwell,
            StepKind::ChangeTool { .. } | StepKind::Inputs(_) | StepKind::Count(_) => {
                &mut self.tool_change
            }
            _ => &mut self.wait,
        };
        *share += time;
    }

    /// In motion.
    pub fn motion(&self) -> Time {
        self.feed + self.rapid + self.tap + self.thread
    }

    /// Of everything.
    pub fn total(&self) -> Time {
        self.motion() + self.turn + self.wait + self.dwell + self.tool_change
    }
}

/// Adds up planned steps, one after another.
pub struct Added {
    limits: MachineLimits,
    clock: Clock,
    /// What was added up.
    pub shares: Shares,
}

impl Added {
    /// Nothing yet.
    pub fn new(limits: MachineLimits) -> Self {
        Self { limits, clock: Clock::default(), shares: Shares::default() }
    }

    /// One more; how long it takes.
    pub fn step(&mut self, step: &Step) -> Time {
        let before = self.clock.elapsed();
        self.clock.count(step, &self.limits);
        let time = self.clock.elapsed() - before;
        self.shares.add(&step.kind, time);
        time
    }

    /// Time in motion.
    pub fn motion(&self) -> Time {
        self.shares.motion()
    }
}
