//! What repeated taps have learnt: one record for each kind of stroke, a fixed number of them.
//!
//! ```text
//!   tap begins ──► the record of its tool, lead, speeds and stroke ──► corrections, errors
//!                  none: a free place, or that of the record longest unused
//! ```
use crate::event::TapFigures;
use alloc::vec::Vec;
use motion::TapPlan;
use sync::{Correction, Learning, LearningRecord, StrokeKey, Taught};
use units::{Angle, Length, Time};

/// Kinds of strokes that are remembered at once.
pub const LEARNING_RECORDS: usize = 8;

/// All records; the one used last stands last.
#[derive(Clone, Debug)]
pub(crate) struct LearningRecords {
    learning: Option<Learning>,
    list: Vec<LearningRecord>,
    /// A tap is learning, with the record that stands last.
    active: bool,
}

impl LearningRecords {
    /// With room for all that will ever be kept.
    pub(crate) fn new(learning: Option<Learning>) -> Self {
        let room = if learning.is_some() { LEARNING_RECORDS } else { 0 };
        Self { learning, list: Vec::with_capacity(room), active: false }
    }

    /// What was learnt before; records beyond the room are left out.
    pub(crate) fn recall(&mut self, records: Vec<LearningRecord>) {
        if self.learning.is_some() {
            self.list.clear();
            self.list.extend(records.into_iter().take(LEARNING_RECORDS));
        }
    }

    /// All of them.
    pub(crate) fn list(&self) -> &[LearningRecord] {
        &self.list
    }

    /// A tap begins.
    pub(crate) fn begin(&mut self, tool: u32, plan: &TapPlan) {
        let Some(learning) = self.learning else { return };
        let key = StrokeKey {
            tool,
            lead: plan.lead,
            spin: plan.spin,
            return_spin: plan.return_spin,
            turns: Angle::rev(plan.inward.end().s),
            times: (Time::s(plan.inward.duration()), Time::s(plan.outward.duration())),
        };
        match self.list.iter().position(|record| record.key.is_like(&key)) {
            Some(index) => self.list[index..].rotate_left(1),
            None if self.list.len() < LEARNING_RECORDS => {
                self.list.push(LearningRecord::new(key, learning.gain));
            }
            None => {
                self.list.rotate_left(1);
                if let Some(record) = self.list.last_mut() {
                    record.reset(key, learning.gain);
                }
            }
        }
        self.active = true;
        if let Some(record) = self.list.last_mut() {
            record.begin();
        }
    }

    /// Corrections of feed and spindle at a time of the stroke.
    pub(crate) fn correction(&self, at: Time) -> (Correction, Correction) {
        match self.list.last() {
            Some(record) if self.active => record.correction(at),
            _ => Default::default(),
        }
    }

    /// What this period missed.
    pub(crate) fn note(&mut self, at: Time, feed: Length, spindle: Angle) {
        if let Some(record) = self.list.last_mut().filter(|_| self.active) {
            record.note(at, feed, spindle);
        }
    }

    /// Turns by which the spindle is braked earlier than planned.
    pub(crate) fn early(&self) -> Angle {
        self.list.last().filter(|_| self.active).map_or(Angle::ZERO, |record| record.early)
    }

    /// Strokes of this kind have taught how the spindle stops.
    pub(crate) fn know(&self) -> bool {
        self.list.last().is_some_and(|record| self.active && record.strokes > 0)
    }

    /// An encoder-following tap has ended as it should; `taught`: by how much longer than planned
    /// the stopping angle showed itself, if the spindle slowed down to a creep on the way.
    pub(crate) fn finish_following(&mut self, figures: &TapFigures, taught: Option<Angle>) {
        if core::mem::take(&mut self.active)
            && let Some(record) = self.list.last_mut()
        {
            match taught {
                Some(late) => record.stopped_late(late, figures.depth_error),
                None => record.overran(figures.depth_error),
            }
        }
    }

    /// A tap has ended as it should.
    pub(crate) fn finish(&mut self, figures: &TapFigures) -> Option<Taught> {
        let learning = self.learning.filter(|_| self.active)?;
        self.active = false;
        // a drive at its limit cannot answer: nothing of this stroke would help the next one
        if figures.saturated {
            return None;
        }
        Some(self.list.last_mut()?.finish(figures.sync.rms, &learning))
    }
}
