//! Power, emergency stop, reset, homing; and what takes a tool out of the work.
use super::control::Control;
use super::manual::refused_by_kernel;
use super::request::{Accepted, Refusal};
use super::state::{EmergencyStop, ExecutionEvent, Mode, Power};
use super::under_way::InWork;
use crate::config;
use crate::recovery::WayOut;
use crate::stops::RecoverySettings;
use canon::Axis;
use kernel::{Order, WithdrawalPlan};
use servo::LaneStop;
use sim::Fault;

impl Control {
    pub(super) fn switch_power(&mut self, on: bool) -> Result<Accepted, Refusal> {
        if on != (self.power == Power::On) {
            if on {
                self.executor.kernel.switch_on();
                self.power = Power::On;
            } else {
                self.switch_off()?;
            }
        }
        Ok(Accepted::default())
    }

    fn switch_off(&mut self) -> Result<(), Refusal> {
        if !self.executor.kernel.switch_off() {
            return Err(Refusal::because("an axis moves or a spindle turns: stop it first"));
        }
        self.power = Power::Off;
        self.everything_was_stopped();
        Ok(())
    }

    /// Spindle and coolant are off without a word of a program.
    pub(super) fn everything_was_stopped(&mut self) {
        self.data.stop_spindles();
        self.handwheel = [None; bus::AXES];
    }

    /// Of the simulated machine's chain: a test of it. The real one is hardware.
    pub(super) fn press_emergency_stop(&mut self, pressed: bool) -> Result<Accepted, Refusal> {
        if self.outside.is_some() {
            return self.stop_instead(pressed);
        }
        if pressed {
            self.executor.machine.strike(Fault::EmergencyStop);
        } else {
            // what was pressed before does not open the chain again afterwards
            self.executor.stops.withdraw(LaneStop::EmergencyStop);
            self.executor.machine.repair(Fault::EmergencyStop);
        }
        Ok(Accepted::default())
    }

    /// The first axis that is not homed.
    pub(super) fn first_not_homed(&self) -> Option<Axis> {
        let axes = self.base.machine.axes.iter().flatten().map(|axis| axis.letter);
        axes.into_iter().find(|axis| !self.is_homed(*axis))
    }

    /// An axis knows where it is.
    pub fn is_homed(&self, axis: Axis) -> bool {
        self.executor.kernel.is_homed(axis)
    }

    /// One axis, or all in the machine's order: those of equal numbers together.
    pub(super) fn home(&mut self, axis: Option<Axis>) -> Result<Accepted, Refusal> {
        if let Some(axis) = axis {
            self.axis_file(axis)?;
        }
        if self.is_referencing() {
            return Err(Refusal::because("homing is under way: wait, or stop the jog"));
        }
        self.executor.kernel.clear();
        self.to_home = config::homing(&self.base.machine)
            .into_iter()
            .filter(|homing| axis.is_none_or(|axis| homing.axis == axis))
            .collect();
        let begun = self.home_next();
        match begun {
            Ok(_) => self.enter(Mode::Manual),
            Err(_) => self.to_home.clear(),
        }
        begun
    }

    /// The axes whose turn it is begin.
    fn home_next(&mut self) -> Result<Accepted, Refusal> {
        let Some(order) = self.to_home.first().map(|homing| homing.order) else {
            return Ok(Accepted::default());
        };
        let (now, later) = self.to_home.drain(..).partition(|homing| homing.order == order);
        self.to_home = later;
        for homing in now {
            let begun = self.executor.kernel.home(homing.axis, &homing.how);
            begun.map_err(|why| refused_by_kernel(why, homing.axis))?;
        }
        Ok(Accepted::default())
    }

    /// The next axes are homed when those before are.
    pub(super) fn go_on_homing(&mut self) {
        if self.to_home.is_empty() || self.executor.kernel.is_homing() {
            return;
        }
        if !self.executor.kernel.is_ready() || self.is_resetting {
            self.to_home.clear();
        } else if let Err(why) = self.home_next() {
            self.to_home.clear();
            self.events.notice(why.to_string());
        }
    }

    /// Alarms are cleared; what was executed is forgotten; spindles and coolant come to rest.
    pub(super) fn reset(&mut self) -> Result<Accepted, Refusal> {
        let was_disabled = self.executor.kernel.is_off() && self.power == Power::On;
        if !self.executor.kernel.faults().is_empty() || was_disabled {
            self.executor.kernel.switch_on();
            if self.power == Power::Off || was_disabled {
                self.power = Power::Off;
                self.executor.kernel.switch_off();
            }
            self.told_faults = 0;
            self.clear_alarms();
        } else if self.power == Power::On {
            self.executor.kernel.order(Order::Abort); // what turns comes to rest first
            self.is_resetting = true;
        }
        self.everything_was_stopped();
        self.executor.kernel.clear_outputs();
        self.is_hold_asked = false;
        self.execution_after(ExecutionEvent::Reset);
        Ok(Accepted::default())
    }

