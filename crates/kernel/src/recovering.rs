//! Taking a tool out of the work after a stop in which spindle and feed ran down apart.
//!
//! ```text
//!   Settle ─► Unload ─► Feed or Spindle ─► Out ─► over
//!     │        feed to     the axis that     both, along the coupling, slowly
//!     │        zero force  overran
//!     └─ the spindle is held where it stands; nothing is homed, nothing else moves
//! ```
//!
//! Every move is from rest to rest. The projection is taken when the spindle is held, from the
//! encoders as they are then: recovery can be killed and begun again at any moment. The way, and
//! who moves, is [`sync::recovery`]'s.
use crate::axis::Target;
use crate::config::Subject;
use crate::drives::{Drives, Finding};
use crate::event::{EventKind, RecoveryFigures};
use crate::execute::Context;
use crate::fault::FaultKind;
use crate::terms::target;
use sync::recovery::{Mover, Point, Projection, Stored, Way};
use sync::{Blend, BlendPoint, Coupling, Rotation, SyncMode};
use units::Axis;
use units::{Accel, Angle, Length, Speed, Spin, SpinAccel, Time};

/// What to take out, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RecoveryPlan {
    /// The axis that follows.
    pub axis: Axis,
    /// The spindle that leads.
    pub spindle: u8,
    /// The coupling, its ends, and the sense of travel when the stop began.
    pub stored: Stored,
    /// What the spindle's reading lacks of the stored angle: whole turns, after a loss of power.
    pub turn: Angle,
    /// Which way back onto the coupling.
    pub way: Way,
    /// Most speed and acceleration of the spindle.
    pub spin: (Spin, SpinAccel),
    /// Most speed and acceleration of the axis while it moves alone.
    pub feed: (Speed, Accel),
}

/// A move of one axis or spindle, since a while.
#[derive(Clone, Copy, Debug)]
struct Leg {
    blend: Blend,
    at_s: f64,
}

impl Leg {
    const fn new(blend: Blend) -> Self {
        Self { blend, at_s: 0.0 }
    }

    /// A period on; where it is now and a moment later, and whether it is over.
    fn advance(&mut self, dt: f64, ahead: f64) -> (BlendPoint, BlendPoint, bool) {
        self.at_s += dt;
        let over = self.at_s >= self.blend.duration_s();
        (self.blend.at(self.at_s), self.blend.at(self.at_s + ahead), over)
    }
}

/// How far it is.
#[derive(Clone, Copy, Debug)]
enum RecoveryStage {
    Settle { waited_s: f64 },
    Unload(Leg),
    Feed(Leg),
    Spindle(Leg),
    Out(Leg),
    Done,
}

/// A recovery under way.
#[derive(Clone, Debug)]
pub(crate) struct Recovering {
    plan: RecoveryPlan,
    stage: RecoveryStage,
    projection: Projection,
    helix_max: Length,
    began: Time,
    error: Option<Length>,
}

impl Recovering {
    pub(crate) const fn new(plan: RecoveryPlan, now: Time) -> Self {
        let nowhere = Point { angle: Angle::ZERO, place: Length::ZERO };
        let projection = Projection { from: nowhere, unloaded: nowhere, mover: None, to: nowhere };
        Self {
            plan,
            stage: RecoveryStage::Settle { waited_s: 0.0 },
            projection,
            helix_max: Length::ZERO,
            began: now,
            error: None,
        }
    }

    /// The drives come up for it.
    pub(crate) const fn begins(&mut self, now: Time) {
        self.began = now;
    }

    /// It is out.
    pub(crate) const fn is_done(&self) -> bool {
        matches!(self.stage, RecoveryStage::Done)
    }

    /// Distance from the coupling, by this period's readings; from when it is known.
    pub(crate) const fn sync_error(&self) -> Option<Length> {
        self.error
    }

