//! From one speed to another as fast as a ceiling on the acceleration and a jerk allow, and strokes
//! made of two such ramps.
//!
//! The trick is the plane of v and a²: there a piece of constant jerk is a *straight line*, because
//! d(a²)/dv = 2a·(da/dt)/(dv/dt) = 2j. The fastest ramp is then simply the lowest of three:
//!
//! ```text
//!  a² │      rise, slope +2j
//!     │      ╱╲________________________ ceiling: what the machine can give at this speed,
//!     │     ╱ :        ╲___             any falling chain of straight lines
//!     │    ╱  :            ╲___  ╲
//!     │   ╱   :               :╲__╲
//!     │  ╱    :               :    ╲    fall, slope −2j
//!     └─┴─────┴───────────────┴─────┴──► v
//!      v₀     v_r             v_f   v₁
//! ```
//!
//! | symbol | meaning | unit (move; spindle) |
//! |---|---|---|
//! | v, a, j | speed, acceleration, jerk | mm/s…; rev/s… |
//! | y | a² | |
//! | `v_r`, `v_f` | where the rise meets the ceiling, where the fall leaves it | |
//!
//! Under a level ceiling this is the known seven-piece profile: a/j up, level, a/j down, cruise,
//! and the same mirrored (Biagiotti, Melchiorri: Trajectory Planning for Automatic Machines, 3.4).
use motion::{Instant, Phase, Profile};

/// A stretch of a ceiling: y = `y` + `slope`·(speed − `v`), up to the next stretch's `v`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stretch {
    /// Speed at which it begins.
    pub(crate) v: f64,
    /// Square of the acceleration there.
    pub(crate) y: f64,
    /// Change of `y` with speed: twice the jerk. Never positive.
    pub(crate) slope: f64,
}

impl Stretch {
    /// Speed at which two lines cross; not finite if they are parallel.
    fn crossing(self, other: Self) -> f64 {
        (other.y - other.slope * other.v - self.y + self.slope * self.v)
            / (self.slope - other.slope)
    }
}

/// Most stretches of a ceiling. Two ramps, each with a rise and a fall, and a cruise: 2·(28 + 2) +
/// 1 < 64.
pub(crate) const MAX_STRETCHES: usize = 28;

/// The largest acceleration at each speed: falls with speed, never rises.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ceiling {
    stretches: [Stretch; MAX_STRETCHES],
    count: usize,
}

impl Ceiling {
    /// The same at every speed.
    pub(crate) fn level(accel: f64) -> Self {
        let mut stretches = [Stretch::default(); MAX_STRETCHES];
        stretches[0].y = accel * accel;
        Self { stretches, count: 1 }
    }

    /// Go on along another line from where it crosses the last one; stretches that begin beyond
    /// that are forgotten. Ignored when the lines are parallel or there is no room (the last line
    /// then goes on).
    pub(crate) fn bend_to(&mut self, line: Stretch) {
        while self.count > 0 {
            let last = self.stretches[self.count - 1];
            let v = last.crossing(line);
            if !v.is_finite() || self.count == MAX_STRETCHES {
                return;
            }
            if v >= last.v || self.count == 1 {
                self.stretches[self.count] =
                    Stretch { v, y: line.y + line.slope * (v - line.v), ..line };
                self.count += 1;
                return;
            }
            self.count -= 1;
        }
    }

    pub(crate) fn stretches(&self) -> &[Stretch] {
        &self.stretches[..self.count]
    }

    /// Square of the acceleration at a speed.
    pub(crate) fn y(&self, v: f64) -> f64 {
        let stretch =
            self.stretches().iter().rev().find(|s| s.v <= v).unwrap_or(&self.stretches[0]);
        (stretch.y + stretch.slope * (v - stretch.v)).max(0.0)
    }

    /// Each stretch with the speed at which it ends.
    fn spans(&self) -> impl Iterator<Item = (Stretch, f64)> + '_ {
        let ends = self.stretches().iter().skip(1).map(|s| s.v).chain([f64::INFINITY]);
        self.stretches().iter().copied().zip(ends)
    }

    /// Speed at which a rise of slope 2·`jerk` from (`v0`, 0) meets it.
    fn met_by_rise(&self, v0: f64, jerk: f64) -> f64 {
        let meet = |s: Stretch| v0 + (s.y + s.slope * (v0 - s.v)) / (2.0 * jerk - s.slope);
        self.spans()
            .map(|(s, end)| (meet(s), end))
            .find(|(v, end)| v <= end)
            .map_or(v0, |(v, _)| v.max(v0))
    }

    /// Speed at which a fall of slope −2·`jerk` to (`v1`, 0) leaves it.
    fn left_by_fall(&self, v1: f64, jerk: f64) -> f64 {
        let leave = |s: Stretch| v1 - (s.y + s.slope * (v1 - s.v)) / (2.0 * jerk + s.slope);
        self.spans()
            .map(|(s, end)| (leave(s), end))
            .find(|(v, end)| v <= end)
            .map_or(v1, |(v, _)| v.min(v1))
    }
}

/// Pieces from one speed to a higher one, with no acceleration at either end (unless the jerk is
/// infinite).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramp {
    pieces: [Phase; MAX_STRETCHES + 2],
    count: usize,
    end: Instant,
}

