//! The rigid tap (G84, G74, G33.1): in along the coupling, back along the same coupling.
//!
//! ```text
//!             spindle at rest       held at the start angle              inward stroke over
//!   AwaitRest ───────┬────► Orient ───────────────────────► In ───────────────────────► Bottom
//!                    │ encoder-following                    ▲                              │ dwell over
//!                    └────► StepOn ─────────────────────────┘                              ▼
//!                            axis on the coupling                                         Out
//!                                                                       outward stroke over │
//!                             Done ◄──── Leave ◄─────────── RunDown ◄───────────────────────┤
//!                                at start      at rest         encoder-following            │
//!                              ▲                                                            │
//!                              └────────────────────────────────────────────────────────────┘
//! ```
//!
//! From `In`, `Bottom` and `Out` a stop leads to `Halted`, which stays on the coupling
//! ([`Halting`]).
//!
//! From `In` to `Out` the axis obeys one [`Coupling`]; only the spindle's order changes, so
//! reversal needs no special case. *Command-synchronised*, spindle and axis obey the planned
//! strokes θ(t), and the depth is met because the plan ends there. *Encoder-following*, the spindle
//! only obeys a speed: the stroke's clock waits at the top speed until the turns that are left are
//! the turns that braking takes (the predicted stopping angle, ω²/2a for a constant a), then runs
//! on. The order to turn back thus comes early, and the depth is met instead of overrun. A spindle
//! whose drive makes its own ramps is only [told](crate::told) speeds: its strokes are no planned
//! strokes at all.
//!
//! | symbol | meaning |
//! |---|---|
//! | clock | time within the stroke |
//! | s | revolutions done in the stroke, magnitude |
use units::{Accel, Angle, Lead, Length, Speed, Spin, SpinAccel, Time};

use crate::halting::{After, sense};
use crate::strokes::{Leg, Stroke, planned};
use crate::told::{Spoken, Told};
use crate::{Blend, Coupling, Course, Follower, Halt, Halting, Rotation};

/// What to tap. Coordinates are those of the following axis.
#[derive(Debug, PartialEq)]
pub struct Tap<'a, S> {
    /// Axis travel per revolution of the spindle in its positive sense.
    pub lead: Lead,
    /// Where the coupling is engaged and left.
    pub start: Length,
    /// Where the spindle turns back.
    pub bottom: Length,
    /// Where it is over: the start, or short of it where the next peck goes on.
    pub end: Length,
    /// The spindle's sense inwards: only the sign counts.
    pub spin: Spin,
    /// In.
    pub inward: &'a S,
    /// Wait at the bottom.
    pub dwell: Time,
    /// Out.
    pub outward: &'a S,
    /// Angle within a turn that belongs to `start`; `None`: wherever the spindle stands.
    pub start_angle: Option<Angle>,
    /// The axis obeys the encoder and the spindle only a speed.
    pub encoder_following: bool,
    /// Turns by which an encoder-following spindle is braked earlier than planned: what it overran
    /// before.
    pub early: Angle,
    /// Its drive makes its own ramps.
    pub spoken: Option<Spoken>,
    /// Limits of the small moves onto the coupling and off it.
    pub approach: (Speed, Accel),
    /// How it is stopped on the way.
    pub halt: Halt,
}

/// What the cycle is told each period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Time since the last one.
    pub elapsed: Time,
    /// The measured master, predicted for the moment the setpoint is for.
    pub master: Rotation,
    /// The same as a follower obeys it: more smoothly, perhaps.
    pub followed: Rotation,
    /// The spindle stands.
    pub at_rest: bool,
    /// The angle at which the spindle is held, once it is held where it was asked to be.
    pub held: Option<Angle>,
    /// It shall come to rest, and stay so.
    pub rest: bool,
    /// Once it stands, it shall come out of the work.
    pub out: bool,
}

/// What the cycle asks of the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ask {
    /// Come to rest.
    Rest,
    /// Hold an angle: the one within a turn, or wherever it stands.
    Hold(Option<Angle>),
    /// Obey this angle.
    Angle(Rotation),
    /// Obey this speed; the angle is free.
    Speed(Rotation),
}

/// What the cycle is about, for people and reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Waiting for the spindle to stand, or to be oriented.
    Prepare,
    /// Going in.
    In,
    /// Standing at the bottom.
    Bottom,
    /// Coming out.
    Out,
    /// Over.
    Done,
}

/// Time within a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    at: Time,
    /// Where the clock waits for the turns that are left to be those that braking takes.
    wait_at: Option<Time>,
}

