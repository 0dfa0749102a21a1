//! Keeps the kernel supplied: operations are planned ahead, steps wait in a queue, and the kernel's
//! is kept full.
use crate::KernelHandle;
use crate::Services;
use crate::ahead::MotionAhead;
use crate::job::Source;
use crate::messages::{Message, Messages};
use crate::observers::Observing;
use crate::override_pace::Pace;
use canon::{Op, OpKind};
use diag::Diagnostic;
use kernel::Answered;
use plan::Planner;
use plan::{Step, StepKind};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use units::Time;

/// Where what waits lasts longer than this, so many operations are planned in a period, and the
/// rest in the next ones: a thread that also answers people is not held up by the filling of a
/// queue.
const LASTS: Time = Time::s(0.5);
const AT_ONCE: usize = 16;

/// From a program's operations to the steps that the kernel executes.
pub struct Feeder {
    /// The program's operations.
    pub ops: Box<dyn Source + Send>,
    /// The planner.
    pub planner: Planner,
    /// Steps on their way to the kernel.
    queue: VecDeque<Step>,
    /// Steps that the kernel has and has not done.
    sent: VecDeque<Step>,
    /// An operation that waits for a measurement.
    waiting: Option<(u32, Op)>,
    /// What the waiting steps were planned for.
    pace: Pace,
    /// How far planning is ahead.
    pub(super) ahead: MotionAhead,
    /// The program has no further operation.
    is_at_end: bool,
    /// What kept each tap from being faster, by the index of its operation.
    pub(super) limiting: BTreeMap<u32, String>,
    /// What the program says, until the machine has come there.
    pub(super) messages: Messages,
    /// Indices of the operations that tap.
    taps: BTreeSet<u32>,
    /// What is wrong with a program that is interpreted while it runs, and what cannot be planned:
    /// nothing is from there on.
    refused: Vec<Diagnostic>,
}

impl Feeder {
    /// Of these operations, with this planner.
    pub fn new(ops: Box<dyn Source + Send>, planner: Planner) -> Self {
        Self {
            ops,
            planner,
            queue: VecDeque::new(),
            sent: VecDeque::new(),
            waiting: None,
            pace: Pace::default(),
            ahead: MotionAhead::default(),
            is_at_end: false,
            limiting: BTreeMap::new(),
            messages: Messages::default(),
            taps: BTreeSet::new(),
            refused: Vec::new(),
        }
    }

    /// Plan anew what has not been done, if the operator's overrides want it.
    pub(super) fn follow_overrides(&mut self, kernel: &mut KernelHandle) {
        let back = self.pace.keep(kernel, &mut self.planner, &mut self.queue, &mut self.sent);
        self.ahead.forget_last(back.steps);
        self.ahead.shorten_last(back.shorter);
    }

    /// The kernel has lost its steps after a stop in `stopped`: what follows that operation is sent
    /// again.
    pub(super) fn send_again_after(&mut self, stopped: u32) {
        self.sent.retain(|step| step.op > stopped);
        for step in self.sent.drain(..).rev() {
            self.queue.push_front(step);
        }
    }

    /// Forget what was sent and is done: what the kernel does not have any more, of operations
    /// before the one under way. What it has stays, whatever its operation: on a path that was
    /// planned anew they need not rise.
    fn forget_done(&mut self, kernel: &KernelHandle) {
        let (done, mut before) =
            (kernel.report().op, self.sent.len().saturating_sub(kernel.steps()));
        self.sent.retain(|step| {
            let is_before = before > 0;
            before = before.saturating_sub(1);
            !is_before || step.op >= done
        });
    }

