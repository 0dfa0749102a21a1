//! How fast planned time passes: overrides, hold and resume at any instant, within the axes'
//! limits.
//!
//! Planned motion q(τ) keeps the limits when τ runs like the clock. The operator makes it run at
//! another rate σ = dτ/dt:
//!
//! ```text
//!   v = q̇·σ        a = q̈·σ² + q̇·σ′        j = q⃛·σ³ + 3·q̈·σ·σ′ + q̇·σ″
//!
//!   σ 1 ──────╲             ╱─────     the path is left untouched: only when it is run through changes
//!     0        ╲___hold____╱
//! ```
//!
//! At a rate that does not change, and is not above 1, a plan within its limits stays within them.
//! So a change is begun, and made faster, only while there is a known way to end it:
//!
//! ```text
//!   this period     as strong a change as every axis allows…
//!   from then on    …if the change can be eased to none from there, period by period along the plan, within all limits, and
//!                   on this side of the wanted rate. If it cannot, a smaller change; at last, the easing known from before
//! ```
//!
//! The known way is one along the plan: while the rate changes, the plan must stay (it may get
//! longer). A change that would still be under way where the known plan ends is no known way: what
//! comes later may leave no room for it. Only where the plan is known for so few periods that not
//! even an even rate can be looked at is it taken nevertheless.
//!
//! What is looked at is what is told to the axes: second and third differences of their setpoints
//! at the servo period. With the one period that is under way, the differences know two periods of
//! the past.
//!
//! | symbol | meaning |
//! |---|---|
//! | `rate` x | planned time that passes in a period, over the period |
//! | `change` d | of the rate, from a period to the next |
//! | `first`, `second` | differences of the setpoints, mm |
use motion::{AXES, Bounds, Limits};

/// A place on planned motion.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PlannedPoint {
    /// Where.
    pub(crate) q: [f64; AXES],
    /// How fast at rate 1, per second.
    pub(crate) v: [f64; AXES],
    /// The limits of rapids count there.
    pub(crate) rapid: bool,
}

/// Planned motion from some place on.
pub(crate) trait Motion: Clone {
    /// Planned time passes; `false`: how motion goes on there is not known yet.
    fn pass(&mut self, time: f64) -> bool;
    /// Where it is now.
    fn place(&self) -> PlannedPoint;
}

/// A period: how long it is, s, and how much planned time passes in it at rate 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Period {
    pub(crate) length: f64,
    pub(crate) planned: f64,
}

/// The rate, and what has been told to the axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TimeScaling {
    rate: f64,
    change: f64,
    /// Change of the change.
    bend: f64,
    /// The rate that easing would come to.
    settles: f64,
    /// That easing ends within what is known of the plan.
    known: bool,
    /// Periods since a change was asked for that has not come.
    waited: u32,
    told: Told,
    /// With this period's setpoints.
    foreseen: bool,
}

/// The last setpoints.
#[derive(Clone, Copy, Debug, Default)]
struct Told {
    q: [f64; AXES],
    first: [f64; AXES],
    second: [f64; AXES],
    /// Which of the last four were rapid, a bit each.
    rapid: u8,
}

/// Most periods in which a change must be eased to none.
const EASING: usize = 128;
/// Most periods that are looked at in one, whatever is tried.
pub(crate) const SIGHT: usize = 160;
/// How many changes are tried in a period, beside that of easing.
const TRIES: usize = 4;
/// By how much of their limits differences of planned motion may be above them.
const ACCEL_ROOM: f64 = 0.003;
const JERK_ROOM: f64 = 0.02;
/// How much of that is aimed at: the rest is for rounding, and for speeds that change within a
/// period.
const AIMED: f64 = 0.5;
/// Where a plan leaves no room for a change in so many seconds, it is made with twice as much.
const PATIENCE_S: f64 = 0.05;
/// An axis slower than this does not limit the rate, mm/s.
const STILL: f64 = 1e-9;
/// Rates that differ by less are one.
const SAME: f64 = 1e-12;

impl TimeScaling {
    /// As planned, at rest.
    pub(crate) const FULL: Self = Self {
        rate: 1.0,
        change: 0.0,
        bend: 0.0,
        settles: 1.0,
        known: false,
        waited: 0,
        told: Told { q: [0.0; AXES], first: [0.0; AXES], second: [0.0; AXES], rapid: 0 },
        foreseen: false,
    };

    /// Planned time of a period, over the period.
    pub(crate) const fn rate(&self) -> f64 {
        self.rate
    }

    /// Whether planned time stands.
    pub(crate) const fn stands(&self) -> bool {
        self.rate == 0.0 && self.change == 0.0
    }