/// Where the cycle stands. Each state holds what is true in it, and no more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cycle {
    /// Waiting for the spindle to stand.
    AwaitRest,
    /// Turning the spindle to the start angle.
    Orient,
    /// Stepping the axis onto the coupling of a spindle that cannot be turned to an angle.
    StepOn(Coupling, Blend, Time),
    /// Going in.
    In(Coupling, Clock),
    /// Standing at the bottom since the time given.
    Bottom(Coupling, Time),
    /// Coming out.
    Out(Coupling, Clock),
    /// Stopped on the way, on the coupling.
    Halted(Coupling, Halting),
    /// In, and out again, on the ramps of the spindle's own drive.
    Told(Coupling, Told),
    /// Following until the spindle stands.
    RunDown(Coupling),
    /// Bringing the axis from where the spindle left it to the end.
    Leave(Blend, Time),
    /// Over.
    Done,
}

impl Cycle {
    /// The cycle's beginning.
    pub const fn new() -> Self {
        Self::AwaitRest
    }

    /// The state after this period. One arm per arrow in the picture.
    #[must_use]
    pub fn next<S: Stroke>(self, tap: &Tap<S>, tick: &Tick) -> Self {
        match self {
            Self::AwaitRest if !tick.at_rest || tick.rest => self,
            Self::AwaitRest if tap.encoder_following => step_on(tap, tick.followed.angle),
            Self::AwaitRest => Self::Orient,
            Self::Orient if tick.rest => self,
            Self::Orient => tick.held.map_or(self, |angle| {
                Self::In(Coupling::line(tap.lead, angle, tap.start), clock(tap, tap.inward))
            }),
            Self::StepOn(coupling, blend, at) => {
                let at = at + tick.elapsed;
                if at.value() < blend.duration_s() {
                    return Self::StepOn(coupling, blend, at);
                }
                if tap.spoken.is_some() {
                    return Self::Told(coupling, Told::In);
                }
                Self::In(coupling, clock(tap, tap.inward))
            }
            Self::In(coupling, clock) if tick.rest => clock.halt(Course::In, tap, coupling, tick),
            Self::In(coupling, clock) => {
                let left = turns_left(tap, &coupling, tap.bottom, tick, 1.0) - tap.early;
                let clock = clock.advance(tap.inward, tick, left);
                let over = clock.at - tap.inward.duration();
                if over < Time::ZERO {
                    return Self::In(coupling, clock);
                }
                bottom(tap, coupling, over)
            }
            Self::Bottom(coupling, _) if tick.rest => {
                let s = tap.inward.length();
                halted(tap, coupling, Halting::Standing(Course::In, s), tick)
            }
            Self::Bottom(coupling, waited) => bottom(tap, coupling, waited + tick.elapsed),
            Self::Out(coupling, clock) if tick.rest => clock.halt(Course::Out, tap, coupling, tick),
            Self::Halted(coupling, halting) => halted(tap, coupling, halting, tick),
            Self::Out(coupling, clock) => {
                let left = turns_left(tap, &coupling, tap.end, tick, -1.0);
                let clock = clock.advance(tap.outward, tick, left);
                if clock.at < tap.outward.duration() {
                    Self::Out(coupling, clock)
                } else if tap.encoder_following {
                    Self::RunDown(coupling)
                } else {
                    Self::Done
                }
            }
            Self::Told(coupling, told) => {
                tap.spoken.map_or(self, |spoken| told.next(coupling, tap, &spoken, tick))
            }
            Self::RunDown(coupling) if tick.at_rest => {
                let z = coupling.position(tick.followed.angle);
                Self::Leave(at_approach_speed(tap, z, tap.end), Time::ZERO)
            }
            Self::RunDown(_) | Self::Done => self,
            Self::Leave(blend, at) if (at + tick.elapsed).value() < blend.duration_s() => {
                Self::Leave(blend, at + tick.elapsed)
            }
            Self::Leave(..) => Self::Done,
        }
    }

