//! How fast planned time passes: overrides, hold and resume at any instant, within the axes' limits.
//!
//! Planned motion q(τ) keeps the limits when τ runs like the clock. The operator makes it run at another rate σ = dτ/dt:
//!
//! ```text
//!   v = q̇·σ        a = q̈·σ² + q̇·σ′        j = q⃛·σ³ + 3·q̈·σ·σ′ + q̇·σ″
//!
//!   σ 1 ──────╲             ╱─────     the path is left untouched: only when it is run through changes
//!     0        ╲___hold____╱
//! ```
//!
//! Each period σ″ is chosen, which is the only thing that can be: as near as possible to what brings σ to the rate that is
//! wanted, and such that every axis keeps |a| ≤ A in the next period and |j| ≤ J. Both are intervals of σ″. σ is never above 1, so
//! that what was planned leaves room for a rate that does not change; where an axis brakes as hard as it can already,
//! the hold waits for the room that the braking itself makes. Where the two kinds of intervals have nothing in common (two
//! axes in a bend, each at its limit), acceleration counts before jerk.
use path::{AXES, Bounds};

/// An axis' planned motion, at rate 1.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rates {
    pub(crate) v: [f64; AXES],
    pub(crate) a: [f64; AXES],
    pub(crate) j: [f64; AXES],
}

/// σ and σ′.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tempo {
    pub(crate) rate: f64,
    slope: f64,
}

/// Share of the jerk with which an approach to the wanted rate reckons: the rest may be in use by the path.
const RECKONED: f64 = 0.4;
/// Share of the jerk that 3·q̈·σ·σ′ may take.
const COUPLED: f64 = 0.1;
/// An axis slower than this does not limit the rate, mm/s.
const STILL: f64 = 1e-9;
/// A rate as near to the wanted one as this has reached it.
const REACHED: f64 = 1e-4;
/// Fastest change of the rate where nothing moves that could limit it, 1/s.
const FREE: f64 = 1e3;

impl Tempo {
    /// As planned.
    pub(crate) const FULL: Self = Self { rate: 1.0, slope: 0.0 };

    /// Whether planned time stands.
    pub(crate) const fn stands(&self) -> bool {
        self.rate == 0.0
    }

    /// At the wanted rate, and staying there.
    pub(crate) const fn is_steady(&self, wanted: f64) -> bool {
        self.rate == wanted && self.slope == 0.0
    }

    /// A step has ended at rest: the next one begins at the wanted rate.
    pub(crate) const fn rest(&mut self, wanted: f64) {
        (self.rate, self.slope) = (wanted, 0.0);
    }

    /// Speed, acceleration and jerk by the clock, of what they are by planned time.
    pub(crate) fn of(&self, v: f64, a: f64, j: f64) -> (f64, f64, f64) {
        let (s, slope) = (self.rate, self.slope);
        (v * s, a * s * s + v * slope, j * s * s * s + 3.0 * a * s * slope)
    }

    /// In a period that ends with another tempo: how much clock time is left from where `over` of planned time is left, and
    /// the tempo there.
    pub(crate) fn before(&self, end: &Self, over: f64, dt: f64) -> (f64, Self) {
        if end.rate <= 0.0 || over <= 0.0 {
            return (0.0, *end);
        }
        let (mut left, mut tempo) = ((over / end.rate).min(dt), *end);
        for _ in 0..3 {
            tempo = self.towards(end, 1.0 - left / dt, dt);
            left = (over / f64::midpoint(tempo.rate, end.rate)).min(dt);
        }
        (left, tempo)
    }

    /// A share of the way through a period that ends with another tempo.
    fn towards(&self, end: &Self, share: f64, dt: f64) -> Self {
        let slope = self.slope + (end.slope - self.slope) * share;
        // at the wanted rate the slope jumps: then the rates alone tell
        let smooth = self.rate + f64::midpoint(self.slope, end.slope) * dt;
        if (smooth - end.rate).abs() > REACHED * 0.1 {
            return Self { rate: self.rate + (end.rate - self.rate) * share, slope };
        }
        Self { rate: self.rate + f64::midpoint(self.slope, slope) * share * dt, slope }
    }

