//! One law of time along pieces of a path, and the steps that come of it.
//!
//! ```text
//!   pieces ─► Law ─► phases ─► Follow steps, as soon as nothing that comes can change them
//! ```
use crate::limits::MachineLimits;
use crate::settings::OperatorSettings;
use crate::{Step, StepKind};
use alloc::collections::VecDeque;
use motion::{Entry, Follow, Limits, PHASES, Pace, Phase, Piece, Shape};
use path::law::{Config, Law, LawRefusal, State, Timed, merged};

/// How much farther ahead than braking takes the first stop is that is asked for in motion.
const AHEAD: f64 = 2.0;

/// Share of a servo period that phases are merged within: setpoints do not show what happens
/// between them, and what the control does in a period is bounded.
const SHORTEST_PHASE: f64 = 0.125;

/// A law of time comes to rest by arithmetic: slower than this it stands, mm/s.
const STANDS: f64 = 1e-3;

/// See the module's header.
#[derive(Clone, Debug)]
pub(crate) struct Timing {
    law: Law,
    pace: Pace,
    per_revolution: bool,
    /// Each line ends at rest.
    stops: bool,
    /// Line of the last piece, and how far it is until it may stop.
    last: Option<u32>,
    braking: f64,
    limits: Limits,
    /// Pieces that the law has and that have not been handed on; `done` were before them.
    pieces: VecDeque<Piece>,
    done: u64,
    /// Not yet handed on: phases of the piece `done`.
    follow: Option<Follow>,
    refusal: Option<(u32, LawRefusal)>,
    /// The path ends before what was refused.
    is_refused: bool,
    /// Phases shorter than this together are handed on as one.
    shortest: f64,
}

impl Timing {
    /// From rest, or from motion that is under way on the first piece. `spin`: revolutions per
    /// second, for a feed per revolution.
    pub(crate) fn new(
        limits: &MachineLimits,
        spin: Option<f64>,
        settings: OperatorSettings,
        state: Option<State>,
    ) -> Self {
        let n = spin.unwrap_or(1.0);
        let config = Config { limits: limits.motion(n), period: limits.joining.period.value() * n };
        let state = state.unwrap_or_default();
        Self {
            law: Law::resuming(config, state),
            limits: config.limits,
            pace: Pace { share: settings.share, turning: n },
            per_revolution: spin.is_some(),
            stops: settings.stops,
            last: None,
            braking: AHEAD * braking(&config, state.v),
            pieces: VecDeque::new(),
            done: 0,
            follow: None,
            refusal: None,
            is_refused: false,
            shortest: SHORTEST_PHASE * config.period,
        }
    }

    /// What the law has refused, with the line of the program.
    pub(crate) const fn take_refusal(&mut self) -> Option<(u32, LawRefusal)> {
        self.refusal.take()
    }

    /// What the axes can do, which curves are to suit.
    pub(crate) const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Go on along a piece; its feed is as programmed.
    pub(crate) fn push(&mut self, piece: Piece) {
        if self.is_refused {
            return;
        }
        let mut piece = Piece { feed: piece.feed * self.pace.share, ..piece };
        if self.stops && self.last.is_some_and(|last| last != piece.line) && self.braking <= 0.0 {
            piece.entry = Entry::Rest;
        }
        self.last = Some(piece.line);
        self.braking -= piece.length();
        match self.law.push(piece) {
            Ok(()) => self.pieces.push_back(piece),
            Err(why) => (self.refusal, self.is_refused) = (Some((piece.line, why)), true),
        }
    }

    /// Hand on what is decided.
    pub(crate) fn pump(&mut self, emit: &mut dyn FnMut(Step)) {
        while let Some(timed) = self.law.next() {
            self.take(&timed, emit);
        }
    }

    /// The path ends here, in position.
    pub(crate) fn close(&mut self, emit: &mut dyn FnMut(Step)) {
        self.law.close();
        self.pump(emit);
        if let Some(follow) = self.follow.take() {
            emit(step(Follow { exact_stop: true, ..follow }));
        }
    }

    /// Whether what is under way can go on within all limits.
    pub(crate) fn goes_on(&mut self) -> bool {
        self.law.prepare() && self.refusal.is_none()
    }

    /// Motion where what has not been handed on begins.
    pub(crate) fn begins(&self) -> Option<State> {
        let Phase { s, v, a, .. } = self.follow.as_ref()?.phases[0];
        Some(State { s, v, a })
    }

    /// Pieces that have not been handed on, with their feed as programmed.
    pub(crate) fn left(&self) -> impl Iterator<Item = Piece> {
        let share = self.pace.share;
        self.pieces.iter().map(move |p| Piece { feed: p.feed / share, ..*p })
    }

