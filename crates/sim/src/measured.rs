//! What a drive says of its own torque, or of its force along the axis.
//!
//! ```text
//!   given ──► × (1 + s) ──► delay ──► + noise ──► whole steps ──► said
//! ```
//!
//! s is the error of the motor's torque constant: the drive measures current. A share is one of the
//! drive's peak, so that one description serves motors and linear motors alike.
use crate::Config;
use crate::rng::Rng;
use bus::{AXES, Feedback, SPINDLES, Truth};
use units::{Force, Time, Torque};

/// The stream of what drives measure is another one than that of the plant.
const OF_MEASURED: u64 = 0x544F_5251_5545_0000;
/// Longest delay, in periods.
const MOST_DELAY_PERIODS: usize = 1024;

/// How a drive measures the torque, or the force, that it gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredTorque {
    /// One step of the reading, as a share of the drive's peak; 0 for none.
    pub resolution_share: f64,
    /// Standard deviation of its noise, as a share of the drive's peak.
    pub noise_share: f64,
    /// From what is given to what is said.
    pub delay: Time,
    /// Error of the motor's torque constant, as a share.
    pub constant_error: f64,
}

/// The drives that measure what they give: axes by their index on the bus.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuredTorques {
    /// By axis.
    pub axes: [Option<MeasuredTorque>; AXES],
    /// By spindle.
    pub spindles: [Option<MeasuredTorque>; SPINDLES],
}

/// All of them at work: axes and spindles by their index on the bus.
#[derive(Clone, Debug, Default)]
pub(crate) struct TorqueSensors {
    axes: Vec<(usize, TorqueSensor)>,
    spindles: Vec<(usize, TorqueSensor)>,
}

impl TorqueSensors {
    pub(crate) fn new(measured: &MeasuredTorques, config: &Config) -> Self {
        let Config { seed, period, .. } = *config;
        let axes = config.axes.iter().filter_map(|(index, model)| {
            let sensor = measured.axes.get(*index)?.as_ref()?;
            let peak = model.peak_force().value();
            Some((*index, TorqueSensor::new(sensor, peak, period, seed, *index)))
        });
        let spindles = config.spindles.iter().zip(&measured.spindles).enumerate();
        let spindles = spindles.filter_map(|(index, (model, sensor))| {
            let (peak, place) = (model.peak_torque.value(), AXES + index);
            Some((index, TorqueSensor::new(sensor.as_ref()?, peak, period, seed, place)))
        });
        Self { axes: axes.collect(), spindles: spindles.collect() }
    }

    /// A period is over: what the drives say of what they gave at last.
    pub(crate) fn read(&mut self, truth: &Truth, said: &mut Feedback) {
        for (index, sensor) in &mut self.axes {
            let given = truth.axis_forces[*index].value();
            said.axes[*index].force = Some(Force::n(sensor.read(given)));
        }
        for (index, sensor) in &mut self.spindles {
            let given = truth.spindle_torques[*index].value();
            said.spindles[*index].torque = Some(Torque::n_m(sensor.read(given)));
        }
    }
}

/// One of them, in N or N·m.
#[derive(Clone, Debug)]
struct TorqueSensor {
    scale: f64,
    step: f64,
    noise: f64,
    rng: Rng,
    /// What was given in the last periods, the oldest at `next`; empty without delay.
    underway: Vec<f64>,
    next: usize,
}

impl TorqueSensor {
    /// `place` is 0 for X and so on, then that of spindles: each has draws of its own.
    fn new(model: &MeasuredTorque, peak: f64, period: Time, seed: u64, place: usize) -> Self {
        let periods = (model.delay.value() / period.value()).round() as usize;
        Self {
            scale: 1.0 + model.constant_error,
            step: model.resolution_share * peak,
            noise: model.noise_share * peak,
            rng: Rng::new(seed ^ OF_MEASURED ^ place as u64).branch(),
            underway: vec![0.0; periods.min(MOST_DELAY_PERIODS)],
            next: 0,
        }
    }

    /// A period is over, in which the drive gave this at last.
    fn read(&mut self, given: f64) -> f64 {
        let late = match self.underway.get_mut(self.next) {
            Some(oldest) => core::mem::replace(oldest, given),
            None => given,
        };
        self.next = if self.next + 1 < self.underway.len() { self.next + 1 } else { 0 };
        let noise = if self.noise > 0.0 { self.noise * self.rng.bell() } else { 0.0 };
        let seen = late * self.scale + noise;
        if self.step > 0.0 { (seen / self.step).round() * self.step } else { seen }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const IDEAL: MeasuredTorque = MeasuredTorque {
        resolution_share: 0.0,
        noise_share: 0.0,
        delay: Time::ZERO,
        constant_error: 0.0,
    };

    fn sensor(model: MeasuredTorque, seed: u64) -> TorqueSensor {
        TorqueSensor::new(&model, 50.0, Time::s(0.25e-3), seed, 2)
    }

    #[test]
    fn what_is_given_is_said_after_the_delay_and_in_whole_steps() {
        let model = MeasuredTorque { resolution_share: 1e-3, delay: Time::s(1e-3), ..IDEAL };
        let mut late = sensor(model, 1);
        let said: Vec<f64> = (1..=8).map(|i| late.read(1.01 * f64::from(i))).collect();
        assert_eq!(said[..4], [0.0; 4], "four periods");
        for (i, said) in said.iter().skip(4).enumerate() {
            let given = 1.01 * (i + 1) as f64;
            assert!((said - given).abs() <= 0.025 + 1e-12, "{said} of {given}");
            assert!((said / 0.05 - (said / 0.05).round()).abs() < 1e-9, "{said}");
        }
    }

    #[test]
    fn noise_has_its_deviation_and_the_constant_its_error() {
        let mut noisy = sensor(MeasuredTorque { noise_share: 0.02, ..IDEAL }, 3);
        let said: Vec<f64> = (0..20_000).map(|_| noisy.read(10.0)).collect();
        let mean = said.iter().sum::<f64>() / said.len() as f64;
        let square = said.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / said.len() as f64;
        assert!((mean - 10.0).abs() < 0.03, "{mean}");
        assert!((square.sqrt() - 1.0).abs() < 0.03, "{}", square.sqrt());
        let mut strong = sensor(MeasuredTorque { constant_error: 0.05, ..IDEAL }, 3);
        assert_eq!(strong.read(10.0), 10.5);
    }
}
