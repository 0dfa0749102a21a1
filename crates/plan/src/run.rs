//! Moves that are run through without a stop: joined into one path, with one law of time along it.
//!
//! ```text
//!   moves ─► Joiner ─► pieces ─► Timing ─► Follow steps
//! ```
//!
//! A move that stays alone between two stops is a [`Move`] with its own profile, as before: it
//! needs no joining.
use crate::along::Along;
use crate::beside::{Beside, SideBySide};
use crate::ends::{Cutter, Ends};
use crate::limits::MachineLimits;
use crate::settings::OperatorSettings;
use crate::timing::Timing;
use crate::{Step, StepKind};
use alloc::boxed::Box;
use motion::{Move, Path, Programmed};
use path::geometry::{Joiner, Segment};
use path::law::LawRefusal;

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
pub(crate) struct OrderedMove {
    pub(crate) segment: Segment,
    pub(crate) path: Path,
    pub(crate) bound: Along,
    pub(crate) alone: Alone,
}

impl OrderedMove {
    /// Revolutions per second if its feed is per revolution.
    pub(crate) fn spin(&self) -> Option<f64> {
        match self.alone {
            Alone::PerRevolution(_, n) => Some(n),
            Alone::PerTime(_) | Alone::Lasting(_) => None,
        }
    }

    /// mm.
    pub(crate) fn length(&self) -> f64 {
        self.path.length()
    }

    /// As fast as the program and the axes allow it, mm/s.
    pub(crate) fn speed(&self) -> f64 {
        let programmed = match self.alone {
            Alone::PerTime(speed) => speed,
            Alone::PerRevolution(lead, n) => lead * n,
            Alone::Lasting(time) => self.length() / time,
        };
        programmed.min(self.bound.speed)
    }

    /// How far it is from that speed to rest, mm.
    pub(crate) fn braking(&self) -> f64 {
        let (v, Along { accel, jerk, .. }) = (self.speed(), self.bound);
        v * (v / accel + accel / jerk) / 2.0
    }

    /// Its feed, as a step has it.
    fn programmed(&self) -> Option<Programmed> {
        let Segment { feed, rapid, .. } = self.segment;
        let turning = self.spin().unwrap_or(1.0);
        (!rapid).then_some(Programmed { feed, turning })
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
        let kind = StepKind::Move(Box::new(Move {
            path: self.path,
            profile,
            rapid,
            per_revolution,
            exact_stop: true,
            floats: false,
            programmed: self.programmed(),
        }));
        Step { op, line, kind }
    }
}

/// See the module's header.
#[derive(Clone, Debug, Default)]
pub(crate) struct JoinedRun {
    first: Option<OrderedMove>,
    joiner: Option<Joiner>,
    pub(crate) timing: Option<Timing>,
    /// Where every line ends at rest: what cuts pieces there.
    pub(crate) cutter: Cutter,
    /// Revolutions per second of a run whose feed is per revolution.
    pub(crate) spin: Option<f64>,
    /// What the operator wants of it.
    pub(crate) settings: OperatorSettings,
    refusal: Option<(u32, LawRefusal)>,
    /// A program is planned ahead of its run: nothing of it comes back to be planned anew.
    beside: Option<Beside>,
}

impl JoinedRun {
    /// One that joins and times side by side.
    pub(crate) fn side_by_side(both: SideBySide) -> Self {
        Self { beside: Some(Beside::new(both)), ..Self::default() }
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.first.is_none() && self.timing.is_none()
    }

    /// The one move there is, to be taken elsewhere.
    pub(crate) const fn take_first(&mut self) -> Option<OrderedMove> {
        self.first.take()
    }

    /// The one move there is, if no second one has come.
    pub(crate) fn alone(&self) -> Option<Step> {
        self.first.as_ref().map(OrderedMove::step)
    }

