//! The master's observer: angle, speed and acceleration from a quantised encoder, and their
//! prediction.
//!
//! ```text
//!   ordered acceleration u ──►┌───────────────┐
//!                             │ θ̂, ω̂, d̂ model │──► after T: θ̂ + ω̂T + ½(u+d̂)T²
//!   encoder q·floor(θ/q) ───►└───────────────┘
//!                  r = measured − predicted corrects all three
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | θ, ω | angle, speed | rev, rev/s |
//! | u | acceleration the drive is ordered | rev/s² |
//! | d | acceleration that was not ordered: cutting torque, friction, a saturated drive | rev/s² |
//! | h | period | s |
//! | ξ | e^(−2π·f·h), triple pole at the bandwidth f | — |
//!
//! Steady-state gains of an α-β-γ filter with a triple real pole (Morrison's fading-memory filter
//! of second degree): α = 1−ξ³, β = 3/2(1−ξ)²(1+ξ), γ = (1−ξ)³. With u known, a planned ramp leaves
//! no residual; the bandwidth only decides how fast d is learnt against how much quantisation
//! passes.
use units::{Angle, Spin, SpinAccel, Time};

use crate::Rotation;

/// The filter itself, for whatever is measured: mm or rev, and their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracker {
    period_s: f64,
    gains: [f64; 3],
    place: f64,
    rate: f64,
    ordered: f64,
    disturbance: f64,
}

impl Tracker {
    /// A tracker of something at rest at `place`, called once a period, that learns disturbances
    /// with a bandwidth well below half the sampling rate.
    pub fn new(period_s: f64, bandwidth_hz: f64, place: f64) -> Self {
        let xi = libm::exp(-core::f64::consts::TAU * bandwidth_hz * period_s);
        let alpha = 1.0 - xi * xi * xi;
        let beta = 1.5 * (1.0 - xi) * (1.0 - xi) * (1.0 + xi);
        let gamma = (1.0 - xi) * (1.0 - xi) * (1.0 - xi);
        Self {
            period_s,
            gains: [alpha, beta / period_s, gamma / (period_s * period_s)],
            place,
            rate: 0.0,
            ordered: 0.0,
            disturbance: 0.0,
        }
    }

    /// The same of something at zero that moves at a rate.
    pub fn moving(period_s: f64, bandwidth_hz: f64, rate: f64) -> Self {
        Self { rate, ..Self::new(period_s, bandwidth_hz, 0.0) }
    }

    /// The largest bandwidth, Hz, at which an encoder of a given count leaves no more noise on the
    /// rate than is allowed (standard deviations). Quantisation is count/√12; of a variance σ² the
    /// filter leaves σ²·(1−ξ)³·(49+50ξ+13ξ²)/(2h²·(1+ξ)⁵), which is 7/4·σ²(1−ξ)³/h² for ξ near 1.
    pub fn bandwidth_for(period_s: f64, count: f64, rate_noise: f64) -> f64 {
        let sigma = count / libm::sqrt(12.0);
        let gap = libm::cbrt(4.0 / 7.0 * libm::pow(rate_noise * period_s / sigma, 2.0));
        let xi = (1.0 - gap).max(f64::MIN_POSITIVE);
        -libm::log(xi) / (core::f64::consts::TAU * period_s)
    }

    /// Take one reading.
    pub fn read(&mut self, measured: f64) {
        let h = self.period_s;
        let accel = self.acceleration();
        let place = self.place + h * (self.rate + h * accel / 2.0);
        let residual = measured - place;
        self.place = place + self.gains[0] * residual;
        self.rate += h * accel + self.gains[1] * residual;
        self.disturbance += self.gains[2] * residual;
    }

    /// How much a count at most adds to the acceleration of the place, by its second difference:
    /// α·count/h², and as much again where the next count takes it back.
    pub fn count_accel(&self, count: f64) -> f64 {
        2.0 * self.gains[0] * count / (self.period_s * self.period_s)
    }

    /// Be told the acceleration that is ordered for the period now beginning.
    pub const fn order(&mut self, accel: f64) {
        self.ordered = accel;
    }

    /// Where it is.
    pub const fn place(&self) -> f64 {
        self.place
    }

    /// How fast it moves.
    pub const fn rate(&self) -> f64 {
        self.rate
    }

    /// Its acceleration, ordered or not.
    pub fn acceleration(&self) -> f64 {
        self.ordered + self.disturbance
    }
}

