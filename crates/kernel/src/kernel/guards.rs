//! What the kernel looks at in each period, whatever it is doing: the age of the feedback,
//! spindles, the setpoints that are about to be sent.
//!
//! ```text
//!   feedback ─► age? ─► encoders? ─► readings ─► spindles? ─► steps … targets ─► setpoints? ─► loops ─► numbers? ─► Command
//! ```
//!
//! A setpoint that is refused is not sent: the axis goes on from the last one, braking. If
//! setpoints are refused while the machine is stopped for an alarm already, nothing is left that
//! could brake them, and outputs go off.
use super::{Kernel, Mode};
use crate::config::Subject;
use crate::drives::Finding;
use crate::execute::Activity;
use crate::fault::FaultKind;
use crate::setpoint_monitor::Led;
use bus::{AXES, Command, Feedback, SPINDLES};
use motion::THREADING_AXES;
use units::Axis;

impl Kernel {
    /// Whether the feedback is new.
    pub(super) fn check_age(&mut self, feedback: &Feedback) -> Result<(), Finding> {
        let runs = matches!(self.mode, Mode::Running | Mode::Halted);
        self.feedback_age.check(feedback.time, self.config.period, runs)
    }

    /// Whether spindles turn as they were ordered to, by this period's readings.
    pub(super) fn check_spindles(&mut self) -> Result<(), Finding> {
        let stopping = match self.mode {
            Mode::New | Mode::Starting(_) | Mode::Disabled => return Ok(()),
            Mode::Running => false,
            Mode::Halted => true,
        };
        let tap = self.coupled().map(|(_, spindle, _)| spindle);
        let turning = self.drives.chain.is_some() || self.way_out.is_some();
        let rescue = self.recovering.is_some() || self.withdrawing.is_some();
        for index in 0..SPINDLES {
            let Some(spindle) = &self.drives.spindles[index] else { continue };
            let tied = rescue || turning || tap == Some(index);
            self.spindle_monitor.check(index, spindle, (tied, stopping))?;
        }
        Ok(())
    }

    /// A motion is under way that goes on into the next step, or within one.
    pub(crate) const fn is_flowing(&self) -> bool {
        self.drives.flowing
    }

    /// The steps have run out, and the last one went on into another: everything goes on from where
    /// it was a period ago.
    pub(super) fn has_run_out(&mut self) -> bool {
        let dry = self.drives.flowing && self.queue.line(self.chained).is_none();
        if dry {
            for index in 0..AXES {
                let led = self.led(index);
                let Some(axis) = self.drives.axes[index].as_mut().filter(|_| led != Led::Angle)
                else {
                    continue;
                };
                axis.target = self.setpoints.sent(index);
            }
            self.drives.flowing = false;
        }
        dry
    }

    /// Close all loops, if what they would be told can be told.
    pub(super) fn close_loops(&mut self, feedback: &Feedback) -> Command {
        let period_s = self.config.period.value();
        for index in 0..AXES {
            if self.drives.axes[index].is_none() {
                continue;
            }
            let led = self.led(index);
            let stopped = matches!(self.mode, Mode::Halted);
            // what brakes by itself has been stopped already
            let homed = self.homing.is_homed(index)
                && !self.homing.is_homing(index)
                && (!stopped || led == Led::Angle);
            let coupled_stop = stopped && led == Led::Angle;
            let Some(axis) = &self.drives.axes[index] else { continue };
            let Err(finding) =
                self.setpoints.check(index, axis, period_s, (led, homed, coupled_stop))
            else {
                continue;
            };
            self.raise(finding, feedback);
            if stopped {
                self.mode = Mode::Disabled;
            }
            let Some(axis) = &mut self.drives.axes[index] else { continue };
            if finding.0 == FaultKind::SoftLimit {
                let motion = &self.config.motion;
                let most = motion.feed.accel[index].max(motion.rapid.accel[index]);
                let most = if most.is_finite() { most } else { 0.0 };
                axis.brakes_at = axis.brakes_at.max(most);
            }
            self.setpoints.replace(index, axis, (led, period_s));
        }
        if !matches!(self.mode, Mode::Disabled) {
            let command = self.drives.command();
            match unusable(&command) {
                None => return command,
                Some(of) => {
                    self.raise((FaultKind::SetpointInvalid, of, 0.0, 0.0), feedback);
                    self.mode = Mode::Disabled; // a loop that has lost its state can brake nothing
                }
            }
        }
        Command { tool: self.drives.tool, ..Command::default() }
    }

    /// What leads an axis in this period.
    fn led(&self, index: usize) -> Led {
        let rescue = self.recovering.is_some() || self.withdrawing.is_some();
        let taps = self.drives.follower.is_some_and(|(axis, _)| axis == index)
            || self.coupled().is_some_and(|(axis, ..)| axis == index);
        let threads = self.drives.chain.is_some() && index < THREADING_AXES;
        if rescue || taps || threads || self.drives.coupled.is_superposed(index) {
            return Led::Angle;
        }
        if !matches!(self.mode, Mode::Running) || self.retreating.is_some() {
            return Led::Itself;
        }
        match &self.activity {
            Activity::Moving(..) | Activity::Probing(_) => {
                if self.queue.is_per_revolution(self.chained) { Led::Angle } else { Led::Path }
            }
            _ => Led::Itself,
        }
    }
}

/// Whose command is no number, if one is not.
fn unusable(command: &Command) -> Option<Subject> {
    let axis = command.axes.iter().position(|axis| {
        !(axis.position.is_finite() && axis.speed.is_finite() && axis.force.is_finite())
    });
    let spindle = command.spindles.iter().position(|spindle| {
        let turned = spindle.orient.is_none_or(|to| to.angle.is_finite());
        !(spindle.angle.is_finite()
            && spindle.spin.is_finite()
            && spindle.torque.is_finite()
            && turned)
    });
    axis.map(|index| Subject::Axis(Axis::ALL[index]))
        .or_else(|| spindle.map(|index| Subject::Spindle(index as u8)))
}
