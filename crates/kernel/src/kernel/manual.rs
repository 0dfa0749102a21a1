//! What is done without a program: drives on and off, axes moved by hand, all forgotten after an
//! alarm.
use super::{Kernel, Mode};
use crate::event::EventKind;
use crate::execute::Activity;
use crate::manual::{ManualOrder, ManualRefusal, SpindleByHand};
use crate::spindle::SpindleLoop;
use bus::{Command, Feedback, State};
use units::{Angle, Axis, Coordinate, Spin, Time};

impl Kernel {
    /// Outputs off: everything stands and nothing is executed. Whether that is so.
    pub fn switch_off(&mut self) -> bool {
        let may = self.is_standing() && !self.is_moved_by_hand() && self.queue.is_empty();
        if may || matches!(self.mode, Mode::New | Mode::Starting(_)) {
            let operator = self.operator.without_orders();
            self.begin_anew();
            (self.operator, self.mode) = (operator, Mode::Disabled);
            (self.drives.mist, self.drives.flood) = (false, false);
        }
        matches!(self.mode, Mode::Disabled)
    }

    /// Everything is off: the changer keeps the tool that the machine has, whatever was ordered
    /// before.
    pub(super) fn leave(&mut self, feedback: &Feedback) -> Command {
        self.drives.tool = feedback.tool.unwrap_or(self.drives.tool);
        Command { tool: self.drives.tool, ..Command::default() }
    }

    /// Outputs are off.
    pub const fn is_off(&self) -> bool {
        matches!(self.mode, Mode::Disabled)
    }

    /// The drives are up and no alarm has stopped the machine.
    pub const fn is_ready(&self) -> bool {
        matches!(self.mode, Mode::Running)
    }

    /// The drives come up, each axis where it stands; what stopped the machine before has had its
    /// answer. Overrides stay.
    pub fn switch_on(&mut self) {
        let operator = self.operator.without_orders();
        self.begin_anew();
        self.operator = operator;
    }

    /// A program has ended or was given up, and the axes stand: another one may come, with the
    /// spindles turning on as they are told to. Whether that is so.
    pub fn clear(&mut self) -> bool {
        let mut axes = self.drives.axes.iter().flatten();
        let stand = axes.all(|axis| axis.target.speed == 0.0) && !self.operator.wants_out();
        let stands = matches!(self.mode, Mode::Running) && stand;
        if !stands || self.engaged().is_some() || self.way_out.is_some() {
            return false;
        }
        self.queue.clear();
        self.drives.guard = crate::sequence_steps::Guard::default();
        (self.chained, self.drives.chain) = (0, None);
        (self.activity, self.begun, self.aborted) = (Activity::Idle, false, false);
        self.operator = self.operator.without_orders();
        self.answer = None;
        self.report.state = State::Idle;
        true
    }

    /// All outputs to the machine's surroundings are off, as after a reset.
    pub fn clear_outputs(&mut self) {
        self.drives.outputs = bus::Signals::default();
    }

    /// Move an axis by hand from the next tick on, or otherwise than until now.
    ///
    /// # Errors
    /// There is no such axis, it cannot be moved by hand now, or the order makes no sense.
    pub fn move_manually(&mut self, axis: Axis, order: ManualOrder) -> Result<(), ManualRefusal> {
        let Some(moved) = self.drives.axes.get(axis.index()).and_then(Option::as_ref) else {
            return Err(ManualRefusal::NoAxis);
        };
        if !order.is_sound() {
            return Err(ManualRefusal::NotANumber);
        }
        self.may_move_manually()?;
        if self.operator.inhibit().feed {
            return Err(ManualRefusal::Inhibited);
        }
        self.manual.take(axis.index(), order, moved.target.position);
        Ok(())
    }

