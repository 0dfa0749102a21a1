//! Moves that go on into one another, of which a sample is planned: what a long program takes,
//! without planning all of it.
//!
//! ```text
//!   moves ─┬─► rough time of every stretch of them
//!          │   ├──┼───────┼─┼──┼──────────────┼──┼───┼──┼─┼───┼──┤   all of it: the whole program
//!          │        ▲           ▲           ▲           ▲           every Δ s one
//!          └─► the stretches that lie there, with moves before and behind each
//!
//!              ├──── lead ────┼──── stretch ────┼──── lead ────┤
//!            at rest          │  time counted   │           at rest
//! ```
//!
//! A stretch that takes long is kept rather than a short one, and one that takes Δ or longer in any
//! case. Δ doubles whenever too many are kept, so a program may have any length.
//!
//! A stretch begins at rest a lead ahead of where its time is counted, and ends at rest a lead
//! behind, so that in between it is run as in the whole path: what lies farther away than braking
//! and starting take does not change it.
mod rough;
mod stretch;

pub use stretch::Stretch;

use crate::clock::Clock;
use crate::run::OrderedMove;
use alloc::vec::Vec;
use motion::Path;
use rough::Rough;
use stretch::{Before, Passed};
use units::Time;

/// Moves of a stretch; a curve counts as so many lines.
const MOVES: usize = 200;
const CURVE: usize = 4;
/// Stretches that are kept at most.
const KEPT: usize = 512;
/// Δ to begin with, s.
const STEP: f64 = 1.0 / 1024.0;

/// Times of moves at feed and of rapids among them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeedAndRapid {
    /// At feed.
    pub feed: Time,
    /// In rapid.
    pub rapid: Time,
}

impl FeedAndRapid {
    /// Of both.
    pub fn total(&self) -> Time {
        self.feed + self.rapid
    }
}

/// Everything that was found out of paths that were not planned.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Stretches, kept or not.
    pub stretches: usize,
    /// Their rough time.
    pub rough: Time,
    /// Δ: in so much rough time, at least one was kept.
    pub step: Time,
    /// Those that were kept, in the order of the program.
    pub kept: Vec<Stretch>,
    /// What is under way of the path, and what its moves count.
    under_way: Rough,
    count: usize,
    /// The stretch that is under way, and others whose lead behind is too short yet.
    open: Vec<Stretch>,
    before: Before,
    /// A path is under way, and along it the spindle turns as [`OrderedMove::spin`] has it.
    is_under_way: bool,
    spin: Option<f64>,
}

impl Default for Sample {
    fn default() -> Self {
        Self {
            stretches: 0,
            rough: Time::ZERO,
            step: Time::s(STEP),
            kept: Vec::new(),
            under_way: Rough::default(),
            count: 0,
            open: Vec::new(),
            before: Before::default(),
            is_under_way: false,
            spin: None,
        }
    }
}

impl Sample {
    /// Whether a path is under way.
    pub(crate) const fn is_under_way(&self) -> bool {
        self.is_under_way
    }

    /// Whether a move can go on from the ones before without a stop.
    pub(crate) fn takes(&self, order: &OrderedMove) -> bool {
        !self.is_under_way || self.spin == order.spin()
    }

    /// The next move of a path; `clock` knows how fast the spindle turns.
    pub(crate) fn push(&mut self, order: &OrderedMove, clock: &Clock) {
        (self.is_under_way, self.spin) = (true, order.spin());
        let is_long = self.count >= MOVES;
        if is_long && self.open.last().is_some_and(|open| !open.counts(order.segment.op)) {
            self.end_stretch();
        }
        if self.under_way.len() == 0 {
            self.open.push(Stretch::new(self.before.lead(), *clock));
        }
        self.under_way.push(order);
        self.count += if matches!(order.path, Path::Line { .. }) { 1 } else { CURVE };
        let passed = Passed::of(order);
        self.open.iter_mut().for_each(|open| open.push(&passed));
        self.before.push(passed);
        self.close();
    }

    /// The path comes to rest.
    pub(crate) fn rest(&mut self, clock: &Clock) {
        if core::mem::take(&mut self.is_under_way) {
            self.under_way.rest();
            self.before.clear();
            self.open.iter_mut().for_each(|open| open.rest(*clock));
            self.close();
        }
    }

    /// There are no more moves.
    pub(crate) fn finish(&mut self) {
        self.end_stretch();
        self.kept.append(&mut self.open);
        self.thin();
    }

    /// The stretch under way has all its moves; what it is kept for is known now.
    fn end_stretch(&mut self) {
        let Some(stretch) = self.open.last_mut().filter(|_| self.under_way.len() > 0) else {
            return;
        };
        let begins = self.rough;
        let rough = self.under_way.take();
        self.count = 0;
        self.rough += rough;
        self.stretches += 1;
        stretch.end(begins, rough);
        if !stretch.lies_on(self.step) {
            self.open.pop();
        }
    }

    /// Keep those whose lead behind is long enough.
    fn close(&mut self) {
        let kept = &mut self.kept;
        self.open.retain_mut(|open| {
            let is_whole = open.is_whole();
            if is_whole {
                kept.push(core::mem::take(open));
            }
            !is_whole
        });
        self.thin();
    }

    /// Fewer, where too many were kept.
    fn thin(&mut self) {
        while self.kept.len() > KEPT {
            self.step = self.step * 2.0;
            let step = self.step;
            self.kept.retain(|stretch| stretch.lies_on(step));
            self.open.retain(|stretch| stretch.is_open() || stretch.lies_on(step));
        }
    }
}
