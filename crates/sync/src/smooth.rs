//! The master's angle for a follower that must not shake: from a coarse encoder, with a bound on
//! the acceleration.
//!
//! ```text
//!   ordered u ──────────────────────┐
//!              ┌─────────────────┐  ▼  ┌──────┐
//!   θ ──►(−)──►│ M(x) / (x·Q(x)) │─►(+)─►│ 1/s² │──┬─► θ̂, ω̂, û
//!         ▲    └─────────────────┘     └──────┘  │
//!         └──────────────────────────────────────┘
//! ```
//!
//! An α-β-γ filter ([`crate::Tracker`]) hands a share α of each count on to the angle in the period
//! in which it is read, and two periods' difference of that is an acceleration of α·q/h²: hundreds
//! of rev/s² at a period of 1 ms. Here a count reaches the acceleration first, through a filter,
//! and the angle by integration.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | q, h | one count, period | rev, s |
//! | x | z − 1, the difference to the next period | — |
//! | w, g | poles at −w: at z = 1 − g, g = 1 − e^(−w·h) | 1/s, — |
//! | R | acceleration that counts may cost | rev/s² |
//!
//! Closed loop: D = x³·Q + (1 + x/2)·M = (x + g)⁵, five equal poles. With 1 − θ̂/θ = x³·Q/D it has
//! no lag at a constant speed nor at a constant acceleration, also through a reversal. Comparing
//! coefficients:
//!
//! ```text
//!   M = m₂x² + m₁x + m₀      m₀ = g⁵     m₁ = 5g⁴ − m₀/2     m₂ = 10g³ − m₁/2
//!   Q = x² + q₁x + q₀        q₁ = 5g     q₀ = 10g² − m₂/2
//! ```
//!
//! Counts are at most q/2 off their mean, so that they cost no more than q/2 times the sum of the
//! absolute values of the impulse response to the acceleration, which is below 6·w² for w·h ≤ 0.3
//! (4.9·w² for w·h → 0). From R = 3·q·w² follows w. To the angle that sum is 2.4 to 2.9: where the
//! counts beat with the period as badly as can be, the angle is off by 1.5·q, else by less than
//! half a count.
//!
//! What it costs: an acceleration Δ that nothing announced is learnt within about 5/w, and until
//! then the angle is off by 2.0 to 2.6 times Δ/w²; an unannounced jump of speed Δω by about Δω/w.
//! With w from R that is up to 8·q·Δ/R: both below a count and quiet (R ≪ Δ) is only what is
//! announced by u.
use crate::Rotation;
use units::{Angle, Spin, SpinAccel, Time};

/// Bound of the impulse response's sum over w².
const RESPONSE: f64 = 6.0;
/// Largest w·h for which it holds.
const FASTEST: f64 = 0.3;

/// A master stands where readings are no farther off than so many counts, and the speed is below
/// one count in 1/w, for so many 1/w: what it does then is learnt.
const OFF: f64 = 1.5;
const LEARNT: f64 = 5.0;

/// Estimates how a master turns, with a bound on what the encoder's counts do to the acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothObserver {
    period_s: f64,
    /// Of a master that stands: how far off its readings may be, rev, and how fast it may seem,
    /// rev/s.
    standing: (f64, f64),
    /// For how long it has stood, and must stand, s.
    stood_s: f64,
    learning_s: f64,
    /// m₀, m₁, m₂.
    upper: [f64; 3],
    /// q₀, q₁.
    lower: [f64; 2],
    /// What 1/(x·Q) makes of the residuals, its first and second difference.
    filter: [f64; 3],
    angle: f64,
    spin: f64,
    learnt: f64,
    ordered: f64,
}

impl SmoothObserver {
    /// An observer of a master at rest at `angle`, whose encoder has counts of `count`, called once
    /// a period. They cost no more acceleration than `most`.
    pub fn new(period: Time, count: Angle, most: SpinAccel, angle: Angle) -> Self {
        let h = period.value();
        let w = libm::sqrt(2.0 * most.value() / (RESPONSE * count.value())).min(FASTEST / h);
        let g = 1.0 - libm::exp(-w * h);
        let m0 = g * g * g * g * g;
        let m1 = 5.0 * g * g * g * g - m0 / 2.0;
        let m2 = 10.0 * g * g * g - m1 / 2.0;
        Self {
            period_s: h,
            standing: (OFF * count.value(), w * count.value()),
            stood_s: 0.0,
            learning_s: LEARNT / w,
            upper: [m0, m1, m2],
            lower: [10.0 * g * g - m2 / 2.0, 5.0 * g],
            filter: [0.0; 3],
            angle: angle.value(),
            spin: 0.0,
            learnt: 0.0,
            ordered: 0.0,
        }
    }

    /// Take one reading, and the acceleration ordered for the period now beginning.
    pub fn update(&mut self, measured: Angle, ordered: SpinAccel) {
        let (h, accel) = (self.period_s, self.ordered + self.learnt);
        self.angle += h * (self.spin + h * accel / 2.0);
        self.spin += h * accel;
        let [p0, p1, p2] = self.filter;
        self.learnt = (self.upper[0] * p0 + self.upper[1] * p1 + self.upper[2] * p2) / (h * h);
        let residual = measured.value() - self.angle;
        let (near, slow) = self.standing;
        // what is ordered still, or not yet, is learnt to be so too
        let stands = residual.abs() <= near && self.spin.abs() <= slow && ordered.value() == 0.0;
        self.stood_s = if stands { self.stood_s + h } else { 0.0 };
        let p3 = residual - self.lower[1] * p2 - self.lower[0] * p1;
        self.filter = [p0 + p1, p1 + p2, p2 + p3];
        self.ordered = ordered.value();
    }

    /// Whether the master stands, and has stood for as long as learning takes: it is known where.
    pub fn stands(&self) -> bool {
        self.stood_s >= self.learning_s
    }

    /// How the master turns at the moment of the last reading; [`Rotation::after`] predicts from
    /// there.
    pub fn now(&self) -> Rotation {
        Rotation {
            angle: Angle::rev(self.angle),
            spin: Spin::rev_per_s(self.spin),
            accel: SpinAccel::rev_per_s2(self.ordered + self.learnt),
        }
    }
}

#[cfg(test)]
#[path = "smooth_tests.rs"]
mod tests;
