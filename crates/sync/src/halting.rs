//! Stopping in the middle of a tap, on the coupling, and going on or back from there.
//!
//! ```text
//!   speed │     plan                      The master is slowed down along the way that it was going, with
//!         │    ______                     bounded torque and jerk; the follower goes on obeying its law, so
//!         │   ╱      ╲ hold               both stop together. Where the plan itself brakes harder, the plan
//!         │  ╱     ╲  ╲                   is followed: a stop never passes the stroke's own end.
//!         │ ╱       ╲_ ╲
//!         └───────────┴──┴──► time
//!
//!               speed zero              go on: to the bottom, or to the end
//!   Stopping ───────────────► Standing ──────────────────────────────────────► Rejoining ─► Bottom, End
//!      ▲                         │  ▲                                            │
//!      │                  out    ▼  └── at the clear place ───────────┐          │
//!      └──────── held ─────── Rejoining (Clear) ──────────────────────┘◄─────────┘ held
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s | turns from the start, inwards positive | rev |
//! | v, a, J | speed and acceleration along the way (v ≥ 0), bound of the jerk | rev/s… |
//! | σ | time within the stroke that is being left | s |
//!
//! Braking aims at a = −min(A(v), √(2·J·v)): as hard as allowed, and early enough to let go without
//! a jolt. The way is that of the plan, s = plan(σ) with dσ/dt = `v/v_plan`, and v never exceeds
//! the plan's speed there.
use units::{Angle, Length, Spin, SpinAccel, SpinJerk, Time};

use crate::{Blend, Coupling, Rotation, Stroke, StrokePoint, Tap, Tick};

/// Slower than this a stop is over, rev/s: below what an encoder shows.
const STANDS: f64 = 1e-4;
/// A place is reached within this, rev.
const THERE: f64 = 1e-6;

/// How a tap that stops is slowed down, and how it is taken out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halt {
    /// Most deceleration of the master while its torque is the limit.
    pub level: SpinAccel,
    /// Most deceleration times speed while its power is the limit, rev²/s³.
    pub power: f64,
    /// Most jerk of the master.
    pub jerk: SpinJerk,
    /// Limits of the way out after a stop.
    pub slow: (Spin, SpinAccel),
    /// Limits of the way on.
    pub on: (Spin, SpinAccel),
    /// Coordinate at which the tap is clear of the work.
    pub clear: Length,
}

impl Halt {
    /// A(v).
    fn accel(&self, v: f64) -> f64 {
        self.level.value().min(self.power / v.max(f64::MIN_POSITIVE))
    }
}

/// Where to after a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// On, to where the spindle turns back.
    Bottom,
    /// On, to the end of the way out.
    End,
    /// Out of the work.
    Clear,
}

/// What was being done when it stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// The planned way in.
    In,
    /// The planned way out.
    Out,
    /// A way on or out after an earlier stop.
    Again(Blend, Goal),
}

/// A stop on the coupling, and what comes after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Halting {
    /// Slowing down.
    Stopping(Course, Braking),
    /// Standing at so many turns from the start.
    Standing(Course, Angle),
    /// On the way on, or out, since a while.
    Rejoining(Blend, Time, Goal),
}

/// The slowing down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Braking {
    /// σ.
    at: Time,
    v: f64,
    a: f64,
    jerk: f64,
}

/// What a period of it came to.
pub(crate) enum After {
    /// Still on it.
    Halting(Halting),
    /// It is where the spindle turns back.
    Bottom,
    /// It is at the end of the way out.
    End,
}

impl Halting {
    /// Leave a planned stroke at a time within it.
    pub(crate) fn leave<S: Stroke>(course: Course, tap: &Tap<S>, at: Time, waits: bool) -> Self {
        let point = plan(course, tap, at);
        let a = if waits { 0.0 } else { point.accel.value() };
        Self::Stopping(course, Braking { at, v: point.spin.value(), a, jerk: 0.0 })
    }

