//! Pins of an axis: mm, degrees.
use crate::driven::DrivenPin;
use crate::ffi::{Hal, Pin};
use crate::new_pin::{input, output};
use bus::AxisFeedback;
use units::Coordinate;

/// Pins of an axis.
#[derive(Debug)]
pub(crate) struct AxisPins {
    pos_cmd: Pin<f64>,
    vel_cmd: Pin<f64>,
    enable: Pin<bool>,
    pos_fb: Pin<f64>,
    fault: Pin<bool>,
    ready: DrivenPin,
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
            home_sw: input(hal, &name("home-sw"))?,
            limits: [input(hal, &name("limit-neg"))?, input(hal, &name("limit-pos"))?],
        })
    }

    /// `awaits`: the drive says by its pin that it is ready.
    pub(crate) fn read(&self, enabled: bool, awaits: bool) -> AxisFeedback {
        AxisFeedback {
            position: Coordinate::new(self.pos_fb.get()),
            ready: enabled && !self.fault.get() && (!awaits || self.ready.says()),
            home_switch: self.home_sw.get(),
            limit_switches: [self.limits[0].get(), self.limits[1].get()],
            ..AxisFeedback::default()
        }
    }

    /// Something drives the pin by which the drive says that it is ready.
    pub(crate) fn is_ready_driven(&self) -> bool {
        self.ready.is_driven()
    }

    pub(crate) fn write(&self, enable: bool, position: f64, speed: f64) {
        // one that is off is told to be where it is, so that nothing jumps when it is switched on
        self.pos_cmd.set(if enable { position } else { self.pos_fb.get() });
        self.vel_cmd.set(if enable { speed } else { 0.0 });
        self.enable.set(enable);
    }
}
