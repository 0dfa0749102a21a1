//! Running a planned tap on the loops: the cycle decides, this carries it out and watches it.
//!
//! ```text
//!   TapPlan ─► sync::Cycle ─► ask ──────────────► spindle loop
//!                  ▲           └─ order, or ─┐
//!                  │    readings ─► age ─► prediction ─► coupling ─► axis loop
//!                  └──────────── spindle                    │
//!                                       monitor ◄── readings of both
//! ```
use crate::axis::{AxisLoop, Target};
use crate::config::{Config, FeedForward, SpindleControl, Subject};
use crate::drives::{Drives, Finding};
use crate::event::{EventKind, TapFigures};
use crate::execute::Context;
use crate::fault::FaultKind;
use crate::moving::{point, stand_at};
use crate::scribe::{Leave, RECORD_WAIT, TapRecord};
use crate::spindle::SpindleLoop;
use crate::stroke::{Mark, Planned};
use plan::TapPlan;
use sync::recovery::{Direction, Stored};
use sync::{
    Ask, Correction, Coupling, Cycle, Follower, Halt, MAX_TRANSPORT, Monitor, Phase, Prediction,
    Rotation, Spoken, Stopping, SyncMode, Tap, Tick, Verdict,
};
use units::{Accel, Angle, Length, Speed, Spin, SpinAccel, SpinJerk, Time};

/// Time in which a stop's deceleration rises where the plan's jerk does not say, s.
const STOP_RISE_S: f64 = 0.01;
/// Share of a stop's deceleration with which a tap that was held goes on.
const ON_SHARE: f64 = 0.3;
/// A tap that began in its thread is clear of the work so many turns above it.
const CLEAR_TURNS: f64 = 2.0;

/// Readings of the master on their way to the follower.
#[derive(Clone, Copy, Debug)]
struct Transport {
    readings: [Rotation; MAX_TRANSPORT as usize + 1],
    age: usize,
}

impl Transport {
    fn new(first: Rotation, age: u8) -> Self {
        let age = usize::from(age.min(MAX_TRANSPORT));
        Self { readings: [first; MAX_TRANSPORT as usize + 1], age }
    }