    /// What is kept together on the way out: axis, spindle, and how, by the spindle's own reading.
    pub(crate) fn coupled(&self) -> Option<(usize, usize, Coupling)> {
        let RecoveryStage::Out(_) = self.stage else { return None };
        let (start, turn) = (self.plan.stored.start(), self.plan.turn);
        let coupling = Coupling::line(self.plan.stored.lead(), start.angle - turn, start.place);
        Some((self.plan.axis.index(), usize::from(self.plan.spindle), coupling))
    }

    /// Go on for `dt` seconds.
    pub(crate) fn advance(
        &mut self,
        dt: f64,
        drives: &mut Drives,
        context: &mut Context,
    ) -> Result<(), Finding> {
        self.watch(drives);
        self.stage = match self.stage {
            RecoveryStage::Settle { waited_s } => self.settle(waited_s + dt, drives, context)?,
            RecoveryStage::Unload(leg) => match feed(self.plan.axis, leg, dt, drives) {
                Some(leg) => RecoveryStage::Unload(leg),
                None => self.back(),
            },
            RecoveryStage::Feed(leg) => match feed(self.plan.axis, leg, dt, drives) {
                Some(leg) => RecoveryStage::Feed(leg),
                None if self.plan.way == Way::Straight => self.over(context),
                None => self.out(context),
            },
            RecoveryStage::Spindle(leg) => match self.turn(leg, dt, drives) {
                (leg, _, false) => RecoveryStage::Spindle(leg),
                (_, _, true) => self.out(context),
            },
            RecoveryStage::Out(leg) => {
                let (leg, ordered, told) = self.turn(leg, dt, drives);
                let stands = self.follow(&leg, ordered, drives, context);
                if told && stands { self.over(context) } else { RecoveryStage::Out(leg) }
            }
            RecoveryStage::Done => RecoveryStage::Done,
        };
        Ok(())
    }

    /// Hold the spindle where it stands, then look where that is.
    fn settle(
        &mut self,
        waited_s: f64,
        drives: &mut Drives,
        context: &mut Context,
    ) -> Result<RecoveryStage, Finding> {
        let (axis, spindle) = (self.plan.axis, self.plan.spindle);
        let of = Subject::Spindle(spindle);
        let Some(control) = drives.spindles.get_mut(usize::from(spindle)).and_then(Option::as_mut)
        else {
            return Err((FaultKind::NotConfigured, of, 0.0, 0.0));
        };
        control.hold(None);
        let Some(angle) = control.held() else {
            let limit = context.config.waits.oriented;
            if waited_s > limit.value() {
                return Err((FaultKind::NotOriented, of, waited_s, limit.value()));
            }
            return Ok(RecoveryStage::Settle { waited_s });
        };
        let Some(follower) = &drives.axes[axis.index()] else {
            return Err((FaultKind::NotConfigured, Subject::Axis(axis), 0.0, 0.0));
        };
        let at =
            Point { angle: angle + self.plan.turn, place: Length::mm(follower.target.position) };
        self.projection = self.plan.stored.project(at, self.plan.way);
        let error = self.plan.stored.error(at);
        context.note(EventKind::RecoveryBegun { error, mover: self.projection.mover });
        Ok(self.unload())
    }

    fn unload(&self) -> RecoveryStage {
        let Projection { from, unloaded, .. } = self.projection;
        RecoveryStage::Unload(Leg::new(self.feed_blend(from.place, unloaded.place)))
    }

    /// Back onto the coupling, by who overran.
    fn back(&self) -> RecoveryStage {
        let Projection { unloaded, mover, to, .. } = self.projection;
        match mover {
            Some(Mover::Spindle) => {
                RecoveryStage::Spindle(Leg::new(self.spindle_blend(unloaded.angle, to.angle)))
            }
            Some(Mover::Feed) | None => {
                RecoveryStage::Feed(Leg::new(self.feed_blend(unloaded.place, to.place)))
            }
        }
    }

    fn out(&self, context: &mut Context) -> RecoveryStage {
        context.note(EventKind::OnCoupling);
        let (from, to) = (self.projection.to.angle, self.plan.stored.start().angle);
        RecoveryStage::Out(Leg::new(self.spindle_blend(from, to)))
    }