impl Ramp {
    /// From `v0` up to `v1` (0 ≤ v0 ≤ v1) under a ceiling, with a jerk that may be infinite.
    ///
    /// The ceiling must not fall more steeply than the jerk.
    pub(crate) fn up(ceiling: &Ceiling, jerk: f64, v0: f64, v1: f64) -> Self {
        let mut ramp = Self {
            pieces: [Phase::default(); MAX_STRETCHES + 2],
            count: 0,
            end: Instant { s: 0.0, v: v0, a: 0.0 },
        };
        if v1 <= v0 {
            return ramp;
        }
        let (mut low, mut high) = (v0, v1);
        if jerk.is_finite() {
            low = ceiling.met_by_rise(v0, jerk);
            high = ceiling.left_by_fall(v1, jerk);
            if low >= high {
                let half = libm::sqrt((v1 - v0) / jerk);
                ramp.add(half, 0.0, jerk);
                ramp.add(half, half * jerk, -jerk);
                ramp.end = Instant { s: ramp.end.s, v: v1, a: 0.0 };
                return ramp;
            }
            ramp.add(libm::sqrt(ceiling.y(low)) / jerk, 0.0, jerk);
        }
        ramp.follow(ceiling, low, high);
        if jerk.is_finite() {
            let a = libm::sqrt(ceiling.y(high));
            ramp.add(a / jerk, a, -jerk);
        }
        ramp.end = Instant { s: ramp.end.s, v: v1, a: 0.0 };
        ramp
    }

    /// Along the ceiling from one speed to another.
    fn follow(&mut self, ceiling: &Ceiling, low: f64, high: f64) {
        for (stretch, end) in ceiling.spans() {
            let (from, to) = (low.max(stretch.v), high.min(end));
            if to <= from {
                continue;
            }
            let at = |v: f64| libm::sqrt((stretch.y + stretch.slope * (v - stretch.v)).max(0.0));
            let (a0, a1) = (at(from), at(to));
            self.add(2.0 * (to - from) / (a0 + a1), a0, stretch.slope / 2.0);
        }
    }

    fn add(&mut self, duration: f64, a: f64, j: f64) {
        // a stretch that rounding has made empty would only cost the kernel time
        if duration > 0.0 && duration.is_finite() {
            let piece = Phase { duration, s: self.end.s, v: self.end.v, a, j };
            self.pieces[self.count] = piece;
            self.count += 1;
            self.end = piece.end();
        }
    }

    pub(crate) fn pieces(&self) -> &[Phase] {
        &self.pieces[..self.count]
    }

    /// How far it goes.
    pub(crate) const fn length(&self) -> f64 {
        self.end.s
    }

    /// The same ramp backwards in time, so that it ends at `s_end`: s(t) = `s_end` − s(T − t).
    pub(crate) fn mirrored(&self, s_end: f64) -> impl Iterator<Item = Phase> + '_ {
        self.pieces().iter().rev().map(move |p| {
            let last = p.end();
            Phase { duration: p.duration, s: s_end - last.s, v: last.v, a: -last.a, j: p.j }
        })
    }
}

/// Up one ramp, along at its speed, and down the other one backwards, over exactly `length`; both
/// ramps lead to the same speed and are together not longer than that.
pub(crate) fn stroke(length: f64, up: &Ramp, down: &Ramp) -> Profile {
    let mut profile = Profile::EMPTY;
    let cruise = length - up.length() - down.length();
    let along = Phase { duration: cruise / up.end.v, s: up.length(), v: up.end.v, a: 0.0, j: 0.0 };
    let along = (cruise > 0.0 && up.end.v > 0.0).then_some(along);
    for piece in up.pieces().iter().copied().chain(along).chain(down.mirrored(length)) {
        // cannot fail: two ramps and a cruise fit, see MAX_STRETCHES
        let fits = profile.push(piece);
        debug_assert!(fits);
    }
    profile.ending_at(Instant { s: length, v: 0.0, a: 0.0 })
}

/// The fastest way over `length` from rest to rest with speed, acceleration and jerk within limits;
/// the jerk may be infinite. In seven pieces or fewer, with no acceleration at either end.
///
/// A length that is not positive gives [`Profile::EMPTY`], as do limits that are not.
///
/// With the peak speed v: the two ramps take v/a + a/j each (2·√(v/j) when a is never reached), so
/// that their length is v²/a + v·a/j (2·√(v³/j)); v is the programmed speed, or where that is
/// `length`.
pub fn rest_to_rest(length: f64, speed: f64, accel: f64, jerk: f64) -> Profile {
    let sound = length > 0.0 && speed > 0.0 && accel > 0.0 && accel.is_finite() && jerk > 0.0;
    if !(sound && length.is_finite()) {
        return Profile::EMPTY;
    }
    let peak = speed.min(peak_speed(length, accel, jerk));
    let ramp = Ramp::up(&Ceiling::level(accel), jerk, 0.0, peak);
    stroke(length, &ramp, &ramp)
}

/// Highest speed on a way from rest to rest that is not otherwise limited.
fn peak_speed(length: f64, accel: f64, jerk: f64) -> f64 {
    let half = accel * accel / (2.0 * jerk);
    let with_level = accel * length / (libm::sqrt(half * half + accel * length) + half);
    if with_level >= 2.0 * half {
        with_level
    } else {
        let root = libm::cbrt(length * libm::sqrt(jerk) / 2.0);
        root * root
    }
}