    /// Send one off; the one that arrives.
    fn pass(&mut self, reading: Rotation) -> Rotation {
        self.readings.rotate_right(1);
        self.readings[0] = reading;
        self.readings[self.age]
    }
}

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
    engaged_s: f64,
    deepest: Length,
    fastest: Spin,
    saturated: bool,
    error: Option<Length>,
    /// By how much longer than planned the spindle has shown to stop.
    taught: Option<Angle>,
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
        let transport = Transport::new(spindle.now(), age);
        stand_at(&point(&plan.start), drives)?;
        drives.lessons.begin(drives.tool, plan);
        Ok(Self {
            cycle: Cycle::new(),
            monitor: Monitor::new(config.sync_windows, plan.surface, plan.bottom),
            transport,
            marks: [Mark::default(), Mark::default()],
            waited_s: 0.0,
            unwritten_s: 0.0,
            engaged_s: 0.0,
            deepest: -(plan.bottom - plan.start.along(plan.axis)).abs(),
            fastest: Spin::ZERO,
            saturated: false,
            error: None,
            taught: None,
        })
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
        self.coupling().is_some() && z.is_some_and(|z| self.monitor.depth(z) >= Length::ZERO)
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
        let seen = self.watch(plan, Length::mm(axis.position()), spindle, context);
        if let (Err(finding), false) = (seen, context.halted) {
            return Outcome::Failed(finding);
        }
        let mode = context.config.synchronisation;
        let following = mode != SyncMode::CommandSynchronised;
        let marks = self.marks.clone();
        let tap = Tap {
            lead: plan.lead,
            start: plan.start.along(plan.axis),
            bottom: plan.bottom,
            end: plan.end,
            spin: plan.spin,
            inward: &Planned { profile: &plan.inward, mark: &marks[0] },
            dwell: plan.dwell,
            outward: &Planned { profile: &plan.outward, mark: &marks[1] },
            start_angle: plan.start_angle,
            encoder_following: following,
            early: drives.lessons.early(),
            spoken: spoken(plan, &spindle.control, context.config, drives.lessons.know())
                .filter(|_| following),
            gentle: axis.control.gentle,
            halt: halt(plan, axis, spindle),
        };
        let master = self.master(mode, spindle, context.config.period);
        let tick = Tick {
            elapsed: Time::s(dt),
            master,
            at_rest: spindle.at_rest(),
            held: spindle.held(),
            rest: context.halted || context.operator.wants_rest(),
            out: context.operator.wants_out(),
        };
        let was = self.cycle.phase();
        let engages = self.engages(&tap, &tick);
        let record = engages
            .map(|theta0| TapRecord::of(plan, context.op, context.line, drives.tool, theta0));
        match record.map_or(Leave::Granted, |record| drives.scribe.ask(&record)) {
            Leave::Granted => self.cycle = self.cycle.next(&tap, &tick),
            Leave::Waiting => {
                self.waited_s = 0.0; // the spindle is where it should be
                self.unwritten_s += dt;
            }
            Leave::Refused => self.unwritten_s = f64::INFINITY,
        }
        if was != Phase::Out && self.cycle.phase() == Phase::Out {
            drives.scribe.turned();
        }
        self.taught = self.taught.or(self.cycle.taught());
        let lessons = &mut drives.lessons;
        // how long an encoder-following stroke takes is not known beforehand
        let moment = self.cycle.moment(&tap).filter(|_| !following);
        let standing = self.cycle.phase() == Phase::Bottom;
        let learnt = |ahead: f64| match moment {
            Some(at) if standing => held(lessons.correction(at)),
            Some(at) => lessons.correction(at + Time::s(ahead)),
            None => Default::default(),
        };
        let order = self.lead(&tap, spindle, axis.lookahead_s(), &learnt);
        // what the axis obeys now, and when its force acts
        let (now, ahead) = if following {
            (master, master)
        } else {
            order.unwrap_or((spindle.ordered(), spindle.ordered()))
        };
        let planned = (self.cycle.axis(&tap, now), now.angle);
        let ahead = corrected(self.cycle.axis(&tap, ahead), learnt(axis.lookahead_s()).0);
        let now = corrected(planned.0, learnt(0.0).0);
        if let Some(at) = moment {
            let feed = planned.0.position - Length::mm(axis.position());
            lessons.note(at, feed, planned.1 - spindle.reading());
        }
        axis.target = target(&now, &ahead, axis.lookahead_s());
        self.marks = marks;
        let engaged = self.cycle.coupling().is_some();
        drives.follower = engaged.then_some((plan.axis.index(), feed_forwards(mode)));
        self.note(was, context, dt);
        match self.limits(plan, context) {
            Err(finding) => Outcome::Failed(finding),
            Ok(()) if self.cycle == Cycle::Done => {
                let figures = self.figures();
                if following {
                    drives.lessons.finish_following(&figures, self.taught);
                } else {
                    drives.lessons.finish(&figures);
                }
                context.note(EventKind::TapEnded(figures));
                Outcome::Done
            }
            Ok(()) => Outcome::Busy,
        }
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

    /// The master that an encoder-following axis obeys: the reading that has arrived, or what it predicts.
    fn master(&mut self, mode: SyncMode, spindle: &SpindleLoop, period: Time) -> Rotation {
        match mode {
            SyncMode::CommandSynchronised => spindle.now(),
            SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport } => {
                self.transport.pass(spindle.now()).after(period * f64::from(transport))
            }
            SyncMode::EncoderFollowing { .. } => {
                let raw = Rotation { angle: spindle.reading(), ..spindle.now() };
                self.transport.pass(raw)
            }
        }
    }

    /// Hand the cycle's wish to the spindle; what it was ordered now and at the axis' lookahead.
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
            Ask::Hold(angle) => spindle.hold(angle),
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
        let into = if plan.bottom < plan.start.along(plan.axis) { -1.0 } else { 1.0 };
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
        Err((kind, Subject::Spindle(plan.spindle), 0.0, 0.0))
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