    /// A period later.
    pub(crate) fn next<S: Stroke>(self, tap: &Tap<S>, coupling: &Coupling, tick: &Tick) -> After {
        match self {
            Self::Stopping(course, braking) => stop(course, braking, tap, tick.elapsed),
            Self::Standing(course, s) => After::Halting(self.stand(course, s, tap, coupling, tick)),
            Self::Rejoining(blend, at, goal) => {
                let at = at + tick.elapsed;
                if at.value() >= blend.duration_s() {
                    return match goal {
                        Goal::Bottom => After::Bottom,
                        Goal::End => After::End,
                        Goal::Clear => {
                            let s = Angle::rev(blend.end());
                            After::Halting(Self::Standing(Course::Again(blend, goal), s))
                        }
                    };
                }
                let held = if goal == Goal::Clear { !tick.out } else { tick.rest };
                if held {
                    return After::Halting(Self::leave(Course::Again(blend, goal), tap, at, false));
                }
                After::Halting(Self::Rejoining(blend, at, goal))
            }
        }
    }

    /// Standing: on as soon as it is not held any more, out as soon as that is asked.
    fn stand<S: Stroke>(
        self,
        course: Course,
        s: Angle,
        tap: &Tap<S>,
        coupling: &Coupling,
        tick: &Tick,
    ) -> Self {
        let goal = if tick.out {
            Goal::Clear
        } else if tick.rest {
            return self;
        } else {
            match course {
                // who was taken out begins again
                Course::In | Course::Again(_, Goal::Clear) => Goal::Bottom,
                Course::Out => Goal::End,
                Course::Again(_, goal) => goal,
            }
        };
        let to = turns(tap, coupling, goal);
        if goal == Goal::Clear && (to - s.value()).abs() < THERE {
            return self;
        }
        // a spindle that only obeys a speed is where it is
        let from = if tap.encoder_following {
            (tick.master.angle - origin(tap, coupling)).value() * sense(tap)
        } else {
            s.value()
        };
        let (spin, accel) = match goal {
            Goal::Clear => tap.halt.slow,
            Goal::Bottom | Goal::End => tap.halt.on,
        };
        let blend = Blend::new(from, to, spin.value(), accel.value());
        Self::Rejoining(blend, Time::ZERO, goal)
    }

    /// It stands.
    pub(crate) const fn is_standing(&self) -> bool {
        matches!(self, Self::Standing(..))
    }

    /// It stands where the tap is clear of the work.
    pub(crate) fn is_cleared(&self) -> bool {
        matches!(self, Self::Standing(Course::Again(blend, Goal::Clear), s)
            if (s.value() - blend.end()).abs() < THERE)
    }

    /// It goes out, or did before it stopped.
    pub(crate) const fn is_outward(&self) -> bool {
        let goal = match self {
            Self::Stopping(Course::In, _) | Self::Standing(Course::In, _) => return false,
            Self::Stopping(Course::Out, _) | Self::Standing(Course::Out, _) => return true,
            Self::Stopping(Course::Again(_, goal), _)
            | Self::Standing(Course::Again(_, goal), _)
            | Self::Rejoining(_, _, goal) => goal,
        };
        !matches!(goal, Goal::Bottom)
    }

    /// How the master shall turn, `ahead` from now.
    pub(crate) fn rotation<S: Stroke>(
        &self,
        tap: &Tap<S>,
        coupling: &Coupling,
        ahead: Time,
    ) -> Rotation {
        let (s, v, a) = match self {
            Self::Standing(_, s) => (s.value(), 0.0, 0.0),
            Self::Rejoining(blend, at, _) => {
                let point = blend.at((*at + ahead).value());
                (point.s, point.v, point.a)
            }
            Self::Stopping(course, braking) => {
                let (point, way) = (plan(*course, tap, braking.at), way(*course));
                let (turned, v, a) = braking.ahead(ahead.value());
                (place(*course, tap, &point) + turned * way, v * way, a * way)
            }
        };
        let sense = sense(tap);
        Rotation {
            angle: origin(tap, coupling) + Angle::rev(s * sense),
            spin: Spin::rev_per_s(v * sense),
            accel: SpinAccel::rev_per_s2(a * sense),
        }
    }
}

impl Braking {
    /// Turned, speed and acceleration a moment later, as it goes on now.
    fn ahead(&self, t: f64) -> (f64, f64, f64) {
        let v = self.v + t * (self.a + t * self.jerk / 2.0);
        if v <= 0.0 {
            return (0.0, 0.0, 0.0);
        }
        let turned = t * (self.v + t * (self.a / 2.0 + t * self.jerk / 6.0));
        (turned, v, self.a + t * self.jerk)
    }
}

