//! What the operator orders, and where it holds the machine.
//!
//! An order is taken between two ticks and acts from the next one on; what it has led to is said in
//! a [`Notice`].
use super::{Kernel, Mode};
use crate::config::Subject;
use crate::event::EventKind;
use crate::execute::Activity;
use crate::fault::FaultKind;
use crate::operator::{Notice, Operator, Order};
use crate::queue::{Step, StepKind};
use crate::spindle::SpindleLoop;
use crate::time_scaling::SIGHT;
use crate::track::Track;
use motion::{HandedBack, UnderWay};

impl Kernel {
    /// Take an order of the operator; it acts from the next tick on.
    pub fn order(&mut self, order: Order) {
        let synchronised =
            matches!(&self.activity, Activity::Tapping(run) if run.coupling().is_some());
        let paused = matches!(self.activity, Activity::Pausing);
        let by_hand = match self.activity {
            Activity::ChangingByHand { tool } => Some(tool),
            _ => None,
        };
        let alarm = matches!(self.mode, Mode::Halted | Mode::Disabled);
        if alarm && matches!(order, Order::Resume | Order::FeedHold) {
            return self.note(EventKind::Operator(Notice::NothingToResume));
        }
        if order == Order::Retract && synchronised && self.operator.wants_rest() {
            self.note(EventKind::Operator(Notice::BackingOut));
        }
        let locked = match order {
            Order::SpindleOverride(_) => synchronised || !self.drives.spindle_overridden,
            _ => synchronised,
        };
        match order {
            Order::Flood(on) => self.drives.flood = on,
            Order::Mist(on) => self.drives.mist = on,
            _ => {}
        }
        let asked = paused || by_hand.is_some();
        if let Some(notice) = self.operator.take(order, locked, (paused, asked)) {
            self.note(EventKind::Operator(notice));
        }
        if let (Order::Confirm, Some(tool)) = (order, by_hand) {
            self.drives.tool = tool;
            self.activity = Activity::Changing { tool, waited_s: 0.0 };
            self.note(EventKind::Resumed);
        }
        let goes_on =
            order == Order::Confirm || order == Order::Resume && !self.operator.wants_rest();
        if goes_on && paused {
            self.activity = Activity::AtOnce;
            self.note(EventKind::Resumed);
        }
    }

    /// Mist and flood coolant flow.
    pub const fn coolant(&self) -> [bool; 2] {
        [self.drives.mist, self.drives.flood]
    }

    /// Give back what has not been done, so that it can be planned anew: what has pushed it
    /// pushes what comes of it. A step that is under way and is no feed along a path stays. `None`:
    /// an override or a hold is just changing how fast the plan is run through, and how that ends
    /// is known of this plan only; ask again after the next tick.
    pub fn hand_back(&mut self) -> Option<HandedBack> {
        if matches!(self.activity, Activity::Moving(..)) && !self.drives.time_scaling.is_even() {
            return None;
        }
        let under_way = self.begun.then(|| self.queue.front()).flatten();
        let done = match (&self.activity, under_way) {
            (Activity::Moving(moving, _), Some(step)) => {
                Track::of(&step.kind).and_then(|track| moving.done(track))
            }
            _ => None,
        };
        let stays = self.chained + usize::from(self.begun && done.is_none());
        if done.is_some() {
            (self.activity, self.begun) = (Activity::Idle, false);
        }
        let steps = self.queue.len().saturating_sub(stays);
        self.queue.truncate(stays);
        Some(HandedBack { steps, done })
    }

    /// What is done of the step under way, if it moves and can be planned anew.
    pub fn under_way(&self) -> Option<UnderWay> {
        let step = self.queue.front().filter(|_| self.begun && self.chained == 0)?;
        match (&self.activity, Track::of(&step.kind)) {
            (Activity::Moving(moving, _), Some(track)) => moving.under_way(track, &self.drives),
            _ => None,
        }
    }

    /// Give up the last `steps` of those that wait: what is planned instead comes in time. `at`:
    /// the step that is then the last, and under way, ends at that planned time of it in motion,
    /// and goes on into what comes. `false`, and nothing is changed: none would be left, or what is
    /// left goes on into what comes so soon that the way in which an override or a hold changes the
    /// rate now may lead beyond it.
    pub fn give_up(&mut self, steps: usize, at: Option<f64>) -> bool {
        let stays = self.queue.len().saturating_sub(steps);
        if stays <= self.chained || at.is_some() && stays != 1 {
            return false;
        }
        let goes_on = at.is_some() || self.track_at(stays - 1).is_some_and(|track| !track.rests());
        if goes_on && !self.goes_on_long(stays, at) || at.is_some_and(|at| !self.queue.cut(0, at)) {
            return false;
        }
        self.queue.truncate(stays);
        true
    }

