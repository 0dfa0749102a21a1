//! Moving along a planned path.
//!
//! ```text
//!   clock ──► time scaling (overrides, hold) ──► planned time ──► profile or phases: s, ṡ, s̈, s⃛ ──► path: every axis
//!             or turns of the spindle, G95
//! ```
//!
//! A [`Move`] goes from rest to rest with its own profile. [`Follow`] steps go on into one another:
//! each brings a piece of the joined path and the phases along it. For a feed per revolution
//! planned time is revolutions, and all rates are per revolution: v = v′·|ω|, a = a′·ω², j =
//! j′·|ω|³.
use crate::config::{Config, Subject};
use crate::drives::{Drives, Finding, MOVING};
use crate::fault::FaultKind;
use crate::operator::Operator;
use crate::queue::Queue;
use crate::spindle::SpindleLoop;
use crate::time_scaling::Period;
use crate::track::{Ahead, Rates, Track};
use motion::{AXES, UnderWay};

/// A step may begin this far from where the axis stands, mm; the difference is smoothed away.
pub(crate) const JUMP_MM: f64 = 0.050;

/// A move under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving {
    /// Planned seconds or revolutions done.
    at: f64,
    held: bool,
    /// It shall come to rest where it can, and go no further.
    rests: bool,
}

/// How far a spindle has turned since moves per revolution began that go on into one another.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turned {
    origin_rev: f64,
    most_rev: f64,
}

impl Moving {
    /// It stands by the operator's hold, somewhere along its path.
    pub(crate) const fn is_held(&self) -> bool {
        self.held
    }

    /// Come to rest on the path as soon as the limits allow.
    pub(crate) const fn come_to_rest(&mut self) {
        self.rests = true;
    }

    /// Begin, if the axes stand where the move begins.
    pub(crate) fn begin(track: Track, drives: &mut Drives) -> Result<Self, Finding> {
        stand_at(&track.begins(), drives)?;
        for index in MOVING {
            if track.moves(index) && drives.axes[index].is_none() {
                let of = Subject::Axis(units::Axis::ALL[index]);
                return Err((FaultKind::NotConfigured, of, 0.0, 0.0));
            }
        }
        let origin_rev = match &drives.spindles[0] {
            Some(spindle) => spindle.master().angle.value(),
            None if track.per_revolution() => {
                return Err((FaultKind::NotConfigured, Subject::Spindle(0), 0.0, 0.0));
            }
            None => 0.0,
        };
        if !drives.flowing {
            drives.turned = Turned { origin_rev, most_rev: 0.0 };
        }
        Ok(Self { at: 0.0, held: false, rests: false })
    }

    /// Go on for `dt` seconds along the step at this place of the queue; the seconds that were left
    /// over when it is done.
    pub(crate) fn advance(
        &mut self,
        (steps, index): (&Queue, usize),
        dt: f64,
        drives: &mut Drives,
        (operator, config): (&Operator, &Config),
    ) -> Option<f64> {
        let Some(track) = steps.get(index).and_then(|step| Track::of(&step.kind)) else {
            return Some(dt);
        };
        let length = config.period.value();
        let wanted = if self.rests { 0.0 } else { wanted(track, drives, operator) };
        let (passing, pace) = passing(track, dt, drives);
        let passes = if let Some(owed) = drives.owed.take() {
            owed
        } else {
            if self.at == 0.0 && !drives.flowing {
                drives.time_scaling.begin(wanted, track.begins()); // from rest any rate will do
            }
            let period = Period { length, planned: pace * length };
            if let Some(ahead) = Ahead::new(steps, index, self.at, pace) {
                let beside = drives.beside(&config.motion);
                let limits = beside.as_ref().unwrap_or(&config.motion);
                drives.time_scaling.advance(wanted, ahead, limits, period);
            }
            passing * drives.time_scaling.rate()
        };
        self.at += passes;
        let over = self.at - track.duration();
        if over >= 0.0 {
            drives.flowing = !track.rests();
            set(&track.rates(track.duration(), pace, drives.lookahead_s()), length, drives);
            drives.rest_axes();
            drives.owed = drives.flowing.then_some(over);
            let left = if passes > 0.0 { dt * (over / passes).min(1.0) } else { 0.0 };
            return Some(if track.per_revolution() { 0.0 } else { left });
        }
        self.held = wanted == 0.0 && drives.time_scaling.stands();
        drives.flowing = true;
        let rates = track.rates(self.at, pace, drives.lookahead_s());
        set(&rates, length, drives);
        drives.time_scaling.reached(&rates.q, track.rapid());
        None
    }

