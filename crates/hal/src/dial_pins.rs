//! Pins of an override's dial, as halui's: counts that turn it, or at which it stands.
use crate::ffi::{Direction, Hal, Pin};
use crate::new_pin::{input, named};
use bus::OverrideDial;

/// A dial.
#[derive(Debug)]
pub(crate) struct DialPins {
    counts: Pin<i32>,
    scale: Pin<f64>,
    count_enable: Pin<bool>,
    direct_value: Pin<bool>,
    before: i32,
    turned: f64,
}

impl DialPins {
    /// `name` is such as `feed-override`.
    pub(crate) fn new(hal: &Hal, name: &str) -> Result<Self, String> {
        let pins = Self {
            counts: input(hal, &format!("{name}.counts"))?,
            scale: input(hal, &format!("{name}.scale"))?,
            count_enable: named(hal, &format!("{name}.count-enable"), Direction::In)?,
            direct_value: input(hal, &format!("{name}.direct-value"))?,
            before: 0,
            turned: 0.0,
        };
        pins.count_enable.set(true); // as halui begins
        Ok(pins)
    }

    pub(crate) fn read(&mut self) -> OverrideDial {
        let (counts, percent) = (self.counts.get(), self.scale.get() * 100.0);
        let by = f64::from(counts.wrapping_sub(self.before));
        self.before = counts;
        let is_read = self.count_enable.get() && percent.is_finite();
        let is_value = is_read && self.direct_value.get();
        if is_read && !is_value {
            self.turned += by * percent;
        }
        let at = is_value.then(|| (f64::from(counts) * percent) as f32);
        OverrideDial { turned: self.turned as f32, at }
    }
}
