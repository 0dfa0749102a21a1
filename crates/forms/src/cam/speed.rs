//! How fast a cam can turn: slope, acceleration and jerk of the wheel's path, and a work speed that
//! varies over the turn.
//!
//! ```text
//!   ẋ = X′·n      ẍ = X″·n² + X′·ṅ      x⃛ = X‴·n³ + …            n: turns of C per second
//!
//!   removal rate per width  Q′ = aₑ·(ds/dψ)·n          s: along the contour
//! ```
//!
//! At a constant speed Q′ is many times larger on the flanks than on the base circle: burn there,
//! idling here. A speed n(ψ) ∝ 1/(ds/dψ) makes it constant. What the axes cannot follow is cut off:
//! n ≤ the spindle's highest speed, ẋ and ẍ within X's limits, ṅ within the spindle's. The square
//! of the speed as a function of angle has the acceleration as half its slope, so the last limit is
//! one pass forwards and one backwards over the turn.
use super::path::WheelPath;
use units::{Accel, Angle, Jerk, Length, Speed, Spin, SpinAccel, Time};

/// What the axes may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisBounds {
    /// Fastest X.
    pub speed: Speed,
    /// Its greatest acceleration.
    pub accel: Accel,
    /// Its greatest jerk.
    pub jerk: Jerk,
    /// Fastest C.
    pub spin: Spin,
    /// Its greatest acceleration.
    pub spin_accel: SpinAccel,
}

/// What bounds the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// X's speed.
    Speed,
    /// X's acceleration.
    Acceleration,
    /// X's jerk.
    Jerk,
    /// C's highest speed.
    Spin,
}

impl Bound {
    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed of X",
            Self::Acceleration => "acceleration of X",
            Self::Jerk => "jerk of X",
            Self::Spin => "highest speed of C",
        }
    }
}

/// Greatest derivatives of a path at a constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Travel from least to greatest.
    pub stroke: Length,
    /// Greatest speed.
    pub speed: Speed,
    /// Greatest acceleration.
    pub accel: Accel,
    /// Greatest jerk.
    pub jerk: Jerk,
}

/// A work speed over the turn.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkSpeed {
    /// Speed at equal steps of C, rev/s.
    pub spin: Vec<f64>,
    /// Time of one turn.
    pub turn_time: Time,
    /// Greatest removal rate over its mean: 1 is constant.
    pub peak: f64,
    /// The same at a constant speed.
    pub peak_constant: f64,
}

impl WheelPath {
    /// What X must do at a speed of C.
    pub fn motion(&self, spin: Spin) -> Motion {
        let n = spin.abs().value();
        let [slope, bend, jolt] = self.steepest();
        let fold = |start: f64, f: fn(f64, f64) -> f64| self.centre.iter().copied().fold(start, f);
        Motion {
            stroke: Length::mm(fold(f64::NEG_INFINITY, f64::max) - fold(f64::INFINITY, f64::min)),
            speed: Speed::mm_per_s(slope * n),
            accel: Accel::mm_per_s2(bend * n * n),
            jerk: Jerk::mm_per_s3(jolt * n * n * n),
        }
    }

    /// The highest constant speed of C, and what bounds it.
    pub fn highest_speed(&self, bounds: &AxisBounds) -> (Spin, Bound) {
        let [slope, bend, jolt] = self.steepest();
        let candidates = [
            (bounds.spin.value(), Bound::Spin),
            (bounds.speed.value() / slope, Bound::Speed),
            ((bounds.accel.value() / bend).sqrt(), Bound::Acceleration),
            ((bounds.jerk.value() / jolt).cbrt(), Bound::Jerk),
        ];
        let lowest =
            candidates.into_iter().filter(|c| !c.0.is_nan()).min_by(|a, b| a.0.total_cmp(&b.0));
        lowest.map_or((bounds.spin, Bound::Spin), |(n, bound)| (Spin::rev_per_s(n), bound))
    }

    /// Largest first three derivatives per revolution.
    pub fn steepest(&self) -> [f64; 3] {
        let n = self.centre.len();
        let points = (0..n).map(|k| self.at(Angle::rev(k as f64 / n as f64)));
        points.fold([0.0; 3], |[a, b, c], p| {
            [f64::max(a, p.slope.abs()), f64::max(b, p.bend.abs()), f64::max(c, p.jolt.abs())]
        })
    }

