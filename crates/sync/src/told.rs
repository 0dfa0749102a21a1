//! The tap of a spindle whose drive is only told a speed: it is told early, and what it does is
//! watched.
//!
//! ```text
//!        told S               turns left = N·(1 + u)           slow: its deceleration has shown itself
//!   In ─────────► at speed ─────────────────────────► Slow ────────────────────────────────────────────┐
//!                    │            told a speed between, then to creep      turns left = N as it showed  │
//!                    │ turns left = N + early                                                          ▼
//!                    └────── learnt, and it repeats well enough ─────────────────────────────────────► Turn
//!                                                          told to turn back, still going in            │
//!       RunDown ◄──────────────────── Out ◄──────── Bottom ◄──────── dwell ─────────────────────────────┤
//!                 turns left = N       ▲                                          it stands             │
//!                                      └──────────────────────────────────────────────────────────────┘
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | N | stopping angle at the present speed, by the machine's file ([`Stopping`]) |
//! | u | share by which it may be longer: large before anything is learnt |
//! | early | turns that it was longer at the programmed speed, learnt from the strokes before; it goes with the square of the speed |
//!
//! The first stroke of a kind is on the safe side: it leaves the speed so early that even a
//! stopping angle longer by u would not pass the bottom, and creeps on to it. Creeping takes long,
//! so it goes on at a speed between, where a first part of the ramp has shown how the drive brakes,
//! and is told to creep when the turns that are left are those that the rest of the ramp takes,
//! with a quarter of u. From the second stroke on the spindle is told to turn back straight from
//! its speed, if the turning point repeats well enough: it scatters with the speed times the
//! scatter of the drive's delay, and with the ramp. Where it does not, the later strokes creep too,
//! but for a moment only, because how the drive stops is known. A stop on the way tells it to
//! stand; the feed stays on its helix meanwhile, and the stroke goes on, or out, from there. An
//! order is given in a period, so the turning point is met within half a period's way.
use crate::stopping::{Stopping, stopping_angle};
use crate::strokes::Stroke;
use crate::tapping::{Cycle, Phase, Tap, Tick};
use crate::{Ask, Coupling, Rotation};
use units::{Angle, Spin, SpinAccel, Time};

/// The deceleration has shown itself once the spindle is as slow as this many times its creep …
const SHOWN: f64 = 1.5;
/// … and a first part of the ramp has, to this share of the speed before: there it goes on until
/// the rest of the ramp is due.
const BETWEEN: f64 = 0.7;
/// The first part is measured when so much of it is left.
const NEARLY: f64 = 0.5;
/// At the speed between it stays for so long, or does not go there: a ramp that begins anew begins
/// at a steady speed.
const STEADY_FOR: Time = Time::s(0.01);
/// By this share of what it may be off before the rest of the ramp may differ from its first part.
const REST: f64 = 0.25;
/// Below this uncertainty there is nothing to be learnt on the way.
const KNOWN: f64 = 0.02;
/// At its creep it shall stay for so long before it is told to turn back.
const CREEPS_FOR: Time = Time::s(0.02);
/// What an observer of an encoder of a thousand lines is late by when a ramp sets in.
const SEEN_LATE: Time = Time::s(4e-3);

/// A spindle that is told speeds, in one tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spoken {
    /// Speeds in and out, signed.
    pub speeds: (Spin, Spin),
    /// How it stops, by the machine's file, from the moment at which the control decides.
    pub stopping: Stopping,
    /// Share by which the stopping angle may be longer than that and what was learnt.
    pub uncertainty: f64,
    /// How much later it may obey.
    pub late: Time,
    /// A speed from which that does not matter.
    pub creep: Spin,
    /// It is known well enough to be told to turn back straight from its speed.
    pub at_speed: bool,
}

