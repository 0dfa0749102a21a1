//! A spindle drive that is only told a speed: a relay passes the order on, and the drive ramps by itself.
//!
//! ```text
//!   order  ──┐          ┌────────
//!            └──────────┘                    each change of the order draws anew:
//!   speed  ──────╲                             delay  d·(…)  +  σd·N        relay and drive's scan
//!                │ ╲                           ramp   a/(1 + σa·N)          stopping time
//!          delay │  ╲____                      speed  ω·(1 + σω·N)          slip, tension of a belt
//! ```
//!
//! N is drawn from the normal distribution. The speed is what the drive makes it: it has torque enough, and the torque
//! it gives follows from inertia, friction and load. So are spindles without synchronisation, with contactors and a
//! frequency converter or a pole-changing motor; a machine is given one by
//! [`crate::SimulatedMachine::with_plain_drive`].
use crate::rng::Rng;
use core::f64::consts::TAU;
use units::{SpinAccel, Time};

/// A drive with its scatter; every scatter is one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainDrive {
    /// From an order until the speed begins to change.
    pub delay: Time,
    /// Scatter of the delay.
    pub delay_scatter: Time,
    /// Of the ramp up.
    pub accel: SpinAccel,
    /// Of the ramp down.
    pub decel: SpinAccel,
    /// Scatter of the time that a ramp takes, as a share.
    pub ramp_scatter: f64,
    /// Scatter of the speed, as a share.
    pub speed_scatter: f64,
}

/// An order that changes within this time of its last change is one and the same, on its way, s.
const ONE_ORDER_S: f64 = 5e-3;
/// A ramp is never drawn so fast or so slow that its time changes by more than this factor.
const MOST_FACTOR: f64 = 2.0;

/// A drive at work. Speeds in rad/s.
#[derive(Clone, Debug)]
pub(crate) struct Relay {
    model: PlainDrive,
    rng: Rng,
    ordered: f64,
    /// Time since the order last changed, and since it began to change, s.
    unchanged_s: f64,
    since_s: f64,
    delay_s: f64,
    accel: f64,
    decel: f64,
    speed_factor: f64,
    target: f64,
}

impl Relay {
    pub(crate) const fn new(model: PlainDrive, rng: Rng) -> Self {
        Self {
            model,
            rng,
            ordered: 0.0,
            unchanged_s: f64::INFINITY,
            since_s: f64::INFINITY,
            delay_s: 0.0,
            accel: 0.0,
            decel: 0.0,
            speed_factor: 1.0,
            target: 0.0,
        }
    }

    /// What it is told.
    pub(crate) fn obey(&mut self, ordered: f64) {
        if ordered == self.ordered || !ordered.is_finite() {
            return;
        }
        if self.unchanged_s > ONE_ORDER_S {
            self.draw();
            self.since_s = 0.0;
        }
        self.ordered = ordered;
        self.unchanged_s = 0.0;
    }

    fn draw(&mut self) {
        let model = self.model;
        let longest = 1.0 + model.ramp_scatter * self.rng.normal();
        let longest = longest.clamp(1.0 / MOST_FACTOR, MOST_FACTOR);
        self.accel = model.accel.value() * TAU / longest;
        self.decel = model.decel.value() * TAU / longest;
        let delay = model.delay.value() + model.delay_scatter.value() * self.rng.normal();
        self.delay_s = delay.max(0.0);
        self.speed_factor = 1.0 + model.speed_scatter * self.rng.normal();
    }

    /// Speed after a step of `h` seconds.
    pub(crate) fn step(&mut self, omega: f64, h: f64) -> f64 {
        self.unchanged_s += h;
        self.since_s += h;
        if self.since_s > self.delay_s {
            self.target = self.ordered * self.speed_factor;
        }
        let slows_down = omega * self.target < 0.0 || self.target.abs() < omega.abs();
        let most = if slows_down { self.decel } else { self.accel } * h;
        omega + (self.target - omega).clamp(-most, most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 25e-6;

    fn exact() -> PlainDrive {
        PlainDrive {
            delay: Time::s(0.02),
            delay_scatter: Time::ZERO,
            accel: SpinAccel::rev_per_s2(50.0 / 0.08),
            decel: SpinAccel::rev_per_s2(50.0 / 0.08),
            ramp_scatter: 0.0,
            speed_scatter: 0.0,
        }
    }

    /// Revolutions and time from an order to stop, out of full speed, until it stands.
    fn stop(relay: &mut Relay) -> (f64, f64) {
        let mut omega = 0.0;
        relay.obey(50.0 * TAU);
        for _ in 0..20_000 {
            omega = relay.step(omega, STEP);
        }
        relay.obey(0.0);
        let (mut turned, mut time) = (0.0, 0.0);
        while omega > 0.0 {
            let before = omega;
            omega = relay.step(omega, STEP);
            turned += f64::midpoint(before, omega) / TAU * STEP;
            time += STEP;
        }
        (turned, time)
    }

    #[test]
    fn a_stop_takes_the_delay_and_the_ramp_and_coasts_by_delay_and_half_the_ramp() {
        let (turned, time) = stop(&mut Relay::new(exact(), Rng::new(1)));
        assert!((time - 0.10).abs() < 2.0 * STEP, "{time} s");
        assert!((turned - 50.0 * (0.02 + 0.04)).abs() < 2.0 * 50.0 * STEP, "{turned} rev");
    }

    #[test]
    fn an_order_that_arrives_over_a_millisecond_is_one_order() {
        let mut relay = Relay::new(exact(), Rng::new(1));
        let mut omega = 0.0;
        for k in 1..=4000 {
            relay.obey(50.0 * TAU * f64::from(k.min(40)) / 40.0);
            omega = relay.step(omega, STEP);
        }
        assert!((omega - 50.0 * TAU * (0.1 - 0.02) / 0.08).abs() < 1.0, "{omega}");
    }

    #[test]
    fn coasts_scatter_as_their_causes_do() {
        let drive = PlainDrive {
            delay_scatter: Time::s(5e-3),
            ramp_scatter: 0.1,
            speed_scatter: 0.01,
            ..exact()
        };
        let mut relay = Relay::new(drive, Rng::new(3));
        let coasts: Vec<f64> = (0..400).map(|_| stop(&mut relay).0).collect();
        let n = coasts.len() as f64;
        let mean = coasts.iter().sum::<f64>() / n;
        let sigma = (coasts.iter().map(|c| (c - mean).powi(2)).sum::<f64>() / n).sqrt();
        // n·√(σd² + (σa·t/2)²) = 50·√(5² + 4²) ms = 0.32 rev, and 1 % of speed: 0.05 rev or less
        assert!((sigma - 0.32).abs() < 0.04, "{sigma} rev");
    }
}
