//! What a front end asks of a control between its requests: one question, one answer, nothing
//! changes but the events that are taken.
use super::control::Control;
use super::event::{Alarm, Event};
use super::state::{EmergencyStop, Execution, Need};
use bus::State;
use canon::Axis;
use kernel::Waiting;
use units::{Coordinate, Time};

impl Control {
    /// The emergency stop chain, as the machine says it is.
    pub fn emergency_stop(&self) -> EmergencyStop {
        let is_open = self.executor.machine.feedback().emergency_stop;
        if is_open { EmergencyStop::Triggered } else { EmergencyStop::Armed }
    }

    /// The next thing that has happened.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop()
    }

    /// Events that were not asked for in time.
    pub const fn lost_events(&self) -> u64 {
        self.events.lost()
    }

    /// Alarms, oldest first: those that a reset has cleared too.
    pub fn alarms(&self) -> &[Alarm] {
        &self.alarms
    }

    /// What the program does.
    pub const fn execution(&self) -> Execution {
        self.execution
    }

    /// The drives are up, and nothing has stopped the machine.
    pub fn is_ready(&self) -> bool {
        self.meets(&Need::PowerOn).is_ok()
    }

    /// No program is under way, nothing moves, and no spindle is told to turn.
    pub fn is_at_standstill(&self) -> bool {
        let kernel = &self.executor.kernel;
        let by_hand = kernel.is_moving_manually() || self.is_referencing();
        let still = !by_hand && !self.is_resetting && !self.is_recovering;
        self.under_way.is_none() && still && (kernel.is_off() || kernel.is_standing())
    }

    /// What the axes do.
    pub fn activity(&self) -> State {
        self.executor.kernel.report().state
    }

    /// What it waits for, since when, and for how long at most.
    pub fn waiting(&self) -> Option<Waiting> {
        self.executor.kernel.waiting()
    }

    /// The program's line that is executed.
    pub fn line(&self) -> u32 {
        self.executor.kernel.report().line
    }

    /// A tool that is tied to a spindle is in the work.
    pub fn is_tool_in_work(&self) -> bool {
        self.is_tap_in_thread()
    }

    /// An alarm has stopped the machine, and no reset has cleared it.
    pub fn has_alarm(&self) -> bool {
        !self.executor.kernel.faults().is_empty()
    }

    /// Why nothing changes any more unless it is asked for: an alarm stands and everything has come
    /// to rest, or the machine is gone.
    pub fn stopped_by(&self) -> Option<String> {
        if let Some(why) = self.executor.machine.lost() {
            return Some(why);
        }
        let kernel = &self.executor.kernel;
        let by_hand = kernel.is_moving_manually() || self.is_referencing();
        let rests = !by_hand && !self.is_resetting && !self.is_recovering;
        let stands = kernel.is_off() || kernel.is_standing();
        let fault = kernel.faults().first().filter(|_| rests && stands)?;
        Some(fault.to_string())
    }

    /// Every axis is homed.
    pub fn is_homed_all(&self) -> bool {
        self.first_not_homed().is_none()
    }

    /// An axis or a spindle is moved by hand.
    pub fn is_moving_manually(&self) -> bool {
        self.executor.kernel.is_moving_manually()
    }

    /// The drives are up, whether or not an alarm has stopped the machine.
    pub fn is_up(&self) -> bool {
        let kernel = &self.executor.kernel;
        kernel.is_ready() || !kernel.is_off() && self.has_alarm()
    }

    /// An axis finds its reference.
    pub fn is_referencing(&self) -> bool {
        !self.to_home.is_empty() || self.executor.kernel.is_homing()
    }

    /// An axis is moved by hand as long as its lease lasts.
    pub fn is_jogging_on_lease(&self) -> bool {
        self.executor.kernel.is_moving_on_lease()
    }

    /// The simulated tool in the spindle, if it is broken.
    pub fn broken_tool(&self) -> Option<&canon::Tool> {
        let is_broken = self.executor.machine.truth().is_some_and(|truth| truth.tool_broken);
        self.base.tools.get(self.mounted()).filter(|_| is_broken)
    }

    /// Where each axis of the machine is told to be.
    pub fn setpoints(&self) -> impl Iterator<Item = (Axis, Coordinate)> {
        let axes = self.base.machine.axes.iter().flatten().map(|axis| axis.letter);
        axes.map(|axis| (axis, self.executor.kernel.setpoint(axis).unwrap_or(Coordinate::ZERO)))
    }

    /// Machine time.
    pub fn now(&self) -> Time {
        self.executor.machine.feedback().time
    }

    /// Length of the servo period.
    pub fn period_time(&self) -> Time {
        self.executor.machine.period()
    }

    /// The machine's file.
    pub const fn machine(&self) -> &store::machine::MachineFile {
        &self.base.machine
    }
}