/// Where such a tap stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Told {
    /// Told its speed inwards.
    In,
    /// Told to creep.
    Slow(Slowing),
    /// Told to turn back, or to stand for the dwell; still going in. With what the stroke has
    /// taught.
    Turn(Option<Angle>),
    /// Standing at the bottom since the time given.
    Bottom(Option<Angle>, Time),
    /// Told its speed outwards.
    Out(Option<Angle>),
    /// Held: told to stand, wherever that is, and whether it does. With the way to go on, and what
    /// was taught.
    Held {
        /// On inwards.
        inward: bool,
        /// As in `Turn`.
        taught: Option<Angle>,
        /// It stands.
        stands: bool,
    },
    /// Told its speed outwards by what holds it: at the start it is held again.
    Clear(Option<Angle>),
    /// It has come to the start so: told to stand, and held there, whether or not it is still told
    /// to come out.
    Cleared {
        /// As in `Turn`.
        taught: Option<Angle>,
        /// It stands.
        stands: bool,
    },
}

/// On the way to the creep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slowing {
    /// Where it began to slow down, inwards, and its speed then.
    from: (Angle, Spin),
    /// How it really stops, once that is seen.
    shown: Option<Stopping>,
    /// What it is told, magnitude: a speed between, or the creep.
    told: Spin,
    /// The longest that it may take to stop by what the first part of the ramp has shown.
    rest: Option<Stopping>,
}

impl Spoken {
    /// The longest that it may take to stop, with what was learnt.
    fn longest(&self, early: Angle) -> Stopping {
        self.stopping.later_by(early, self.speeds.0).slower_by(self.uncertainty)
    }

    /// How fast it gains speed, from rest to `to` over the turns that it has done: n²/2N, which is
    /// far steadier than what an observer sees of a coarse encoder's acceleration. That one only
    /// tells whether it does.
    fn rises(&self, spin: Spin, seen: SpinAccel, turned: Angle, to: Spin) -> SpinAccel {
        let n = spin.value();
        let mean = SpinAccel::rev_per_s2(n * n / (2.0 * turned.value().max(f64::MIN_POSITIVE)));
        let missing = (to.abs() - spin).max(Spin::ZERO);
        if seen < mean / 2.0 || self.stopping.delay <= Time::ZERO {
            return SpinAccel::ZERO;
        }
        mean.min(missing / self.stopping.delay)
    }
}

