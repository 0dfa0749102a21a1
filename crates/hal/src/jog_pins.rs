//! Pins by which an axis is jogged: a handwheel's, as those of LinuxCNC's `axis.x`, and two keys.
use crate::driven::DrivenPin;
use crate::ffi::{Hal, Pin};
use crate::new_pin::input;
use bus::{WHEEL_STEPS_PER_UNIT, WheelTravel};

/// The wheel and the keys of an axis.
#[derive(Debug)]
pub(crate) struct JogPins {
    counts: Pin<i32>,
    scale: Pin<f64>,
    enable: Pin<bool>,
    plus: DrivenPin<bool>,
    minus: DrivenPin<bool>,
    before: i32,
    /// Steps of [`WheelTravel`] that the wheel has asked for.
    steps: i32,
    /// What is left of a step.
    rest: f64,
}

impl JogPins {
    pub(crate) fn new(hal: &Hal, letter: char) -> Result<Self, String> {
        let name = |what: &str| format!("{letter}.{what}");
        Ok(Self {
            counts: input(hal, &name("jog-counts"))?,
            scale: input(hal, &name("jog-scale"))?,
            enable: input(hal, &name("jog-enable"))?,
            plus: DrivenPin::new(hal, &name("jog-plus"))?,
            minus: DrivenPin::new(hal, &name("jog-minus"))?,
            before: 0,
            steps: 0,
            rest: 0.0,
        })
    }

    /// What the wheel has asked for since the component was loaded.
    pub(crate) fn wheel(&mut self) -> WheelTravel {
        let counts = self.counts.get();
        let by = f64::from(counts.wrapping_sub(self.before)) * self.scale.get();
        self.before = counts;
        if self.enable.get() && by.is_finite() {
            let steps = by * WHEEL_STEPS_PER_UNIT + self.rest;
            let whole = steps.trunc();
            self.rest = steps - whole;
            self.steps = self.steps.wrapping_add(whole as i32);
        }
        WheelTravel::of_steps(self.steps)
    }

    /// The key that is held: −1, 1, or 0 for none or both. One that nothing drives is not held.
    pub(crate) fn key(&self) -> i8 {
        i8::from(self.plus.says()) - i8::from(self.minus.says())
    }
}
