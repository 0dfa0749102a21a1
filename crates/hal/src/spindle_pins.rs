//! Pins of a spindle: rev/min, revolutions.
use crate::axis_pins::ReliedOn;
use crate::driven::DrivenPin;
use crate::ffi::{Direction, Hal, Pin};
use crate::index::Unwrapped;
use crate::new_pin::{input, named, output};
use bus::{SpindleCommand, SpindleFeedback};
use units::{Angle, Orientation, Time, Torque, TurnDirection};

/// Pins of a spindle.
#[derive(Debug)]
pub(crate) struct SpindlePins {
    speed_cmd: Pin<f64>,
    speed_cmd_rps: Pin<f64>,
    enable: Pin<bool>,
    forward: Pin<bool>,
    reverse: Pin<bool>,
    brake: Pin<bool>,
    revs: Pin<f64>,
    index_enable: Pin<bool>,
    fault: Pin<bool>,
    ready: DrivenPin<bool>,
    torque: DrivenPin<f64>,
    inhibit: DrivenPin<bool>,
    pos_cmd: Pin<f64>,
    orient: Pin<bool>,
    orient_angle: Pin<f64>,
    orient_mode: Pin<i32>,
    is_oriented: Pin<bool>,
    orient_fault: Pin<i32>,
    locked: Pin<bool>,
    counted: Unwrapped,
    /// Where it is, by its encoder.
    at: Angle,
}

impl SpindlePins {
    pub(crate) fn new(hal: &Hal, number: usize) -> Result<Self, String> {
        let name = |what: &str| format!("spindle.{number}.{what}");
        Ok(Self {
            speed_cmd: output(hal, &name("speed-cmd"))?,
            speed_cmd_rps: output(hal, &name("speed-cmd-rps"))?,
            enable: output(hal, &name("enable"))?,
            forward: output(hal, &name("forward"))?,
            reverse: output(hal, &name("reverse"))?,
            brake: output(hal, &name("brake"))?,
            revs: input(hal, &name("revs"))?,
            index_enable: named(hal, &name("index-enable"), Direction::Io)?,
            fault: input(hal, &name("fault"))?,
            ready: DrivenPin::new(hal, &name("ready"))?,
            torque: DrivenPin::new(hal, &name("torque-fb"))?,
            inhibit: DrivenPin::new(hal, &name("inhibit"))?,
            pos_cmd: output(hal, &name("pos-cmd"))?,
            orient: output(hal, &name("orient"))?,
            orient_angle: output(hal, &name("orient-angle"))?,
            orient_mode: output(hal, &name("orient-mode"))?,
            is_oriented: input(hal, &name("is-oriented"))?,
            orient_fault: input(hal, &name("orient-fault"))?,
            locked: output(hal, &name("locked"))?,
            counted: Unwrapped::default(),
            at: Angle::ZERO,
        })
    }

    /// `relied_on`: the pins of this drive that the machine's file relies on.
    pub(crate) fn read(&mut self, enabled: bool, relied_on: ReliedOn) -> SpindleFeedback {
        let is_set = self.index_enable.get();
        let (revs, index) = self.counted.read(self.revs.get(), is_set);
        let (angle, index) = (Angle::rev(revs), index.map(Angle::rev));
        self.at = angle;
        SpindleFeedback {
            angle,
            index,
            ready: enabled && !self.fault.get() && (!relied_on.ready || self.ready.says()),
            torque: self.torque.said().filter(|_| relied_on.torque).map(Torque::n_m),
            saturated: false,
            oriented: self.is_oriented.get(),
            orient_fault: self.orient_fault.get(),
            ..SpindleFeedback::default()
        }
    }

    /// `is_watched`: the pin holds, too, while nothing drives it.
    pub(crate) fn is_inhibited(&self, is_watched: bool) -> bool {
        self.inhibit.get() || is_watched && !self.inhibit.is_driven()
    }

    /// Whether something drives the pins of its drive, and the one by which it is inhibited.
    pub(crate) fn driven(&self) -> (ReliedOn, bool) {
        let of_drive = ReliedOn { ready: self.ready.is_driven(), torque: self.torque.is_driven() };
        (of_drive, self.inhibit.is_driven())
    }

    /// The next index mark is looked for, or not any more.
    fn look(&mut self, mark: bool) {
        if self.counted.look(mark) != self.index_enable.get() {
            self.index_enable.set(mark);
        }
    }

    pub(crate) fn write(&mut self, told: &SpindleCommand, obeys_after: Time, mark: bool) {
        self.look(mark);
        let enable = told.enable;
        let rps = if enable { told.spin.value() } else { 0.0 };
        // one that is off is told to be where it is, so that nothing jumps when it is switched on
        let ahead = if enable { told.angle + told.spin * obeys_after } else { self.at };
        self.pos_cmd.set(ahead.value());
        self.speed_cmd.set(rps * 60.0);
        self.speed_cmd_rps.set(rps);
        self.enable.set(enable);
        self.forward.set(rps > 0.0);
        self.reverse.set(rps < 0.0);
        self.brake.set(!enable || told.locked);
        let orient = told.orient.filter(|_| enable);
        if let Some(Orientation { angle, direction }) = orient {
            self.orient_angle.set(angle.in_deg().rem_euclid(360.0));
            // as LinuxCNC's component `orient` takes it
            self.orient_mode.set(match direction {
                TurnDirection::Shortest => 0,
                TurnDirection::Forward => 1,
                TurnDirection::Backward => 2,
            });
        }
        self.orient.set(orient.is_some() && !told.locked);
        self.locked.set(orient.is_some() && told.locked);
    }
}