    /// A speed over the turn that removes as evenly as the axes allow, at a mean of `mean`.
    pub(crate) fn even_removal(&self, mean: Spin, bounds: &AxisBounds) -> WorkSpeed {
        // the share of X's acceleration that C's own leaves
        const FOR_BEND: f64 = 0.7;
        let n = self.centre.len();
        let points: Vec<_> = (0..n).map(|k| self.at(Angle::rev(k as f64 / n as f64))).collect();
        let ceiling: Vec<f64> = points
            .iter()
            .map(|p| {
                let by_speed = bounds.speed.value() / p.slope.abs();
                let by_accel = (FOR_BEND * bounds.accel.value() / p.bend.abs()).sqrt();
                let by_jerk = (FOR_BEND * bounds.jerk.value() / p.jolt.abs()).cbrt();
                bounds.spin.value().min(by_speed).min(by_accel).min(by_jerk)
            })
            .collect();
        let slopes: Vec<f64> = points.iter().map(|p| p.slope.abs()).collect();
        let accel = |k: usize| {
            let by_x = (1.0 - FOR_BEND) * bounds.accel.value() / slopes[k];
            bounds.spin_accel.value().min(by_x)
        };
        // the constant that the mean speed asks for is found by halving: the turn's time falls with
        // it
        let (mut low, mut high) = (0.0_f64, f64::MAX.sqrt());
        let mut spin = vec![mean.abs().value(); n];
        for _ in 0..200 {
            let rate =
                if high > 1e12 { (low * 2.0 + 1.0).min(1e12) } else { f64::midpoint(low, high) };
            spin = self.speeds(rate, &ceiling, &accel);
            let time: f64 = spin.iter().map(|s| 1.0 / (s * n as f64)).sum();
            if time > 1.0 / mean.abs().value() {
                low = rate;
            } else {
                high = rate;
            }
            if low >= 1e12 || (high - low) < 1e-9 * high {
                break;
            }
        }
        let removal = |spin: &[f64]| {
            let rates = spin.iter().zip(&self.contact).map(|(s, c)| s * c);
            let (sum, most) = rates.fold((0.0, 0.0), |(a, b), r| (a + r, f64::max(b, r)));
            most * n as f64 / sum
        };
        WorkSpeed {
            turn_time: Time::s(spin.iter().map(|s| 1.0 / (s * n as f64)).sum()),
            peak: removal(&spin),
            peak_constant: removal(&vec![1.0; n]),
            spin,
        }
    }

    /// rate/(ds/dψ), under the ceiling, its square with a bounded slope.
    fn speeds(&self, rate: f64, ceiling: &[f64], accel: &impl Fn(usize) -> f64) -> Vec<f64> {
        let n = ceiling.len();
        let wanted =
            self.contact.iter().zip(ceiling).map(|(c, top)| (rate / c.max(1e-9)).min(*top));
        let mut squares: Vec<f64> = wanted.map(|s| s * s).collect();
        let step = 1.0 / n as f64;
        // twice around, so that the seam has been passed with what comes before it known
        for i in 0..2 * n {
            let (here, next) = (i % n, (i + 1) % n);
            squares[next] = squares[next].min(squares[here] + 2.0 * accel(here) * step);
        }
        for i in (0..2 * n).rev() {
            let (here, before) = ((i + 1) % n, i % n);
            squares[before] = squares[before].min(squares[here] + 2.0 * accel(before) * step);
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::cam::*;
    use units::*;

    const BOUNDS: AxisBounds = AxisBounds {
        speed: Speed::mm_per_s(160.0),
        accel: Accel::mm_per_s2(14_000.0),
        jerk: Jerk::mm_per_s3(800_000.0),
        spin: Spin::rpm(300.0),
        spin_accel: SpinAccel::rev_per_s2(60.0),
    };

    fn automotive() -> WheelPath {
        let form = ClosedForm::Automotive {
            base: Length::mm(34.0),
            lift: Length::mm(9.0),
            half_angle: Angle::deg(65.0),
            follower: Follower::Flat,
        };
        form.cam().unwrap().wheel_path(Length::mm(200.0), 720).unwrap()
    }

    #[test]
    fn an_eccentric_at_60_rpm_has_the_acceleration_of_a_circle() {
        let cam = ClosedForm::Eccentric { radius: Length::mm(25.0), eccentricity: Length::mm(4.0) };
        let path = cam.cam().unwrap().wheel_path(Length::mm(200.0), 720).unwrap();
        let motion = path.motion(Spin::rpm(60.0));
        let w = std::f64::consts::TAU;
        // e·ω² (1 + e/(r + W)) at the top, as of a crank
        assert!((motion.accel.value() - 4.0 * w * w * (1.0 + 4.0 / 225.0)).abs() < 1e-3);
        assert!((motion.stroke.value() - 8.0).abs() < 1e-9);
    }

    #[test]
    fn at_the_highest_speed_one_limit_is_reached_and_none_exceeded() {
        let path = automotive();
        let (spin, bound) = path.highest_speed(&BOUNDS);
        let motion = path.motion(spin);
        let shares =
            [motion.speed / BOUNDS.speed, motion.accel / BOUNDS.accel, motion.jerk / BOUNDS.jerk];
        assert!(shares.iter().all(|s| *s < 1.0 + 1e-9), "{shares:?} {bound:?}");
        assert!(shares.iter().any(|s| *s > 1.0 - 1e-9), "{shares:?} {bound:?}");
    }

    #[test]
    fn a_varying_work_speed_removes_more_evenly_within_the_limits() {
        let path = automotive();
        let even = path.even_removal(Spin::rpm(30.0), &BOUNDS);
        assert!((even.turn_time.value() - 2.0).abs() < 1e-3, "{}", even.turn_time);
        assert!(
            even.peak < 1.1 && even.peak_constant > 1.5,
            "{} {}",
            even.peak,
            even.peak_constant
        );
        let n = even.spin.len();
        for k in 0..n {
            let (a, b) = (even.spin[k], even.spin[(k + 1) % n]);
            let spin_accel = (b * b - a * a) * n as f64 / 2.0;
            let p = path.at(Angle::rev(k as f64 / n as f64));
            let accel = p.bend * a * a + p.slope * spin_accel;
            assert!(spin_accel.abs() <= BOUNDS.spin_accel.value() * (1.0 + 1e-6));
            assert!(accel.abs() <= BOUNDS.accel.value() * 1.01, "{accel} at {k}");
            assert!(p.slope.abs() * a <= BOUNDS.speed.value() * (1.0 + 1e-9));
        }
    }
}