    /// Planned time has come to where it is: the slope that its rates there leave.
    pub(crate) fn arrive(&mut self, rates: &Rates, bounds: &Bounds) {
        if self.slope == 0.0 {
            return;
        }
        let mut slope = (-f64::INFINITY, f64::INFINITY);
        for i in 0..AXES {
            let v = rates.v[i];
            if v.abs() >= STILL {
                let path = rates.a[i] * self.rate * self.rate;
                narrow(&mut slope, (-bounds.accel[i] - path, bounds.accel[i] - path), v, 0.0, 1.0);
            }
        }
        self.slope = if slope.0 <= slope.1 { self.slope.clamp(slope.0, slope.1) } else { 0.0 };
    }

    /// One period on, towards the wanted rate (0…1), with the rates where planned time will be at its end if the tempo
    /// does not change; planned time that passes in it, s.
    pub(crate) fn advance(&mut self, wanted: f64, rates: &Rates, bounds: &Bounds, dt: f64) -> f64 {
        if self.is_steady(wanted) {
            return self.rate * dt;
        }
        let (sigma, slope) = (self.rate, self.slope);
        let (mut accel, mut jerk) = ((-FREE / dt, FREE / dt), (-f64::INFINITY, f64::INFINITY));
        let missing = wanted - sigma;
        let mut most = missing.abs() / dt;
        // what the planned jerk leaves where the slope must be taken back
        let there = if wanted > sigma { sigma } else { wanted };
        let room = 1.0 - there * there * there;
        for i in 0..AXES {
            let (v, a, j) = (rates.v[i], rates.a[i], rates.j[i]);
            if v.abs() < STILL {
                continue;
            }
            let (strongest, hardest) = (bounds.accel[i], bounds.jerk[i]);
            // its part from the path is given, its part from σ′ is ours
            let path = a * sigma * sigma;
            narrow(&mut accel, (-strongest - path, strongest - path), v, slope, dt);
            if hardest.is_finite() {
                let given = j * sigma * sigma * sigma + 3.0 * a * sigma * slope;
                let (low, high) = ((-hardest - given) / v, (hardest - given) / v);
                jerk = (jerk.0.max(low.min(high)), jerk.1.min(low.max(high)));
                // √(2·|missing|·reach): from there the slope can still be taken back in time, if the path itself does
                // not brake as well
                let reach = RECKONED * room * hardest / v.abs();
                let mut own = libm::sqrt(2.0 * missing.abs() * reach);
                if missing < 0.0 {
                    let brakes = a * v.signum() * (sigma * sigma - wanted * wanted) / v.abs();
                    own = (own + brakes.min(0.0)).max(0.0);
                }
                most = most.min(own).min(COUPLED * hardest / strongest);
            }
        }
        let wish = (most.copysign(missing) - slope) / dt;
        let mut bend = wish;
        if jerk.0 <= jerk.1 {
            bend = bend.clamp(jerk.0, jerk.1);
        }
        if accel.0 <= accel.1 {
            bend = bend.clamp(accel.0, accel.1);
        } else {
            bend = -slope / dt; // nothing fits: at least do not make it worse
        }
        let mut after = slope + bend * dt;
        let mut rate = sigma + dt * (slope + after) / 2.0;
        let passes = (wanted - rate) * missing <= 0.0 && missing != 0.0;
        if passes || (wanted - rate).abs() < REACHED {
            (rate, after) = (wanted, 0.0);
        }
        self.rate = rate.clamp(0.0, 1.0);
        self.slope = if self.rate == 0.0 { 0.0 } else { after };
        dt * (sigma + self.rate) / 2.0
    }
}

/// |path + v·(slope + bend·dt)| within the room, as an interval of bend.
fn narrow(to: &mut (f64, f64), room: (f64, f64), v: f64, slope: f64, dt: f64) {
    let (low, high) = ((room.0 / v - slope) / dt, (room.1 / v - slope) / dt);
    *to = (to.0.max(low.min(high)), to.1.min(low.max(high)));
}
