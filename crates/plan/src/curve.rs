//! How fast a spindle may change its speed: the torque and power curve of its drive as a ceiling.
//!
//! ```text
//!   M │‾‾‾‾‾‾‾‾╲          M(ω) = margin · min(M_peak, P/ω)
//!     │         ╲___      accelerating: J·2π·α = M(ω) − c₀ − c₁·ω − M_cut
//!     │             ╲____ braking:      J·2π·α = M(ω) + c₀             (friction helps; c₁·ω and the cut
//!     └────────┴─────────► ω                                            stay in reserve)
//!           base speed P/M_peak
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | n, ω | speed; ω = 2π·n | rev/s, rad/s |
//! | α | rate of n | rev/s² |
//! | J | inertia | kg·m² |
//! | M, P | torque, power of the drive | N·m, W |
//! | c₀, c₁ | friction, and friction per speed | N·m, N·m·s/rad |
//! | h(n) = p/n − k − c·n | α above the base speed | rev/s² |
//!
//! A [`Ceiling`] is a chain of straight lines in the plane of n and α². h is convex, so is h² where
//! h > 0, and a tangent of a convex curve lies below it: the chain is made of tangents, and a plan made
//! with it never asks for more than the curve. Neighbouring tangents touch at speeds 10 % apart, so
//! that they meet about 0.4 % (of α) below the curve. Where the curve falls more steeply than the jerk allows,
//! the chain leaves the level early enough.
//!
//! A forced or level ramp that ignores P/ω saturates the drive, and with it goes the synchronism: that is
//! the commonest way for fast tapping to fail.
use crate::SpindleLimits;
use crate::ramp::{Ceiling, MAX_STRETCHES, Ramp, Stretch};
use crate::{Piece, Profile};
use core::f64::consts::TAU;
use units::{Spin, Torque};

/// Ratio of the speeds at which neighbouring tangents touch the curve, if their number suffices.
const TANGENT_RATIO: f64 = 1.1;
/// Of the allowed jerk, the share that following the curve may use; the fall at the ramp's end must be steeper.
const FOLLOW_SHARE: f64 = 0.9;
/// Of the level acceleration, what must be left at the highest speed: below it a speed is not reached
/// in any useful time.
const RESERVE: f64 = 0.03;

/// α over n: level up to the base speed, p/n − k − c·n above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Curve {
    /// Level, rev/s².
    level: f64,
    /// rev²/s³.
    p: f64,
    /// rev/s².
    k: f64,
    /// 1/s.
    c: f64,
}

impl SpindleLimits {
    /// Speeding up against friction and a cut, to `top` at most.
    pub(crate) fn speeding_up(&self, cut: Torque, top: Spin) -> Curve {
        let per_torque = 1.0 / (TAU * self.inertia.value());
        let load = self.friction.value() + cut.value();
        // friction grows with speed: the level takes it at its upper end
        let at = top.value().min(self.base_speed().value()) * TAU;
        let drag = load + self.viscous_n_m_s_per_rad * at;
        Curve {
            level: (self.margin * self.peak_torque.value() - drag) * per_torque,
            p: self.margin * self.peak_power.value() / TAU * per_torque,
            k: load * per_torque,
            c: self.viscous_n_m_s_per_rad * TAU * per_torque,
        }
    }

    /// Slowing down; friction helps.
    pub(crate) fn slowing_down(&self) -> Curve {
        let per_torque = 1.0 / (TAU * self.inertia.value());
        let help = self.friction.value();
        Curve {
            level: (self.margin * self.peak_torque.value() + help) * per_torque,
            p: self.margin * self.peak_power.value() / TAU * per_torque,
            k: -help * per_torque,
            c: 0.0,
        }
    }

    /// Speed above which power, not torque, is the limit.
    pub fn base_speed(&self) -> Spin {
        Spin::rev_per_s(self.peak_power.value() / (TAU * self.peak_torque.value()))
    }

    /// Largest rate of α, rev/s³; infinite if torque may rise at once.
    pub(crate) fn jerk(&self) -> f64 {
        let level = self.margin * self.peak_torque.value() / (TAU * self.inertia.value());
        if self.torque_rise.value() > 0.0 {
            level / self.torque_rise.value()
        } else {
            f64::INFINITY
        }
    }

    /// Highest speed that is reached in useful time against friction and a cut.
    pub fn reachable(&self, cut: Torque) -> Spin {
        let curve = self.speeding_up(cut, self.max_speed);
        if curve.level <= 0.0 {
            return Spin::ZERO;
        }
        self.max_speed.min(Spin::rev_per_s(curve.speed_where(RESERVE * curve.level)))
    }

