//! Running a planned tap on the loops: the cycle decides, this carries it out and watches it.
//!
//! ```text
//!   TapPlan ─► sync::Cycle ─► ask ──────────────► spindle loop
//!                  ▲           └─ order, or ─┐
//!                  │    readings ─► age ─► prediction ─► coupling ─► axis loop
//!                  └──────────── spindle                    │
//!                                       monitor ◄── readings of both
//! ```
mod depth;
mod torque;
mod transport;

use crate::axis::AxisLoop;
use crate::config::{Config, Subject};
use crate::drives::{Drives, Finding};
use crate::event::{EventKind, TapFigures};
use crate::execute::Context;
use crate::fault::FaultKind;
use crate::moving::stand_at;
use crate::record_requests::{
    Permission, RECORD_WAIT, RecordRequests, TURN_AGAIN, TURN_AHEAD, TURN_WAIT, WorkRecord,
};
use crate::spindle::SpindleLoop;
use crate::stroke::{Mark, Planned};
use crate::terms::{approach, clear, corrected, feed_forwards, halt, held, spoken, target, turned};
use crate::track::point;
use motion::TapPlan;
use sync::recovery::{Direction, Stored};
use sync::{
    Ask, Correction, Coupling, Cycle, Monitor, Phase, Rotation, Stroke, SyncMode, Tap, Tick,
    Verdict,
};
use transport::Transport;
use units::{Angle, Length, Orientation, Spin, Time};

/// A tap under way.
#[derive(Clone, Debug)]
pub(crate) struct TapRun {
    cycle: Cycle,
    monitor: Monitor,
    transport: Transport,
    marks: [Mark; 2],
    waited_s: f64,
    /// For so long the record has kept it from going in.
    unwritten_s: f64,
    /// For so long it has kept it from turning back.
    unturned_s: f64,
    engaged_s: f64,
    deepest: Length,
    fastest: Spin,
    saturated: bool,
    error: Option<Length>,
    /// By how much longer than planned the spindle has shown to stop.
    taught: Option<Angle>,
    /// Whether the axis goes by where the spindle is, not by where it shall be.
    trailing: Trailing,
    /// The axis follows the spindle no farther: it brakes.
    stays: bool,
}

/// Whether the axis goes by where the spindle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Trailing {
    /// The spindle is where it shall be.
    No,
    /// It does not obey, until it stands where it shall.
    Until,
    /// Its drive is gone.
    ForGood,
}

/// What one period of a tap came to.
pub(crate) enum Outcome {
    /// Go on.
    Busy,
    /// It is over.
    Done,
    /// It failed.
    Failed(Finding),
}

impl TapRun {
    /// Begin, if the axes stand at the start and the machine has what it takes.
    pub(crate) fn begin(
        plan: &TapPlan,
        drives: &mut Drives,
        config: &Config,
    ) -> Result<Self, Finding> {
        if drives.axes[plan.axis.index()].is_none() {
            return Err((FaultKind::NotConfigured, Subject::Axis(plan.axis), 0.0, 0.0));
        }
        let master = drives.spindles.get(usize::from(plan.spindle)).and_then(Option::as_ref);
        let Some(spindle) = master else {
            return Err((FaultKind::NotConfigured, Subject::Spindle(plan.spindle), 0.0, 0.0));
        };
        let age = match config.synchronisation {
            SyncMode::CommandSynchronised => 0,
            SyncMode::EncoderFollowing { transport, .. } => transport,
        };
        let transport = Transport::new(spindle, age);
        drives.supervision.begin(drives.tool, plan, (&spindle.control, config.period));
        stand_at(&point(&plan.start), drives)?;
        drives.learning_records.begin(drives.tool, plan);
        Ok(Self {
            cycle: Cycle::new(),
            monitor: Monitor::new(config.sync_windows, plan.surface, plan.bottom),
            transport,
            marks: [Mark::default(), Mark::default()],
            waited_s: 0.0,
            unwritten_s: 0.0,
            unturned_s: 0.0,
            engaged_s: 0.0,
            deepest: -(plan.bottom - plan.start.along(plan.axis).of_linear()).abs(),
            fastest: Spin::ZERO,
            saturated: false,
            error: None,
            taught: None,
            trailing: Trailing::No,
            stays: false,
        })
    }

    /// The spindle turns as it likes: go with it.
    pub(crate) fn trail(&mut self, plan: &TapPlan, drives: &mut Drives, for_good: bool) {
        let spindle = drives.spindles[usize::from(plan.spindle)].as_ref();
        let (Some(coupling), Some(spindle)) = (self.coupling(), spindle) else { return };
        let place = coupling.follow(spindle.now()).position;
        if let Some(axis) =
            drives.axes[plan.axis.index()].as_mut().filter(|_| self.trailing == Trailing::No)
        {
            axis.rebase(place.value());
        }
        self.trailing = if for_good || self.trailing == Trailing::ForGood {
            Trailing::ForGood
        } else {
            Trailing::Until
        };
    }

