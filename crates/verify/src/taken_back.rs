//! Verdicts that are taken back: a later cut has changed the feature, or shown that no one has seen
//! its hole.
//!
//! ```text
//!   workpiece ─► destroyed ─┬─► a feature that is there   its verdict is changed
//!                           ├─► one that is not judged yet  kept until it is
//!                           └─► one of a program before   kept for who has counted it
//! ```
use crate::feature::{Feature, FeatureKind};
use crate::judge::Judge;
use crate::thread::UNSEEN;
use crate::turned;
use crate::undone::Undone;
use crate::verdict::Verdict;
use units::Time;

/// Features of programs before of which it is kept that they were destroyed.
const MOST_FORGOTTEN: usize = 1000;

/// What was taken back.
#[derive(Clone, Debug, Default)]
pub(crate) struct TakenBack {
    /// Places in the list of features that were changed after they were judged, in that order.
    pub(crate) changed: Vec<usize>,
    /// Threads in holes that no one saw were looked at, because something is drilled.
    is_drilled: bool,
    /// Of features that are not judged yet.
    to_come: Vec<Undone>,
    /// Of features that the judge has forgotten.
    forgotten: Vec<Undone>,
}

impl TakenBack {
    /// Verdicts as they are now.
    pub(crate) fn known(features: &[Feature]) -> Vec<Verdict> {
        features.iter().map(|feature| feature.verdict.clone()).collect()
    }

    /// Features of these ops are part of another one that follows: those that were in the list.
    pub(crate) fn absorb(&mut self, ops: &[u32], features: &mut Vec<Feature>) -> Vec<u32> {
        let mut absorbed = Vec::new();
        features.retain(|feature| {
            let stays = !ops.contains(&feature.op);
            absorbed.extend((!stays).then_some(feature.op));
            stays
        });
        self.changed.extend(absorbed.iter().map(|_| Judge::REMOVED));
        absorbed
    }

    /// Which of them have been changed since.
    pub(crate) fn compare(&mut self, before: &[Verdict], features: &[Feature]) {
        let all = before.iter().zip(features).enumerate();
        let changed = all.filter(|(_, (before, now))| **before != now.verdict);
        self.changed.extend(changed.map(|(place, _)| place));
    }
}

impl Judge {
    /// What stands in the place of a feature that is no longer in the list: it is part of another
    /// one, and those behind it have moved up.
    pub const REMOVED: usize = usize::MAX;

    /// Places in the list of features whose verdict was changed after they were judged: those of
    /// the changes from this one on, or [`Self::REMOVED`].
    pub fn changed_since(&self, change: usize) -> &[usize] {
        self.taken_back.changed.get(change..).unwrap_or_default()
    }

    /// Features that were taken before ([`Self::take_features`]) and destroyed since.
    pub fn take_undone(&mut self) -> Vec<Undone> {
        std::mem::take(&mut self.taken_back.forgotten)
    }

    /// A program begins whose holes are there already, or not.
    pub const fn holes_are_there(&mut self, pre_drilled: bool) {
        self.config.pre_drilled = pre_drilled;
    }

    /// The program drills: what was tapped without a hole that was seen is not found good.
    pub(crate) fn will_drill(&mut self) {
        self.work.will_be_drilled();
        if std::mem::replace(&mut self.taken_back.is_drilled, true) || self.config.pre_drilled {
            return;
        }
        for (place, feature) in self.features.iter_mut().enumerate() {
            if feature.has_assumed_hole() && feature.verdict.is_pass() {
                feature.verdict = Verdict::NotJudged { reason: UNSEEN.to_owned() };
                self.taken_back.changed.push(place);
            }
        }
    }

    /// What a cut has changed is changed in its verdict.
    pub(crate) fn take_back(&mut self) {
        if self.work.is_drilled() {
            self.will_drill();
        }
        let mut undone = std::mem::take(&mut self.taken_back.to_come);
        undone.extend(self.work.take_undone());
        self.take_back_of(undone);
    }

    /// Cuts of another kind have changed these.
    pub(crate) fn take_back_of(&mut self, undone: Vec<Undone>) {
        for undone in undone {
            let made = |f: &Feature| f.op == undone.op && !matches!(f.kind, FeatureKind::Milled(_));
            if let Some(place) = self.features.iter().rposition(made) {
                self.features[place].changed(&undone);
                self.taken_back.changed.push(place);
            } else if let Some(place) = self.before.iter().position(made) {
                let mut feature = self.before.swap_remove(place);
                feature.changed(&undone);
                (feature.time, feature.duration) = (self.now, Time::ZERO);
                self.features.push(feature);
            } else if self.orders.iter().any(|order| order.first == undone.op) {
                self.taken_back.to_come.push(undone);
            } else if self.taken_back.forgotten.len() < MOST_FORGOTTEN {
                self.taken_back.forgotten.push(undone);
            }
        }
    }

    /// What turns with the work is judged as it stands.
    pub(crate) fn settle_turned(&mut self) {
        let mut undone = self.gears.settle();
        undone.extend(self.ground.settle());
        if let Some(bar) = &mut self.bar {
            undone.extend(self.polygons.settle(bar));
        }
        self.take_back_of(undone);
        self.settle_threads();
    }

    fn settle_threads(&mut self) {
        for change in self.threads.settle(self.bar.as_mut(), &self.config) {
            let (instead, found) = match change {
                turned::ListChange::New(found) => (None, found),
                turned::ListChange::Instead(op, found) => (Some(op), found),
            };
            let found = found.map(Box::new).map(FeatureKind::Turned);
            let is_it =
                |f: &Feature| Some(f.op) == instead && matches!(f.kind, FeatureKind::Turned(_));
            match self.features.iter().rposition(is_it) {
                Some(listed) => {
                    self.features[listed] = found;
                    self.taken_back.changed.push(listed);
                }
                None => self.features.push(found),
            }
        }
    }
}