    /// What the spindle shall do, `ahead` of the present setpoint.
    pub fn ask<S: Stroke>(&self, tap: &Tap<S>, ahead: Time) -> Ask {
        let (coupling, leg, (time, waits)) = match *self {
            Self::AwaitRest | Self::StepOn(..) | Self::RunDown(_) | Self::Leave(..) => {
                return Ask::Rest;
            }
            Self::Told(_, told) => {
                return tap.spoken.map_or(Ask::Rest, |spoken| told.ask(tap, &spoken));
            }
            Self::Orient => return Ask::Hold(tap.start_angle),
            Self::Done if tap.encoder_following => return Ask::Rest,
            Self::Done => return Ask::Hold(None),
            Self::In(coupling, clock) => (coupling, Leg::In, clock.seen(ahead)),
            Self::Bottom(coupling, waited) => (coupling, Leg::Bottom, (waited + ahead, false)),
            Self::Out(coupling, clock) => (coupling, Leg::Out, clock.seen(ahead)),
            Self::Halted(coupling, halting) => {
                let rotation = halting.rotation(tap, &coupling, ahead);
                let by_speed = tap.encoder_following;
                return if by_speed { Ask::Speed(rotation) } else { Ask::Angle(rotation) };
            }
        };
        let mut rotation = planned(tap, &coupling, leg, time);
        if waits {
            // the profile already brakes at this time; the spindle shall not yet
            rotation.accel = SpinAccel::ZERO;
        }
        if tap.encoder_following { Ask::Speed(rotation) } else { Ask::Angle(rotation) }
    }

    /// Where the axis shall be, and how it moves. `master` is what it obeys: the order given to the
    /// spindle, or the predicted reading.
    pub fn axis<S: Stroke>(&self, tap: &Tap<S>, master: Rotation) -> Follower {
        match self {
            Self::AwaitRest | Self::Orient => {
                Follower { position: tap.start, ..Follower::default() }
            }
            Self::Done => Follower { position: tap.end, ..Follower::default() },
            Self::StepOn(_, blend, at) | Self::Leave(blend, at) => {
                let point = blend.at(at.value());
                Follower {
                    position: Length::mm(point.s),
                    speed: Speed::mm_per_s(point.v),
                    accel: Accel::mm_per_s2(point.a),
                }
            }
            Self::In(coupling, _)
            | Self::Bottom(coupling, _)
            | Self::Out(coupling, _)
            | Self::Halted(coupling, _)
            | Self::Told(coupling, _)
            | Self::RunDown(coupling) => coupling.follow(master),
        }
    }

    /// The coupling, while one is engaged.
    pub const fn coupling(&self) -> Option<Coupling> {
        match *self {
            Self::In(coupling, _)
            | Self::Bottom(coupling, _)
            | Self::Out(coupling, _)
            | Self::Halted(coupling, _)
            | Self::Told(coupling, _)
            | Self::RunDown(coupling) => Some(coupling),
            Self::AwaitRest | Self::Orient | Self::StepOn(..) | Self::Leave(..) | Self::Done => {
                None
            }
        }
    }

    /// How far the planned strokes have gone: in, and on from there out. `None` outside of them.
    pub fn moment<S: Stroke>(&self, tap: &Tap<S>) -> Option<Time> {
        match self {
            Self::In(_, clock) => Some(clock.at),
            Self::Bottom(..) => Some(tap.inward.duration()),
            Self::Out(_, clock) => Some(tap.inward.duration() + clock.at),
            Self::AwaitRest
            | Self::Orient
            | Self::StepOn(..)
            | Self::Halted(..)
            | Self::Told(..)
            | Self::RunDown(_)
            | Self::Leave(..)
            | Self::Done => None,
        }
    }

    /// Turns by which this stroke has shown the stopping angle to be longer than by the machine's
    /// file.
    pub const fn taught(&self) -> Option<Angle> {
        match self {
            Self::Told(_, told) => told.taught(),
            Self::AwaitRest
            | Self::Orient
            | Self::StepOn(..)
            | Self::In(..)
            | Self::Bottom(..)
            | Self::Out(..)
            | Self::Halted(..)
            | Self::RunDown(_)
            | Self::Leave(..)
            | Self::Done => None,
        }
    }

    /// It was taken out after a stop, and stands where the tap is clear of the work.
    pub fn is_cleared(&self) -> bool {
        match self {
            Self::Halted(_, halting) => halting.is_cleared(),
            Self::Told(_, told) => told.is_cleared(),
            _ => false,
        }
    }

    /// It was stopped, and stands.
    pub const fn is_standing(&self) -> bool {
        match self {
            Self::Halted(_, halting) => halting.is_standing(),
            Self::Told(_, told) => told.is_standing(),
            Self::AwaitRest
            | Self::Orient
            | Self::StepOn(..)
            | Self::In(..)
            | Self::Bottom(..)
            | Self::Out(..)
            | Self::RunDown(_)
            | Self::Leave(..)
            | Self::Done => false,
        }
    }

