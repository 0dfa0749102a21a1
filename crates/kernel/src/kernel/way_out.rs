//! A tool that is tied to a spindle, but not screwed to the work: what is known of its way out, and
//! when it takes it.
//!
//! ```text
//!   WayOut step ─► written down? ─► in force ── the pass is over, or WayOut(None) ─► out
//!                                      │ alarm with the drives alive, abort
//!                                      └► infeed axis away from the work, then everything stops
//! ```
use super::{Kernel, Mode};
use crate::config::Subject;
use crate::event::EventKind;
use crate::execute::Activity;
use crate::fault::FaultKind;
use crate::queue::{Step, StepKind};
use crate::record_requests::WorkRecord;
use crate::retreating::{self, Retreating};
use crate::spindle::SpindleLoop;
use crate::threading;
use crate::withdrawing::{WithdrawalPlan, Withdrawing};
use motion::{TiedCut, WayOut};

/// Of a chain of stretches so many are kept, to turn it again after a hold.
const KEPT: usize = crate::queue::QUEUE / 2;

impl Kernel {
    /// Take a tool out of work that it is not screwed to, and do nothing else, as for
    /// [`Kernel::recover`].
    pub fn withdraw(&mut self, plan: WithdrawalPlan) {
        self.begin_anew();
        self.withdrawing = Some(Withdrawing::new(plan, self.now));
    }

    /// The way out for the tool that is in the work, unless it is a tap.
    pub const fn way_out(&self) -> Option<&WayOut> {
        self.way_out.as_ref()
    }

    /// The first tick of whatever takes a tool out: from here on it takes its time.
    pub(super) fn begin_rescue(&mut self) {
        if let Some(recovering) = &mut self.recovering {
            recovering.begins(self.now);
        }
        if let Some(withdrawing) = &mut self.withdrawing {
            withdrawing.begins(self.now);
        }
    }

    /// Go on with a withdrawal, if there is one.
    pub(super) fn withdraw_on(&mut self, dt: f64) -> Option<Result<(), crate::drives::Finding>> {
        let withdrawing = self.withdrawing.as_mut()?;
        let (was, began) = (withdrawing.is_done(), withdrawing.began());
        match withdrawing.advance(dt, &mut self.drives) {
            Err(finding) => return Some(Err(finding)),
            Ok(true) if !was => {
                let duration = self.now - began;
                self.note(EventKind::Withdrawn { duration });
            }
            Ok(_) => {}
        }
        Some(Ok(()))
    }

    /// The step at the queue's front is done.
    pub(super) fn finish_step(&mut self) {
        let Some(step) = self.queue.get(self.chained) else { return };
        match &step.kind {
            StepKind::WayOut(Some(way_out)) => self.way_out = Some(*way_out),
            StepKind::WayOut(None) => self.is_out(),
            // a pass is over, and the tool leaves the groove
            StepKind::Move(_) | StepKind::Follow(_) if self.turns_thread() => self.is_out(),
            StepKind::Thread(stretch) if !stretch.ends && self.chained < KEPT => {
                self.chained += 1;
                (self.begun, self.activity) = (false, Activity::Idle);
                return;
            }
            _ => {}
        }
        self.leave_hole();
        self.queue.remove_first(self.chained + 1);
        (self.chained, self.begun, self.activity) = (0, false, Activity::Idle);
    }

    /// A hold has taken the tool off a thread, or it goes back to where that began.
    pub(super) fn is_off_thread(&self) -> bool {
        self.drives.chain.is_some_and(|chain| chain.is_off())
    }

    /// The way off work that the infeed axis alone takes the tool off.
    fn straight(&self) -> Option<WayOut> {
        self.way_out.filter(WayOut::is_straight)
    }

    fn turns_thread(&self) -> bool {
        self.way_out.is_some_and(|way_out| way_out.cut == TiedCut::Thread)
    }

    /// The tool is out of the work.
    pub(super) fn is_out(&mut self) {
        if self.way_out.take().is_some() {
            self.drives.record_requests.out();
        }
    }

    /// The chain is turned again from its first stretch.
    pub(super) const fn turn_again(&mut self) {
        (self.chained, self.begun, self.activity) = (0, false, Activity::Idle);
    }

    /// What leads the tool off a thread at a hold: nothing where the chain is not kept from its
    /// beginning.
    pub(super) fn off_thread(&self) -> Option<WayOut> {
        let way_out = self.way_out?;
        let first = self.queue.front()?;
        let whole = matches!(first.kind, StepKind::Thread(stretch) if stretch.start.is_some());
        whole.then_some(way_out)
    }

