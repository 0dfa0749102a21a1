//! Probing moves: straight, from rest to rest, joined to nothing; where they end is known when they
//! have been made.
use super::{Job, Planner};
use crate::StepKind;
use crate::findings::number;
use alloc::format;
use canon::{Position, Probe};
use diag::Diagnostic;
use motion::{Move, Path, ProbeEnd};

impl Planner {
    pub(super) fn probe(&mut self, job: &mut Job, order: &Probe) {
        self.check_probe(job);
        self.come_down(job);
        self.has_probed();
        let path = Path::Line { from: self.programmed, to: order.to };
        self.programmed = order.to;
        let feed = order.feed.value();
        if !(feed > 0.0 && feed.is_finite()) {
            let text = format!("expected a feed above zero (F), found {}", number(feed));
            self.findings.add(Diagnostic::error("M0303", job.span, text));
            return;
        }
        if self.is_refused(job, &[path]) {
            return;
        }
        let Some(bound) = self.bound(job, &path, false, feed) else { return };
        let profile = bound.profile(path.length(), feed.min(bound.speed));
        if self.profile_is_refused(job, &profile, 1.0) {
            return;
        }
        self.tell_spindles(job);
        let order_of = Move {
            path,
            profile,
            rapid: false,
            per_revolution: false,
            exact_stop: true,
            floats: true,
            programmed: None,
        };
        let until = ProbeEnd { contact: order.until_contact, required: order.required };
        self.hand_on(job, StepKind::Probe { order: order_of.into(), until });
    }

    /// A probing move has ended here, not where it was programmed to.
    pub const fn stands_at(&mut self, place: Position) {
        self.programmed = place;
    }
}
