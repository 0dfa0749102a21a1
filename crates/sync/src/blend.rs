//! A small move from rest to rest: turning a spindle to an angle, stepping an axis onto its
//! coupling.
//!
//! ```text
//!   s(τ) = d·(10τ³ − 15τ⁴ + 6τ⁵),  τ = t/T      peak speed  15/8·d/T
//!   s │      ______                             peak accel. 10/√3·d/T²
//!     │    ╱                                    T = the larger of what the two limits ask
//!     │___╱
//!     └──────────► t
//! ```
//!
//! The quintic is the polynomial of least degree with speed and acceleration zero at both ends
//! (minimum jerk, Flash & Hogan 1985). It serves a spindle (rev) and an axis (mm) alike.

/// The move, in revolutions or millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    from: f64,
    distance: f64,
    duration_s: f64,
}

/// Where it is at one time: place, rate and the rate of that.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlendPoint {
    /// Place.
    pub s: f64,
    /// Rate.
    pub v: f64,
    /// Rate of the rate.
    pub a: f64,
}

impl Blend {
    /// From one place to another within a speed and an acceleration, both positive.
    pub fn new(from: f64, to: f64, speed_limit: f64, accel_limit: f64) -> Self {
        let distance = to - from;
        let by_speed = 1.875 * distance.abs() / speed_limit;
        let by_accel = libm::sqrt(10.0 / libm::sqrt(3.0) * distance.abs() / accel_limit);
        Self { from, distance, duration_s: by_speed.max(by_accel) }
    }

    /// How long it lasts, s.
    pub const fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Where it ends.
    pub fn end(&self) -> f64 {
        self.from + self.distance
    }

    /// State at a time from its start, s; at rest before and after.
    pub fn at(&self, time_s: f64) -> BlendPoint {
        if time_s >= self.duration_s {
            return BlendPoint { s: self.end(), v: 0.0, a: 0.0 };
        }
        let (d, tt) = (self.distance, self.duration_s);
        let x = (time_s / tt).max(0.0);
        let rest = 1.0 - x;
        BlendPoint {
            s: self.from + d * x * x * x * (10.0 + x * (6.0 * x - 15.0)),
            v: d / tt * 30.0 * x * x * rest * rest,
            a: d / (tt * tt) * 60.0 * x * rest * (1.0 - 2.0 * x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn no_distance_takes_no_time() {
        let still = Blend::new(4.0, 4.0, 1.0, 1.0);
        assert_eq!((still.duration_s(), still.at(0.0).s), (0.0, 4.0));
    }

    proptest! {
        #[test]
        fn it_keeps_its_limits_and_uses_one_of_them_fully(
            from in -10.0..10.0f64, distance in -10.0..10.0f64, speed in 0.1..50.0f64, accel in 0.1..500.0f64,
        ) {
            prop_assume!(distance.abs() > 1e-6);
            let blend = Blend::new(from, from + distance, speed, accel);
            let (mut v, mut a) = (0.0f64, 0.0f64);
            for i in 0..=2000 {
                let point = blend.at(blend.duration_s() * f64::from(i) / 2000.0);
                (v, a) = (v.max(point.v.abs()), a.max(point.a.abs()));
            }
            prop_assert!(v <= speed * 1.000_001 && a <= accel * 1.000_001);
            prop_assert!(v > speed * 0.999 || a > accel * 0.999);
            prop_assert!((blend.at(blend.duration_s()).s - from - distance).abs() < 1e-12);
        }
    }
}