    /// The way off the work for an alarm, where what has failed is not what leads it.
    pub(super) fn retreat_for(&self, kind: FaultKind, of: Subject) -> Option<Retreating> {
        if let Some(order) = self.config.phase_loss.filter(|_| kind == FaultKind::CouplingLost) {
            return Retreating::begin(&order, &self.drives);
        }
        if let Some(leaving) = self.drives.chain.and_then(|chain| chain.leaving()) {
            return Some(leaving);
        }
        let way_out = self.straight().filter(|way_out| of != Subject::Axis(way_out.infeed))?;
        Retreating::to_clear(&way_out, &self.drives, &self.config)
    }

    /// An abort takes the tool off the work first. Whether it is on its way.
    pub(super) fn leaves_work(&mut self) -> bool {
        if self.retreating.is_none() {
            let begun = self
                .straight()
                .and_then(|way_out| Retreating::to_clear(&way_out, &self.drives, &self.config));
            self.retreating = begun;
        }
        let dt = self.config.period.value();
        if let Some(retreating) = &mut self.retreating {
            retreating.advance(dt, false, &mut self.drives);
            if !retreating.is_out() {
                return true;
            }
            self.retreating = None;
        }
        if self.way_out.is_none_or(|way_out| retreating::is_clear(&way_out, &self.drives)) {
            self.is_out();
        }
        false
    }

    /// Stopped by an alarm: go on leaving the work, until the spindles may stop. The axis that
    /// does.
    pub(super) fn retreat(&mut self, threading: bool) -> Option<usize> {
        let retreating = self.retreating.as_mut()?;
        let (axis, was) = (retreating.axis(), retreating.is_out());
        retreating.advance(self.config.period.value(), threading, &mut self.drives);
        let (over, there) = (retreating.is_out(), retreating.is_there(&self.drives));
        // an axis that does not obey leaves its tool in the work
        if over && there {
            self.is_out();
        }
        if over && !was {
            for spindle in self.drives.spindles.iter_mut().flatten() {
                spindle.brake();
            }
        }
        Some(axis)
    }

    /// Whether the axis that takes the tool off the work obeys: one whose encoder stands still
    /// would run away.
    pub(super) fn check_retreating(&self) -> Result<(), crate::drives::Finding> {
        let retreating = self.retreating.filter(|retreating| !retreating.is_out());
        match retreating {
            Some(retreating) => self.drives.check_axis_follows(retreating.axis()),
            None => Ok(()),
        }
    }

    /// A thread that is being turned keeps its coupling until the spindle stands, or the chain is
    /// over.
    pub(super) fn stay_on_thread(&mut self) -> bool {
        let Activity::Threading = &self.activity else { return false };
        let Some(step) = self.queue.get(self.chained) else { return false };
        let StepKind::Thread(stretch) = step.kind else { return false };
        let Some(over) = threading::stay(&stretch, self.config.period, &mut self.drives) else {
            return false;
        };
        if over {
            self.chained += 1;
            let next = self.queue.get(self.chained);
            let goes_on = matches!(next, Some(Step { kind: StepKind::Thread(next), .. }) if next.start.is_none());
            if !goes_on {
                self.activity = Activity::Idle;
            }
        }
        true
    }

    /// The axis and the spindle of a thread that is being turned.
    pub(super) fn thread_pair(&self) -> Option<(usize, usize)> {
        let Activity::Threading = &self.activity else { return None };
        let StepKind::Thread(stretch) = self.queue.get(self.chained)?.kind else { return None };
        let axis = self.way_out?.pass?.axis.index();
        self.drives.chain.map(|_| (axis, usize::from(stretch.spindle)))
    }

    /// What the drives shall keep together of a thread that is being turned.
    pub(super) fn on_thread(&self) -> Option<bus::Coupled> {
        let (Activity::Threading, Mode::Running | Mode::Halted) = (&self.activity, &self.mode)
        else {
            return None;
        };
        let StepKind::Thread(stretch) = self.queue.get(self.chained)?.kind else { return None };
        let spindle = self.drives.spindles.get(usize::from(stretch.spindle))?.as_ref()?;
        self.drives.chain?.tangent(&stretch, SpindleLoop::reading(spindle))
    }

    /// While the axes are on their way to where a tool is fed in: ask for its record now.
    pub(super) fn foresee_way_out(&mut self) {
        let travels = matches!(self.activity, Activity::Moving(..) | Activity::Settling { .. });
        if !self.drives.record_requests.is_on() || !travels || self.way_out.is_some() {
            return;
        }
        let passes = |step: &Step<'_>| {
            !matches!(step.kind, StepKind::Move(_) | StepKind::Follow(_) | StepKind::Spindle { .. })
        };
        let Some(Step { op, line, kind: StepKind::WayOut(Some(way_out)) }) =
            self.queue.iter().skip(1).find(passes)
        else {
            return;
        };
        let record = WorkRecord::of_way_out(&way_out, op, line, self.drives.tool);
        self.drives.record_requests.ask(&record);
    }
}