    /// The rate is not about to change by itself: motion may go on along another plan.
    pub(crate) const fn is_even(&self) -> bool {
        self.change == 0.0
    }

    /// At the wanted rate, and staying there.
    const fn is_steady(&self, wanted: f64) -> bool {
        self.rate == wanted && self.change == 0.0
    }

    /// Motion begins at rest, here: at the wanted rate at once.
    pub(crate) const fn begin(&mut self, wanted: f64, q: [f64; AXES]) {
        *self = Self { rate: wanted, settles: wanted, ..Self::FULL };
        self.told.q = q;
    }

    /// Speed, acceleration and jerk by the clock, of what they are by planned time.
    pub(crate) fn of(&self, v: f64, a: f64, j: f64, period_s: f64) -> (f64, f64, f64) {
        let (slope, bend) = (self.change / period_s, self.bend / (period_s * period_s));
        // the rate is a mean over the period that ends here
        let s = (self.rate + self.change / 2.0).max(0.0);
        let jerk = j * s * s * s + 3.0 * a * s * slope + v * bend;
        (v * s, a * s * s + v * slope, jerk)
    }

    /// One period on, towards the wanted rate (0…1), along motion from here on:
    /// [`TimeScaling::rate`] is that of this period.
    pub(crate) fn advance(
        &mut self,
        wanted: f64,
        motion: impl Motion,
        limits: &Limits,
        period: Period,
    ) {
        if self.is_steady(wanted) {
            (self.bend, self.settles, self.waited) = (0.0, wanted, 0);
            return;
        }
        let patience = libm::exp2(f64::from(self.waited) * period.length / PATIENCE_S);
        let Self { rate, change, told, .. } = *self;
        let walk = Walk { motion, rate, change, told, limits, period, patience };
        let now = Easing { rate: self.settles, known: self.known && change != 0.0 };
        let (next, Easing { rate: settles, known }) = walk.choose(wanted, now);
        if next.change == 0.0 && (settles - wanted).abs() > SAME {
            self.waited = self.waited.saturating_add(1);
        }
        self.bend = next.change - change;
        (self.rate, self.change, self.told) = (next.rate, next.change, next.told);
        (self.settles, self.known, self.foreseen) = (settles, known, true);
        if self.change == 0.0 && (self.rate - wanted).abs() <= SAME {
            self.rate = wanted; // an easing ends there but for rounding
        }
    }

    /// The axes are told to be here.
    pub(crate) fn reached(&mut self, q: &[f64; AXES], rapid: bool) {
        if self.foreseen {
            self.told.q = *q; // per revolution, a little off what was foreseen
        } else {
            self.told.next(q, rapid);
        }
        self.foreseen = false;
    }
}

impl Told {
    /// One setpoint on.
    fn next(&mut self, q: &[f64; AXES], rapid: bool) {
        for (i, q) in q.iter().enumerate() {
            let first = q - self.q[i];
            self.second[i] = first - self.first[i];
            self.first[i] = first;
        }
        self.q = *q;
        self.rapid = self.rapid << 1 | u8::from(rapid);
    }
}

/// How easing ends.
#[derive(Clone, Copy, Debug)]
struct Easing {
    /// The rate that it comes to.
    rate: f64,
    /// It ends within what is known of the plan.
    known: bool,
}

/// The next periods, as they would be.
#[derive(Clone)]
struct Walk<'a, M> {
    motion: M,
    rate: f64,
    change: f64,
    told: Told,
    limits: &'a Limits,
    period: Period,
    patience: f64,
}