    /// The first move of what waits here; beyond all moves if nothing does.
    pub(crate) fn next_op(&self) -> u32 {
        let alone = self.first.as_ref().map(|first| first.segment.op);
        let timed = self.timing.as_ref().and_then(|timing| timing.left().next());
        let piece = timed.as_ref().or_else(|| self.cutter.held()).map(|piece| piece.op);
        let joined = || self.joiner.as_ref().and_then(Joiner::next_op);
        let waits = || self.beside.as_ref().and_then(Beside::next_op);
        alone.or(piece).or_else(joined).or_else(waits).unwrap_or(u32::MAX)
    }

    /// Whether a move can go on from the ones before without a stop.
    pub(crate) fn takes(&self, order: &OrderedMove) -> bool {
        let spin = self.first.as_ref().map_or(self.spin, OrderedMove::spin);
        self.is_empty() || spin == order.spin()
    }

    /// What the law has refused, with the line of the program.
    pub(crate) const fn take_refusal(&mut self) -> Option<(u32, LawRefusal)> {
        self.refusal.take()
    }

    /// Go on with a move; a run that begins with it is as the operator has set it.
    pub(crate) fn push(
        &mut self,
        order: OrderedMove,
        settings: OperatorSettings,
        (limits, ends): (&MachineLimits, &Ends),
        emit: &mut dyn FnMut(Step),
    ) {
        if self.is_empty() {
            (self.spin, self.settings) = (order.spin(), settings);
            self.first = Some(order);
            return;
        }
        self.begin(limits, ends, emit);
        self.join(order.segment, ends, emit);
    }

    /// More than one move, or one that is not to be as programmed.
    fn begin(&mut self, limits: &MachineLimits, ends: &Ends, emit: &mut dyn FnMut(Step)) {
        if self.timing.is_none() {
            self.timing = Some(Timing::new(limits, self.spin, self.settings, None));
        }
        if let Some(first) = self.first.take() {
            self.join(first.segment, ends, emit);
        }
    }

    fn join(&mut self, segment: Segment, ends: &Ends, emit: &mut dyn FnMut(Step)) {
        let Self { joiner, timing, settings, refusal, cutter, beside, .. } = self;
        let Some(timing) = timing else { return };
        // where every line ends at rest, it ends where it was programmed to
        let tolerance = if settings.stops { 0.0 } else { segment.tolerance };
        let joiner = joiner.get_or_insert_with(|| Joiner::new(timing.limits()));
        let (stops, segment) = (settings.stops, Segment { tolerance, ..segment });
        if let Some(beside) = beside.as_mut().filter(|_| !stops) {
            if beside.push(segment) {
                beside.turn(joiner, timing, emit);
            }
        } else {
            joiner.push(segment, &mut |piece| {
                if stops {
                    cutter.push(piece, ends, &mut |piece| timing.push(piece));
                } else {
                    timing.push(piece);
                }
            });
            timing.pump(emit);
        }
        *refusal = refusal.take().or_else(|| timing.take_refusal());
    }

    /// Stop at the end of the last move, in position.
    pub(crate) fn finish(
        &mut self,
        (limits, ends): (&MachineLimits, &Ends),
        emit: &mut dyn FnMut(Step),
    ) {
        if let Some(first) = &self.first {
            let has_profile = matches!(first.path, Path::Line { .. });
            if has_profile && self.settings.share == 1.0 {
                emit(first.step());
                self.first = None;
                return;
            }
            self.begin(limits, ends, emit);
        }
        let Some(mut timing) = self.timing.take() else { return };
        let Self { cutter, settings, .. } = self;
        if let (Some(joiner), Some(beside), false) =
            (&mut self.joiner, &mut self.beside, settings.stops)
        {
            beside.finish(joiner, &mut timing, emit);
        } else if let Some(joiner) = &mut self.joiner {
            joiner.finish(&mut |piece| {
                if settings.stops {
                    cutter.push(piece, ends, &mut |piece| timing.push(piece));
                } else {
                    timing.push(piece);
                }
            });
        }
        cutter.finish(u32::MAX, ends, &mut |piece| timing.push(piece));
        timing.close(emit);
        let refusal = self.refusal.take().or_else(|| timing.take_refusal());
        *self = Self { refusal, beside: self.beside.take(), ..Self::default() };
    }
}
