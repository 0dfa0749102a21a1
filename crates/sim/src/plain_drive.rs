//! A spindle drive that is only told a speed: a relay passes the order on, and the drive ramps by
//! itself.
//!
//! ```text
//!   order  ──┐          ┌────────
//!            └──────────┘                    each change of the order draws anew:
//!   speed  ──────╲                             delay  d·(…)  +  σd·N        relay and drive's scan
//!                │ ╲                           ramp   a/(1 + σa·N)          stopping time
//!          delay │  ╲____                      speed  ω·(1 + σω·N)          slip, tension of a belt
//! ```
//!
//! N is drawn from the normal distribution. The speed is what the drive makes it: it has torque
//! enough, and the torque it gives follows from inertia, friction and load. So are spindles without
//! synchronisation, with contactors and a frequency converter or a pole-changing motor; a machine
//! is given one by [`crate::SimulatedMachine::with_plain_drive`].
use crate::rng::Rng;
use core::f64::consts::TAU;
use units::{Orientation, Spin, SpinAccel, Time, TurnDirection};

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
    /// It brings the spindle to an angle by itself, so fast and with such ramps; `None`: it cannot.
    pub orients: Option<(Spin, SpinAccel)>,
}

/// An order that changes within this time of its last change is one and the same, on its way, s.
const ONE_ORDER_S: f64 = 5e-3;
/// It says that the spindle is oriented when it stands within so much of the angle, rev.
const ORIENTED: f64 = 0.05 / 360.0;
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
    /// The angle within a turn that it brings the spindle to; the place where that is, counted on
    /// through whole turns, rev; since when it is told that, s; it stands there.
    orients_to: Option<Orientation>,
    turns_to: Option<f64>,
    told_s: f64,
    is_there: bool,
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
            orients_to: None,
            turns_to: None,
            told_s: 0.0,
            is_there: false,
        }
    }

    /// It shall orient the spindle, or no longer.
    pub(crate) fn orient(&mut self, to: Option<Orientation>) {
        let to = to.filter(|to| to.angle.is_finite() && self.model.orients.is_some());
        if to != self.orients_to {
            (self.orients_to, self.told_s, self.is_there) = (to, 0.0, false);
            self.turns_to = None;
        }
    }

    /// The spindle stands at the angle.
    pub(crate) const fn is_oriented(&self) -> bool {
        self.is_there
    }

    /// Speed after a step of `h` seconds on the way to the angle, from `at`, rev.
    fn step_to_angle(&mut self, omega: f64, at: f64, to: Orientation, h: f64) -> f64 {
        let (spin, accel) = self.model.orients.unwrap_or((Spin::ZERO, SpinAccel::ZERO));
        let (most, accel) = (spin.in_rad_per_s(), accel.value() * TAU);
        let to = *self.turns_to.get_or_insert_with(|| {
            let on = (to.angle.value() - at).rem_euclid(1.0);
            at + match to.direction {
                TurnDirection::Backward => on - 1.0,
                TurnDirection::Shortest if on > 0.5 => on - 1.0,
                TurnDirection::Shortest | TurnDirection::Forward => on,
            }
        });
        let left = (to - at) * TAU;
        self.is_there = left.abs() < ORIENTED * TAU && omega.abs() < accel * h;
        // as fast as it can still brake from, and no further than there
        let fast = (2.0 * accel * left.abs()).sqrt().min(most).min(left.abs() / h);
        omega + (fast.copysign(left) - omega).clamp(-accel * h, accel * h)
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

    /// Speed after a step of `h` seconds; the spindle stands at `at`, rev.
    pub(crate) fn step(&mut self, omega: f64, at: f64, h: f64) -> f64 {
        self.unchanged_s += h;
        self.since_s += h;
        self.told_s += h;
        if let Some(to) = self.orients_to.filter(|_| self.told_s > self.model.delay.value()) {
            return self.step_to_angle(omega, at, to, h);
        }
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
    use TurnDirection::{Backward, Forward, Shortest};
    use units::Angle;

    const STEP: f64 = 25e-6;

    fn exact() -> PlainDrive {
        PlainDrive {
            delay: Time::s(0.02),
            delay_scatter: Time::ZERO,
            accel: SpinAccel::rev_per_s2(50.0 / 0.08),
            decel: SpinAccel::rev_per_s2(50.0 / 0.08),
            ramp_scatter: 0.0,
            speed_scatter: 0.0,
            orients: None,
        }
    }

    /// Revolutions and time from an order to stop, out of full speed, until it stands.
    fn stop(relay: &mut Relay) -> (f64, f64) {
        let mut omega = 0.0;
        relay.obey(50.0 * TAU);
        for _ in 0..20_000 {
            omega = relay.step(omega, 0.0, STEP);
        }
        relay.obey(0.0);
        let (mut turned, mut time) = (0.0, 0.0);
        while omega > 0.0 {
            let before = omega;
            omega = relay.step(omega, 0.0, STEP);
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
            omega = relay.step(omega, 0.0, STEP);
        }
        assert!((omega - 50.0 * TAU * (0.1 - 0.02) / 0.08).abs() < 1.0, "{omega}");
    }

    #[test]
    fn it_orients_as_it_is_told_and_says_so_when_it_stands_there() {
        let orients = Some((Spin::rpm(100.0), SpinAccel::rev_per_s2(10.0)));
        for (from, to, direction, way) in [
            (0.1, 0.3, Shortest, 0.2),
            (0.1, 0.9, Shortest, -0.2),
            (7.75, 0.25, Shortest, 0.5),
            (3.0, 0.0, Shortest, 0.0),
            (0.1, 0.3, Forward, 0.2),
            (0.1, 0.3, Backward, -0.8),
            (5.1, 0.9, Forward, 0.8),
        ] {
            let mut relay = Relay::new(PlainDrive { orients, ..exact() }, Rng::new(1));
            let (mut omega, mut at, mut time) = (0.0, from, 0.0);
            relay.orient(Some(Orientation { angle: Angle::rev(to), direction }));
            while !relay.is_oriented() && time < 3.0 {
                let before: f64 = omega;
                omega = relay.step(omega, at, STEP);
                at += f64::midpoint(before, omega) / TAU * STEP;
                time += STEP;
            }
            let turned: f64 = at - from;
            assert!((turned - way).abs() < 1e-3, "{from} to {to}: {turned} rev");
            // up and down at 10 rev/s², at most 100 rev/min: it comes to that within 0.14 rev
            let (way, most) = (f64::abs(way), 100.0 / 60.0);
            let ramps = most * most / 10.0;
            let least =
                if way < ramps { 2.0 * (way / 10.0).sqrt() } else { way / most + most / 10.0 };
            assert!(time >= least * 0.9 && time < least + 0.2, "{from} to {to}: {time} s");
            relay.orient(None);
            assert!(!relay.is_oriented());
        }
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