/// Estimates how a master turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer(Tracker);

impl Observer {
    /// An observer of a master at rest at `angle`; see [`Tracker::new`].
    pub fn new(period: Time, bandwidth_hz: f64, angle: Angle) -> Self {
        Self(Tracker::new(period.value(), bandwidth_hz, angle.value()))
    }

    /// Take one reading, and the acceleration ordered for the period now beginning.
    pub fn update(&mut self, measured: Angle, ordered: SpinAccel) {
        self.0.read(measured.value());
        self.0.order(ordered.value());
    }

    /// The acceleration that the counts of its encoder may cost: see [`Tracker::count_accel`].
    pub fn count_accel(&self, count: Angle) -> SpinAccel {
        SpinAccel::rev_per_s2(self.0.count_accel(count.value()))
    }

    /// How the master turns at the moment of the last reading; [`Rotation::after`] predicts from
    /// there.
    pub fn now(&self) -> Rotation {
        Rotation {
            angle: Angle::rev(self.0.place()),
            spin: Spin::rev_per_s(self.0.rate()),
            accel: SpinAccel::rev_per_s2(self.0.acceleration()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: Time = Time::s(250e-6);

    /// Run an observer on θ(t) seen through an encoder; the largest error of angle [rev] and speed
    /// [rev/s], predicted `ahead` periods, after settling.
    fn worst(
        counts: f64,
        ahead: u32,
        theta: impl Fn(f64) -> (f64, f64),
        ordered: f64,
    ) -> (f64, f64) {
        let mut observer = Observer::new(H, 100.0, Angle::ZERO);
        let (mut angle, mut spin) = (0.0f64, 0.0f64);
        for k in 0..4000u32 {
            let measured = (theta(f64::from(k) * H.value()).0 * counts).floor() / counts;
            observer.update(Angle::rev(measured), SpinAccel::rev_per_s2(ordered));
            let predicted = observer.now().after(H * f64::from(ahead));
            let (real, rate) = theta(f64::from(k + ahead) * H.value());
            if k > 400 {
                angle = angle.max((predicted.angle.value() - real).abs());
                spin = spin.max((predicted.spin.value() - rate).abs());
            }
        }
        (angle, spin)
    }

    #[test]
    fn a_constant_speed_is_predicted_to_the_encoders_step() {
        let counts = 1_048_576.0;
        let (angle, spin) = worst(counts, 2, |t| (100.0 * t, 100.0), 0.0);
        assert!(angle < 2.0 / counts, "{angle} rev");
        assert!(spin < 2e-3, "{spin} rev/s");
    }

    #[test]
    fn a_coarse_encoder_is_smoothed_below_its_step() {
        let (angle, _) = worst(4096.0, 2, |t| (37.3 * t, 37.3), 0.0);
        assert!(angle < 1.0 / 4096.0, "{angle} rev");
    }

    #[test]
    fn an_acceleration_nobody_ordered_is_learnt() {
        let ramp = |t: f64| (50.0 * t * t, 100.0 * t);
        let (angle, _) = worst(1_048_576.0, 1, ramp, 0.0);
        assert!(angle < 3e-6, "{angle} rev");
        let (ordered, _) = worst(1_048_576.0, 1, ramp, 100.0);
        assert!(ordered < 3e-6, "{ordered} rev");
    }

    #[test]
    fn the_bandwidth_for_a_coarse_encoder_leaves_the_noise_that_is_allowed() {
        let (h, count, allowed) = (H.value(), 1.0 / 4096.0, 0.02);
        let bandwidth = Tracker::bandwidth_for(h, count, allowed);
        let mut tracker = Tracker::new(h, bandwidth, 0.0);
        let (mut squares, mut counted) = (0.0, 0.0);
        for k in 0..200_000u32 {
            // a speed whose way per period shares no period with the count: quantisation is noise
            let place = f64::from(k) * 0.618_034 * 7.3 * count;
            tracker.read((place / count).floor() * count);
            if k > 4000 {
                let off = tracker.rate() - 0.618_034 * 7.3 * count / h;
                (squares, counted) = (squares + off * off, counted + 1.0);
            }
        }
        let noise = f64::sqrt(squares / counted);
        assert!(noise < 1.2 * allowed, "{noise} rev/s at {bandwidth} Hz");
        assert!((50.0..200.0).contains(&bandwidth), "{bandwidth} Hz");
    }
}
