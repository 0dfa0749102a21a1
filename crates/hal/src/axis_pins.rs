//! Pins of an axis: mm, degrees.
use crate::driven::DrivenPin;
use crate::ffi::{Direction, Hal, Pin};
use crate::index::Unwrapped;
use crate::new_pin::{input, named, output};
use bus::AxisFeedback;
use units::{Coordinate, Force};

/// What a drive says of itself by pins that something must drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ReliedOn {
    pub(crate) ready: bool,
    pub(crate) torque: bool,
}

/// Pins of an axis.
#[derive(Debug)]
pub(crate) struct AxisPins {
    pos_cmd: Pin<f64>,
    vel_cmd: Pin<f64>,
    enable: Pin<bool>,
    pos_fb: Pin<f64>,
    fault: Pin<bool>,
    ready: DrivenPin<bool>,
    torque: DrivenPin<f64>,
    home_sw: Pin<bool>,
    limits: [Pin<bool>; 2],
    index_enable: Pin<bool>,
    counted: Unwrapped,
}

impl AxisPins {
    pub(crate) fn new(hal: &Hal, letter: char) -> Result<Self, String> {
        let name = |what: &str| format!("{letter}.{what}");
        Ok(Self {
            pos_cmd: output(hal, &name("pos-cmd"))?,
            vel_cmd: output(hal, &name("vel-cmd"))?,
            enable: output(hal, &name("enable"))?,
            pos_fb: input(hal, &name("pos-fb"))?,
            fault: input(hal, &name("fault"))?,
            ready: DrivenPin::new(hal, &name("ready"))?,
            torque: DrivenPin::new(hal, &name("torque-fb"))?,
            home_sw: input(hal, &name("home-sw"))?,
            limits: [input(hal, &name("limit-neg"))?, input(hal, &name("limit-pos"))?],
            index_enable: named(hal, &name("index-enable"), Direction::Io)?,
            counted: Unwrapped::default(),
        })
    }

    /// `relied_on`: the pins of this drive that the machine's file relies on.
    pub(crate) fn read(&mut self, enabled: bool, relied_on: ReliedOn) -> AxisFeedback {
        let (position, index) = self.counted.read(self.pos_fb.get(), self.index_enable.get());
        AxisFeedback {
            position: Coordinate::new(position),
            index: index.map(Coordinate::new),
            ready: enabled && !self.fault.get() && (!relied_on.ready || self.ready.says()),
            force: self.torque.said().filter(|_| relied_on.torque).map(Force::n),
            home_switch: self.home_sw.get(),
            limit_switches: [self.limits[0].get(), self.limits[1].get()],
            ..AxisFeedback::default()
        }
    }

    /// Whether something drives the pins of its drive.
    pub(crate) fn driven(&self) -> ReliedOn {
        ReliedOn { ready: self.ready.is_driven(), torque: self.torque.is_driven() }
    }

    /// `mark`: the next index mark is looked for.
    pub(crate) fn write(&mut self, enable: bool, position: f64, speed: f64, mark: bool) {
        if self.counted.look(mark) != self.index_enable.get() {
            self.index_enable.set(mark);
        }
        // one that is off is told to be where it is, so that nothing jumps when it is switched on
        let reading = self.counted.reading_at(position);
        self.pos_cmd.set(if enable { reading } else { self.pos_fb.get() });
        self.vel_cmd.set(if enable { speed } else { 0.0 });
        self.enable.set(enable);
    }
}
