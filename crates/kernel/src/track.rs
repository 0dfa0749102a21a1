//! What is followed: a step that moves along a path, and the steps into which it goes on.
//!
//! ```text
//!   queue  │ Follow │ Follow │ Follow ▌ Tap │ …        planned time runs on from step to step, to the next rest
//!              ▲ now ──────────────► ▲ known
//! ```
use crate::queue::{Queue, StepKind};
use crate::time_scaling::{Motion, PlannedPoint};
use motion::{AXES, Shape};
use motion::{Follow, Move, coordinate};
use units::{Coordinate, CoordinateSpeed, Position};

/// What is followed.
#[derive(Clone, Copy)]
pub(crate) enum Track<'a> {
    /// From rest to rest.
    Move(&'a Move),
    /// On from the step before, and into the next.
    Follow(&'a Follow),
}

/// Where the axes shall be, and their speeds, accelerations and jerks at the full rate, per second.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rates {
    pub(crate) q: [f64; AXES],
    pub(crate) v: [f64; AXES],
    pub(crate) a: [f64; AXES],
    pub(crate) j: [f64; AXES],
}

/// Planned motion from a place in the queue's front step on, to the next rest or to the last step
/// that is known.
#[derive(Clone, Copy)]
pub(crate) struct Ahead<'a> {
    steps: &'a Queue,
    index: usize,
    track: Track<'a>,
    /// Planned time of the step.
    at: f64,
    /// Planned time per second at the full rate: revolutions, for a feed per revolution.
    pace: f64,
}

impl<'a> Track<'a> {
    /// Of a step that moves along a path.
    pub(crate) const fn of(kind: &StepKind<'a>) -> Option<Self> {
        match kind {
            StepKind::Move(order) | StepKind::Probe { order, .. } => Some(Self::Move(order)),
            StepKind::Follow(order) => Some(Self::Follow(order)),
            _ => None,
        }
    }

    pub(crate) fn duration(self) -> f64 {
        match self {
            Self::Move(order) => order.profile.duration(),
            Self::Follow(order) => order.duration(),
        }
    }

    pub(crate) fn per_revolution(self) -> bool {
        match self {
            Self::Move(order) => order.per_revolution,
            Self::Follow(order) => order.per_revolution,
        }
    }

    pub(crate) fn rapid(self) -> bool {
        match self {
            Self::Move(order) => order.rapid,
            Self::Follow(order) => order.piece.rapid,
        }
    }

    /// Share of the programmed feed that it was planned for.
    pub(crate) fn share(self) -> f64 {
        match self {
            Self::Follow(order) if !order.piece.rapid => order.pace.share,
            Self::Move(_) | Self::Follow(_) => 1.0,
        }
    }

    pub(crate) fn floats(self) -> bool {
        match self {
            Self::Move(order) => order.floats,
            Self::Follow(_) => false,
        }
    }

    /// At planned time `t`; `n`: planned time per second.
    pub(crate) fn rates(self, t: f64, n: f64, ahead: f64) -> Rates {
        match self {
            Self::Move(order) => along(order, t, n, ahead),
            Self::Follow(order) => {
                let (s, v, a, j) = order.at(t);
                let (v, a, j) = (v * n, a * n * n, j * n * n * n);
                let d = order.piece.at(s);
                let mut rates = Rates { q: d.q, ..Rates::default() };
                for i in 0..AXES {
                    rates.v[i] = d.q1[i] * v;
                    rates.a[i] = d.q1[i] * a + d.q2[i] * v * v;
                    rates.j[i] = d.q1[i] * j + 3.0 * d.q2[i] * v * a + d.q3[i] * v * v * v;
                }
                rates
            }
        }
    }

    /// It ends at rest.
    pub(crate) const fn rests(self) -> bool {
        match self {
            Self::Move(order) => order.rests(),
            Self::Follow(order) => order.exact_stop,
        }
    }

    /// Where it begins.
    pub(crate) fn begins(self) -> [f64; AXES] {
        match self {
            Self::Move(order) => point(order.path.from()),
            Self::Follow(order) => order.piece.at(order.phases[0].s).q,
        }
    }

    /// Whether an axis goes anywhere.
    pub(crate) fn moves(self, index: usize) -> bool {
        match self {
            Self::Move(order) => point(order.path.from())[index] != point(order.path.to())[index],
            Self::Follow(order) => {
                let length = order.piece.length();
                order.piece.at(0.0).q[index] != order.piece.at(length).q[index]
            }
        }
    }
}

/// A move with its own profile; its jerk is what the acceleration becomes a moment ahead.
fn along(order: &Move, t: f64, n: f64, ahead: f64) -> Rates {
    let motion = |t: f64| {
        let mut at = order.profile.at(t);
        (at.v, at.a) = (at.v * n, at.a * n * n);
        order.path.motion(at)
    };
    let (now, then) = (motion(t), motion(t + ahead * n));
    let mut rates = Rates::default();
    for i in 0..AXES {
        rates.q[i] = now.position[i].value();
        rates.v[i] = now.speed[i].value();
        rates.a[i] = now.accel[i].value();
        rates.j[i] = (then.accel[i].value() - now.accel[i].value()) / ahead;
    }
    rates
}

impl<'a> Ahead<'a> {
    /// From a planned time of the step at this place of the queue, if it is one that moves.
    pub(crate) fn new(steps: &'a Queue, index: usize, at: f64, pace: f64) -> Option<Self> {
        let track = Track::of(&steps.get(index)?.kind)?;
        Some(Self { steps, index, track, at, pace })
    }
}

impl Motion for Ahead<'_> {
    fn pass(&mut self, time: f64) -> bool {
        self.at += time;
        loop {
            let over = self.at - self.track.duration();
            if over < 0.0 || self.track.rests() {
                return true;
            }
            let next = self.steps.get(self.index + 1).map(|step| step.kind);
            let Some(StepKind::Follow(next)) = next else { return false };
            (self.index, self.track, self.at) = (self.index + 1, Track::Follow(next), over);
        }
    }

    fn place(&self) -> PlannedPoint {
        let rapid = self.track.rapid();
        match self.track {
            Track::Move(order) => {
                let mut at = order.profile.at(self.at);
                at.v *= self.pace;
                let motion = order.path.motion(at);
                let (q, v) = (
                    motion.position.map(Coordinate::value),
                    motion.speed.map(CoordinateSpeed::value),
                );
                PlannedPoint { q, v, rapid }
            }
            Track::Follow(order) => {
                let (s, speed, ..) = order.at(self.at);
                let at = order.piece.at(s);
                PlannedPoint { q: at.q, v: at.q1.map(|slope| slope * speed * self.pace), rapid }
            }
        }
    }
}

pub(crate) fn point(position: &Position) -> [f64; AXES] {
    units::Axis::ALL.map(|axis| coordinate(position, axis))
}
