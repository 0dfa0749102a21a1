//! Moves that are run through without a stop: joined into one path, with one law of time along it.
//!
//! ```text
//!   moves ─► Joiner ─► pieces ─► Law ─► phases ─► Follow steps, as soon as nothing that comes can change them
//!                          └───────────────────────┘
//! ```
//!
//! A move that stays alone between two stops is a [`Move`] with its own profile, as before: it needs no joining.
use crate::limits::MachineLimits;
use crate::motion::Along;
use crate::path::Path;
use crate::step::{Follow, Move, PHASES, Step, StepKind};
use alloc::collections::VecDeque;
use path::geometry::{Joiner, Segment};
use path::law::{Config, Law, Refusal, Timed};
use path::{Phase, Piece};

/// How the feed of a move that stays alone is meant.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Alone {
    /// mm/s.
    PerTime(f64),
    /// mm/rev, at rev/s.
    PerRevolution(f64, f64),
    /// s.
    Lasting(f64),
}

/// A move, both ways: as part of a run, and alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Order {
    pub(crate) segment: Segment,
    pub(crate) path: Path,
    pub(crate) bound: Along,
    pub(crate) alone: Alone,
}

impl Order {
    /// Revolutions per second if its feed is per revolution.
    fn spin(&self) -> Option<f64> {
        match self.alone {
            Alone::PerRevolution(_, n) => Some(n),
            Alone::PerTime(_) | Alone::Lasting(_) => None,
        }
    }

    fn step(&self) -> Step {
        let length = self.path.length();
        let profile = match self.alone {
            Alone::PerTime(wanted) => self.bound.profile(length, wanted),
            Alone::PerRevolution(lead, n) => self.bound.profile_over_revolutions(length, lead, n),
            Alone::Lasting(time) => self.bound.profile_lasting(length, time),
        };
        let Segment { rapid, op, line, .. } = self.segment;
        let per_revolution = self.spin().is_some();
        let kind = StepKind::Move(Move {
            path: self.path,
            profile,
            rapid,
            per_revolution,
            exact_stop: true,
            floats: false,
        });
        Step { op, line, kind }
    }
}

/// See the module's header.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    first: Option<Order>,
    joiner: Joiner,
    law: Option<Law>,
    /// Revolutions per second of a run whose feed is per revolution.
    spin: Option<f64>,
    /// Pieces that the law has and that have not been handed on; `done` were before them.
    pieces: VecDeque<Piece>,
    done: u64,
    /// Not yet handed on: phases of the piece `done`.
    follow: Option<Follow>,
    refusal: Option<(u32, Refusal)>,
}

impl Default for Run {
    fn default() -> Self {
        Self {
            first: None,
            joiner: Joiner::new(),
            law: None,
            spin: None,
            pieces: VecDeque::new(),
            done: 0,
            follow: None,
            refusal: None,
        }
    }
}

impl Run {
    pub(crate) fn is_empty(&self) -> bool {
        self.first.is_none() && self.law.is_none()
    }

    /// The one move there is, if no second one has come.
    pub(crate) fn alone(&self) -> Option<Step> {
        self.first.as_ref().map(Order::step)
    }

    /// Whether a move can go on from the ones before without a stop.
    pub(crate) fn takes(&self, order: &Order) -> bool {
        let spin = self.first.as_ref().map_or(self.spin, Order::spin);
        self.is_empty() || spin == order.spin()
    }

    /// What the law has refused, with the line of the program.
    pub(crate) fn take_refusal(&mut self) -> Option<(u32, Refusal)> {
        self.refusal.take()
    }

    /// Go on with a move.
    pub(crate) fn push(
        &mut self,
        order: Order,
        limits: &MachineLimits,
        emit: &mut dyn FnMut(Step),
    ) {
        if self.is_empty() {
            self.spin = order.spin();
            self.first = Some(order);
            return;
        }
        if self.law.is_none() {
            self.law = Some(Law::new(config(limits, self.spin)));
        }
        if let Some(first) = self.first.take() {
            self.join(first.segment);
        }
        self.join(order.segment);
        self.pump(emit);
    }

    fn join(&mut self, segment: Segment) {
        let Self { joiner, law, pieces, refusal, .. } = self;
        joiner.push(segment, &mut |piece| give(law, pieces, refusal, piece));
    }

    /// Stop at the end of the last move, in position.
    pub(crate) fn finish(&mut self, emit: &mut dyn FnMut(Step)) {
        if let Some(first) = self.first.take() {
            emit(first.step());
            return;
        }
        if self.law.is_none() {
            return;
        }
        let Self { joiner, law, pieces, refusal, .. } = self;
        joiner.finish(&mut |piece| give(law, pieces, refusal, piece));
        if let Some(law) = law {
            law.close();
        }
        self.pump(emit);
        if let Some(mut follow) = self.follow.take() {
            follow.exact_stop = true;
            emit(step(follow));
        }
        let refusal = self.refusal.take();
        *self = Self { refusal, ..Self::default() };
    }

    fn pump(&mut self, emit: &mut dyn FnMut(Step)) {
        while let Some(timed) = self.law.as_mut().and_then(Law::next) {
            self.take(&timed, emit);
        }
    }

    fn take(&mut self, timed: &Timed, emit: &mut dyn FnMut(Step)) {
        if timed.piece == self.done
            && let Some(follow) = &mut self.follow
            && usize::from(follow.count) < PHASES
        {
            follow.phases[usize::from(follow.count)] = timed.phase;
            follow.count += 1;
            return;
        }
        if let Some(follow) = self.follow.take() {
            emit(step(follow));
        }
        while self.done < timed.piece {
            self.pieces.pop_front();
            self.done += 1;
        }
        let Some(piece) = self.pieces.front() else { return };
        let mut phases = [Phase::default(); PHASES];
        phases[0] = timed.phase;
        let per_revolution = self.spin.is_some();
        self.follow =
            Some(Follow { piece: *piece, phases, count: 1, per_revolution, exact_stop: false });
    }
}

fn give(
    law: &mut Option<Law>,
    pieces: &mut VecDeque<Piece>,
    refusal: &mut Option<(u32, Refusal)>,
    piece: Piece,
) {
    let Some(law) = law else { return };
    match law.push(piece) {
        Ok(()) => pieces.push_back(piece),
        Err(why) => *refusal = Some((piece.line, why)),
    }
}

fn step(follow: Follow) -> Step {
    let Piece { op, line, .. } = follow.piece;
    Step { op, line, kind: StepKind::Follow(follow) }
}

fn config(limits: &MachineLimits, spin: Option<f64>) -> Config {
    let n = spin.unwrap_or(1.0);
    Config { limits: limits.motion(n), period: limits.joining.period.value() * n }
}
