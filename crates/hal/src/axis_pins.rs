//! Pins of an axis: mm, degrees.
use crate::driven::DrivenPin;
use crate::ffi::{Hal, Pin};
use crate::new_pin::{input, output};
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
        })
    }

    /// `relied_on`: the pins of this drive that the machine's file relies on.
    pub(crate) fn read(&self, enabled: bool, relied_on: ReliedOn) -> AxisFeedback {
        AxisFeedback {
            position: Coordinate::new(self.pos_fb.get()),
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

    pub(crate) fn write(&self, enable: bool, position: f64, speed: f64) {
        // one that is off is told to be where it is, so that nothing jumps when it is switched on
        self.pos_cmd.set(if enable { position } else { self.pos_fb.get() });
        self.vel_cmd.set(if enable { speed } else { 0.0 });
        self.enable.set(enable);
    }
}