    fn take(&mut self, timed: &Timed, emit: &mut dyn FnMut(Step)) {
        if timed.piece == self.done
            && let Some(follow) = &mut self.follow
        {
            let count = usize::from(follow.count);
            let last = &mut follow.phases[count - 1];
            if last.duration + timed.phase.duration < self.shortest
                && let Some(merged) = merged(last, &timed.phase)
            {
                *last = merged;
                return;
            }
            if count < PHASES {
                follow.phases[count] = timed.phase;
                follow.count += 1;
                return;
            }
        }
        let follow = self.follow.take();
        while self.done < timed.piece {
            self.pieces.pop_front();
            self.done += 1;
        }
        let Some(piece) = self.pieces.front() else { return };
        if let Some(follow) = follow {
            let begins = timed.phase.s == 0.0 && timed.phase.v < STANDS;
            let exact_stop = self.stops && begins && piece.entry == Entry::Rest;
            emit(step(Follow { exact_stop, ..follow }));
        }
        let mut phases = [Phase::default(); PHASES];
        phases[0] = timed.phase;
        let (per_revolution, pace) = (self.per_revolution, self.pace);
        let piece = *piece;
        self.follow =
            Some(Follow { piece, phases, count: 1, per_revolution, exact_stop: false, pace });
    }
}

/// How far it is from a speed to rest for the slowest axis alone.
fn braking(config: &Config, v: f64) -> f64 {
    let least = |of: fn(&motion::Bounds) -> &[f64; motion::AXES]| {
        let both = [&config.limits.feed, &config.limits.rapid];
        both.iter().flat_map(|b| of(b)).fold(f64::INFINITY, |m: f64, x| m.min(*x))
    };
    let (accel, jerk) = (least(|b| &b.accel), least(|b| &b.jerk));
    v * (v / accel + accel / jerk) / 2.0
}

pub(crate) fn step(follow: Follow) -> Step {
    let Piece { op, line, .. } = follow.piece;
    Step { op, line, kind: StepKind::Follow(follow.into()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AxisLimits, Joining, Tapping, ToolChange};
    use alloc::vec::Vec;
    use motion::{Curve, Line};
    use units::{CoordinateAccel, CoordinateJerk, CoordinateSpeed, Length, Time};

    fn limits() -> MachineLimits {
        let axis = AxisLimits {
            travel: None,
            rapid_speed: CoordinateSpeed::new(500.0),
            feed_speed: CoordinateSpeed::new(500.0),
            accel: CoordinateAccel::new(1e4),
            rapid_jerk: CoordinateJerk::new(1e6),
            feed_jerk: CoordinateJerk::new(1e6),
        };
        let mut axes = [None; 9];
        axes[0] = Some(axis);
        MachineLimits {
            axes,
            spindles: Vec::new(),
            tool_change: ToolChange { z: None, x: None, y: None, pockets: 0, time: Time::ZERO },
            settling: Time::ZERO,
            tapping: Tapping::along_z(0.9),
            joining: Joining { tolerance: Length::ZERO, ..Joining::EXACT },
            signals: None,
        }
    }

    /// Along X from one place to another, mm.
    fn along_x([from, to]: [f64; 2], feed: f64, line: u32) -> Piece {
        let at = |x| core::array::from_fn(|axis| if axis == 0 { x } else { 0.0 });
        let length = to - from;
        let curve = Curve::Line(Line { from: at(from), to: at(to), length });
        let entry = Entry::Smooth;
        Piece { curve, begin: 0.0, length, feed, rapid: false, entry, op: line, line }
    }

    #[test]
    fn a_path_ends_at_rest_before_what_is_refused() {
        let mut timing = Timing::new(&limits(), None, OperatorSettings::default(), None);
        let mut steps = Vec::new();
        for (line, ends) in (1..).zip([[0.0, 30.0], [30.0, 60.0], [60.0, 90.0]]) {
            timing.push(along_x(ends, if line == 2 { 0.0 } else { 100.0 }, line));
            timing.pump(&mut |step| steps.push(step));
        }
        assert_eq!(timing.take_refusal(), Some((2, LawRefusal::Feed(0.0))));
        timing.push(along_x([90.0, 99.0], 100.0, 4));
        timing.close(&mut |step| steps.push(step));
        let last = steps.last().expect("the first line is run");
        assert!(steps.iter().all(|step| step.line == 1), "{steps:?}");
        let StepKind::Follow(follow) = &last.kind else { panic!("{last:?}") };
        let phase = follow.phases[usize::from(follow.count) - 1];
        let t = phase.duration;
        let end = phase.s + t * (phase.v + t * (phase.a / 2.0 + t * phase.j / 6.0));
        assert!((end - 30.0).abs() < 1e-6, "{end}");
        assert!((phase.v + t * (phase.a + t * phase.j / 2.0)).abs() < 1e-3, "{phase:?}");
    }
}