/// How this tap is stopped: with what is left of the drive when nothing is planned, no more jerk than its own
/// strokes, and never beyond what the axis can follow.
fn halt(plan: &TapPlan, axis: &AxisLoop, spindle: &SpindleLoop) -> Halt {
    let lead = plan.lead.value().abs();
    let (level, power) = spindle.braking();
    let level = level.min(axis.braking() / lead);
    let jerk = plan.inward.pieces().iter().map(|piece| piece.j.abs()).fold(0.0, f64::max);
    // a stroke of straight ramps has none
    let jerk = if jerk.is_finite() && jerk > 0.0 { jerk } else { level / STOP_RISE_S };
    Halt {
        level: SpinAccel::rev_per_s2(level),
        power,
        jerk: SpinJerk::rev_per_s3(jerk),
        slow: spindle.control.orient,
        on: (
            plan.spin.abs().min(Spin::rev_per_s(power / level)),
            SpinAccel::rev_per_s2(ON_SHARE * level),
        ),
        clear: clear(plan),
    }
}

/// Where the tap is clear of the work: at its start; of a peck that begins in the thread, above the surface.
fn clear(plan: &TapPlan) -> Length {
    let start = plan.start.along(plan.axis);
    let into = if plan.bottom < start { -1.0 } else { 1.0 };
    if (plan.surface - start).value() * into > 0.0 {
        return start;
    }
    plan.surface - Length::mm(CLEAR_TURNS * plan.lead.value().abs() * into)
}

/// What the cycle must know of a spindle whose drive makes its own ramps. An order given in this period takes effect
/// after the command's delay.
fn spoken(
    plan: &TapPlan,
    control: &SpindleControl,
    config: &Config,
    known: bool,
) -> Option<Spoken> {
    control.own_ramps.map(|own| Spoken {
        speeds: (plan.spin, plan.return_spin),
        stopping: Stopping { delay: own.delay + config.command_delay, decel: own.decel },
        uncertainty: own.uncertainty,
        creep: plan.spin.abs() * own.creep,
        known,
    })
}

/// The feed-forwards that go with what is made of the readings; `None`: the axis' own.
const fn feed_forwards(mode: SyncMode) -> Option<FeedForward> {
    match mode {
        SyncMode::CommandSynchronised
        | SyncMode::EncoderFollowing { prediction: Prediction::Observer, .. } => None,
        SyncMode::EncoderFollowing { prediction: Prediction::None, .. } => Some(FeedForward::NONE),
        SyncMode::EncoderFollowing { prediction: Prediction::Speed, .. } => {
            Some(FeedForward { speed: 1.0, ..FeedForward::NONE })
        }
    }
}

/// A correction held where it stands.
fn held((feed, spindle): (Correction, Correction)) -> (Correction, Correction) {
    let still = |c: Correction| Correction { u: c.u, rate: 0.0, accel: 0.0 };
    (still(feed), still(spindle))
}

fn corrected(follower: Follower, by: Correction) -> Follower {
    Follower {
        position: follower.position + Length::mm(by.u),
        speed: follower.speed + Speed::mm_per_s(by.rate),
        accel: follower.accel + Accel::mm_per_s2(by.accel),
    }
}

fn turned(rotation: Rotation, by: Correction) -> Rotation {
    Rotation {
        angle: rotation.angle + Angle::rev(by.u),
        spin: rotation.spin + Spin::rev_per_s(by.rate),
        accel: rotation.accel + SpinAccel::rev_per_s2(by.accel),
    }
}

fn target(now: &Follower, ahead: &Follower, lookahead_s: f64) -> Target {
    let accel = now.accel.value();
    Target {
        position: now.position.value(),
        speed: now.speed.value(),
        accel,
        jerk: (ahead.accel.value() - accel) / lookahead_s,
    }
}