    /// Keep the kernel's queue full, as far as the program goes; see [`AT_ONCE`].
    pub(super) fn fill(
        &mut self,
        kernel: &mut KernelHandle,
        services: &mut Services,
        observers: &mut Observing,
    ) {
        let mut planned = 0;
        while !kernel.is_full() && (self.refused.is_empty() || !self.queue.is_empty()) {
            if let Some(step) = self.queue.pop_front() {
                if kernel.push(&step).is_err() {
                    // no room for a plan of its kind: again after the next tick
                    return self.queue.push_front(step);
                }
                self.ahead.push(&step);
                self.limits_of(&step);
                self.sent.push_back(step);
                self.forget_done(kernel);
                continue;
            }
            if planned >= AT_ONCE && self.ahead.time() > LASTS {
                return;
            }
            planned += 1;
            let next = match self.waiting.take() {
                Some(waiting) => Some(waiting),
                None => self.ops.next().inspect(|(index, op)| services.announced(*index, op)),
            };
            self.is_at_end = next.is_none();
            let Some((index, op)) = next else {
                self.planner.finish(&mut |step| self.queue.push_back(step));
                self.check();
                if self.queue.is_empty() {
                    return;
                }
                continue;
            };
            if services.cams.is_early(&op) {
                self.waiting = Some((index, op));
                return;
            }
            match &op.kind {
                OpKind::Tap(_) => {
                    self.taps.insert(index);
                }
                OpKind::Message(text) => {
                    let message = Message { line: op.span.line, text: text.clone() };
                    self.messages.push(index, message);
                }
                _ => {}
            }
            services.op(index, &op);
            observers.op(index, &op, self.ops.frame());
            self.planner.written_in(self.ops.frame());
            self.planner.push(index, &op, &mut |step| self.queue.push_back(step));
            self.check();
            services.sequences.planned(self.planner.take_marks());
            for table in self.planner.take_tables() {
                // the planner's tables are finite, and a step without its table is an alarm
                if let Ok(function) = kernel::Periodic::new(&table.nodes) {
                    let _ = kernel.put_table(table.id, function);
                }
            }
        }
    }

    /// The kernel has done a period.
    pub(super) fn done(&mut self, kernel: &KernelHandle) {
        self.ahead.keep(kernel.steps(), self.is_at_end && self.queue.is_empty());
    }

    /// What a program orders after an answer of the machine is seen here for the first time, and of
    /// a long program what only planning finds. What was planned before it ends at rest.
    fn check(&mut self) {
        if !self.refused.is_empty() {
            return;
        }
        self.refused.extend(self.planner.take_findings().into_iter().filter(Diagnostic::is_error));
        if self.ops.is_live() {
            self.refused.extend(self.ops.findings().into_iter().filter(Diagnostic::is_error));
        }
        if !self.refused.is_empty() {
            self.planner.finish(&mut |step| self.queue.push_back(step));
        }
    }

    /// Why nothing more is planned, if that is so.
    pub(super) fn refused(&self) -> &[Diagnostic] {
        &self.refused
    }

    /// The machine has answered an operation that has asked.
    pub(super) fn answer(&mut self, answered: &Answered) {
        let answer = match answered.answer {
            kernel::Answer::Input(value) => canon::Answer::Input(value),
            kernel::Answer::Probe { contact, stands, changed } => {
                self.planner.stands_at(stands);
                canon::Answer::Probe { contact, stands, changed }
            }
        };
        self.ops.answer(answered.op, &answer);
    }

    /// What keeps a tap from being faster. One that is not tied to the spindle is a feed in and out
    /// at the programmed speed; in a clutch holder it also waits until the splines have let go and
    /// the spindle has turned round.
    fn limits_of(&mut self, step: &Step) {
        match &step.kind {
            StepKind::Tap(tap) => {
                let speed = tap.limiting.speed.name();
                let text = format!("{speed}; run-up: {}", tap.limiting.ramp.name());
                self.limiting.insert(step.op, text);
            }
            StepKind::Dwell(time) if self.taps.contains(&step.op) => {
                let text = format!("programmed speed; dwell {:.3} s each way", time.value());
                self.limiting.insert(step.op, text);
            }
            StepKind::Move(_) if self.taps.contains(&step.op) => {
                self.limiting
                    .entry(step.op)
                    .or_insert_with(|| "programmed speed; reversal: the spindle's own".to_owned());
            }
            _ => {}
        }
    }
}
