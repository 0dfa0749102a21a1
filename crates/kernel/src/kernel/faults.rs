//! What is found wrong, and how the machine is stopped for it.
use super::{FAULTS, Kernel, Mode};
use crate::config::Subject;
use crate::drives::Finding;
use crate::event::EventKind;
use crate::execute::Activity;
use crate::fault::{Fault, FaultKind, Reaction};
use bus::Feedback;
use canon::Axis;
use plan::StepKind;

impl Kernel {
    /// What is wrong before anything is done.
    pub(super) fn check(&self, feedback: &Feedback) -> Result<(), Finding> {
        if feedback.emergency_stop {
            return Err((FaultKind::EmergencyStop, Subject::Machine, 0.0, 0.0));
        }
        self.drives.check_readings(feedback)?;
        match self.mode {
            Mode::New | Mode::Starting(_) | Mode::Disabled => Ok(()),
            Mode::Running => {
                if let Some(of) = self.reported {
                    return Err((FaultKind::DriveAlarm, of, 0.0, 0.0));
                }
                self.drives.check_ready(feedback)?;
                let waits = &self.config.waits;
                self.drives.check_coupled(waits.at_speed, waits.oriented)?;
                self.drives.check_following()
            }
            Mode::Halted => self.drives.check_ready(feedback),
        }
    }

    /// A fault: remember it and stop the way it asks for.
    pub(super) fn raise(&mut self, (kind, subject, value, limit): Finding, feedback: &Feedback) {
        if matches!(self.mode, Mode::Disabled) {
            return;
        }
        let (op, line) = (self.report.op, self.report.line);
        let fault = Fault { kind, subject, value, limit, time: feedback.time, op, line };
        if self.faults.len() < FAULTS {
            self.faults.push(fault);
        }
        self.note(EventKind::FaultRaised(fault));
        self.mode = match kind.reaction() {
            Reaction::Disable => Mode::Disabled,
            Reaction::Halt => {
                self.operator.alarm();
                let coupled =
                    matches!(&self.activity, Activity::Tapping(run) if run.coupling().is_some());
                // a tap's master is slowed down by the tap itself
                let led = self.queue.front().and_then(|step| match &step.kind {
                    StepKind::Tap(plan) if coupled => Some(usize::from(plan.spindle)),
                    _ => None,
                });
                for (index, spindle) in self.drives.spindles.iter_mut().enumerate() {
                    if let Some(spindle) = spindle.as_mut().filter(|_| led != Some(index)) {
                        spindle.brake();
                    }
                }
                Mode::Halted
            }
        };
        (self.drives.mist, self.drives.flood) = (false, false);
    }

    /// Following errors worth an event.
    pub(super) fn warn(&mut self) {
        for index in 0..bus::AXES {
            let Some(axis) = &mut self.drives.axes[index] else { continue };
            let (error, limit) = (axis.error(), axis.control.windows.following_warn.value());
            if error.abs() <= limit / 2.0 {
                axis.warned = false;
            } else if error.abs() > limit && !axis.warned {
                axis.warned = true;
                let (axis, error) = (Axis::ALL[index], units::Length::mm(error));
                self.note(EventKind::FollowingWarning { axis, error });
            }
        }
    }
}