    /// Turn a spindle by hand at this speed until its lease is over, or otherwise than until now;
    /// at no speed: stop it.
    ///
    /// # Errors
    /// There is no such spindle, it cannot be turned by hand now, or it cannot turn so fast.
    pub fn turn_manually(
        &mut self,
        spindle: usize,
        spin: Spin,
        until: Time,
    ) -> Result<(), ManualRefusal> {
        self.may_move_manually()?;
        let Some(turned) = self.drives.spindles.get_mut(spindle).and_then(Option::as_mut) else {
            return Err(ManualRefusal::NoAxis);
        };
        if !(spin.abs() <= turned.control.highest && until.is_finite()) {
            return Err(ManualRefusal::NotANumber);
        }
        if self.operator.inhibit().spindle && spin != Spin::ZERO {
            return Err(ManualRefusal::Inhibited);
        }
        turned.slew_to(spin);
        self.drives.in_force[spindle] = Spin::ZERO; // no program has ordered it
        self.manual.turn(spindle, (spin != Spin::ZERO).then_some(SpindleByHand::Until(until)));
        Ok(())
    }

    /// Bring a spindle to this angle within its turn and hold it there.
    ///
    /// # Errors
    /// There is no such spindle, or it cannot be moved by hand now.
    pub fn orient_manually(&mut self, spindle: usize, angle: Angle) -> Result<(), ManualRefusal> {
        self.may_move_manually()?;
        if self.operator.inhibit().spindle {
            return Err(ManualRefusal::Inhibited);
        }
        if !angle.is_finite() {
            return Err(ManualRefusal::NotANumber);
        }
        let Some(turned) = self.drives.spindles.get_mut(spindle).and_then(Option::as_mut) else {
            return Err(ManualRefusal::NoAxis);
        };
        turned.stop();
        self.drives.in_force[spindle] = Spin::ZERO;
        self.manual.turn(spindle, Some(SpindleByHand::To(angle, 0.0)));
        Ok(())
    }

    /// All that is moved by hand comes to rest, each axis as hard as it may brake.
    pub fn rest_manually(&mut self) {
        self.manual.rest();
    }

    /// Drives are up and no step of a program waits.
    fn may_move_manually(&self) -> Result<(), ManualRefusal> {
        let ready = matches!(self.mode, Mode::Running) && self.recovering.is_none();
        if !ready || self.withdrawing.is_some() {
            return Err(ManualRefusal::NotReady);
        }
        if !self.queue.is_empty() || self.drives.flowing || self.homing.is_active() {
            return Err(ManualRefusal::Busy);
        }
        Ok(())
    }

    /// An axis or a spindle is moved by hand.
    pub fn is_moving_manually(&self) -> bool {
        self.manual.is_active()
    }

    /// An axis is moved by hand, or homed.
    pub(super) fn is_moved_by_hand(&self) -> bool {
        self.manual.is_active() || self.homing.is_active()
    }

    /// An axis is moved by hand as long as its lease lasts.
    pub fn is_moving_on_lease(&self) -> bool {
        self.manual.is_leased()
    }

    /// Where an axis is told to be.
    pub fn setpoint(&self, axis: Axis) -> Option<Coordinate> {
        let axis = self.drives.axes.get(axis.index())?.as_ref()?;
        Some(Coordinate::new(axis.target.position))
    }

    /// How fast a spindle is told to turn; one that there is not, not at all.
    pub fn ordered_spin(&self, spindle: usize) -> Spin {
        let spindle = self.drives.spindles.get(spindle).and_then(Option::as_ref);
        spindle.map_or(Spin::ZERO, |spindle| spindle.ordered().spin)
    }

    /// No spindle is told to turn.
    pub fn spindles_rest(&self) -> bool {
        let spindles = self.drives.spindles.iter().flatten();
        spindles.map(SpindleLoop::ordered).all(|ordered| ordered.spin.value() == 0.0)
    }

    /// Axes that are moved by hand go on.
    pub(super) fn advance_manual(&mut self, feedback: &Feedback) {
        let rests = self.operator.hands_rest();
        let sees = (self.config.period.value(), feedback);
        let times = (self.now, self.config.waits.oriented);
        if let Err(finding) = self.manual.advance(times, rests, sees, &mut self.drives) {
            self.raise(finding, feedback);
        }
        while let Some(axis) = self.manual.take_stopped() {
            self.note(EventKind::StoppedBySwitch { axis });
        }
    }
}