/// Slow down for a period.
fn stop<S: Stroke>(course: Course, braking: Braking, tap: &Tap<S>, h: Time) -> After {
    let Braking { at, v, a, .. } = braking;
    let (dt, most) = (h.value(), tap.halt.jerk.value());
    let let_go = libm::sqrt(2.0 * most * v);
    let wanted = -tap.halt.accel(v).min(let_go);
    let jerk = ((wanted - a) / dt).clamp(-most, most);
    let (a_next, v_next) = (a + jerk * dt, v + dt * (a + jerk * dt / 2.0));
    let planned = plan(course, tap, at);
    let over = |at: Time| {
        let s = place(course, tap, &plan(course, tap, at));
        After::Halting(Halting::Standing(course, Angle::rev(s)))
    };
    if v_next <= STANDS && a <= 0.0 || planned.spin.value() <= 0.0 && at.value() > 0.0 {
        return over(at);
    }
    let rate = f64::midpoint(v, v_next) / planned.spin.value().max(STANDS);
    let on = at + h * rate.min(1.0);
    if on >= duration(course, tap) {
        return match course {
            Course::Out | Course::Again(_, Goal::End) => After::End,
            Course::In | Course::Again(_, Goal::Bottom | Goal::Clear) => {
                over(duration(course, tap))
            }
        };
    }
    let there = plan(course, tap, on);
    if v_next >= there.spin.value() && there.accel.value() < 0.0 {
        // the plan brakes harder
        let braking = Braking {
            at: at + h,
            v: plan(course, tap, at + h).spin.value(),
            a: there.accel.value(),
            jerk: 0.0,
        };
        return After::Halting(Halting::Stopping(course, braking));
    }
    After::Halting(Halting::Stopping(course, Braking { at: on, v: v_next, a: a_next, jerk }))
}

/// The stroke that is being left: magnitudes along its way.
fn plan<S: Stroke>(course: Course, tap: &Tap<S>, at: Time) -> StrokePoint {
    match course {
        Course::In => tap.inward.at(at),
        Course::Out => tap.outward.at(at),
        Course::Again(blend, _) => {
            let (point, from) = (blend.at(at.value()), blend.at(0.0).s);
            let sign = way(course);
            StrokePoint {
                turned: Angle::rev((point.s - from) * sign),
                spin: Spin::rev_per_s(point.v * sign),
                accel: SpinAccel::rev_per_s2(point.a * sign),
            }
        }
    }
}

fn duration<S: Stroke>(course: Course, tap: &Tap<S>) -> Time {
    match course {
        Course::In => tap.inward.duration(),
        Course::Out => tap.outward.duration(),
        Course::Again(blend, _) => Time::s(blend.duration_s()),
    }
}

/// +1 inwards, −1 outwards.
fn way(course: Course) -> f64 {
    match course {
        Course::In => 1.0,
        Course::Out => -1.0,
        Course::Again(blend, _) => {
            if blend.end() < blend.at(0.0).s {
                -1.0
            } else {
                1.0
            }
        }
    }
}

/// s of a point of the stroke.
fn place<S: Stroke>(course: Course, tap: &Tap<S>, point: &StrokePoint) -> f64 {
    match course {
        Course::In => point.turned.value(),
        Course::Out => (tap.inward.length() - point.turned).value(),
        Course::Again(blend, _) => blend.at(0.0).s + point.turned.value() * way(course),
    }
}

/// s of a goal.
fn turns<S: Stroke>(tap: &Tap<S>, coupling: &Coupling, goal: Goal) -> f64 {
    match goal {
        Goal::Bottom => tap.inward.length().value(),
        Goal::End => (tap.inward.length() - tap.outward.length()).value(),
        Goal::Clear => {
            let from = coupling.phase_difference(Angle::ZERO, tap.start);
            (coupling.phase_difference(Angle::ZERO, tap.halt.clear) - from).value() * sense(tap)
        }
    }
}

/// Angle of the master at s = 0.
fn origin<S: Stroke>(tap: &Tap<S>, coupling: &Coupling) -> Angle {
    coupling.phase_difference(Angle::ZERO, tap.start)
}

/// +1 when the spindle turns in its positive sense inwards, else −1.
pub(crate) fn sense<S>(tap: &Tap<S>) -> f64 {
    if tap.spin < Spin::ZERO { -1.0 } else { 1.0 }
}