    /// What it is about.
    pub const fn phase(&self) -> Phase {
        match self {
            Self::AwaitRest | Self::Orient | Self::StepOn(..) => Phase::Prepare,
            Self::In(..) => Phase::In,
            Self::Bottom(..) => Phase::Bottom,
            Self::Told(_, told) => told.phase(),
            Self::Halted(_, halting) if !halting.is_outward() => Phase::In,
            Self::Halted(..) | Self::Out(..) | Self::RunDown(_) | Self::Leave(..) => Phase::Out,
            Self::Done => Phase::Done,
        }
    }
}

impl Default for Cycle {
    fn default() -> Self {
        Self::new()
    }
}

impl Clock {
    /// A stop begins.
    fn halt<S: Stroke>(
        self,
        course: Course,
        tap: &Tap<S>,
        coupling: Coupling,
        tick: &Tick,
    ) -> Cycle {
        let (at, waits) = self.seen(Time::ZERO);
        halted(tap, coupling, Halting::leave(course, tap, at, waits), tick)
    }

    /// A period later. While it waits, `turns_left` decides.
    fn advance<S: Stroke>(self, stroke: &S, tick: &Tick, turns_left: Angle) -> Self {
        let at = self.at + tick.elapsed;
        let Some(brake) = self.wait_at else { return Self { at, wait_at: None } };
        let braking = stroke.length() - stroke.at(brake).turned;
        if turns_left > braking {
            return Self { at: at.min(brake), wait_at: Some(brake) };
        }
        // The moment fell between two periods: the clock goes on as if it had been hit exactly.
        let spin = tick.master.spin.abs();
        let late = if spin > Spin::ZERO { (braking - turns_left) / spin } else { Time::ZERO };
        Self { at: brake + late.min(tick.elapsed), wait_at: None }
    }

    /// The time that will be seen a while later, and whether it waits there.
    fn seen(self, ahead: Time) -> (Time, bool) {
        let at = self.at + ahead;
        match self.wait_at {
            Some(brake) if at >= brake => (brake, true),
            Some(_) | None => (at, false),
        }
    }
}

/// A clock for a stroke: one that waits for the encoder, or one that only runs.
fn clock<S: Stroke>(tap: &Tap<S>, stroke: &S) -> Clock {
    Clock { at: Time::ZERO, wait_at: tap.encoder_following.then(|| stroke.brake()) }
}

/// At the bottom since a while: still there, or on the way out.
fn bottom<S: Stroke>(tap: &Tap<S>, coupling: Coupling, waited: Time) -> Cycle {
    if waited < tap.dwell {
        return Cycle::Bottom(coupling, waited);
    }
    let fresh = clock(tap, tap.outward);
    Cycle::Out(coupling, Clock { at: waited - tap.dwell, ..fresh })
}

/// A stop on the coupling goes on for a period.
fn halted<S: Stroke>(tap: &Tap<S>, coupling: Coupling, halting: Halting, tick: &Tick) -> Cycle {
    match halting.next(tap, &coupling, tick) {
        After::Halting(halting) => Cycle::Halted(coupling, halting),
        After::Bottom => bottom(tap, coupling, Time::ZERO),
        After::End if tap.encoder_following => Cycle::RunDown(coupling),
        After::End => Cycle::Done,
    }
}

/// Turns of the master until the follower's place is reached; `leg` is +1 inwards, −1 outwards.
fn turns_left<S>(tap: &Tap<S>, coupling: &Coupling, to: Length, tick: &Tick, leg: f64) -> Angle {
    coupling.phase_difference(tick.master.angle, to) * (sense(tap) * leg)
}

/// Step the axis onto the coupling of a resting spindle, off the work by less than one lead.
fn step_on<S: Stroke>(tap: &Tap<S>, angle: Angle) -> Cycle {
    let sense = sense(tap);
    let ahead = tap.start_angle.map_or(0.0, |start| {
        let turns = (start - angle).value() * sense;
        turns - libm::floor(turns)
    });
    let coupling = Coupling::line(tap.lead, angle + Angle::rev(sense * ahead), tap.start);
    Cycle::StepOn(coupling, at_approach_speed(tap, tap.start, coupling.position(angle)), Time::ZERO)
}

fn at_approach_speed<S>(tap: &Tap<S>, from: Length, to: Length) -> Blend {
    let (speed, accel) = tap.approach;
    Blend::new(from.value(), to.value(), speed.value(), accel.value())
}

#[cfg(test)]
#[path = "tapping_tests.rs"]
mod tests;
