//! Before a step that turns a spindle begins, its encoder has been checked: see
//! [`crate::encoder_check`].
use super::Kernel;
use crate::config::Subject;
use crate::drives::Finding;
use crate::queue::StepKind;
use bus::Feedback;
use motion::SpindleStep;

impl Kernel {
    /// Of this spindle the index mark is looked for.
    pub fn looks_for_index(&self, spindle: usize) -> bool {
        let Some(Some(spindle)) = self.drives.spindles.get(spindle) else { return false };
        let has_index = spindle.control.encoder_check.is_some_and(|check| check.index);
        has_index && spindle.encoder_check.is_under_way()
    }

    /// Of this axis, by its bus index, the index mark is looked for.
    pub const fn axis_looks_for_index(&self, axis: usize) -> bool {
        self.homing.looks_for_index(axis)
    }

    /// Whether the step at the queue's front waits for the check of its spindle, which goes on by a
    /// period. A path that flows into the step is not stopped for it: the check is made when the
    /// spindle is used next.
    pub(super) fn checks_encoder_first(&mut self, feedback: &Feedback) -> Result<bool, Finding> {
        if self.drives.flowing {
            return Ok(false);
        }
        let Some(step) = self.queue.get(self.chained) else { return Ok(false) };
        let (index, sense) = match &step.kind {
            StepKind::Spindle { spindle, order: SpindleStep::Turn { spin, .. } } => {
                (usize::from(*spindle), spin.value())
            }
            StepKind::Spindle { spindle, order: SpindleStep::Surface { surface, .. } } => {
                (usize::from(*spindle), surface.speed.value())
            }
            StepKind::Tap(plan) => (usize::from(plan.spindle), plan.spin.value()),
            _ => return Ok(false),
        };
        let Some(Some(spindle)) = self.drives.spindles.get_mut(index) else { return Ok(false) };
        let mut check = spindle.encoder_check;
        if sense == 0.0 || !check.is_due() {
            return Ok(false);
        }
        let mark = feedback.spindles.get(index).and_then(|said| said.index);
        let found = check.advance(spindle, (sense, self.config.period.value()), mark);
        spindle.encoder_check = check;
        match found {
            Ok(()) => Ok(check.is_due()),
            Err((kind, counts, stated)) => {
                Err((kind, Subject::Spindle(index as u8), counts, stated))
            }
        }
    }

    /// The operator wants everything to stand: a check that is under way is made anew afterwards.
    pub(super) fn break_off_encoder_check(&mut self) {
        for spindle in self.drives.spindles.iter_mut().flatten() {
            if spindle.encoder_check.is_under_way() {
                spindle.encoder_check.break_off();
                spindle.stop();
            }
        }
    }
}