    /// What it is about.
    pub(crate) const fn phase(&self) -> Phase {
        self.cycle.phase()
    }

    /// Distance from the coupling in the material, by this period's readings.
    pub(crate) const fn sync_error(&self) -> Option<Length> {
        self.error
    }

    /// It was stopped on the way, and stands; or it had not begun.
    pub(crate) const fn is_standing(&self) -> bool {
        matches!(self.cycle, Cycle::AwaitRest | Cycle::Orient) || self.cycle.is_standing()
    }

    /// It was stopped on the way, and stands in the material.
    pub(crate) fn is_in_thread(&self, plan: &TapPlan, drives: &Drives) -> bool {
        let z = drives.axes[plan.axis.index()].as_ref().map(|axis| Length::mm(axis.position()));
        // what an encoder says of the very surface may be on either side of it
        let is_below = z.is_some_and(|z| self.monitor.depth(z) >= Length::ZERO);
        self.coupling().is_some() && is_below && !self.cycle.is_cleared()
    }

    /// The coupling that is engaged, from the clear place to the bottom, with the sense of travel.
    pub(crate) fn stored(&self, plan: &TapPlan) -> Option<Stored> {
        let coupling = self.coupling()?;
        let at = |place: Length| coupling.phase_difference(Angle::ZERO, place);
        let direction = match self.cycle.phase() {
            Phase::Prepare | Phase::In | Phase::Bottom => Direction::Inward,
            Phase::Out | Phase::Done => Direction::Outward,
        };
        Some(Stored::on(coupling, at(clear(plan)), at(plan.bottom), direction))
    }

    /// The coupling that is engaged.
    pub(crate) const fn coupling(&self) -> Option<Coupling> {
        self.cycle.coupling()
    }

    /// Go on for `dt` seconds.
    pub(crate) fn advance(
        &mut self,
        plan: &TapPlan,
        dt: f64,
        drives: &mut Drives,
        context: &mut Context,
    ) -> Outcome {
        let (axis, spindle) = (plan.axis.index(), usize::from(plan.spindle));
        let (Some(axis), Some(spindle)) = (&mut drives.axes[axis], &mut drives.spindles[spindle])
        else {
            return Outcome::Done; // begin() has seen to it that both are there
        };
        if self.stays {
            return depth::stay(axis);
        }
        let seen = self.watch(plan, Length::mm(axis.position()), spindle, context);
        if let (Err(finding), false) = (seen, context.halted) {
            return Outcome::Failed(finding);
        }
        let mode = context.config.synchronisation;
        let following = mode != SyncMode::CommandSynchronised;
        let marks = self.marks.clone();
        let tap = Tap {
            lead: plan.lead,
            start: plan.start.along(plan.axis).of_linear(),
            bottom: plan.bottom,
            end: plan.end,
            spin: plan.spin,
            inward: &Planned { profile: &plan.inward, mark: &marks[0] },
            dwell: plan.dwell,
            outward: &Planned { profile: &plan.outward, mark: &marks[1] },
            start_angle: plan.start_angle,
            encoder_following: following,
            early: drives.learning_records.early(),
            spoken: spoken(plan, &spindle.control, context.config, drives.learning_records.know())
                .filter(|_| following),
            approach: approach(axis),
            halt: halt(plan, axis, spindle),
        };
        let master = self.transport.master(mode, spindle, context.config.period);
        let tick = Tick {
            elapsed: Time::s(dt),
            master: master.seen,
            followed: master.followed,
            at_rest: if following && self.cycle == Cycle::AwaitRest {
                spindle.stands_for_follower()
            } else {
                spindle.at_rest()
            },
            held: spindle.held(),
            rest: context.halted || context.operator.wants_rest(),
            out: context.operator.wants_out(),
        };
        let was = self.cycle.phase();
        let engages = self.engages(&tap, &tick);
        let record = engages
            .map(|theta0| WorkRecord::of(plan, context.op, context.line, drives.tool, theta0));
        match record.map_or(Permission::Granted, |record| drives.record_requests.ask(&record)) {
            Permission::Granted => {
                self.cycle = self.turn_back(&tap, &tick, &mut drives.record_requests);
            }
            Permission::Waiting => {
                self.waited_s = 0.0; // the spindle is where it should be
                self.unwritten_s += dt;
            }
            Permission::Refused => self.unwritten_s = f64::INFINITY,
        }
        self.taught = self.taught.or(self.cycle.taught());
        let learning_records = &mut drives.learning_records;
        // how long an encoder-following stroke takes is not known beforehand
        let moment =
            self.cycle.moment(&tap).filter(|_| !following && self.trailing == Trailing::No);
        let standing = self.cycle.phase() == Phase::Bottom;
        let learnt = |ahead: f64| match moment {
            Some(at) if standing => held(learning_records.correction(at)),
            Some(at) => learning_records.correction(at + Time::s(ahead)),
            None => Default::default(),
        };
        let order = self.lead(&tap, spindle, axis.lookahead_s(), &learnt);
        // what the axis obeys now, and when its force acts
        let (now, ahead) = if following || self.trailing != Trailing::No {
            (master.followed, master.followed)
        } else {
            order.unwrap_or((spindle.ordered(), spindle.ordered()))
        };
        let torque =
            torque::supervise(&self.cycle, &mut drives.supervision, (plan, axis, spindle), context);
        let planned = (self.cycle.axis(&tap, now), now.angle);
        let ahead = corrected(self.cycle.axis(&tap, ahead), learnt(axis.lookahead_s()).0);
        let now = corrected(planned.0, learnt(0.0).0);
        if let Some(at) = moment {
            let feed = planned.0.position - Length::mm(axis.position());
            learning_records.note(at, feed, planned.1 - spindle.reading());
        }
        axis.target = target(&now, &ahead, axis.lookahead_s());
        let deep = self.check_depth(plan, axis);
        if self.trailing != Trailing::No && self.cycle.is_standing() && spindle.at_rest() {
            self.stand(spindle, axis);
        }
        self.marks = marks;
        let engaged = self.cycle.coupling().is_some();
        drives.follower = engaged.then_some((plan.axis.index(), feed_forwards(mode)));
        self.note(was, context, dt);
        match deep.and(torque).and_then(|()| self.limits(plan, context)) {
            Err(finding) => Outcome::Failed(finding),
            Ok(()) if self.cycle == Cycle::Done => self.finish(following, drives, context),
            Ok(()) => Outcome::Busy,
        }
    }

