//! What the planned time is made of.
use crate::progress::Progress;
use control::job::Session;
use plan::{Clock, MachineLimits, Step, StepKind};
use serde_json::{Value, json};
use units::{Jerk, Time};

/// What takes time, in the order of the report.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shares {
    pub(super) feed: f64,
    pub(super) rapid: f64,
    pub(super) tap: f64,
    /// Turned threads.
    pub(super) thread: f64,
    /// Turns of the work that are counted: a cam ground or measured, spark-out.
    pub(super) turn: f64,
    pub(super) wait: f64,
    pub(super) dwell: f64,
    pub(super) tool_change: f64,
}

impl Shares {
    pub(super) const fn add(&mut self, step: &StepKind, time: f64) {
        let share = match step {
            StepKind::Move(order) if order.rapid => &mut self.rapid,
            StepKind::Follow(order) if order.piece.rapid => &mut self.rapid,
            StepKind::Move(_) | StepKind::Follow(_) => &mut self.feed,
            StepKind::Tap(_) => &mut self.tap,
            StepKind::Thread(_) => &mut self.thread,
            StepKind::Revolve { .. } => &mut self.turn,
            StepKind::Dwell(_) => &mut self.dwell,
            StepKind::ChangeTool(_) => &mut self.tool_change,
            _ => &mut self.wait,
        };
        *share += time;
    }

    pub(super) const fn motion(&self) -> f64 {
        self.feed + self.rapid + self.tap + self.thread
    }

    pub(super) const fn total(&self) -> f64 {
        self.motion() + self.turn + self.wait + self.dwell + self.tool_change
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "total_time_s": rounded(self.total()),
            "motion_time_s": rounded(self.motion()),
            "feed_time_s": rounded(self.feed),
            "rapid_time_s": rounded(self.rapid),
            "tapping_time_s": rounded(self.tap),
            "threading_time_s": rounded(self.thread),
            "turning_time_s": rounded(self.turn),
            "waiting_time_s": rounded(self.wait),
            "dwell_time_s": rounded(self.dwell),
            "tool_change_time_s": rounded(self.tool_change),
        })
    }
}

/// To a microsecond.
pub(super) fn rounded(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// Adds up planned steps, one after another.
pub(crate) struct Added<'a> {
    limits: &'a MachineLimits,
    clock: Clock,
    pub(super) shares: Shares,
}

impl<'a> Added<'a> {
    /// Nothing yet.
    pub(crate) fn new(limits: &'a MachineLimits) -> Self {
        Self { limits, clock: Clock::default(), shares: Shares::default() }
    }

    /// One more; how long it takes, s.
    pub(crate) fn step(&mut self, step: &Step) -> f64 {
        let before = self.clock.elapsed().value();
        self.clock.count(step, self.limits);
        let time = self.clock.elapsed().value() - before;
        self.shares.add(&step.kind, time);
        time
    }

    /// Time in motion.
    pub(crate) const fn motion(&self) -> Time {
        Time::s(self.shares.motion())
    }
}

/// Time in motion if no axis had a limit of jerk, s; `None`: none has one.
pub(crate) fn without_jerk(
    session: &mut Session,
    text: &[u8],
    options: plan::Options,
) -> Option<f64> {
    let free = Jerk::mm_per_s3(f64::INFINITY);
    let limited = session.machine.axes.clone();
    if limited.iter().flatten().all(|axis| axis.jerk_feed == free && axis.jerk_rapid == free) {
        return None;
    }
    for axis in session.machine.axes.iter_mut().flatten() {
        (axis.jerk_feed, axis.jerk_rapid) = (free, free);
    }
    let limits = control::config::planner(&session.machine);
    let mut added = Added::new(&limits);
    let progress = Progress::of_lines(text, "planning without limits of jerk");
    control::job::preflight::steps(session, text, options, &mut |step| {
        progress.reached(step.line);
        added.step(&step);
    });
    session.machine.axes = limited;
    Some(added.shares.motion())
}
