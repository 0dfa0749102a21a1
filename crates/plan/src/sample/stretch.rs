//! Moves that are planned by themselves, and what they are kept as until then.
use super::FeedAndRapid;
use crate::along::Along;
use crate::clock::Clock;
use crate::ends::Ends;
use crate::limits::MachineLimits;
use crate::run::{Alone, JoinedRun, OrderedMove};
use crate::settings::OperatorSettings;
use crate::{Step, StepKind};
use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::sync::Arc;
use alloc::vec::Vec;
use canon::Position;
use motion::Path;
use path::geometry::Segment;
use units::Time;

/// Moves of a lead: at least, and at most.
const LEAD: (usize, usize) = (48, 400);
/// Length of a lead, in ways that braking to rest takes.
const BRAKING: f64 = 1.5;
/// Of long moves so many are enough, where a lead of them is so many times as long as it has to be.
const OF_LONG_MOVES: (usize, f64) = (12, 4.0);

/// A move; lines, of which there are many, are kept as small as can be, others once for all
/// stretches that have them.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // nearly all are lines
enum Moved {
    Line { from: Position, to: Position, bound: Along, alone: Alone, words: Words },
    Other(Arc<OrderedMove>),
}

/// What a segment is besides its curve.
#[derive(Clone, Copy, Debug)]
struct Words {
    feed: f64,
    rapid: bool,
    tolerance: f64,
    merge: f64,
    op: u32,
    line: u32,
}

impl Moved {
    fn of(order: &OrderedMove) -> Self {
        let Path::Line { from, to } = order.path else { return Self::Other(Arc::new(*order)) };
        let Segment { feed, rapid, tolerance, merge, op, line, .. } = order.segment;
        let words = Words { feed, rapid, tolerance, merge, op, line };
        Self::Line { from, to, bound: order.bound, alone: order.alone, words }
    }

    fn order(&self) -> OrderedMove {
        match self {
            Self::Other(order) => **order,
            Self::Line { from, to, bound, alone, words } => {
                let path = Path::Line { from: *from, to: *to };
                let Words { feed, rapid, tolerance, merge, op, line } = *words;
                let segment =
                    Segment { curve: path.curve(), feed, rapid, tolerance, merge, op, line };
                OrderedMove { segment, path, bound: *bound, alone: *alone }
            }
        }
    }
}

/// A move that has passed.
#[derive(Clone, Debug)]
pub(super) struct Passed {
    moved: Moved,
    op: u32,
    length: f64,
    /// How long a lead there has to be, mm.
    lead: f64,
}

impl Passed {
    pub(super) fn of(order: &OrderedMove) -> Self {
        Self {
            moved: Moved::of(order),
            op: order.segment.op,
            length: order.length(),
            lead: BRAKING * order.braking(),
        }
    }
}

/// Whether a lead of so many moves and mm is as long as it has to be.
fn is_enough(moves: usize, way: f64, lead: f64) -> bool {
    let (few, times) = OF_LONG_MOVES;
    moves >= LEAD.1 || (moves >= LEAD.0 && way >= lead) || (moves >= few && way >= times * lead)
}

/// The last moves since the path last rested.
#[derive(Clone, Debug, Default)]
pub(super) struct Before(VecDeque<Passed>);

