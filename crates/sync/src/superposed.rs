//! What is superposed: a function of a master's turn on top of whatever else moves a follower.
//!
//! ```text
//!   x = base + (1 − w)·g₀(θ) + w·g₁(θ)        w: 0 ──╱── 1 over the fade
//! ```
//!
//! g₀ is what was in force, g₁ what shall be; either may be nothing, so the same formula begins,
//! exchanges and ends a superposition. w is the quintic of [`crate::Blend`], so that speed and
//! acceleration do not jump.
//!
//! At speed, with ω, α the master's rates: ẋ = g′ω, ẍ = g″ω² + g′α, x⃛ = g‴ω³ + 3g″ωα, and the
//! product rule for w.
use crate::{Blend, Periodic, Rotation};

/// A value and its rates: mm and s on an axis, rev and s on a spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Swing {
    /// Value.
    pub value: f64,
    /// Its rate.
    pub rate: f64,
    /// The rate of that.
    pub accel: f64,
    /// The rate of that.
    pub jerk: f64,
}

impl Swing {
    /// A table's value under a master's motion.
    pub fn of(table: &Periodic, master: Rotation) -> Self {
        let at = table.at(master.angle.value());
        let (w, a) = (master.spin.value(), master.accel.value());
        Self {
            value: at.value,
            rate: at.slope * w,
            accel: at.bend * w * w + at.slope * a,
            jerk: at.jolt * w * w * w + 3.0 * at.bend * w * a,
        }
    }

    /// Faded from one to another: the product rule.
    #[must_use]
    pub fn faded(from: Self, to: Self, fade: Self) -> Self {
        let d = Self {
            value: to.value - from.value,
            rate: to.rate - from.rate,
            accel: to.accel - from.accel,
            jerk: to.jerk - from.jerk,
        };
        let w = fade;
        Self {
            value: from.value + w.value * d.value,
            rate: from.rate + w.rate * d.value + w.value * d.rate,
            accel: from.accel + w.accel * d.value + 2.0 * w.rate * d.rate + w.value * d.accel,
            jerk: from.jerk
                + w.jerk * d.value
                + 3.0 * (w.accel * d.rate + w.rate * d.accel)
                + w.value * d.jerk,
        }
    }
}

/// The weight of what shall be, since the fade began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fade {
    blend: Blend,
    since_s: f64,
}

impl Fade {
    /// A fade of this duration, s.
    pub fn lasting(duration_s: f64) -> Self {
        // 15/8 is the quintic's peak speed over its mean
        let speed = 1.875 / duration_s.max(f64::MIN_POSITIVE);
        Self { blend: Blend::new(0.0, 1.0, speed, f64::INFINITY), since_s: 0.0 }
    }

    /// It is over.
    pub fn is_over(&self) -> bool {
        self.since_s >= self.blend.duration_s()
    }

    /// A period later.
    pub fn advance(&mut self, period_s: f64) {
        self.since_s += period_s;
    }

    /// The weight, and its rates; a moment later than now if so asked.
    pub fn weight(&self, later_s: f64) -> Swing {
        let at = self.blend.at(self.since_s + later_s);
        Swing { value: at.s, rate: at.v, accel: at.a, jerk: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;
    use units::{Angle, Spin, SpinAccel};

    fn wave(per_turn: u32) -> Periodic {
        let at = |k| (core::f64::consts::TAU * f64::from(per_turn) * f64::from(k) / 720.0).cos();
        Periodic::new(&(0..720).map(at).collect::<Vec<_>>()).expect("a cosine is a table")
    }

    fn turning(time: f64, spin: f64, accel: f64) -> Rotation {
        Rotation {
            angle: Angle::rev(spin * time + accel * time * time / 2.0),
            spin: Spin::rev_per_s(spin + accel * time),
            accel: SpinAccel::rev_per_s2(accel),
        }
    }

    proptest! {
        #[test]
        fn rates_are_derivatives_also_while_the_master_speeds_up_and_the_fade_goes_on(
            spin in -20.0..20.0f64, accel in -50.0..50.0f64, time in 0.01..0.29f64,
        ) {
            let (from, to) = (wave(4), wave(6));
            let fade = Fade::lasting(0.3);
            let at = |t: f64| {
                let master = turning(t, spin, accel);
                Swing::faded(Swing::of(&from, master), Swing::of(&to, master), fade.weight(t))
            };
            let h = 1e-5;
            let (before, now, after) = (at(time - h), at(time), at(time + h));
            let near = |difference: f64, derivative: f64, scale: f64| (difference / (2.0 * h) - derivative).abs() < 1e-4 * scale;
            prop_assert!(near(after.value - before.value, now.rate, 1e3));
            prop_assert!(near(after.rate - before.rate, now.accel, 1e6));
        }
    }

    #[test]
    fn a_fade_from_nothing_begins_and_ends_smoothly() {
        let fade = Fade::lasting(0.5);
        let (begin, end) = (fade.weight(0.0), fade.weight(0.5));
        assert_eq!((begin.value, begin.rate, begin.accel), (0.0, 0.0, 0.0));
        assert_eq!((end.value, end.rate, end.accel), (1.0, 0.0, 0.0));
    }
}