    /// A tap, or another tool that is tied to a spindle, is in the work.
    pub(super) fn is_tap_in_thread(&self) -> bool {
        let kernel = &self.executor.kernel;
        if self.is_tool_left() || self.in_work.is_some() {
            return true;
        }
        let is_tap = kernel.engaged().is_some() && (kernel.is_off() || kernel.is_in_thread());
        is_tap || self.under_way.is_none() && kernel.way_out().is_some()
    }

    /// The control that stopped it, with all of its drives, backs it out along its thread.
    pub(super) fn retract(&mut self) -> Result<Accepted, Refusal> {
        if !self.executor.kernel.can_back_out() {
            let why = "the tap cannot be backed out: it moves, or a drive or an encoder is gone; hold, or recover";
            return Err(Refusal::because(why));
        }
        self.order(Order::Retract)
    }

    /// Drives, power or an encoder were gone: the tool is taken out from where the encoders show
    /// it.
    pub(super) fn recover(&mut self) -> Result<Accepted, Refusal> {
        if self.under_way.is_some() {
            return Err(Refusal::because("a program is under way: retract, or stop it first"));
        }
        if self.is_recovering {
            return Err(Refusal::because("a recovery is on its way already"));
        }
        if self.emergency_stop() == EmergencyStop::Triggered {
            return Err(Refusal::because("the emergency stop is triggered: release it first"));
        }
        if let Some(why) = self.executor.machine.lost() {
            return Err(Refusal::because(format!(
                "{why}; start the control again: it takes the tool out then"
            )));
        }
        let way_out = self.way_out_of_left()?;
        let kernel = &mut self.executor.kernel;
        if kernel.can_back_out() {
            return Err(Refusal::because("the control can back the tap out itself: retract"));
        }
        match way_out {
            Some(WayOut::Along(plan)) => kernel.recover(plan),
            Some(WayOut::Off(plan)) => kernel.withdraw(plan),
            None => self.recover_own()?,
        }
        self.is_recovering = true;
        self.power = Power::On;
        self.told_faults = 0;
        Ok(Accepted::default())
    }

    /// The way out of what this control has led into the work.
    fn recover_own(&mut self) -> Result<(), Refusal> {
        let settings = RecoverySettings::new(&self.base);
        let kernel = &mut self.executor.kernel;
        let tap = kernel
            .engaged()
            .map(|stored| InWork::Tap(stored, kernel.surface().unwrap_or(stored.start().place)));
        // a recovery before this one may have been stopped by an alarm
        let in_work = tap.or_else(|| kernel.way_out().copied().map(InWork::Tool)).or(self.in_work);
        match in_work {
            Some(InWork::Tap(stored, surface)) => {
                self.executor.machine.mend();
                // the thread was cut in the coordinates that homing has found
                let mut now = *self.executor.machine.feedback();
                for (axis, letter) in now.axes.iter_mut().zip(Axis::ALL) {
                    axis.position += kernel.shift(letter);
                }
                for (index, spindle) in now.spindles.iter_mut().enumerate() {
                    spindle.angle += kernel.spindle_shift(index);
                }
                let plan = settings.plan(stored, surface, &now).map_err(Refusal::because)?;
                kernel.recover(plan);
            }
            Some(InWork::Tool(way_out)) => {
                if !way_out.is_straight() {
                    let why = "nothing ties this tool to an axis: turn the spindle backwards by hand until it is out, then state that the tool is free";
                    return Err(Refusal::because(why));
                }
                self.executor.machine.mend();
                let legs = [Some((way_out.infeed, way_out.clear)), None];
                kernel.withdraw(WithdrawalPlan { legs });
            }
            None => {}
        }
        self.in_work = in_work;
        Ok(())
    }

    /// A recovery is over: by its end, or by an alarm.
    pub(super) fn after_recovery(&mut self) {
        if !self.executor.kernel.faults().is_empty() {
            return self.events.notice("the recovery was stopped by an alarm");
        }
        self.in_work = None;
        self.executor.kernel.go_on();
        self.executor.kernel.clear();
        self.left_is_out();
        self.clear_alarms();
        self.events.notice("the tool is out of the work");
    }

    /// Kernel and control forget the tool that was in the work.
    pub(super) fn tool_is_free(&mut self) -> Result<Accepted, Refusal> {
        if self.under_way.is_some() || self.is_recovering {
            return Err(Refusal::because("stop what moves first"));
        }
        if !self.executor.kernel.is_standing() {
            return Err(Refusal::because("wait until everything stands"));
        }
        self.forget_left()?;
        self.in_work = None;
        self.executor.kernel.switch_on();
        self.executor.kernel.switch_off();
        (self.power, self.told_faults) = (Power::Off, 0);
        self.clear_alarms();
        self.everything_was_stopped();
        Ok(Accepted::default())
    }
}
