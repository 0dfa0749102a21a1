//! Moving along a planned path.
//!
//! ```text
//!   clock ──► tempo (overrides, hold) ──► planned time ──► profile or phases: s, ṡ, s̈, s⃛ ──► path: every axis
//!             or turns of the spindle, G95
//! ```
//!
//! A [`Move`] goes from rest to rest with its own profile. [`Follow`] steps go on into one another: each brings a piece of
//! the joined path and the phases along it. For a feed per revolution planned time is revolutions, and all rates are
//! per revolution: v = v′·|ω|, a = a′·ω², j = j′·|ω|³.
use crate::config::Subject;
use crate::drives::{Drives, Finding, MOVING};
use crate::fault::FaultKind;
use crate::operator::Operator;
use crate::spindle::SpindleLoop;
use crate::tempo::{Rates, Tempo};
use canon::Position;
use path::{AXES, Limits, Shape};
use plan::{Follow, Move, StepKind, coordinate};

/// A step may begin this far from where the axis stands, mm; the difference is smoothed away.
pub(crate) const JUMP_MM: f64 = 0.050;

/// What is followed.
#[derive(Clone, Copy)]
pub(crate) enum Track<'a> {
    /// From rest to rest.
    Move(&'a Move),
    /// On from the step before, and into the next.
    Follow(&'a Follow),
}

/// A move under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving {
    /// Planned seconds or revolutions done.
    at: f64,
    /// Where the spindle stood at the start, for moves per revolution, and how far it has turned.
    origin_rev: f64,
    turned_rev: f64,
    held: bool,
}

/// Where the axes shall be, and their rates at full tempo.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    q: [f64; AXES],
    rates: Rates,
}

impl<'a> Track<'a> {
    /// Of a step that moves along a path.
    pub(crate) const fn of(kind: &'a StepKind) -> Option<Self> {
        match kind {
            StepKind::Move(order) => Some(Self::Move(order)),
            StepKind::Follow(order) => Some(Self::Follow(order)),
            _ => None,
        }
    }

    fn duration(self) -> f64 {
        match self {
            Self::Move(order) => order.profile.duration(),
            Self::Follow(order) => order.duration(),
        }
    }

    fn per_revolution(self) -> bool {
        match self {
            Self::Move(order) => order.per_revolution,
            Self::Follow(order) => order.per_revolution,
        }
    }

    fn rapid(self) -> bool {
        match self {
            Self::Move(order) => order.rapid,
            Self::Follow(order) => order.piece.rapid,
        }
    }

    /// Share of the programmed feed that it was planned for.
    fn share(self) -> f64 {
        match self {
            Self::Follow(order) if !order.piece.rapid => order.pace.share,
            Self::Move(_) | Self::Follow(_) => 1.0,
        }
    }

    fn floats(self) -> bool {
        match self {
            Self::Move(order) => order.floats,
            Self::Follow(_) => false,
        }
    }

    fn exact_stop(self) -> bool {
        match self {
            Self::Move(order) => order.exact_stop,
            Self::Follow(order) => order.exact_stop,
        }
    }

    /// At planned time `t`; `n`: planned time per second.
    fn place(self, t: f64, n: f64, ahead: f64) -> Place {
        match self {
            Self::Move(order) => along(order, t, n, ahead),
            Self::Follow(order) => {
                let (s, v, a, j) = order.at(t);
                let (v, a, j) = (v * n, a * n * n, j * n * n * n);
                let d = order.piece.at(s);
                let mut place = Place { q: d.q, ..Place::default() };
                for i in 0..AXES {
                    place.rates.v[i] = d.q1[i] * v;
                    place.rates.a[i] = d.q1[i] * a + d.q2[i] * v * v;
                    place.rates.j[i] = d.q1[i] * j + 3.0 * d.q2[i] * v * a + d.q3[i] * v * v * v;
                }
                place
            }
        }
    }

    /// Where it begins.
    fn begins(self) -> [f64; AXES] {
        match self {
            Self::Move(order) => point(order.path.from()),
            Self::Follow(order) => order.piece.at(order.phases[0].s).q,
        }
    }

