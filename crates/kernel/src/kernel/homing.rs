//! Homing, seen from the kernel: who may be homed when, and what is said of it.
use super::{Kernel, Mode};
use crate::config::Subject;
use crate::drives::Finding;
use crate::event::EventKind;
use crate::fault::FaultKind;
use crate::homing::{HomingOrder, HomingOutcome};
use crate::manual::ManualRefusal;
use crate::queue::StepKind;
use bus::{AXES, Feedback};
use units::{Axis, Coordinate};

impl Kernel {
    /// Home an axis from the next tick on, or at once where its encoder or the operator knows its
    /// place. Several axes may be homed at the same time.
    ///
    /// # Errors
    /// There is no such axis, it cannot be moved now, or the order makes no sense.
    pub fn home(&mut self, axis: Axis, order: &HomingOrder) -> Result<(), ManualRefusal> {
        let index = axis.index();
        if self.drives.axes.get(index).is_none_or(Option::is_none) {
            return Err(ManualRefusal::NoAxis);
        }
        if !order.is_sound() {
            return Err(ManualRefusal::NotANumber);
        }
        let ready = matches!(self.mode, Mode::Running) && self.recovering.is_none();
        if !ready || self.withdrawing.is_some() {
            return Err(ManualRefusal::NotReady);
        }
        let busy = !self.queue.is_empty() || self.drives.flowing || self.manual.is_active();
        if busy || self.homing.is_homing(index) {
            return Err(ManualRefusal::Busy);
        }
        self.homing.begin_anew(index);
        self.count_homed(index);
        let Some(moved) = &mut self.drives.axes[index] else { return Err(ManualRefusal::NoAxis) };
        match self.homing.begin(index, moved, order) {
            HomingOutcome::Homed(deviation) => {
                self.count_homed(index);
                self.note_homed(axis, deviation);
            }
            HomingOutcome::UnderWay | HomingOutcome::Stopped => {
                self.note(EventKind::HomingBegun { axis });
            }
        }
        Ok(())
    }

    /// An axis knows where it is. All do at first: who knows better says so with
    /// [`Kernel::forget_home`].
    pub const fn is_homed(&self, axis: Axis) -> bool {
        self.homing.is_homed(axis.index())
    }

    /// All axes of the machine know where they are.
    pub fn is_all_homed(&self) -> bool {
        let axes = self.drives.axes.iter().enumerate();
        axes.filter(|(_, axis)| axis.is_some()).all(|(index, _)| self.homing.is_homed(index))
    }

    /// The axes that are being homed, and what each does.
    pub fn homing(&self) -> impl Iterator<Item = (Axis, &'static str)> + '_ {
        self.homing.under_way()
    }

    /// An axis does not know where it is: its encoder was without power, or its reading is not to
    /// be trusted.
    pub fn forget_home(&mut self, axis: Axis) {
        self.homing.forget_home(axis.index());
        self.count_homed(axis.index());
    }

    /// What is added to an encoder's reading to make a position of it.
    pub const fn zero(&self, axis: Axis) -> Coordinate {
        Coordinate::new(self.homing.zero(axis.index()))
    }

    /// Axes that are homed go on; axes that are moved for the first time move the way they are told
    /// to.
    pub(super) fn advance_homing(&mut self, feedback: &Feedback) {
        let (rests, period_s) = (self.operator.is_ordered_to_rest(), self.config.period.value());
        for index in 0..AXES {
            let Some(axis) = &mut self.drives.axes[index] else { continue };
            let said = &feedback.axes[index];
            let outcome = self.homing.advance(index, axis, said, rests, period_s);
            let outcome = outcome.and_then(|outcome| {
                self.homing.check_sense(index, axis)?;
                Ok(outcome)
            });
            self.count_homed(index);
            let axis = Axis::ALL[index];
            match outcome {
                Ok(Some(HomingOutcome::Homed(deviation))) => self.note_homed(axis, deviation),
                Ok(Some(HomingOutcome::Stopped)) => self.note(EventKind::HomingStopped { axis }),
                Ok(Some(HomingOutcome::UnderWay) | None) => {}
                Err(finding) => self.raise(finding, feedback),
            }
        }
    }

    fn note_homed(&mut self, axis: Axis, deviation: Option<f64>) {
        self.note(EventKind::Homed { axis, deviation: deviation.map(Coordinate::new) });
    }

    /// Whether a step moves no axis that does not know where it is.
    pub(super) fn check_homed(&self, kind: &StepKind<'_>) -> Result<(), Finding> {
        let moves = matches!(
            kind,
            StepKind::Move(_)
                | StepKind::Probe { .. }
                | StepKind::Follow(_)
                | StepKind::Tap(_)
                | StepKind::Thread(_)
        );
        let mut axes = self.drives.axes.iter().enumerate();
        let lost = axes.find(|(index, axis)| axis.is_some() && !self.homing.is_homed(*index));
        match lost {
            Some((index, _)) if moves => {
                Err((FaultKind::NotHomed, Subject::Axis(Axis::ALL[index]), 0.0, 0.0))
            }
            Some(_) | None => Ok(()),
        }
    }
}