    /// It is over: what was learnt is kept.
    fn finish(&self, following: bool, drives: &mut Drives, context: &mut Context) -> Outcome {
        let figures = self.figures();
        if following {
            drives.learning_records.finish_following(&figures, self.taught);
        } else {
            drives.learning_records.finish(&figures);
        }
        context.note(EventKind::TapEnded(figures));
        if let Some(supervised) = drives.supervision.finish() {
            context.note(EventKind::TapSupervised(supervised));
        }
        Outcome::Done
    }

    /// The cycle after this period: it turns back at the bottom when that is on the disk. A spindle
    /// on the ramps of its own drive has been told to turn back before it stands, and waits for
    /// nothing.
    fn turn_back(
        &mut self,
        tap: &Tap<Planned>,
        tick: &Tick,
        record_requests: &mut RecordRequests,
    ) -> Cycle {
        let next = self.cycle.next(tap, tick);
        let at = self.cycle.moment(tap);
        let brakes = at.is_some_and(|at| at >= tap.inward.duration() - TURN_AHEAD);
        let told = matches!(self.cycle, Cycle::Told(..));
        let halted = matches!(self.cycle, Cycle::Halted(..));
        let turns = next.phase() == Phase::Out;
        let about_to = match self.cycle.phase() {
            Phase::In => brakes || told || turns,
            Phase::Bottom => true,
            Phase::Prepare | Phase::Out | Phase::Done => false,
        };
        if !about_to || record_requests.turn() == Permission::Granted || !turns || told {
            return next;
        }
        let Some(coupling) = self.coupling().filter(|_| self.unturned_s < TURN_WAIT.value()) else {
            return next;
        };
        if halted {
            self.unturned_s += tick.elapsed.value();
            return if self.cycle.is_standing() { self.cycle } else { next };
        }
        self.unturned_s += TURN_AGAIN.value();
        // so far before the end of its dwell that the spindle does not turn back by its lookahead
        // either
        Cycle::Bottom(coupling, tap.dwell - TURN_AGAIN)
    }

    /// A spindle that did not obey stands: the axis does too, and goes by orders again if there is
    /// a drive to obey them.
    fn stand(&mut self, spindle: &SpindleLoop, axis: &mut AxisLoop) {
        let there = spindle.error().abs() <= spindle.control.windows.oriented.value();
        if let (Trailing::Until, Some(coupling), true) = (self.trailing, self.coupling(), there) {
            axis.rebase(coupling.follow(spindle.ordered()).position.value());
            self.trailing = Trailing::No;
        }
        axis.rest();
    }