impl Told {
    /// The state after this period.
    pub(crate) fn next<S: Stroke>(
        self,
        coupling: Coupling,
        tap: &Tap<S>,
        spoken: &Spoken,
        tick: &Tick,
    ) -> Cycle {
        let inwards = if spoken.speeds.0 < Spin::ZERO { -1.0 } else { 1.0 };
        let spin = tick.master.spin * inwards;
        // the period in which an order comes nearest to its moment
        let half = spin.abs() * tick.elapsed / 2.0;
        let left = coupling.phase_difference(tick.master.angle, tap.bottom) * inwards - half;
        // it may still gain speed while the drive has not obeyed yet
        let turned = (tap.bottom - tap.start).abs() / tap.lead.abs() - left;
        let rises = spoken.rises(spin, tick.master.accel * inwards, turned, spoken.speeds.0);
        let share = square((spin + rises * spoken.stopping.delay) / spoken.speeds.0);
        let is = match self {
            Self::Held { inward, taught, .. } => Self::held(inward, taught, tick),
            Self::Cleared { taught, .. } if tick.rest || tick.out => {
                Self::Cleared { taught, stands: tick.at_rest }
            }
            Self::Cleared { .. } => Self::In,
            _ if tick.rest && !tick.out => Self::Held {
                inward: self.phase() == Phase::In,
                taught: self.taught(),
                stands: false,
            },
            Self::In if spoken.at_speed => {
                let early = spoken.stopping.angle_while(spin, rises) + tap.early * share;
                if left > early { self } else { Self::Turn(None) }
            }
            Self::In => {
                let longest = spoken.longest(tap.early);
                let creeping = spoken.creep * (CREEPS_FOR + longest.delay);
                let late = (spin + rises * spoken.stopping.delay) * (SEEN_LATE + spoken.late);
                if left > longest.angle_while(spin, rises) + creeping + late {
                    self
                } else {
                    // how far it turns on, and how fast, before the drive obeys
                    let delay = spoken.stopping.delay;
                    let rotation = Rotation { accel: rises * inwards, ..tick.master }.after(delay);
                    let from = (rotation.angle * inwards, rotation.spin * inwards);
                    Self::Slow(Slowing::begin(from, spoken))
                }
            }
            Self::Slow(slowing) => {
                let longest = spoken.longest(tap.early);
                slowing.next(spoken, longest, (spin, left), tick.master.angle * inwards)
            }
            Self::Turn(_) if spin > Spin::ZERO && !tick.at_rest => self,
            Self::Turn(taught) if tap.dwell > Time::ZERO => Self::Bottom(taught, Time::ZERO),
            Self::Bottom(taught, waited) if waited + tick.elapsed < tap.dwell => {
                Self::Bottom(taught, waited + tick.elapsed)
            }
            Self::Turn(taught) | Self::Bottom(taught, _) => Self::Out(taught),
            Self::Out(taught) | Self::Clear(taught) => {
                let left = coupling.phase_difference(tick.master.angle, tap.end) * -inwards - half;
                // what was learnt of this speed inwards holds for the way out as far as the speeds
                // are alike
                let more = taught.unwrap_or(tap.early) * square(spin / spoken.speeds.0);
                let turned = (tap.bottom - tap.end).abs() / tap.lead.abs() - left;
                let accel = tick.master.accel * -inwards;
                let rises = spoken.rises(-spin, accel, turned, spoken.speeds.1);
                if left <= spoken.stopping.angle_while(spin, rises) + more {
                    if let Self::Clear(taught) = self {
                        let cleared = Self::Cleared { taught, stands: false };
                        return Cycle::Told(coupling, cleared);
                    }
                    return Cycle::RunDown(coupling);
                }
                self
            }
        };
        Cycle::Told(coupling, is)
    }

    /// Held: out as soon as that is asked, on as soon as it is not held any more.
    fn held(inward: bool, taught: Option<Angle>, tick: &Tick) -> Self {
        match (tick.out, tick.rest) {
            (true, _) => Self::Clear(taught),
            (false, true) => Self::Held { inward, taught, stands: tick.at_rest },
            (false, false) if inward => Self::In,
            (false, false) => Self::Out(taught),
        }
    }

    /// It is held, and stands.
    pub(crate) const fn is_standing(self) -> bool {
        matches!(self, Self::Held { stands: true, .. } | Self::Cleared { stands: true, .. })
    }

    /// It stands where the tap is clear of the work.
    pub(crate) const fn is_cleared(self) -> bool {
        matches!(self, Self::Cleared { stands: true, .. })
    }

    /// What it is about.
    pub(crate) const fn phase(self) -> Phase {
        match self {
            Self::In
            | Self::Slow(_)
            | Self::Turn(_)
            | Self::Held { inward: true, .. }
            | Self::Cleared { .. } => Phase::In,
            Self::Bottom(..) => Phase::Bottom,
            Self::Out(_) | Self::Clear(_) | Self::Held { inward: false, .. } => Phase::Out,
        }
    }

    /// What the spindle is told.
    pub(crate) fn ask<S: Stroke>(self, tap: &Tap<S>, spoken: &Spoken) -> Ask {
        let (inwards, outwards) = spoken.speeds;
        let spin = match self {
            Self::In => inwards,
            Self::Slow(slowing) if inwards < Spin::ZERO => -slowing.told,
            Self::Slow(slowing) => slowing.told,
            Self::Turn(_) if tap.dwell > Time::ZERO => Spin::ZERO,
            Self::Bottom(..) | Self::Held { .. } | Self::Cleared { .. } => Spin::ZERO,
            Self::Turn(_) | Self::Out(_) | Self::Clear(_) => outwards,
        };
        Ask::Speed(Rotation { spin, ..Rotation::default() })
    }

