//! A long program is fit to be executed before it is known how long it takes: that is planned apart
//! from the control, while it waits for its start or is under way.
//!
//! ```text
//!   load ─► judged ─► fit: may be started ──────────────► under way: time left
//!                      └─► timing ── plan (anywhere, minutes) ── timed ─┘
//! ```
use super::control::Control;
use super::timeline::{Noting, Timeline};
use crate::config;
use crate::job::preflight::{Proved, plan_unless, planner};
use crate::job::{Cursor, Interruption, Operations, Session};
use diag::Diagnostic;
use plan::{MachineLimits, Planner};
use std::sync::Arc;

/// A program whose time is to be planned.
pub struct Timing {
    operations: Arc<Operations>,
    planner: Planner,
    limits: MachineLimits,
    interruption: Interruption,
}

/// How long each operation of it takes.
pub struct Timed {
    operations: Arc<Operations>,
    /// `None`: it was broken off.
    timeline: Option<Timeline>,
    /// What cannot be planned: the program will stop there.
    wrong: Vec<Diagnostic>,
}

impl Timing {
    fn of(session: &Session, operations: &Arc<Operations>) -> Self {
        let options = session.plan_options(session.machine.setup.stock.material);
        Self {
            operations: Arc::clone(operations),
            // in one thread: another core is the control's
            planner: planner(session, options),
            limits: config::planner(&session.machine),
            interruption: Interruption::default(),
        }
    }

    /// It is not wanted any more when this says so.
    #[must_use]
    pub fn unless(self, interruption: Interruption) -> Self {
        Self { interruption, ..self }
    }

    /// Plan it.
    pub fn plan(self) -> Timed {
        let Self { operations, mut planner, limits, interruption } = self;
        let mut noting = Noting::new(limits);
        let mut cursor = Cursor::new(Arc::clone(&operations), None);
        let is_whole = plan_unless(&interruption, &mut cursor, &mut planner, &mut |step| {
            noting.step(&step);
        });
        let wrong = planner.take_findings().into_iter().filter(Diagnostic::is_error).collect();
        Timed { operations, timeline: is_whole.then_some(noting.timeline), wrong }
    }
}

impl Control {
    /// The operations of the program that is under way or loaded, if it is fit and its time is not
    /// known.
    pub fn untimed(&self) -> Option<&Arc<Operations>> {
        self.to_be_timed().map(|(_, operations)| operations)
    }

    /// Its time is to be planned.
    pub fn timing(&self) -> Option<Timing> {
        self.to_be_timed().map(|(session, operations)| Timing::of(session, operations))
    }

    fn to_be_timed(&self) -> Option<(&Session, &Arc<Operations>)> {
        let under_way = self.under_way.as_ref().filter(|program| program.timeline.is_none());
        if let Some(program) = under_way {
            return Some((&program.session, &program.proved.operations));
        }
        let fit = self.loaded.as_ref()?.proof.as_ref()?.untimed()?;
        Some((&fit.session, &fit.proved.operations))
    }

    /// The time of a program is known; it is left alone if another one is loaded meanwhile.
    pub fn timed(&mut self, timed: Timed) {
        let Timed { operations, timeline: Some(timeline), wrong } = timed else { return };
        let planned = Some(timeline.planned());
        let is_of = |proved: &Proved| Arc::ptr_eq(&proved.operations, &operations);
        let fit = self.loaded.as_mut().and_then(|loaded| loaded.proof.as_mut()?.untimed_mut());
        if let Some(fit) = fit.filter(|fit| is_of(&fit.proved)) {
            fit.proved.known.planned = planned;
            fit.timeline = Some(timeline);
        } else if let Some(program) =
            self.under_way.as_mut().filter(|program| is_of(&program.proved))
        {
            program.proved.known.planned = planned;
            program.timeline = Some(timeline);
        } else {
            return;
        }
        if let Some(loaded) = self.loaded.as_mut().filter(|_| !operations.is_typed()) {
            loaded.planned = planned;
        }
        for finding in wrong {
            let (line, why) = (finding.span.line, finding.message);
            self.events.notice(format!("the program will stop before line {line}: {why}"));
        }
    }
}