    fn over(&self, context: &mut Context) -> RecoveryStage {
        context.note(EventKind::RecoveryEnded(RecoveryFigures {
            error_before: self.plan.stored.error(self.projection.from),
            mover: self.projection.mover,
            helix_error_max: self.helix_max,
            duration: context.feedback.time - self.began,
        }));
        RecoveryStage::Done
    }

    fn feed_blend(&self, from: Length, to: Length) -> Blend {
        let (speed, accel) = self.plan.feed;
        Blend::new(from.value(), to.value(), speed.value(), accel.value())
    }

    fn spindle_blend(&self, from: Angle, to: Angle) -> Blend {
        let (spin, accel) = self.plan.spin;
        let turn = self.plan.turn;
        Blend::new((from - turn).value(), (to - turn).value(), spin.value(), accel.value())
    }

    /// Turn the spindle; what it is ordered now, and whether that was all of its way.
    fn turn(&self, mut leg: Leg, dt: f64, drives: &mut Drives) -> (Leg, Rotation, bool) {
        let Some(spindle) = &mut drives.spindles[usize::from(self.plan.spindle)] else {
            return (leg, Rotation::default(), true);
        };
        let (now, ahead, over) = leg.advance(dt, spindle.lookahead_s());
        let ordered = rotation(&now);
        spindle.lead(ordered, rotation(&ahead), true);
        (leg, ordered, over)
    }

    /// Keep the axis on its coupling: by what the spindle is ordered, or, where the axis follows an
    /// encoder since the drive obeys no trajectory, by how it turns; whether the spindle is where
    /// it should be.
    fn follow(&self, leg: &Leg, ordered: Rotation, drives: &mut Drives, context: &Context) -> bool {
        let Some(spindle) = &drives.spindles[usize::from(self.plan.spindle)] else { return true };
        let Some(axis) = &mut drives.axes[self.plan.axis.index()] else { return true };
        let coupling = self.plan.stored.coupling();
        let turn = self.plan.turn;
        let at = |r: Rotation| coupling.follow(Rotation { angle: r.angle + turn, ..r });
        let ahead_s = axis.lookahead_s();
        if context.config.synchronisation == SyncMode::CommandSynchronised {
            let later = rotation(&leg.blend.at(leg.at_s + ahead_s));
            axis.target = target(&at(ordered), &at(later), ahead_s);
            return true;
        }
        let turns = at(spindle.now());
        axis.target = target(&turns, &turns, ahead_s);
        spindle.at_rest()
    }

    /// How far from the coupling it is, and, once it is on it, was at most.
    fn watch(&mut self, drives: &Drives) {
        self.error = None;
        if matches!(self.stage, RecoveryStage::Settle { .. } | RecoveryStage::Done) {
            return;
        }
        let spindle = drives.spindles[usize::from(self.plan.spindle)].as_ref();
        let axis = drives.axes[self.plan.axis.index()].as_ref();
        if let (Some(spindle), Some(axis)) = (spindle, axis) {
            let angle = spindle.reading() + self.plan.turn;
            let error = self.plan.stored.error(Point { angle, place: Length::mm(axis.position()) });
            self.error = Some(error);
            if matches!(self.stage, RecoveryStage::Out(_)) {
                self.helix_max = self.helix_max.max(error.abs());
            }
        }
    }
}

/// Move one axis; `None` when it is there.
fn feed(axis: Axis, mut leg: Leg, dt: f64, drives: &mut Drives) -> Option<Leg> {
    let control = drives.axes[axis.index()].as_mut()?;
    let ahead_s = control.lookahead_s();
    let (now, ahead, over) = leg.advance(dt, ahead_s);
    control.target =
        Target { position: now.s, speed: now.v, accel: now.a, jerk: (ahead.a - now.a) / ahead_s };
    (!over).then_some(leg)
}

const fn rotation(point: &BlendPoint) -> Rotation {
    Rotation {
        angle: Angle::rev(point.s),
        spin: Spin::rev_per_s(point.v),
        accel: SpinAccel::rev_per_s2(point.a),
    }
}