    /// Turns by which the stopping angle at the speed of this tap is longer than by the machine's
    /// file.
    pub(crate) const fn taught(self) -> Option<Angle> {
        match self {
            Self::In | Self::Slow(_) => None,
            Self::Turn(taught)
            | Self::Bottom(taught, _)
            | Self::Out(taught)
            | Self::Held { taught, .. }
            | Self::Clear(taught)
            | Self::Cleared { taught, .. } => taught,
        }
    }
}

impl Slowing {
    /// Told to slow down, from this angle and speed on.
    fn begin(from: (Angle, Spin), spoken: &Spoken) -> Self {
        let between = from.1 * BETWEEN;
        let goes_on = spoken.uncertainty > KNOWN && between > spoken.creep * SHOWN;
        let told = if goes_on { between } else { spoken.creep };
        Self { from, shown: None, told, rest: None }
    }

    /// With the longest that it may take to stop, its speed, the turns that are left, and its angle
    /// inwards.
    fn next(self, spoken: &Spoken, longest: Stopping, now: (Spin, Angle), angle: Angle) -> Told {
        if self.told > spoken.creep {
            return self.between(spoken, longest, now, angle);
        }
        let longest = self.rest.unwrap_or(longest);
        let ((at, from), (spin, left)) = (self.from, now);
        let shown = self.shown.or_else(|| {
            let slow = spin <= spoken.creep * SHOWN;
            slow.then(|| spoken.stopping.shown(from, spin, angle - at)).flatten()
        });
        // until then it is on its way down already: there is no delay to come
        let needed =
            shown.map_or_else(|| stopping_angle(spin, longest.decel), |shown| shown.angle(spin));
        // one that has not shown how it stops brakes as it can, and its speed is known late
        let brakes = shown.is_none() && spin > spoken.creep * SHOWN + longest.decel * longest.delay;
        if left > needed || brakes {
            return Told::Slow(Self { shown, ..self });
        }
        let at_speed = spoken.speeds.0;
        Told::Turn(shown.map(|shown| shown.angle(at_speed) - spoken.stopping.angle(at_speed)))
    }

    /// The same on the way to the speed between, and at it.
    fn between(self, spoken: &Spoken, longest: Stopping, now: (Spin, Angle), angle: Angle) -> Told {
        let ((at, from), (spin, left)) = (self.from, now);
        let is_slow = spin <= self.told + (from - self.told) * NEARLY;
        if !is_slow && self.shown.is_none() {
            return Told::Slow(self); // it brakes as it can
        }
        let seen = || spoken.stopping.shown(from, spin, angle - at).unwrap_or(longest);
        let first = self.shown.unwrap_or_else(seen);
        let rest = first.slower_by(spoken.uncertainty * REST);
        // what the rest of the ramp takes from a speed, with what the order may be late by
        let due = |spin: Spin| {
            let late = spin * (SEEN_LATE + spoken.late);
            rest.angle(spin) + spoken.creep * (CREEPS_FOR + rest.delay) + late
        };
        let creeps =
            |from| Told::Slow(Self { from, shown: None, told: spoken.creep, rest: Some(rest) });
        if self.shown.is_none() {
            let braking =
                stopping_angle(spin, first.decel) - stopping_angle(self.told, first.decel);
            let steady = self.told * STEADY_FOR;
            // it would stay for too short a time at the speed between: the ramp goes on
            return if left - braking < due(self.told) + steady {
                creeps(self.from)
            } else {
                Told::Slow(Self { shown: Some(first), ..self })
            };
        }
        if left > due(spin) {
            return Told::Slow(self);
        }
        creeps((angle + spin * rest.delay, spin))
    }
}

fn square(x: f64) -> f64 {
    x * x
}

#[cfg(test)]
#[path = "told_tests.rs"]
mod tests;
