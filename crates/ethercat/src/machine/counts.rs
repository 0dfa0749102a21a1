//! Counts of a drive, and what they are of an axis or a spindle.
//!
//! ```text
//!   turns of the load = counts · load / (counts per turn · motor)        gear = motor/load, exact
//!   position          = ± turns · (mm, ° or revolutions per turn)
//! ```
//!
//! A drive counts in 32 bits and goes on at the other end; here counts go on in 64.

/// What a count is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountScale {
    /// Counts per turn of the motor.
    pub counts_per_rev: u32,
    /// Turns of the motor per turn of the load, as a fraction.
    pub gear: (u32, u32),
    /// Positive counts are the negative direction.
    pub is_reversed: bool,
    /// What the load goes in a turn: mm, ° or revolutions.
    pub per_rev: f64,
}

impl CountScale {
    const fn sign(&self) -> f64 {
        if self.is_reversed { -1.0 } else { 1.0 }
    }

    /// Place of a count, exact up to the last bit of the whole turns.
    pub fn value(&self, counts: i64) -> f64 {
        let (motor, load) = (i128::from(self.gear.0), i128::from(self.gear.1));
        let turn = i128::from(self.counts_per_rev) * motor;
        let steps = i128::from(counts) * load;
        let (whole, rest) = (steps.div_euclid(turn), steps.rem_euclid(turn));
        self.sign() * self.per_rev * (whole as f64 + rest as f64 / turn as f64)
    }

    /// The count nearest to a place; `None` for one that no 64 bits hold.
    pub fn counts(&self, value: f64) -> Option<i64> {
        let counts = (self.counts_per_unit() * value).round();
        (counts.abs() < 9e15).then_some(counts as i64)
    }

    /// Counts per mm, ° or revolution.
    pub fn counts_per_unit(&self) -> f64 {
        let motor_turns = f64::from(self.gear.0) / f64::from(self.gear.1);
        self.sign() * motor_turns * f64::from(self.counts_per_rev) / self.per_rev
    }

    /// What the load gets of a torque of the motor, N·m: N along an axis, N·m of a spindle
    /// (`is_spindle`). The work of a turn is the same on both sides.
    pub fn effort(&self, torque_n_m: f64, is_spindle: bool) -> f64 {
        let motor_turns_per_unit = self.counts_per_unit() / f64::from(self.counts_per_rev);
        // the unit of an axis is a thousandth of a metre, that of a spindle a turn
        let per_unit = if is_spindle { 1.0 } else { std::f64::consts::TAU * 1e3 };
        torque_n_m * motor_turns_per_unit * per_unit
    }

    /// Speed of the motor, rev/min, at a speed of the load per second.
    pub fn motor_rpm(&self, speed: f64) -> f64 {
        self.counts_per_unit() * speed * 60.0 / f64::from(self.counts_per_rev)
    }
}

/// A counter of 32 bits that is followed over its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unwrapped {
    counts: Option<i64>,
}

impl Unwrapped {
    pub(crate) const fn new() -> Self {
        Self { counts: None }
    }

    /// Takes a reading; the first one is as it stands.
    pub(crate) fn take(&mut self, reading: i32) -> i64 {
        let counts = self.counts.map_or(i64::from(reading), |before| {
            before + i64::from(reading.wrapping_sub(before as i32))
        });
        self.counts = Some(counts);
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREW: CountScale =
        CountScale { counts_per_rev: 131_072, gear: (3, 2), is_reversed: true, per_rev: 10.0 };

    #[test]
    fn a_torque_of_the_motor_does_the_same_work_at_the_load() {
        // 2 N·m · 3/2 · 2π / 10 mm, against the count
        let force = 3.0 * std::f64::consts::TAU / 0.010;
        assert!((SCREW.effort(2.0, false) + force).abs() < 1e-9);
        let belt = CountScale { is_reversed: false, per_rev: 1.0, ..SCREW };
        assert!((belt.effort(2.0, true) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn places_and_counts_belong_together_whatever_gear_and_direction() {
        // three turns of the motor are two of the screw
        assert_eq!(SCREW.value(3 * 131_072), -20.0);
        assert_eq!(SCREW.counts(-20.0), Some(3 * 131_072));
        for counts in [-5_000_000_007, -1, 0, 1, 77, 8_000_000_000] {
            assert_eq!(SCREW.counts(SCREW.value(counts)), Some(counts));
        }
        assert!((SCREW.motor_rpm(10.0) + 90.0).abs() < 1e-9);
    }

    #[test]
    fn a_spindle_keeps_a_count_after_a_year_of_turns() {
        let spindle = CountScale {
            counts_per_rev: 8_388_608,
            gear: (1, 1),
            is_reversed: false,
            per_rev: 1.0,
        };
        let year = 8_388_608_i64 * 10_000 * 60 * 24;
        assert!((spindle.value(year + 1) - spindle.value(year) - 1.0 / 8_388_608.0).abs() < 1e-8);
    }

    #[test]
    fn what_is_no_number_or_too_far_has_no_count() {
        for value in [f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(SCREW.counts(value), None);
        }
    }

    #[test]
    fn a_counter_is_followed_over_its_ends() {
        let mut counter = Unwrapped::new();
        for (reading, counts) in [
            (i32::MAX - 1, i64::from(i32::MAX) - 1),
            (i32::MIN + 3, i64::from(i32::MAX) + 4),
            (i32::MAX, i64::from(i32::MAX)),
        ] {
            assert_eq!(counter.take(reading), counts);
        }
    }
}