    /// From one speed to another (signed; through rest if the sense changes) in the shortest time.
    /// The profile's `v` is the signed speed, its `s` revolutions. Speeds beyond
    /// [`SpindleLimits::reachable`] are taken as that one.
    pub fn ramp(&self, from: Spin, to: Spin) -> Profile {
        let reachable = self.reachable(Torque::ZERO).value();
        let (a, b) =
            (from.value().clamp(-reachable, reachable), to.value().clamp(-reachable, reachable));
        let mut profile = Profile::EMPTY;
        if a * b < 0.0 {
            self.change(&mut profile, a, 0.0);
            self.change(&mut profile, 0.0, b);
        } else {
            self.change(&mut profile, a, b);
        }
        let end = profile.end();
        profile.ending_at(crate::Instant { s: end.s, v: b, a: 0.0 })
    }

    /// Append a change of speed within one sense.
    fn change(&self, profile: &mut Profile, from: f64, to: f64) {
        let (low, high) = (from.abs().min(to.abs()), from.abs().max(to.abs()));
        let sense = if from + to < 0.0 { -1.0 } else { 1.0 };
        let start = profile.end().s;
        let signed = |p: Piece| Piece {
            duration: p.duration,
            s: start + sense * p.s,
            v: sense * p.v,
            a: sense * p.a,
            j: sense * p.j,
        };
        let jerk = self.jerk();
        let mut add = |piece: Piece| {
            // cannot fail: two ramps fit into a profile, see MAX_STRETCHES
            let fits = profile.push(signed(piece));
            debug_assert!(fits);
        };
        if to.abs() > from.abs() {
            let curve = self.speeding_up(Torque::ZERO, Spin::rev_per_s(high));
            let ramp = Ramp::up(&curve.ceiling(f64::INFINITY, jerk, high), jerk, low, high);
            ramp.pieces().iter().copied().for_each(&mut add);
        } else {
            let ceiling = self.slowing_down().ceiling(f64::INFINITY, jerk, high);
            let ramp = Ramp::up(&ceiling, jerk, low, high);
            ramp.mirrored(ramp.length()).for_each(&mut add);
        }
    }
}

impl Curve {
    /// Acceleration below the base speed, rev/s².
    pub(crate) const fn level(&self) -> f64 {
        self.level
    }

    /// Above the base speed: h and its slope dh/dn.
    fn h(&self, n: f64) -> (f64, f64) {
        (self.p / n - self.k - self.c * n, -self.p / (n * n) - self.c)
    }

    /// Where h has fallen to `accel`: c·n² + (k + accel)·n − p = 0; infinite if it never does.
    fn speed_where(&self, accel: f64) -> f64 {
        let b = self.k + accel;
        let denominator = b + libm::sqrt(b * b + 4.0 * self.c * self.p);
        if denominator > 0.0 { 2.0 * self.p / denominator } else { f64::INFINITY }
    }

    /// The chain of lines below the curve and below `accel`, good up to speed `top`.
    pub(crate) fn ceiling(&self, accel: f64, jerk: f64, top: f64) -> Ceiling {
        let level = self.level.min(accel);
        let mut ceiling = Ceiling::level(level);
        let bend = self.speed_where(level);
        if bend >= top {
            return ceiling;
        }
        let first = self.gentle_from(bend, top, FOLLOW_SHARE * jerk);
        let count = libm::ceil(libm::log(top / first) / libm::log(TANGENT_RATIO));
        let count = count.clamp(1.0, (MAX_STRETCHES - 2) as f64) as i32;
        let ratio = libm::pow(top / first, 1.0 / f64::from(count));
        let mut before = Stretch { v: 0.0, y: level * level, slope: 0.0 };
        for i in 0..=count {
            let tangent = self.tangent(first * libm::pow(ratio, f64::from(i)), FOLLOW_SHARE * jerk);
            if let Some(v) = crossing(before, tangent) {
                ceiling.bend(Stretch {
                    v,
                    y: tangent.y + tangent.slope * (v - tangent.v),
                    ..tangent
                });
                before = tangent;
            }
        }
        ceiling
    }

    /// The line that touches h² at speed `n`. (Where even the highest speed needs more than `jerk`, the
    /// gentlest line allowed, which is below the curve on the slower side.)
    fn tangent(&self, n: f64, jerk: f64) -> Stretch {
        let (h, slope) = self.h(n);
        Stretch { v: n, y: h * h, slope: (2.0 * h * slope).max(-2.0 * jerk) }
    }

    /// Lowest speed from `bend` on at which following the curve needs no more than `jerk` = |h·dh/dn|,
    /// which falls with speed.
    fn gentle_from(&self, bend: f64, top: f64, jerk: f64) -> f64 {
        let steep = |n: f64| {
            let (h, slope) = self.h(n);
            -h * slope > jerk
        };
        if !steep(bend) {
            return bend;
        }
        let (mut low, mut high) = (bend, top);
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if steep(middle) { low = middle } else { high = middle }
        }
        high
    }
}

/// Speed at which two lines cross; `None` if they are parallel.
fn crossing(a: Stretch, b: Stretch) -> Option<f64> {
    let turn = a.slope - b.slope;
    let v = (b.y - b.slope * b.v - a.y + a.slope * a.v) / turn;
    (turn != 0.0 && v.is_finite()).then_some(v)
}
