//! The motor of an emulated drive: an inertia that its loops hold where the drive wants it, as fast
//! as the largest speed allows.
use units::{Angle, Inertia, Spin, SpinAccel, Time, Torque};

/// What a drive wants of a motor that something else moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum MotorOrder {
    /// No torque.
    #[default]
    Free,
    /// To be at an angle at the end of the period.
    Angle(Angle),
    /// To turn at a speed.
    Spin(Spin),
    /// To give a torque.
    Torque(Torque),
}

/// A motor and its encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct Motor {
    /// Counts of the encoder per turn.
    pub counts_per_rev: u32,
    /// Largest speed.
    pub most_spin: Spin,
    /// Rated torque, 6076.
    pub rated_torque: Torque,
    /// Inertia of rotor and load.
    pub inertia: Inertia,
    /// Angle from where it was at power on.
    pub angle: Angle,
    /// Speed.
    pub spin: Spin,
    /// Torque that it had to have in the last period.
    pub torque: Torque,
    /// What the drive wants of a motor that is moved from outside: its angle, speed and torque are
    /// written there. `None`: it is an inertia that ideal loops hold.
    pub outside: Option<MotorOrder>,
}

impl Motor {
    /// Makes a motor of 400 W at rest: 131,072 counts a turn, 3,000 rpm, 1.27 N·m.
    pub fn new() -> Self {
        Self {
            counts_per_rev: 131_072,
            most_spin: Spin::rpm(3_000.0),
            rated_torque: Torque::n_m(1.27),
            inertia: Inertia::kg_m2(2e-4),
            angle: Angle::ZERO,
            spin: Spin::ZERO,
            torque: Torque::ZERO,
            outside: None,
        }
    }

    /// Hands an order to what moves the motor from outside; false if nothing does.
    fn hand(&mut self, order: MotorOrder) -> bool {
        if let Some(outside) = &mut self.outside {
            *outside = order;
        }
        self.outside.is_some()
    }

    /// Counts from where it was at power on.
    pub fn counts(&self) -> i64 {
        (self.angle.value() * f64::from(self.counts_per_rev)).round() as i64
    }

    pub(crate) fn angle_of(&self, counts: i64) -> Angle {
        Angle::rev(counts as f64 / f64::from(self.counts_per_rev))
    }

    pub(crate) fn spin_of(&self, counts_per_s: i64) -> Spin {
        Spin::rev_per_s(counts_per_s as f64 / f64::from(self.counts_per_rev))
    }

    /// Goes towards an angle for a period, as fast as it can.
    pub(crate) fn follow(&mut self, to: Angle, period: Time) {
        if self.hand(MotorOrder::Angle(to)) {
            return;
        }
        let most = (self.most_spin * period).value();
        let step = Angle::rev((to - self.angle).value().clamp(-most, most));
        let spin = step / period;
        self.accelerated(spin, period);
        // without the rounding of a sum, where it gets there
        self.angle = if step.abs().value() < most { to } else { self.angle + step };
        self.spin = spin;
    }

    /// Turns at a speed for a period.
    pub(crate) fn run(&mut self, spin: Spin, period: Time) {
        if self.hand(MotorOrder::Spin(spin)) {
            return;
        }
        let most = self.most_spin.value();
        let spin = Spin::rev_per_s(spin.value().clamp(-most, most));
        self.accelerated(spin, period);
        self.angle += spin * period;
        self.spin = spin;
    }

    /// Gives a torque for a period: ω̇ = M/(2π·J).
    pub(crate) fn push(&mut self, torque: Torque, period: Time) {
        if self.hand(MotorOrder::Torque(torque)) {
            return;
        }
        let accel = torque.value() / (std::f64::consts::TAU * self.inertia.value());
        let spin = self.spin + SpinAccel::rev_per_s2(accel) * period;
        self.run(spin, period);
        self.torque = torque;
    }

    /// Runs down without torque, within a second from full speed, by friction.
    pub(crate) fn coast(&mut self, period: Time) {
        if self.hand(MotorOrder::Free) {
            return;
        }
        let friction = SpinAccel::rev_per_s2(self.most_spin.value());
        let less = (friction * period).value().min(self.spin.abs().value());
        let spin = Spin::rev_per_s(self.spin.value() - less.copysign(self.spin.value()));
        self.run(spin, period);
        self.torque = Torque::ZERO;
    }

    fn accelerated(&mut self, to: Spin, period: Time) {
        let accel = (to - self.spin) / period;
        self.torque = Torque::n_m(accel.value() * std::f64::consts::TAU * self.inertia.value());
    }
}

impl Default for Motor {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rated_torque_accelerates_by_m_over_two_pi_j() {
        let mut motor = Motor::new();
        for _ in 0..10 {
            motor.push(Torque::n_m(0.5), Time::s(1e-3));
        }
        let expected = 0.5 / (std::f64::consts::TAU * 2e-4) * 0.01;
        assert!((motor.spin.value() - expected).abs() < 1e-9, "{}", motor.spin);
    }

    #[test]
    fn a_target_too_far_away_is_approached_at_the_largest_speed() {
        let mut motor = Motor::new();
        motor.follow(Angle::rev(100.0), Time::s(1e-3));
        assert!((motor.angle.value() - 0.05).abs() < 1e-12, "{}", motor.angle);
        motor.follow(Angle::rev(0.06), Time::s(1e-3));
        assert_eq!(motor.angle, Angle::rev(0.06));
    }
}