    /// Whether an axis goes anywhere.
    fn moves(self, index: usize) -> bool {
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
fn along(order: &Move, t: f64, n: f64, ahead: f64) -> Place {
    let motion = |t: f64| {
        let mut at = order.profile.at(t);
        (at.v, at.a) = (at.v * n, at.a * n * n);
        order.path.motion(at)
    };
    let (now, then) = (motion(t), motion(t + ahead * n));
    let mut place = Place::default();
    for i in 0..AXES {
        place.q[i] = now.position[i].value();
        place.rates.v[i] = now.speed[i].value();
        place.rates.a[i] = now.accel[i].value();
        place.rates.j[i] = (then.accel[i].value() - now.accel[i].value()) / ahead;
    }
    place
}

impl Moving {
    /// It stands by the operator's hold, somewhere along its path.
    pub(crate) const fn is_held(&self) -> bool {
        self.held
    }

    /// Begin, if the axes stand where the move begins.
    pub(crate) fn begin(track: Track, drives: &mut Drives) -> Result<Self, Finding> {
        stand_at(&track.begins(), drives)?;
        for index in MOVING {
            if track.moves(index) && drives.axes[index].is_none() {
                let of = Subject::Axis(canon::Axis::ALL[index]);
                return Err((FaultKind::NotConfigured, of, 0.0, 0.0));
            }
        }
        let origin_rev = match &drives.spindles[0] {
            Some(spindle) => spindle.now().angle.value(),
            None if track.per_revolution() => {
                return Err((FaultKind::NotConfigured, Subject::Spindle(0), 0.0, 0.0));
            }
            None => 0.0,
        };
        Ok(Self { at: 0.0, origin_rev, turned_rev: 0.0, held: false })
    }

    /// Go on for `dt` seconds; the seconds that were left over when it is done.
    pub(crate) fn advance(
        &mut self,
        track: Track,
        dt: f64,
        drives: &mut Drives,
        (operator, limits): (&Operator, &Limits),
    ) -> Option<f64> {
        let ahead = drives.lookahead_s();
        let acts = track.rapid() || drives.overridden;
        let share = if acts { operator.share(track.rapid()) } else { 1.0 } / track.share();
        let wanted = if operator.wants_rest() { 0.0 } else { share.min(1.0) };
        let mut passing = dt;
        let mut n = 1.0;
        if track.per_revolution() {
            let now = drives.spindles[0].as_ref().map_or_else(Default::default, SpindleLoop::now);
            let turned = (now.angle.value() - self.origin_rev).abs().max(self.turned_rev);
            passing = turned - self.turned_rev;
            self.turned_rev = turned;
            n = now.spin.value().abs();
        }
        let starts = self.at == 0.0 && !drives.flowing;
        if starts && drives.tempo.rate != wanted {
            drives.tempo.rest(wanted); // from rest any tempo will do
        }
        let was = drives.tempo;
        let before = was.rate;
        let bounds = if track.rapid() { &limits.rapid } else { &limits.feed };
        if !drives.tempo.is_steady(wanted) {
            let place = track.place(self.at + passing * before, n, ahead);
            drives.tempo.advance(wanted, &place.rates, bounds, dt);
        }
        let rate = drives.tempo.rate;
        self.at += passing * f64::midpoint(before, rate);
        let over = self.at - track.duration();
        if over >= 0.0 {
            drives.flowing = !track.exact_stop() && !matches!(track, Track::Move(_));
            let place = track.place(track.duration(), n, ahead);
            set(&place, &Tempo::FULL, drives);
            drives.rest_axes();
            if track.per_revolution() {
                return Some(0.0);
            }
            let (left, tempo) = was.before(&drives.tempo, over, dt);
            drives.tempo = tempo;
            return Some(left);
        }
        self.held = wanted == 0.0 && drives.tempo.stands();
        drives.flowing = true;
        let place = track.place(self.at, n, ahead);
        drives.tempo.arrive(&place.rates, bounds);
        let tempo = drives.tempo;
        set(&place, &tempo, drives);
        None
    }

    /// Planned time that is done; `None`: what is left cannot be planned anew.
    pub(crate) fn done(&self, track: Track) -> Option<f64> {
        match track {
            Track::Move(order) => order.programmed.map(|_| self.at),
            Track::Follow(_) => Some(self.at),
        }
    }

    /// Nothing cuts in a rapid; with a floating holder nothing is wrong.
    pub(crate) fn checks_cut(track: Track) -> bool {
        !track.rapid() && !track.floats()
    }
}

pub(crate) fn point(position: &Position) -> [f64; AXES] {
    canon::Axis::ALL.map(|axis| coordinate(position, axis))
}

/// The axes shall stand at a place to within [`JUMP_MM`]; what little is missing is smoothed away.
pub(crate) fn stand_at(place: &[f64; AXES], drives: &mut Drives) -> Result<(), Finding> {
    for index in MOVING {
        let Some(control) = &mut drives.axes[index] else { continue };
        let jump = place[index] - control.target.position;
        let on_the_way = drives.flowing;
        if jump.is_nan() || (jump.abs() > JUMP_MM && !on_the_way) {
            let of = Subject::Axis(canon::Axis::ALL[index]);
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

fn set(place: &Place, tempo: &Tempo, drives: &mut Drives) {
    for index in MOVING {
        let Some(axis) = &mut drives.axes[index] else { continue };
        let (v, a, j) = (place.rates.v[index], place.rates.a[index], place.rates.j[index]);
        let (v, a, j) = tempo.of(v, a, j);
        axis.target.position = place.q[index];
        axis.target.speed = v;
        axis.target.accel = a;
        axis.target.jerk = j;
    }
}
