//! Planning anew what was handed on and has not been done.
//!
//! ```text
//!   kernel ── hand back ► steps, and how much of the first is done ─► Planner::repace ─► steps from there on
//!
//!   speed │      ╭────────╮ more feed          what is under way goes on as planned until a new law of time can take
//!         │  ────┤┈┈┈┈┈┈┈┈┤────                over within all limits; as a rule that is at once
//!         └──────┴────────┴────► way
//! ```
//!
//! A plan leaves its limits unused only where the feed holds it back. To go faster than that (an
//! override above 100 %) the law of time is asked again, from the motion that is under way, with
//! more feed: what follows keeps every limit as the first plan did. So does a stop at the end of
//! each line (single block). Slower needs no new plan: the kernel lets planned time pass more
//! slowly.
use crate::ends::{Cutter, Ends};
use crate::limits::MachineLimits;
use crate::planner::Planner;
use crate::run::JoinedRun;
use crate::settings::OperatorSettings;
use crate::timing::{Timing, step};
use crate::{Step, StepKind};
use alloc::vec::Vec;
use motion::{Curve, Entry, Follow, Instant, Move, PHASES, Pace, Phase, Piece, Shape};
use path::law::State;

/// Where less of a piece is left, it has been done, mm.
const SHORTEST: f64 = 1e-9;

/// A phase of a curve that takes longer than this, s, and ends as fast as it begins, to such a
/// share, can be left anywhere.
const LONG: f64 = 0.02;
const LEVEL: f64 = 0.02;

/// Steps along one path, as they were planned.
#[derive(Debug)]
pub(crate) struct StepRow {
    parts: Vec<Part>,
    pace: Pace,
    per_revolution: bool,
}

/// What follows a row.
#[derive(Clone, Copy)]
enum Waits<'a> {
    /// Pieces of the same path.
    Pieces(&'a [Piece]),
    /// Rest, and then this move.
    Rest(u32),
}

/// A new law of time, from one of the phases on.
struct Anew {
    from: usize,
    timing: Timing,
    cutter: Cutter,
}

/// A phase of it, and the piece with its feed as programmed.
#[derive(Clone, Copy, Debug)]
struct Part {
    piece: Piece,
    phase: Phase,
}

impl Part {
    /// Whether its speed hardly changes.
    fn is_level(&self) -> bool {
        let Phase { duration, v, .. } = self.phase;
        let end = self.phase.at(duration).v;
        (end - v).abs() < LEVEL * v
    }
}

impl Planner {
    /// What the operator wants from now on, of moves that begin at rest.
    pub const fn set_operator(&mut self, settings: OperatorSettings) {
        self.wanted = settings;
    }

    /// Plan anew what the kernel has not done, as the operator wants it: these steps, and of the
    /// first of them the planned time that is done, if it is under way, s or revolutions
    /// ([`motion::HandedBack`]). All that comes of it goes to `emit`, in order; the kernel must
    /// have nothing else.
    ///
    /// Where an axis begins or ceases to swing among these steps, the limits are not the same for
    /// all of them: they stay as they were planned.
    pub fn repace(
        &mut self,
        settings: OperatorSettings,
        steps: Vec<Step>,
        mut done: Option<f64>,
        emit: &mut impl FnMut(Step),
    ) {
        self.set_operator(settings);
        let swings = |step: &Step| {
            matches!(step.kind, StepKind::Superpose(_) | StepKind::AwaitFades | StepKind::Engage(_))
                || matches!(step.kind, StepKind::Release { .. })
        };
        let stays = steps.iter().any(swings);
        let mut row: Option<StepRow> = None;
        let mut steps = steps.into_iter().peekable();
        while let Some(step) = steps.next() {
            let Some((new, ends)) = row_of(&step, done.take().unwrap_or(0.0)) else {
                emit(step); // a run ends at rest before anything else
                continue;
            };
            match &mut row {
                Some(row) => row.parts.extend(new.parts),
                None => row = Some(new),
            }
            if ends && let Some(row) = row.take() {
                if stays {
                    row.as_planned(row.parts.len(), true, emit);
                } else {
                    let next = steps.peek().map_or_else(|| self.outbox.next_op(), |step| step.op);
                    row.again((&self.limits, &self.outbox.ends), settings, next, emit);
                }
            }
        }
        if !stays {
            self.outbox.repace(&self.limits, settings, row, emit);
        } else if let Some(row) = row {
            row.as_planned(row.parts.len(), false, emit);
        }
    }
}

