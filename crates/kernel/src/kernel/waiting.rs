//! What the kernel waits for, and what it has found out for the program.
use super::{Kernel, Mode};
use crate::drives::Finding;
use crate::execute::Activity;
use crate::queue::StepKind;
use crate::record_requests::RECORD_WAIT;
use crate::signals::Answered;
use crate::waiting::{WaitFor, Waiting};
use crate::waits::CONSULT_WAIT;
use bus::Feedback;
use sync::Phase;
use units::Time;

impl Kernel {
    /// Ticks since the last feedback that was new.
    pub const fn ticks_without_news(&self) -> u32 {
        self.feedback_age.lost()
    }

    /// A motor whose turns are counted is off while none are.
    pub(super) fn stop_idle_motor(&mut self) {
        let counts = matches!(self.activity, Activity::Counting(_));
        if !counts || !matches!(self.mode, Mode::Running) {
            self.drives.stop_motor();
        }
    }

    /// What a sequence has proved stays so while something moves.
    pub(super) fn check_inputs(&mut self, feedback: &Feedback) -> Result<(), Finding> {
        if !matches!(self.activity, Activity::Moving(..) | Activity::Counting(_)) {
            return Ok(());
        }
        let checked = self.drives.guard.check(self.config.period.value(), &feedback.inputs);
        checked.inspect_err(|_| self.drives.stop_motor())
    }

    /// What the kernel waits for at present, if it does.
    pub fn waiting(&self) -> Option<Waiting> {
        let waits = &self.config.waits;
        let of = |what, waited_s: f64, limit| {
            let age = Time::s(waited_s);
            Some(Waiting { what, since: self.now - age, age, limit })
        };
        let since_begun = |what, limit| of(what, (self.now - self.begun_at).value(), limit);
        match self.mode {
            Mode::Starting(waited) => return of(WaitFor::Drives, waited, Some(waits.ready)),
            Mode::Running if self.recovering.is_none() && self.withdrawing.is_none() => {}
            Mode::New | Mode::Running | Mode::Halted | Mode::Disabled => return None,
        }
        if let Some(what) = self.interlock().filter(|_| !self.queue.is_empty()) {
            return of(what, (self.now - self.interlocks.since()).value(), None);
        }
        match (&self.activity, self.queue.get(self.chained).map(|step| step.kind)) {
            (Activity::Settling { waited_s, .. }, _) => {
                of(WaitFor::InPosition, *waited_s, Some(waits.in_position))
            }
            (Activity::AwaitingSpeed { spindle, waited_s }, _) => {
                of(WaitFor::SpindleSpeed(*spindle), *waited_s, Some(waits.at_speed))
            }
            (Activity::AwaitingAngle { spindle, waited_s, longest, .. }, _) => of(
                WaitFor::SpindleAngle(*spindle),
                *waited_s,
                Some(longest.unwrap_or(waits.oriented)),
            ),
            (Activity::Changing { tool, waited_s }, _) => {
                of(WaitFor::Tool(*tool), *waited_s, Some(waits.tool_change))
            }
            (Activity::ChangingByHand { tool }, _) => since_begun(WaitFor::ToolByHand(*tool), None),
            (Activity::AwaitingInput { waited_s, .. }, Some(StepKind::Input(wait))) => {
                of(WaitFor::Input(wait), *waited_s, Some(wait.longest))
            }
            (Activity::AwaitingInputs(awaited), Some(StepKind::Inputs(wait))) => of(
                WaitFor::Inputs { on: wait.on, off: wait.off },
                awaited.waited_s,
                Some(wait.longest),
            ),
            (Activity::Counting(counted), Some(StepKind::Count(count))) => {
                of(WaitFor::Edges(count.input), counted.waited_s, Some(count.longest))
            }
            (Activity::Pausing, Some(StepKind::Pause { optional })) => {
                since_begun(WaitFor::Operator { optional }, None)
            }
            (Activity::Recording { waited_s }, _) => {
                of(WaitFor::SyncRecord, *waited_s, Some(RECORD_WAIT))
            }
            (Activity::Engaging(follower), _) => since_begun(WaitFor::Gear(*follower), None),
            (Activity::Fading { .. }, _) => since_begun(WaitFor::Fade, None),
            (Activity::Revolving { .. }, Some(StepKind::Revolve { spindle, .. })) => {
                since_begun(WaitFor::SpindleTurns(spindle), None)
            }
            (Activity::Consulting { waited_s }, _) => {
                of(WaitFor::Measurement, *waited_s, Some(CONSULT_WAIT))
            }
            (Activity::Tapping(run), Some(StepKind::Tap(plan)))
                if run.phase() == Phase::Prepare =>
            {
                since_begun(WaitFor::SpindleForTap(plan.spindle), None)
            }
            _ => None,
        }
    }

    /// What came of the last wait or probing move, once.
    pub const fn take_answer(&mut self) -> Option<Answered> {
        self.answer.take()
    }
}
