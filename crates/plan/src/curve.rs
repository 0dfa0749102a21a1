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
//! | h₁(n) = q − k − c·n | α where torque is the limit, below the base speed | rev/s² |
//! | h₂(n) = p/n − k − c·n | α where power is the limit, above it | rev/s² |
//!
//! A [`Ceiling`] is a chain of straight lines in the plane of n and α². h₁ and h₂ are convex, so
//! are their squares where they are positive, and a tangent of a convex curve lies below it: the
//! chain is made of tangents, and a plan made with it never asks for more than the curve.
//! Neighbouring tangents touch h₂ at speeds 10 % apart, so that they meet about 0.4 % (of α) below
//! it. Where the curve falls more steeply than the jerk allows, the chain leaves it early enough.
//!
//! A forced or level ramp that ignores P/ω saturates the drive, and with it goes the synchronism:
//! that is the commonest way for fast tapping to fail.
use crate::SpindleLimits;
use crate::ramp::{Ceiling, MAX_STRETCHES, Ramp, Stretch};
use core::f64::consts::TAU;
use motion::{Phase, Profile};
use units::{Spin, Torque};

/// Ratio of the speeds at which neighbouring tangents touch the curve, if their number suffices.
const TANGENT_RATIO: f64 = 1.1;
/// Most tangents where torque is the limit.
const TORQUE_TANGENTS: i32 = 5;
/// Most tangents where power is the limit; one stretch is the level at the start.
const POWER_TANGENTS: i32 = 22;
#[allow(clippy::cast_possible_wrap)] // a few dozen
const _: () = assert!(1 + TORQUE_TANGENTS + POWER_TANGENTS <= MAX_STRETCHES as i32);
/// Of the allowed jerk, the share that following the curve may use; the fall at the ramp's end must
/// be steeper.
const FOLLOW_SHARE: f64 = 0.9;
/// Of the level acceleration, what must be left at the highest speed: below it a speed is not
/// reached in any useful time.
const RESERVE: f64 = 0.03;

/// α over n: the lower of h₁ and h₂.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Curve {
    /// rev/s².
    q: f64,
    /// rev²/s³.
    p: f64,
    /// rev/s².
    k: f64,
    /// 1/s.
    c: f64,
}

impl SpindleLimits {
    /// Speeding up against friction and a cut.
    pub(crate) fn speeding_up(&self, cut: Torque) -> Curve {
        self.curve(self.friction.value() + cut.value(), self.viscous_n_m_s_per_rad)
    }

    /// Slowing down; friction helps.
    pub(crate) fn slowing_down(&self) -> Curve {
        self.curve(-self.friction.value(), 0.0)
    }

    /// With a load of `load` N·m and `viscous` N·m·s/rad.
    fn curve(&self, load: f64, viscous: f64) -> Curve {
        let per_torque = 1.0 / (TAU * self.inertia.value());
        Curve {
            q: self.margin * self.peak_torque.value() * per_torque,
            p: self.margin * self.peak_power.value() / TAU * per_torque,
            k: load * per_torque,
            c: viscous * TAU * per_torque,
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
        let curve = self.speeding_up(cut);
        if curve.at_rest() <= 0.0 {
            return Spin::ZERO;
        }
        self.max_speed.min(Spin::rev_per_s(curve.speed_where(RESERVE * curve.at_rest())))
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
        profile.ending_at(motion::Instant { s: end.s, v: b, a: 0.0 })
    }

    /// Append a change of speed within one sense.
    fn change(&self, profile: &mut Profile, from: f64, to: f64) {
        let (low, high) = (from.abs().min(to.abs()), from.abs().max(to.abs()));
        let sense = if from + to < 0.0 { -1.0 } else { 1.0 };
        let start = profile.end().s;
        let signed = |p: Phase| Phase {
            duration: p.duration,
            s: start + sense * p.s,
            v: sense * p.v,
            a: sense * p.a,
            j: sense * p.j,
        };
        let jerk = self.jerk();
        let mut add = |piece: Phase| {
            // cannot fail: two ramps fit into a profile, see MAX_STRETCHES
            let fits = profile.push(signed(piece));
            debug_assert!(fits);
        };
        if to.abs() > from.abs() {
            let ceiling = self.speeding_up(Torque::ZERO).ceiling(f64::INFINITY, jerk, high);
            let ramp = Ramp::up(&ceiling, jerk, low, high);
            ramp.pieces().iter().copied().for_each(&mut add);
        } else {
            let ceiling = self.slowing_down().ceiling(f64::INFINITY, jerk, high);
            let ramp = Ramp::up(&ceiling, jerk, low, high);
            ramp.mirrored(ramp.length()).for_each(&mut add);
        }
    }
}

impl Curve {
    /// Acceleration from rest, rev/s².
    pub(crate) fn at_rest(&self) -> f64 {
        self.q - self.k
    }