    /// The angle that belongs to the start, where the next period would couple the axis.
    fn engages(&self, tap: &Tap<Planned>, tick: &Tick) -> Option<Angle> {
        match self.cycle {
            Cycle::Orient => tick.held,
            Cycle::StepOn(coupling, _, Time::ZERO) => {
                Some(coupling.phase_difference(Angle::ZERO, tap.start))
            }
            Cycle::AwaitRest
            | Cycle::StepOn(..)
            | Cycle::In(..)
            | Cycle::Bottom(..)
            | Cycle::Out(..)
            | Cycle::Halted(..)
            | Cycle::Told(..)
            | Cycle::RunDown(_)
            | Cycle::Leave(..)
            | Cycle::Done => None,
        }
    }

    /// Hand what the cycle orders to the spindle; what it was ordered now and at the axis'
    /// lookahead.
    fn lead(
        &self,
        tap: &Tap<Planned>,
        spindle: &mut SpindleLoop,
        axis_ahead_s: f64,
        learnt: &impl Fn(f64) -> (Correction, Correction),
    ) -> Option<(Rotation, Rotation)> {
        let rotation = |ahead: f64| match self.cycle.ask(tap, Time::s(ahead)) {
            Ask::Angle(rotation) | Ask::Speed(rotation) => Some(rotation),
            Ask::Rest | Ask::Hold(_) => None,
        };
        match self.cycle.ask(tap, Time::ZERO) {
            Ask::Rest => spindle.stop(),
            Ask::Hold(angle) => spindle.hold(angle.map(Orientation::shortest)),
            Ask::Angle(now) => {
                let s = spindle.lookahead_s();
                let ahead = turned(rotation(s).unwrap_or(now), learnt(s).1);
                spindle.lead(turned(now, learnt(0.0).1), ahead, true);
                return Some((now, rotation(axis_ahead_s).unwrap_or(now)));
            }
            Ask::Speed(now) => {
                spindle.lead(now, rotation(spindle.lookahead_s()).unwrap_or(now), false);
            }
        }
        None
    }

    /// Judge this period's readings.
    fn watch(
        &mut self,
        plan: &TapPlan,
        z: Length,
        spindle: &SpindleLoop,
        context: &mut Context,
    ) -> Result<(), Finding> {
        self.error = None;
        let Some(coupling) = self.cycle.coupling() else { return Ok(()) };
        let into = if plan.bottom < plan.start.along(plan.axis).of_linear() { -1.0 } else { 1.0 };
        self.deepest = self.deepest.max((z - plan.bottom) * into);
        self.fastest = self.fastest.max(spindle.now().spin.abs());
        self.saturated |= spindle.saturated();
        let of = Subject::Axis(plan.axis);
        match self.monitor.observe(&coupling, spindle.reading(), z) {
            Verdict::Outside => {}
            Verdict::Within(error) => self.error = Some(error),
            Verdict::Warn(error) => {
                self.error = Some(error);
                context.note(EventKind::SyncWarning { error });
            }
            Verdict::Stop(error) => {
                self.error = Some(error);
                let limit = context.config.sync_windows.stop.value();
                return Err((FaultKind::SyncError, of, error.value(), limit));
            }
        }
        Ok(())
    }

    fn note(&mut self, was: Phase, context: &mut Context, dt: f64) {
        let is = self.cycle.phase();
        if was == Phase::Prepare && is != Phase::Prepare {
            context.note(EventKind::TapStarted);
        }
        if is == Phase::Prepare || matches!(self.cycle, Cycle::RunDown(_)) {
            self.waited_s += dt;
        } else {
            self.waited_s = 0.0;
        }
        if is != Phase::Prepare {
            self.engaged_s += dt;
        }
    }

    /// Its waits have limits.
    fn limits(&self, plan: &TapPlan, context: &Context) -> Result<(), Finding> {
        let waits = &context.config.waits;
        if self.unwritten_s > RECORD_WAIT.value() {
            return Err((FaultKind::RecordNotWritten, Subject::Machine, 0.0, 0.0));
        }
        let (kind, limit) = match self.cycle {
            Cycle::AwaitRest | Cycle::RunDown(_) => (FaultKind::NotAtSpeed, waits.at_speed),
            Cycle::Orient => (FaultKind::NotOriented, waits.oriented),
            Cycle::StepOn(..)
            | Cycle::In(..)
            | Cycle::Bottom(..)
            | Cycle::Out(..)
            | Cycle::Halted(..)
            | Cycle::Told(..)
            | Cycle::Leave(..)
            | Cycle::Done => return Ok(()),
        };
        if self.waited_s <= limit.value() {
            return Ok(());
        }
        let (value, limit) = match kind {
            FaultKind::NotOriented => (self.waited_s, limit.value()),
            _ => (0.0, 0.0),
        };
        Err((kind, Subject::Spindle(plan.spindle), value, limit))
    }

    fn figures(&self) -> TapFigures {
        TapFigures {
            sync: self.monitor.figures(),
            depth_error: self.deepest,
            spin: self.fastest,
            duration: Time::s(self.engaged_s),
            saturated: self.saturated,
        }
    }
}
