//! What a device does apart from a drive's axes: digital inputs and outputs, an encoder.
use crate::coe::Dictionary;
use crate::profile::EmulatedAxis;
use units::{Angle, Spin, Time};

/// Eight digital outputs and inputs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DigitalIo {
    pub(super) inputs: u8,
    pub(super) outputs: u8,
}

/// An encoder on a shaft.
#[derive(Clone, Debug)]
pub(crate) struct Encoder {
    counts_per_rev: u32,
    angle: Angle,
    pub(super) spin: Spin,
    latched: Option<u32>,
}

impl Encoder {
    pub(crate) fn new(counts_per_rev: u32) -> Self {
        Self { counts_per_rev, angle: Angle::ZERO, spin: Spin::ZERO, latched: None }
    }

    fn counts(&self, angle: Angle) -> u32 {
        (angle.value() * f64::from(self.counts_per_rev)).floor() as i64 as u32
    }

    pub(super) fn step(&mut self, dictionary: &mut Dictionary, period: Time) {
        let before = self.angle.value().floor();
        self.angle += self.spin * period;
        let after = self.angle.value().floor();
        let enabled = dictionary.number(0x7010, 1).unwrap_or(0) & 1 != 0;
        if !enabled {
            self.latched = None;
        } else if before != after && self.latched.is_none() {
            self.latched = Some(self.counts(Angle::rev(before.max(after))));
        }
        dictionary.put(0x6010, 1, i64::from(self.latched.is_some()));
        dictionary.put(0x6010, 0x11, i64::from(self.counts(self.angle)));
        dictionary.put(0x6010, 0x12, i64::from(self.latched.unwrap_or(0)));
    }
}

/// What a device does.
#[derive(Clone, Debug)]
pub(crate) enum Application {
    None,
    DigitalIo(DigitalIo),
    Drive(Vec<EmulatedAxis>),
    Encoder(Encoder),
}