    /// Speed above which power is the limit, rev/s.
    pub(crate) fn base(&self) -> f64 {
        self.p / self.q
    }

    /// h₁ or h₂ with its slope dh/dn.
    fn h(&self, n: f64, power: bool) -> (f64, f64) {
        let (drive, fall) = if power { (self.p / n, -self.p / (n * n)) } else { (self.q, 0.0) };
        (drive - self.k - self.c * n, fall - self.c)
    }

    /// Where the curve has fallen to `accel`: q = k + accel + c·n or p/n = k + accel + c·n,
    /// whichever comes first; infinite if it never does.
    fn speed_where(&self, accel: f64) -> f64 {
        let b = self.k + accel;
        let by_torque = if self.c > 0.0 { (self.q - b) / self.c } else { f64::INFINITY };
        let denominator = b + libm::sqrt(b * b + 4.0 * self.c * self.p);
        let by_power = if denominator > 0.0 { 2.0 * self.p / denominator } else { f64::INFINITY };
        by_torque.min(by_power).max(0.0)
    }

    /// The chain of lines below the curve and below `accel`, good up to speed `top`.
    pub(crate) fn ceiling(&self, accel: f64, jerk: f64, top: f64) -> Ceiling {
        let jerk = FOLLOW_SHARE * jerk;
        let level = self.at_rest().min(accel);
        let mut ceiling = Ceiling::level(level);
        let bend = self.speed_where(level);
        let base = self.base();
        if bend < top.min(base) {
            self.follow_torque(&mut ceiling, bend, top.min(base), jerk);
        }
        if bend.max(base) < top {
            self.follow_power(&mut ceiling, bend.max(base), top, jerk);
        }
        ceiling
    }

    /// Tangents of h₁: it falls by the growing friction only, so few are enough. With m of them
    /// over a fall by a share d of the whole, α is missed by less than (d/2m)².
    fn follow_torque(&self, ceiling: &mut Ceiling, from: f64, to: f64, jerk: f64) {
        let fall = self.c * (to - from) / self.h(from, false).0;
        let count = libm::ceil(fall / 0.2).clamp(1.0, f64::from(TORQUE_TANGENTS)) as i32;
        for i in 0..count {
            let share = (f64::from(i) + 0.5) / f64::from(count);
            ceiling.bend_to(self.tangent(from + share * (to - from), false, jerk));
        }
    }

    /// Tangents of h₂, in equal ratios of speed.
    fn follow_power(&self, ceiling: &mut Ceiling, from: f64, to: f64, jerk: f64) {
        let first = self.flattest_from(from, to, jerk);
        let count = libm::ceil(libm::log(to / first) / libm::log(TANGENT_RATIO));
        let count = count.clamp(1.0, f64::from(POWER_TANGENTS) - 1.0) as i32;
        let ratio = libm::pow(to / first, 1.0 / f64::from(count));
        for i in 0..=count {
            ceiling.bend_to(self.tangent(first * libm::pow(ratio, f64::from(i)), true, jerk));
        }
    }

    /// The line that touches h² at speed `n`. (Where even the highest speed needs more than `jerk`,
    /// the flattest line allowed, which is below the curve on the slower side.)
    fn tangent(&self, n: f64, power: bool, jerk: f64) -> Stretch {
        let (h, slope) = self.h(n, power);
        Stretch { v: n, y: h * h, slope: (2.0 * h * slope).max(-2.0 * jerk) }
    }

    /// Lowest speed from `bend` on at which following h₂ needs no more than `jerk` = |h·dh/dn|,
    /// which falls with speed.
    fn flattest_from(&self, bend: f64, top: f64, jerk: f64) -> f64 {
        let steep = |n: f64| {
            let (h, slope) = self.h(n, true);
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