impl<M: Motion> Walk<'_, M> {
    /// This period at the rate that gets nearest to the wanted one, and how easing ends from there;
    /// `now`: how from here.
    fn choose(&self, wanted: f64, mut now: Easing) -> (Self, Easing) {
        let mut safe = self.clone();
        safe.ease();
        let settles = now.rate;
        if (settles - wanted).abs() <= SAME {
            return (safe, now);
        }
        let mut sight = SIGHT;
        now.known = now.known || safe.clone().settle(&mut sight).is_some_and(|easing| easing.known);
        let room = self.room(safe.rate);
        let slower = wanted < settles;
        let farthest = if slower { room.0.max(wanted) } else { room.1.min(wanted) };
        if (farthest < safe.rate) != slower || farthest == safe.rate {
            return (safe, now);
        }
        let (mut near, mut far) = (safe.rate, farthest);
        let mut best = (safe, now);
        for n in 0..TRIES {
            let rate = if n == 0 { farthest } else { f64::midpoint(near, far) };
            let found = self.tried(rate, wanted, slower, &mut sight);
            match found.filter(|(_, easing)| easing.known || !now.known) {
                Some(found) if n == 0 => return found,
                Some(found) => (near, best) = (rate, found),
                None => far = rate,
            }
        }
        best
    }

    /// A rate in this period, if it keeps all limits and can be eased from on this side of the
    /// wanted one.
    fn tried(
        &self,
        rate: f64,
        wanted: f64,
        slower: bool,
        sight: &mut usize,
    ) -> Option<(Self, Easing)> {
        let mut next = self.clone();
        if next.go(rate)? > 1.0 {
            return None;
        }
        let ends = next.clone().settle(sight)?;
        let passes = if slower { ends.rate < wanted - SAME } else { ends.rate > wanted + SAME };
        (!passes).then_some((next, ends))
    }

    /// Ease the change to none, as far as the plan is known. `None`: not within all limits.
    fn settle(&mut self, sight: &mut usize) -> Option<Easing> {
        let mut even = 0;
        for _ in 0..EASING.min(*sight) {
            *sight -= 1;
            if self.change == 0.0 {
                even += 1;
                if even > 2 {
                    return Some(Easing { rate: self.rate, known: true });
                }
            }
            match self.ease() {
                Some(load) if load > 1.0 => return None,
                Some(_) => {}
                None => return Some(Easing { rate: self.rate, known: false }),
            }
        }
        None
    }

    /// One period in which the change becomes as small as it can; what it takes of the limits.
    fn ease(&mut self) -> Option<f64> {
        let rate = if self.change == 0.0 {
            self.rate
        } else {
            let (low, high) = self.room((self.rate + self.change).max(0.0));
            // where two axes want opposite things: half of both
            if low <= high { self.rate.clamp(low, high) } else { f64::midpoint(low, high) }
        };
        self.go(rate.clamp(0.0, 1.0))
    }

    /// One period at a rate: what the most loaded axis takes of its limits. `None`: it is not known
    /// how motion goes on.
    fn go(&mut self, rate: f64) -> Option<f64> {
        let known = self.motion.pass(rate * self.period.planned);
        let place = self.motion.place();
        let before = self.told.second;
        self.told.next(&place.q, place.rapid);
        (self.change, self.rate) = (rate - self.rate, rate);
        let bounds = self.bounds(self.told.rapid, 1.0);
        let mut load = 0.0_f64;
        for (i, before) in before.iter().enumerate() {
            let (accel, jerk) = (bounds.0[i], bounds.1[i]);
            load = load.max(self.told.second[i].abs() / accel);
            load = load.max((self.told.second[i] - before).abs() / jerk);
        }
        known.then_some(load)
    }

    /// The rates, near one, at which every axis keeps its limits in this period.
    fn room(&self, near: f64) -> (f64, f64) {
        let mut motion = self.motion.clone();
        motion.pass(near * self.period.planned);
        let place = motion.place();
        let bounds = self.bounds(self.told.rapid << 1 | u8::from(place.rapid), AIMED);
        let (mut low, mut high) = (-1.0_f64, 2.0_f64);
        for i in 0..AXES {
            let by_rate = place.v[i] * self.period.length;
            if by_rate.abs() < STILL * self.period.length {
                continue;
            }
            let (accel, jerk) = (bounds.0[i], bounds.1[i]);
            let before = self.told.second[i];
            let there = place.q[i] - self.told.q[i] - self.told.first[i];
            let least = (before - jerk).max(-accel) - there;
            let most = (before + jerk).min(accel) - there;
            let (a, b) = (near + least / by_rate, near + most / by_rate);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        (low, high)
    }

    /// Largest second and third differences of the setpoints, with a share of the room above the
    /// limits.
    fn bounds(&self, rapid: u8, share: f64) -> ([f64; AXES], [f64; AXES]) {
        let Limits { feed, rapid: rapids } = self.limits;
        let dt = self.period.length;
        let (two, three) = (dt * dt, dt * dt * dt);
        let room = share * self.patience;
        let of = |limit: fn(&Bounds) -> &[f64; AXES], i: usize| match rapid & 0b1111 {
            0 => limit(feed)[i],
            0b1111 => limit(rapids)[i],
            _ => limit(feed)[i].max(limit(rapids)[i]),
        };
        let accel = two * (1.0 + ACCEL_ROOM * room);
        let jerk = three * (1.0 + JERK_ROOM * room);
        (
            core::array::from_fn(|i| accel * of(|b| &b.accel, i)),
            core::array::from_fn(|i| jerk * of(|b| &b.jerk, i)),
        )
    }
}

#[cfg(test)]
mod tests;
