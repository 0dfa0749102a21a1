//! Steps on their way out: what must wait for the next op before it can be said, and the time that all takes.
//!
//! Two things cannot be decided when they are ordered:
//!
//! ```text
//!   M3 ─ rapid ─ rapid ─ ?    a cut follows: turn the spindle first, then the rapids, then await its speed
//!                             a tap follows: it must stand still; the M3 is kept for later
//!   cut ─ ?                   a cut follows under G64: need not wait until in position
//!                             anything else: must
//! ```
//!
//! So rapids wait while a spindle order is open, and the last cut waits for its successor. Look-ahead will
//! widen this to many cuts; the planner's interface does not change with it.
use crate::limits::MachineLimits;
use crate::{ChipThrow, SpindleStep, Step, StepKind};
use alloc::vec::Vec;
use units::Time;

/// Steps that may wait behind an open spindle order: rapids from one cut to the next are few.
const MAX_WAITING: usize = 16;

/// See the module's header.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outbox {
    /// The last cut, not yet handed on; nothing waits while there is one.
    cut: Option<Step>,
    /// Steps behind an open spindle order.
    waiting: Vec<Step>,
    /// Planned time of all that was handed on, s.
    elapsed: f64,
    /// When the ordered spindle ramp is over, s.
    ready_at: f64,
    /// Speed of spindle 0 that was handed on last, rev/s, without sign.
    speed: f64,
    /// Chips that are to be thrown off once a move passes their level.
    throw: Option<ChipThrow>,
}

impl Outbox {
    /// Planned time of what was handed on and what waits.
    pub(crate) fn elapsed(&self, limits: &MachineLimits) -> Time {
        let mut all = Self { cut: None, waiting: Vec::new(), ..*self };
        self.cut.iter().chain(&self.waiting).for_each(|step| all.count(step, limits));
        Time::s(all.elapsed)
    }

    /// Whether steps wait.
    pub(crate) const fn is_waiting(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Whether no more may wait.
    pub(crate) const fn is_full(&self) -> bool {
        self.waiting.len() >= MAX_WAITING
    }

    /// Keep a step behind the open spindle order.
    pub(crate) fn wait(&mut self, step: Step) {
        self.waiting.push(step);
    }

    /// Hand on what waits; `before` goes ahead of it, and is booked on the op of the first that waits, so that the
    /// ops of the steps never run backwards.
    pub(crate) fn release(
        &mut self,
        before: &[Step],
        limits: &MachineLimits,
        emit: &mut dyn FnMut(Step),
    ) {
        self.end_cut(true, limits, emit);
        let mut waiting = core::mem::take(&mut self.waiting);
        for step in before {
            let (op, line) = waiting.first().map_or((step.op, step.line), |w| (w.op, w.line));
            self.hand_on(Step { op, line, ..*step }, limits, emit);
        }
        for step in waiting.drain(..) {
            self.hand_on(step, limits, emit);
        }
        self.waiting = waiting; // keeps its memory
    }

    /// Hand on the last cut; `stop`: the axes must be in position at its end.
    pub(crate) fn end_cut(
        &mut self,
        stop: bool,
        limits: &MachineLimits,
        emit: &mut dyn FnMut(Step),
    ) {
        if let Some(mut step) = self.cut.take() {
            if let StepKind::Move(cut) = &mut step.kind {
                cut.exact_stop |= stop;
            }
            self.hand_on(step, limits, emit);
        }
    }

    /// Keep a cut until its successor is known.
    pub(crate) fn hold_cut(&mut self, step: Step) {
        self.cut = Some(step);
    }

    /// Hand on a step.
    pub(crate) fn hand_on(
        &mut self,
        step: Step,
        limits: &MachineLimits,
        emit: &mut dyn FnMut(Step),
    ) {
        self.count(&step, limits);
        emit(step);
    }

    fn count(&mut self, step: &Step, limits: &MachineLimits) {
        match &step.kind {
            StepKind::Move(m) => {
                if let Some((throw, at)) = self.throw.and_then(|t| Some((t, t.passed_by(m)?))) {
                    self.ready_at = self.ready_at.max(self.elapsed + at + throw.duration());
                    self.throw = None;
                }
                let speed = if m.per_revolution { self.speed } else { 1.0 };
                self.elapsed += m.profile.duration() / speed;
                if m.exact_stop {
                    self.elapsed += limits.settling.value();
                }
            }
            StepKind::Dwell(time) => self.elapsed += time.value(),
            StepKind::Spindle { spindle, order } => match order {
                SpindleStep::Turn { spin, ramp } => {
                    self.ready_at = self.ready_at.max(self.elapsed + ramp.duration());
                    if *spindle == 0 {
                        self.speed = spin.abs().value();
                    }
                }
                SpindleStep::AwaitSpeed => self.elapsed = self.elapsed.max(self.ready_at),
                SpindleStep::Orient(_) => {}
                SpindleStep::Throw(throw) => {
                    self.throw = Some(*throw);
                    self.ready_at = self.ready_at.max(self.elapsed + throw.duration());
                    if *spindle == 0 {
                        self.speed = throw.then.abs().value();
                    }
                }
            },
            StepKind::Tap(tap) => {
                let stroke = tap.inward.duration() + tap.outward.duration() + tap.dwell.value();
                self.elapsed += stroke + limits.settling.value();
            }
            StepKind::Revolve { spindle: _, turns } if self.speed > 0.0 => {
                self.elapsed += turns.abs().value() / self.speed;
            }
            StepKind::Superpose(order) if self.speed > 0.0 => {
                self.ready_at =
                    self.ready_at.max(self.elapsed + order.over.abs().value() / self.speed);
            }
            StepKind::AwaitFades => self.elapsed = self.elapsed.max(self.ready_at),
            StepKind::Engage(_)
            | StepKind::Release { .. }
            | StepKind::Superpose(_)
            | StepKind::Revolve { .. }
            | StepKind::Consult(_) => {}
            StepKind::ChangeTool(_) => self.elapsed += limits.tool_change.time.value(),
            StepKind::Coolant { .. }
            | StepKind::Output(_)
            | StepKind::Input(_)
            | StepKind::UserCode(_)
            | StepKind::Pause { .. }
            | StepKind::End => {}
        }
    }
}
