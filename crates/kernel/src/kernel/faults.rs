//! What is found wrong, and how the machine is stopped for it.
//!
//! ```text
//!   no tap in its thread     as the alarm asks: outputs off, or brake and hold
//!   a thread that is turned  the infeed axis takes the tool off along it, or all brake; a drive or encoder gone: then off
//!   a tap in its thread      both brake on the coupling, whatever is wrong
//!      spindle does not obey    the axis goes with where the spindle is, until it stands
//!      axis does not obey       the spindle brakes; the thread takes the axis along
//!      an encoder lies          both brake by the setpoints' own steps ([`crate::encoder_plausibility`])
//!      drive or encoder gone    outputs off when everything stands
//! ```
use super::{FAULTS, Kernel, Mode};
use crate::config::Subject;
use crate::drives::Finding;
use crate::encoder_plausibility::Tied;
use crate::event::EventKind;
use crate::execute::Activity;
use crate::fault::{Fault, FaultKind, Reaction};
use crate::operator::Order;
use crate::queue::StepKind;
use crate::sight::Sight;
use crate::spindle::SpindleLoop;
use bus::Feedback;

use units::Axis;

/// What has to stand before outputs go off stands for so long, s.
const STANDS_S: f64 = 0.05;
/// An axis that is stopped is not driven on from this many times the following error of its alarm.
const STRAYS: f64 = 2.0;

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
                if let Some((kind, of)) = self.reported {
                    return Err((kind, of, 0.0, 0.0));
                }
                let moves = matches!(self.activity, Activity::Moving(..));
                let touches = feedback.probe && !self.probe_before;
                if touches && self.config.probe_guard && (moves || self.manual.is_active()) {
                    return Err((FaultKind::ProbeContact, Subject::Machine, 0.0, 0.0));
                }
                self.drives.check_ready(feedback)?;
                let waits = &self.config.waits;
                let lost = self.config.phase_loss.map(|loss| loss.window);
                self.drives.check_coupled(waits.at_speed, waits.oriented, lost)?;
                self.drives.check_following()
            }
            Mode::Halted if self.drive_lost.is_some() => self.check_retreating(),
            Mode::Halted => {
                self.drives.check_ready(feedback)?;
                self.check_retreating()
            }
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
        self.manual.forget(); // what moves brakes from where it is
        self.homing.abandon(&mut self.drives.axes);
        let in_tap = self.tap_in_work();
        let gone = matches!(
            kind,
            FaultKind::DriveNotReady
                | FaultKind::FeedbackInvalid
                | FaultKind::FeedbackStale
                | FaultKind::ReadingImplausible
        );
        let tied = match kind {
            FaultKind::DriveNotReady => self.thread_pair().is_some(),
            FaultKind::ReadingImplausible => true, // the setpoint's own steps bridge the reading
            _ => false,                            // the reading is not bridged
        };
        if gone && (in_tap.is_some() || tied) {
            self.drive_lost = self.drive_lost.or(Some(0));
        }
        let pair = self.coupled().map(|(axis, spindle, _)| (axis, spindle));
        if let (FaultKind::FeedbackStale, Some(_), Some(pair)) = (kind, self.drive_lost, pair) {
            self.drives.go_blind(pair);
            self.plausibility.lose_all();
        }
        let lost = kind == FaultKind::DriveNotReady && matches!(subject, Subject::Spindle(_));
        let disobeys =
            lost || matches!(kind, FaultKind::SyncError | FaultKind::SpindleFollowingError);
        if let (Some(plan), Activity::Tapping(run), true) = (in_tap, &mut self.activity, disobeys) {
            run.trail(&plan, &mut self.drives, lost);
        }
        let runs_away = self.runs_away(kind, subject);
        self.mode = match kind.reaction() {
            Reaction::Disable if self.drive_lost.is_none() => Mode::Disabled,
            Reaction::Halt if runs_away => {
                self.retreating = None;
                Mode::Disabled
            }
            Reaction::Disable | Reaction::Halt => {
                self.operator.alarm();
                self.retract_overloaded(kind, in_tap.is_some());
                self.retreating = self.retreating.or_else(|| self.retreat_for(kind, subject));
                let coupled =
                    matches!(&self.activity, Activity::Tapping(run) if run.coupling().is_some());
                // a tap's master is slowed down by the tap itself
                let led = self.queue.front().and_then(|step| match &step.kind {
                    StepKind::Tap(plan) if coupled => Some(usize::from(plan.spindle)),
                    _ => None,
                });
                if !matches!(self.mode, Mode::Halted) {
                    self.drives.brake_together(&self.config.motion);
                }
                // spindles turn on while the tool leaves the work
                let brakes = self.retreating.is_none();
                for (index, spindle) in self.drives.spindles.iter_mut().enumerate() {
                    if let Some(spindle) = spindle.as_mut().filter(|_| brakes && led != Some(index))
                    {
                        spindle.brake();
                    }
                }
                Mode::Halted
            }
        };
        (self.drives.mist, self.drives.flood) = (false, false);
    }

    /// A tap whose torque is beyond its bounds is to come out along its thread.
    fn retract_overloaded(&mut self, kind: FaultKind, in_tap: bool) {
        let by_torque = matches!(kind, FaultKind::TapOverload | FaultKind::TapCutsNothing);
        if by_torque && in_tap {
            self.drives.supervision.ask_to_retract();
        }
    }

    /// What follows an alarm that has stopped everything.
    pub(super) fn go_on_halted(&mut self, feedback: &Feedback) {
        self.switch_off_strays(feedback);
        self.retract_when_standing();
    }

    /// An overloaded tap comes out as soon as it stands, as if the operator had asked for it.
    fn retract_when_standing(&mut self) {
        if self.drives.supervision.is_to_retract() && self.can_back_out() {
            self.drives.supervision.forget_retract();
            self.order(Order::Retract);
        }
    }

    /// The axis that takes the tool off the work is the one that does not obey, or cannot be seen:
    /// nothing may drive it on.
    fn runs_away(&self, kind: FaultKind, subject: Subject) -> bool {
        let leaving = self.drives.chain.and_then(|chain| chain.leaving());
        let Some(retreating) = self.retreating.or(leaving).filter(|r| !r.is_out()) else {
            return false;
        };
        matches!(kind, FaultKind::FollowingError | FaultKind::ReadingImplausible)
            && subject == Subject::Axis(Axis::ALL[retreating.axis()])
    }

    /// The plan of the tap that is coupled.
    fn tap_in_work(&self) -> Option<motion::TapPlan> {
        let Activity::Tapping(run) = &self.activity else { return None };
        run.coupling()?;
        let StepKind::Tap(plan) = self.queue.front()?.kind else { return None };
        Some(*plan)
    }

    /// Whose encoders are watched: those of a tap, or of a thread that is turned, and of the axis
    /// that takes a tool off the work.
    fn tied(&self) -> Tied {
        let tap = self.coupled().map(|(axis, spindle, _)| (axis, spindle));
        let thread = self.way_out().filter(|way_out| way_out.pass.is_some());
        let infeed = thread.map(|way_out| way_out.infeed.index());
        Tied { pair: tap.or_else(|| self.thread_pair()), infeed }
    }

    /// Readings become those to go by.
    pub(super) fn bridge(&mut self, taken: &mut Feedback) {
        let tied = match self.mode {
            Mode::Running | Mode::Halted => self.tied(),
            Mode::New | Mode::Starting(_) | Mode::Disabled => Tied::default(),
        };
        let period_s = self.config.period.value();
        self.plausibility.frame_lost = self.feedback_age.is_lost();
        let watches = matches!(self.mode, Mode::Running | Mode::Halted);
        let tied_finding = self.plausibility.bridge(tied, taken, &mut self.drives, period_s);
        let finding = tied_finding.or_else(|| {
            let of = &mut self.plausibility;
            watches.then(|| of.bridge_untied(tied, taken, &mut self.drives, period_s))?
        });
        for index in 0..bus::AXES {
            if self.plausibility.was_taken_over(index) {
                self.setpoints.forget(index);
            }
        }
        if let Some(finding) = finding {
            self.raise(finding, taken);
        }
    }

    /// Stopped by an alarm: an axis that nothing ties and that is still driven away from where it
    /// was told to be is switched off, whatever else is going on.
    pub(super) fn switch_off_strays(&mut self, feedback: &Feedback) {
        let tied = self.tied();
        let retreats = self.retreating.map(|retreating| retreating.axis());
        for index in 0..bus::AXES {
            let goes_with = tied.pair.is_some_and(|(axis, _)| axis == index)
                || tied.infeed == Some(index)
                || retreats == Some(index);
            let Some(axis) = self.drives.axes[index].as_mut().filter(|_| !goes_with) else {
                continue;
            };
            let limit = STRAYS * axis.control.windows.following_stop.value();
            let error = axis.error();
            if axis.sight.is_closed() && error.abs() > limit {
                axis.sight = Sight::Off;
                self.drive_lost = self.drive_lost.or(Some(0));
                let of = Subject::Axis(Axis::ALL[index]);
                self.raise((FaultKind::FollowingError, of, error, limit), feedback);
            }
        }
    }

    /// A drive or an encoder is gone, or a loop still pushes at what it could not move, and
    /// everything stands: outputs off.
    pub(super) fn let_go(&mut self) {
        let pushes = || self.drives.check_following().is_err().then_some(0);
        let Some(stood) = self.drive_lost.or_else(pushes) else { return };
        let mut spindles = self.drives.spindles.iter().flatten();
        let stands = self.is_standing() && spindles.all(SpindleLoop::at_rest);
        let stood = if stands { stood + 1 } else { 0 };
        self.drive_lost = Some(stood);
        if f64::from(stood) * self.config.period.value() > STANDS_S {
            self.mode = Mode::Disabled;
        }
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
                let (axis, error) = (Axis::ALL[index], units::Coordinate::new(error));
                self.note(EventKind::FollowingWarning { axis, error });
            }
        }
    }
}