impl Before {
    pub(super) fn push(&mut self, passed: Passed) {
        if self.0.len() == LEAD.1 {
            self.0.pop_front();
        }
        self.0.push_back(passed);
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// As many of them as a stretch needs that begins here.
    pub(super) fn lead(&self) -> impl Iterator<Item = &Passed> {
        let mut way = 0.0;
        let enough = self.0.iter().rev().enumerate().position(|(moves, passed)| {
            way += passed.length;
            is_enough(moves + 1, way, passed.lead)
        });
        self.0.range(enough.map_or(0, |at| self.0.len() - at - 1)..)
    }
}

/// What a stretch consists of.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // nearly all are moves
enum Item {
    Move(Moved),
    /// The path comes to rest; what follows begins with the spindle as this clock has it.
    Rest(Box<Clock>),
}

/// Whether it has all moves that are counted, and how much of the lead behind them.
#[derive(Clone, Copy, Debug, Default)]
enum Behind {
    #[default]
    Open,
    Lead {
        moves: usize,
        way: f64,
    },
    Whole,
}

/// Moves whose time stands for that of others; it can be planned by itself, in any thread.
#[derive(Clone, Debug, Default)]
pub struct Stretch {
    items: Vec<Item>,
    /// The operations that are counted, the last one included.
    counted: Option<(u32, u32)>,
    /// Rough time before it, of the program.
    begins: Time,
    /// Its rough time.
    pub rough: Time,
    /// Moves that are counted.
    pub moves: usize,
    behind: Behind,
    clock: Clock,
}

impl Stretch {
    /// One that begins behind these moves.
    pub(super) fn new<'a>(lead: impl Iterator<Item = &'a Passed>, clock: Clock) -> Self {
        let mut items: Vec<_> = lead.map(|passed| Item::Move(passed.moved.clone())).collect();
        items.reserve(super::MOVES + items.len()); // the lead behind is about as long
        Self { items, clock, ..Self::default() }
    }

    /// How long what is counted takes: planned as the whole path is, from rest to rest.
    pub fn plan(&self, limits: &MachineLimits) -> FeedAndRapid {
        let Some((first, last)) = self.counted else { return FeedAndRapid::default() };
        let mut added = FeedAndRapid::default();
        let mut clock = self.clock;
        let (mut run, ends) = (JoinedRun::default(), Ends::default());
        let at = (limits, &ends);
        for item in self.items.iter().chain([&Item::Rest(Box::new(self.clock))]) {
            let mut count = |step: Step| {
                let before = clock.elapsed();
                clock.count(&step, limits);
                if (first..=last).contains(&step.op) {
                    let share = match &step.kind {
                        StepKind::Move(order) if order.rapid => &mut added.rapid,
                        StepKind::Follow(order) if order.piece.rapid => &mut added.rapid,
                        _ => &mut added.feed,
                    };
                    *share += clock.elapsed() - before;
                }
            };
            match item {
                Item::Move(moved) => {
                    let order = moved.order();
                    if !run.takes(&order) {
                        run.finish(at, &mut count);
                    }
                    run.push(order, OperatorSettings::default(), at, &mut count);
                }
                Item::Rest(then) => {
                    run.finish(at, &mut count);
                    clock = **then;
                }
            }
        }
        added
    }

    /// Whether it lies at a multiple of `step` in the program's rough time: it always does if it is
    /// as long, and those that do for twice the step are among them.
    pub fn lies_on(&self, step: Time) -> bool {
        let number = |time: Time| (time / step) as u64;
        number(self.begins) != number(self.begins + self.rough)
    }

    /// Whether an operation is among those that are counted.
    pub(super) fn counts(&self, op: u32) -> bool {
        self.counted.is_some_and(|(first, last)| (first..=last).contains(&op))
    }

    /// Not all its moves have come.
    pub(super) const fn is_open(&self) -> bool {
        matches!(self.behind, Behind::Open)
    }

    /// Everything is there.
    pub(super) const fn is_whole(&self) -> bool {
        matches!(self.behind, Behind::Whole)
    }

    /// One more move.
    pub(super) fn push(&mut self, passed: &Passed) {
        self.items.push(Item::Move(passed.moved.clone()));
        match &mut self.behind {
            Behind::Open => {
                let (first, _) = self.counted.unwrap_or((passed.op, passed.op));
                self.counted = Some((first, passed.op));
                self.moves += 1;
            }
            Behind::Lead { moves, way } => {
                *moves += 1;
                *way += passed.length;
                if is_enough(*moves, *way, passed.lead) {
                    self.behind = Behind::Whole;
                }
            }
            Behind::Whole => {}
        }
    }

    /// The path rests.
    pub(super) fn rest(&mut self, clock: Clock) {
        self.items.push(Item::Rest(Box::new(clock)));
        if matches!(self.behind, Behind::Lead { .. }) {
            self.behind = Behind::Whole;
        }
    }

    /// All moves that are counted are there: rough time of the program before them, and theirs.
    pub(super) fn end(&mut self, begins: Time, rough: Time) {
        (self.begins, self.rough) = (begins, rough);
        self.behind = Behind::Lead { moves: 0, way: 0.0 };
    }
}