impl StepRow {
    /// To where it comes to rest: at the path's end, or before, at that of a line, where `next` is
    /// the first move of what follows.
    fn again(
        self,
        known: (&MachineLimits, &Ends),
        settings: OperatorSettings,
        next: u32,
        emit: &mut dyn FnMut(Step),
    ) {
        let Some(Anew { from, mut timing, .. }) = self.anew(known, settings, Waits::Rest(next))
        else {
            return self.as_planned(self.parts.len(), true, emit);
        };
        self.as_planned(from, false, emit);
        timing.close(emit);
    }

    /// From the first phase from which a new law of time keeps all limits.
    fn anew(
        &self,
        (limits, ends): (&MachineLimits, &Ends),
        settings: OperatorSettings,
        waits: Waits,
    ) -> Option<Anew> {
        let (waits, next) = match waits {
            Waits::Pieces(pieces) => (pieces, None),
            Waits::Rest(next) => (&[][..], Some(next)),
        };
        let spin = self.per_revolution.then_some(self.pace.turning);
        // on a curve, from where the first plan looked at its limits, unless that is far and
        // nothing happens until then
        let at_once = self.parts.first().is_none_or(|part| {
            matches!(part.piece.curve, Curve::Line(_))
                || part.phase.duration > LONG && part.is_level()
        });
        let mut from = usize::from(!at_once);
        while from < self.parts.len() {
            let Phase { s, v, a, .. } = self.parts[from].phase;
            let timing = Timing::new(limits, spin, settings, Some(State { s, v, a }));
            let mut anew = Anew { from, timing, cutter: Cutter::from(s) };
            for piece in pieces(&self.parts[from..], waits) {
                anew.push(piece, settings, ends);
            }
            if let Some(next) = next {
                anew.finish(next, ends);
            }
            if anew.goes_on(ends) {
                return Some(anew);
            }
            from = 2 * from + 1;
        }
        None
    }

    /// The first phases as they were planned.
    fn as_planned(&self, count: usize, ends: bool, emit: &mut dyn FnMut(Step)) {
        let Self { pace, per_revolution, .. } = *self;
        let mut follow: Option<Follow> = None;
        for Part { piece, phase } in &self.parts[..count] {
            let piece = Piece { feed: piece.feed * pace.share, ..*piece };
            if let Some(follow) = &mut follow
                && is_same(&follow.piece, &piece)
                && usize::from(follow.count) < PHASES
            {
                follow.phases[usize::from(follow.count)] = *phase;
                follow.count += 1;
                continue;
            }
            let mut phases = [Phase::default(); PHASES];
            phases[0] = *phase;
            let new = Follow { piece, phases, count: 1, per_revolution, exact_stop: false, pace };
            if let Some(follow) = follow.replace(new) {
                emit(step(follow));
            }
        }
        if let Some(follow) = follow {
            emit(step(Follow { exact_stop: ends, ..follow }));
        }
    }
}

impl Anew {
    /// Whether what is under way can go on within all limits, with the piece that the cutter holds.
    fn goes_on(&mut self, ends: &Ends) -> bool {
        if self.cutter.held().is_some() {
            let mut whole =
                Self { timing: self.timing.clone(), cutter: self.cutter.clone(), ..*self };
            whole.finish(u32::MAX, ends);
            // without that piece there need be no way to rest yet: it comes before the law is asked
            let _ = self.timing.goes_on();
            return whole.timing.goes_on();
        }
        self.timing.goes_on()
    }

    /// The path comes to rest here; what follows begins with the move `next`.
    fn finish(&mut self, next: u32, ends: &Ends) {
        let Self { timing, cutter, .. } = self;
        cutter.finish(next, ends, &mut |piece| timing.push(piece));
    }