    /// Planned time that is done; `None`: what is left cannot be planned anew.
    pub(crate) fn done(&self, track: Track) -> Option<f64> {
        match track {
            Track::Move(order) => order.programmed.map(|_| self.at),
            Track::Follow(_) => Some(self.at),
        }
    }

    /// The same, and how fast planned time passes at the full rate.
    pub(crate) fn under_way(&self, track: Track, drives: &Drives) -> Option<UnderWay> {
        let spin = drives.spindles[0].as_ref().map(|spindle| spindle.master().spin.value().abs());
        let pace = if track.per_revolution() { spin? } else { 1.0 };
        Some(UnderWay { done: self.done(track)?, pace })
    }

    /// Nothing cuts in a rapid; with a floating holder nothing is wrong.
    pub(crate) fn checks_cut(track: Track) -> bool {
        !track.rapid() && !track.floats()
    }
}

/// The axes shall stand at a place to within [`JUMP_MM`]; what little is missing is smoothed away.
pub(crate) fn stand_at(place: &[f64; AXES], drives: &mut Drives) -> Result<(), Finding> {
    for index in MOVING {
        let Some(control) = &mut drives.axes[index] else { continue };
        let jump = place[index] - control.target.position;
        let on_the_way = drives.flowing;
        if jump.is_nan() || (jump.abs() > JUMP_MM && !on_the_way) {
            let of = Subject::Axis(units::Axis::ALL[index]);
            return Err((FaultKind::SetpointJump, of, jump, JUMP_MM));
        }
    }
    if drives.flowing {
        return Ok(());
    }
    for index in MOVING {
        if let Some(control) = &mut drives.axes[index] {
            control.rebase(place[index]);
        }
    }
    Ok(())
}

/// Planned time that passes in so many seconds at the full rate, and that per second by the
/// spindle's speed.
fn passing(track: Track, dt: f64, drives: &mut Drives) -> (f64, f64) {
    if !track.per_revolution() {
        return (dt, 1.0);
    }
    let now = drives.spindles[0].as_ref().map_or_else(Default::default, SpindleLoop::master);
    let Turned { origin_rev, most_rev } = drives.turned;
    let turned = (now.angle.value() - origin_rev).abs().max(most_rev);
    drives.turned.most_rev = turned;
    (turned - most_rev, now.spin.value().abs())
}

/// The rate that the operator wants for a move.
fn wanted(track: Track, drives: &Drives, operator: &Operator) -> f64 {
    if operator.wants_rest() {
        return 0.0;
    }
    let acts = track.rapid() || drives.overridden;
    let share = if acts { operator.share(track.rapid()) } else { 1.0 };
    (share / track.share()).min(1.0)
}

fn set(rates: &Rates, period_s: f64, drives: &mut Drives) {
    let time_scaling = drives.time_scaling;
    for index in MOVING {
        let Some(axis) = &mut drives.axes[index] else { continue };
        let (v, a, j) = time_scaling.of(rates.v[index], rates.a[index], rates.j[index], period_s);
        axis.target.position = rates.q[index];
        axis.target.speed = v;
        axis.target.accel = a;
        axis.target.jerk = j;
    }
}
