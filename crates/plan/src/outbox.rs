//! Steps on their way out: what must wait for the next op before it can be said, and the time that
//! all takes.
//!
//! Two things cannot be decided when they are ordered:
//!
//! ```text
//!   M3 ─ rapid ─ rapid ─ ?    a cut follows: turn the spindle first, then the rapids, then await its speed
//!                             a tap follows: it must stand still; the M3 is kept for later
//!   cut ─ ?                   a cut follows: goes on, as the path mode has it
//!                             anything else: stops, in position
//! ```
//!
//! So rapids wait while a spindle order is open, and cuts are gathered in a [`JoinedRun`] until
//! something else comes.
use crate::Step;
use crate::beside::SideBySide;
use crate::clock::Clock;
use crate::ends::Ends;
use crate::heat::Heat;
use crate::limits::MachineLimits;
use crate::repace::StepRow;
use crate::run::{JoinedRun, OrderedMove};
use crate::sample::Sample;
use crate::settings::OperatorSettings;
use alloc::boxed::Box;
use alloc::vec::Vec;
use motion::Shape;
use path::geometry::Segment;
use units::Time;

/// Steps that may wait behind an open spindle order: rapids from one cut to the next are few.
const MAX_WAITING: usize = 16;

/// See the module's header.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outbox {
    /// Moves that go on into one another, not yet handed on; nothing waits while there are any.
    run: JoinedRun,
    /// Where they end as programmed.
    pub(crate) ends: Ends,
    /// Steps behind an open spindle order.
    waiting: Vec<Step>,
    /// Planned time of all that was handed on.
    clock: Clock,
    /// What the spindles' drives warm by.
    pub(crate) heat: Heat,
    /// Moves that go on into one another are looked at here instead of being planned.
    pub(crate) sample: Option<Box<Sample>>,
}

impl Outbox {
    /// Planned time of what was handed on and what waits; of moves that go on into one another,
    /// only what is decided.
    pub(crate) fn elapsed(&self, limits: &MachineLimits) -> Time {
        let mut clock = self.clock;
        self.run.alone().iter().for_each(|step| clock.count(step, limits));
        self.waiting.iter().for_each(|step| clock.count(step, limits));
        clock.elapsed()
    }

    /// Moves that go on into one another are joined and timed side by side.
    pub(crate) fn side_by_side(&mut self, both: SideBySide) {
        self.run = JoinedRun::side_by_side(both);
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

    /// Hand on what waits; `before` goes ahead of it, and is booked on the op of the first that
    /// waits, so that the ops of the steps never run backwards.
    pub(crate) fn release(
        &mut self,
        before: impl IntoIterator<Item = Step>,
        limits: &MachineLimits,
        emit: &mut dyn FnMut(Step),
    ) {
        self.end_run(limits, emit);
        let mut waiting = core::mem::take(&mut self.waiting);
        for step in before {
            let (op, line) = waiting.first().map_or((step.op, step.line), |w| (w.op, w.line));
            self.hand_on(Step { op, line, ..step }, limits, emit);
        }
        for step in waiting.drain(..) {
            self.hand_on(step, limits, emit);
        }
        self.waiting = waiting; // keeps its memory
    }

    /// Moves that go on into one another stop here, in position.
    pub(crate) fn end_run(&mut self, limits: &MachineLimits, emit: &mut dyn FnMut(Step)) {
        let Self { run, clock, ends, sample, .. } = self;
        if let Some(sample) = sample {
            sample.rest(clock);
        }
        run.finish((limits, ends), &mut |step| {
            clock.count(&step, limits);
            emit(step);
        });
        ends.end_path();
    }

    /// Go on with a move, without a stop if there can be none.
    pub(crate) fn run_on(
        &mut self,
        order: OrderedMove,
        settings: OperatorSettings,
        limits: &MachineLimits,
        emit: &mut dyn FnMut(Step),
    ) {
        let goes_on = self.sample.as_ref().is_none_or(|sample| sample.takes(&order));
        if !goes_on || !self.run.takes(&order) {
            self.end_run(limits, emit);
        }
        let Self { run, clock, ends, sample, .. } = self;
        if let Some(sample) = sample
            && (sample.is_under_way() || !run.is_empty())
        {
            // a move that stays alone is planned: it costs next to nothing
            run.take_first().iter().chain([&order]).for_each(|order| sample.push(order, clock));
            return;
        }
        let Segment { curve, op, line, .. } = order.segment;
        ends.push(op, line, curve.at(curve.length()).q);
        run.push(order, settings, (limits, ends), &mut |step| {
            clock.count(&step, limits);
            emit(step);
        });
    }

    /// The first move of the run; beyond all moves if there is none.
    pub(crate) fn next_op(&self) -> u32 {
        self.run.next_op()
    }

    /// Plan the run anew, with what came back of it; then whatever waits.
    pub(crate) fn repace(
        &mut self,
        limits: &MachineLimits,
        settings: OperatorSettings,
        back: Option<StepRow>,
        emit: &mut dyn FnMut(Step),
    ) {
        self.run.repace((limits, &self.ends), settings, back, emit);
    }

    /// A move of a run that no law of time exists for, with its line.
    pub(crate) fn take_refusal(&mut self) -> Option<(u32, path::law::LawRefusal)> {
        self.run.take_refusal()
    }

    /// Hand on a step.
    pub(crate) fn hand_on(
        &mut self,
        step: Step,
        limits: &MachineLimits,
        emit: &mut dyn FnMut(Step),
    ) {
        self.clock.count(&step, limits);
        self.heat.count(&step.kind, limits);
        emit(step);
    }
}