    /// The next piece.
    fn push(&mut self, piece: Piece, settings: OperatorSettings, ends: &Ends) {
        let Self { timing, cutter, .. } = self;
        if settings.stops {
            cutter.push(piece, ends, &mut |piece| timing.push(piece));
        } else {
            timing.push(piece);
        }
    }
}

impl JoinedRun {
    /// Plan anew what has not been done: what was handed on and came back, in front of what waits.
    pub(crate) fn repace(
        &mut self,
        known: (&MachineLimits, &Ends),
        settings: OperatorSettings,
        back: Option<StepRow>,
        emit: &mut dyn FnMut(Step),
    ) {
        let Some(old) = &self.timing else {
            self.settings = settings; // of a move that is still alone
            return;
        };
        let left: Vec<Piece> = old.left().chain(self.cutter.held().copied()).collect();
        let anew = if let Some(row) = &back {
            row.anew(known, settings, Waits::Pieces(&left))
        } else {
            let state = old.begins();
            let timing = Timing::new(known.0, self.spin, settings, state);
            let cutter = Cutter::from(state.map_or(0.0, |state| state.s));
            let mut anew = Anew { from: 0, timing, cutter };
            for piece in &left {
                anew.push(*piece, settings, known.1);
            }
            anew.goes_on(known.1).then_some(anew)
        };
        if let Some(row) = back {
            row.as_planned(anew.as_ref().map_or(row.parts.len(), |anew| anew.from), false, emit);
        }
        if let Some(Anew { mut timing, cutter, .. }) = anew {
            timing.pump(emit);
            (self.timing, self.cutter) = (Some(timing), cutter);
            self.settings = settings;
        }
    }
}

/// The pieces of phases, and what follows them. A piece that a plan before this one has cut, or
/// counted to its next line, has phases of both plans: it is as the later one had it.
fn pieces(parts: &[Part], waits: &[Piece]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut left = 0.0;
    let with_ends = parts.iter().map(|part| (part.piece, part.phase.end().s));
    for (piece, end) in with_ends.chain(waits.iter().map(|piece| (*piece, piece.length))) {
        match pieces.last_mut() {
            Some(last) if left > SHORTEST || is_same(last, &piece) => *last = piece,
            _ => pieces.push(piece),
        }
        left = piece.length - end;
    }
    pieces
}

/// The same piece of the path; its feed has been through arithmetic.
fn is_same(a: &Piece, b: &Piece) -> bool {
    a.curve == b.curve && a.begin == b.begin && a.op == b.op
}

/// What a step does along its path after a time of it, and whether it ends at rest. `None`: it is
/// no such step.
fn row_of(of: &Step, done: f64) -> Option<(StepRow, bool)> {
    let (mut parts, mut left) = (Vec::new(), done);
    let mut add = |piece: Piece, phase: Phase| {
        if phase.duration <= left {
            left -= phase.duration;
            return;
        }
        let Instant { s, v, a } = phase.at(left);
        let phase = Phase { duration: phase.duration - left, s, v, a, ..phase };
        left = 0.0;
        parts.push(Part { piece, phase });
    };
    match &of.kind {
        StepKind::Follow(follow) => {
            let Follow { piece, per_revolution, exact_stop, pace, .. } = **follow;
            let piece = Piece { feed: piece.feed / pace.share, ..piece };
            follow.phases[..usize::from(follow.count)].iter().for_each(|phase| add(piece, *phase));
            Some((StepRow { parts, pace, per_revolution }, exact_stop))
        }
        StepKind::Move(order) => {
            let Move { path, profile, per_revolution, exact_stop, .. } = &**order;
            let own = order.programmed?;
            let curve = path.curve();
            let (op, line, length) = (of.op, of.line, curve.length());
            let (begin, feed, rapid, entry) = (0.0, own.feed, false, Entry::Rest);
            let piece = Piece { curve, begin, length, feed, rapid, entry, op, line };
            profile.pieces().iter().for_each(|phase| add(piece, *phase));
            let pace = Pace { share: 1.0, turning: own.turning };
            Some((StepRow { parts, pace, per_revolution: *per_revolution }, *exact_stop))
        }
        _ => None,
    }
}