    fn track_at(&self, index: usize) -> Option<Track<'_>> {
        self.queue.get(index).and_then(|step| Track::of(&step.kind))
    }

    /// The first steps, which move, last longer than what is looked at for a change of the rate.
    /// `at`: where the last one ends.
    fn goes_on_long(&self, steps: usize, at: Option<f64>) -> bool {
        let Some(UnderWay { done, pace }) = self.under_way() else { return false };
        let sees = SIGHT as f64 * self.config.period.value() * pace;
        let takes = |index| match at {
            Some(at) => Some(at),
            None => self.track_at(index).map(Track::duration),
        };
        // what does not move begins at rest: no motion is waiting to go on
        let lasts = (0..steps).map_while(takes).sum::<f64>();
        lasts - done >= sees
    }

    /// Go on after a program's stop.
    pub fn resume(&mut self) {
        self.order(Order::Resume);
    }

    /// A drive reports an alarm with which it can still brake.
    pub const fn report_alarm(&mut self, of: Subject) {
        self.reported = Some((FaultKind::DriveAlarm, of));
    }

    /// The process that leads the kernel is gone, or not to be believed any more: the next tick
    /// finds this alarm.
    pub const fn report_control(&mut self, kind: FaultKind) {
        self.reported = Some((kind, Subject::Machine));
    }

    /// What the operator's orders have left behind.
    pub const fn operator(&self) -> &Operator {
        &self.operator
    }

    /// Nothing moves any more, by the setpoints, and nothing is about to. An axis that is off for
    /// its lost feedback has none: what is left of its stop keeps no other drive on.
    pub fn is_standing(&self) -> bool {
        /// A nanometre, or a millionth of a degree, a second: what rounding leaves of the speed of
        /// an axis that follows an encoder which does not turn.
        const ROUNDING: f64 = 1e-6;
        let mut axes = self.drives.axes.iter().flatten().filter(|axis| !axis.sight.is_off());
        let axes = axes.all(|axis| axis.target.speed.abs() < ROUNDING);
        let spindles = self.drives.spindles.iter().flatten();
        let still = axes && spindles.map(SpindleLoop::ordered).all(|r| r.spin.value() == 0.0);
        match self.mode {
            Mode::Disabled => true,
            Mode::New | Mode::Starting(_) => false,
            Mode::Running | Mode::Halted => still && !self.operator.wants_out(),
        }
    }

    /// A tap that stands in its thread can come out by the control that stopped it: no drive or
    /// encoder of it is gone.
    pub fn can_back_out(&self) -> bool {
        let drives = matches!(self.mode, Mode::Running | Mode::Halted) && self.drive_lost.is_none();
        drives && self.is_standing() && self.engaged().is_some()
    }

    /// No step begins now: the operator holds, and the axes stand. A move that flows on into the
    /// next one slows down in it.
    pub(super) fn holds_before(&mut self, line: u32) -> bool {
        if self.drives.flowing {
            return false;
        }
        self.operator.holds_line(line, self.report.line) || self.operator.wants_rest()
    }

    /// The operator's hold, once everything stands: it is said, and an abort forgets the rest. A
    /// tap that stands in its thread stays there until it is told to go on, or out.
    pub(super) fn hold(&mut self) {
        let wants = self.operator.wants_rest() && self.has_something_held();
        if !wants || self.aborted || !self.is_held() {
            return;
        }
        let in_thread = self.is_in_thread();
        if self.operator.wants_out() && !in_thread {
            self.operator.is_out();
            self.note(EventKind::Operator(Notice::Out));
        }
        if self.operator.wants_abort() && !in_thread {
            if self.leaves_work() {
                return;
            }
            if matches!(self.activity, Activity::Tapping(_)) {
                self.drives.record_requests.out();
            }
            self.queue.clear();
            (self.chained, self.drives.chain) = (0, None);
            (self.activity, self.begun, self.aborted) = (Activity::Idle, false, true);
            self.drives.flowing = false;
            self.drives.spindles.iter_mut().flatten().for_each(SpindleLoop::stop);
            (self.drives.mist, self.drives.flood) = (false, false);
            self.note(EventKind::Operator(Notice::Aborted));
        } else if let Some(notice) = self.operator.standing(in_thread) {
            self.note(EventKind::Operator(notice));
        }
    }

    /// What is done has come to rest for the operator's hold.
    pub(super) fn is_held(&self) -> bool {
        self.activity.is_held(&self.operator, self.drives.chain.as_ref())
    }

    /// A tap is in its thread.
    pub fn is_in_thread(&self) -> bool {
        match (&self.activity, self.queue.front()) {
            (Activity::Tapping(run), Some(Step { kind: StepKind::Tap(plan), .. })) => {
                run.is_in_thread(plan, &self.drives)
            }
            _ => false,
        }
    }
}
