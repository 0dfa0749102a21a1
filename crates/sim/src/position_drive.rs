//! A drive that closes its own position loop: each period it is told where to be at the end of it.
//!
//! ```text
//!   setpoints  x0 ── x1 ── x2      v = (x1 − x0)/T        a = (v1 − v0)/T
//!
//!   xr(t) ─ x ──► Kp ──► + v ──► − vm ──► m·ω·(1 + ∫/Ti) ──► + m·(a + τ·ȧ) ──► force, |F| ≤ Fmax
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x, vm | position by the encoder, speed of the motor | m or rad, /s |
//! | T, h | period of the setpoints, physics step | s |
//! | Kp, ω | position gain, bandwidth of the speed loop | 1/s, rad/s |
//! | m, τ | all that is moved, lag of the force | kg or kg·m², s |
//! | Ti | integral time of the speed loop, 4/ω | s |
//!
//! The drive interpolates on a straight line between setpoints. Cyclic synchronous position of CiA
//! 402 is such a drive.
use core::f64::consts::TAU;
use units::Time;

/// Integral time of the speed loop, in periods of its bandwidth over 2π.
const INTEGRAL: f64 = 4.0;

/// A drive with its loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionDrive {
    /// Position gain, 1/s.
    pub position_gain_per_s: f64,
    /// Bandwidth of the speed loop, Hz.
    pub velocity_bandwidth_hz: f64,
    /// Setpoints are taken for the place this time on at the commanded speed.
    pub ahead: Time,
}

/// What a loop moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    /// Mass or inertia.
    pub(crate) inertia: f64,
    /// Lag of the force, s.
    pub(crate) lag_s: f64,
    /// Force that holds it at rest.
    pub(crate) hold: f64,
    /// Physics step and period of the setpoints, s.
    pub(crate) step_s: f64,
    pub(crate) period_s: f64,
}

/// A loop at work.
#[derive(Clone, Debug)]
pub(crate) struct PositionLoop {
    drive: PositionDrive,
    moved: Moved,
    is_on: bool,
    from: f64,
    to: f64,
    speed: f64,
    accel: f64,
    /// Change of acceleration from one period to the next.
    jolt: f64,
    since_s: f64,
    integral: f64,
}

impl PositionLoop {
    pub(crate) fn new(drive: PositionDrive, moved: Moved) -> Self {
        Self {
            drive,
            moved,
            is_on: false,
            from: 0.0,
            to: 0.0,
            speed: 0.0,
            accel: 0.0,
            jolt: 0.0,
            since_s: 0.0,
            integral: moved.hold,
        }
    }

    /// Takes the setpoint of the coming period. A drive that is switched on begins from where it
    /// is; a setpoint that is no number changes nothing.
    pub(crate) fn obey(&mut self, is_on: bool, (to, speed): (f64, f64), here: f64) {
        let to = to + speed * self.drive.ahead.value();
        if !is_on || !self.is_on {
            let (drive, moved) = (self.drive, self.moved);
            *self = Self { is_on, from: here, to: here, ..Self::new(drive, moved) };
        }
        if !is_on || !to.is_finite() {
            return;
        }
        let period_s = self.moved.period_s;
        let speed = (to - self.to) / period_s;
        let accel = (speed - self.speed) / period_s;
        self.jolt = accel - self.accel;
        (self.from, self.to, self.speed, self.accel) = (self.to, to, speed, accel);
        self.since_s = 0.0;
    }

    /// Force of a physics step, from the position by the encoder and the speed of the motor.
    pub(crate) fn step(&mut self, position: f64, speed: f64, limit: f64) -> f64 {
        let Moved { inertia, lag_s, step_s, period_s, .. } = self.moved;
        let share = (self.since_s / period_s).min(1.0);
        self.since_s += step_s;
        let target = self.from + (self.to - self.from) * share;
        let wanted = self.speed + self.drive.position_gain_per_s * (target - position);
        let omega = TAU * self.drive.velocity_bandwidth_hz;
        let pull = inertia * omega * (wanted - speed);
        let feed_forward = inertia * (self.accel + lag_s * self.jolt / period_s);
        let force = feed_forward + pull + self.integral;
        if force.abs() < limit || force * pull < 0.0 {
            self.integral += pull * omega / INTEGRAL * step_s;
        }
        force.clamp(-limit, limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 25e-6;
    const PERIOD: f64 = 250e-6;

    /// Largest distance from the setpoint of a mass that is led along a path, after a settling
    /// time; a load sets in after half of the way.
    fn worst(path: impl Fn(f64) -> f64, load: f64) -> f64 {
        let drive = PositionDrive {
            position_gain_per_s: 80.0,
            velocity_bandwidth_hz: 70.0,
            ahead: Time::ZERO,
        };
        let moved =
            Moved { inertia: 1200.0, lag_s: 0.0, hold: 0.0, step_s: STEP, period_s: PERIOD };
        let mut servo = PositionLoop::new(drive, moved);
        let (mut x, mut v, mut worst) = (path(0.0), 0.0, 0.0_f64);
        servo.obey(true, (x, 0.0), x);
        for period in 1..4000 {
            let at = f64::from(period) * PERIOD;
            servo.obey(true, (path(at), 0.0), x);
            for _ in 0..10 {
                let pushed = if period > 2000 { load } else { 0.0 };
                v += (servo.step(x, v, 20e3) - pushed) / 1200.0 * STEP;
                x += v * STEP;
            }
            if period > 400 {
                worst = worst.max((path(at) - x).abs());
            }
        }
        worst
    }

    #[test]
    fn a_path_is_followed_to_a_micrometre_without_load() {
        let sine = |t: f64| 0.02 * (1.0 - (TAU * 1.5 * t).cos());
        assert!(worst(sine, 0.0) < 1e-6, "{} m", worst(sine, 0.0));
    }

    #[test]
    fn a_load_is_borne_after_a_few_micrometres() {
        let away = worst(|t| 0.1 * t, 150.0);
        assert!((1e-6..5e-6).contains(&away), "{away} m");
    }
}
