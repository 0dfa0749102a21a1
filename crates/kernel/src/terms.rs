//! What a tap's cycle is told of the machine that it runs on, and what the loops make of its
//! answers.
use crate::axis::{AxisLoop, Target};
use crate::config::{Config, FeedForward, SpindleControl};
use crate::spindle::SpindleLoop;
use motion::TapPlan;
use sync::{Correction, Follower, Halt, Prediction, Rotation, Spoken, Stopping, SyncMode};
use units::{Accel, Angle, Length, Speed, Spin, SpinAccel, SpinJerk, Time};

/// Time in which a stop's deceleration rises where the plan's jerk does not say, s.
const STOP_RISE_S: f64 = 0.01;
/// Share of a stop's deceleration with which a tap that was held goes on.
const ON_SHARE: f64 = 0.3;
/// A tap that began in its thread is clear of the work so many turns above it.
const CLEAR_TURNS: f64 = 2.0;

/// Speed and acceleration of an approach.
pub(crate) fn approach(axis: &AxisLoop) -> (Speed, Accel) {
    let (speed, accel) = axis.control.approach;
    (speed.of_linear(), accel.of_linear())
}

/// How this tap is stopped: with what is left of the drive when nothing is planned, no more jerk
/// than its own strokes, and never beyond what the axis can follow.
pub(crate) fn halt(plan: &TapPlan, axis: &AxisLoop, spindle: &SpindleLoop) -> Halt {
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

/// Where the tap is clear of the work: at its start; of a peck that begins in the thread, above the
/// surface.
pub(crate) fn clear(plan: &TapPlan) -> Length {
    let start = plan.start.along(plan.axis).of_linear();
    let into = if plan.bottom < start { -1.0 } else { 1.0 };
    if (plan.surface - start).value() * into > 0.0 {
        return start;
    }
    plan.surface - Length::mm(CLEAR_TURNS * plan.lead.value().abs() * into)
}

/// What the cycle must know of a spindle whose drive makes its own ramps. An order given in this
/// period takes effect after the command's delay.
pub(crate) fn spoken(
    plan: &TapPlan,
    control: &SpindleControl,
    config: &Config,
    known: bool,
) -> Option<Spoken> {
    control.own_ramps.map(|own| {
        let (late, uncertainty) = if known { own.repeats } else { (Time::ZERO, own.uncertainty) };
        Spoken {
            speeds: (plan.spin, plan.return_spin),
            stopping: Stopping { delay: own.delay + config.command_delay, decel: own.decel },
            uncertainty,
            late,
            creep: plan.spin.abs() * own.creep,
            at_speed: known && plan.turns_at_speed,
        }
    })
}

/// The feed-forwards that go with what is made of the readings; `None`: the axis' own.
pub(crate) const fn feed_forwards(mode: SyncMode) -> Option<FeedForward> {
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
pub(crate) fn held((feed, spindle): (Correction, Correction)) -> (Correction, Correction) {
    let still = |c: Correction| Correction { u: c.u, rate: 0.0, accel: 0.0 };
    (still(feed), still(spindle))
}

pub(crate) fn corrected(follower: Follower, by: Correction) -> Follower {
    Follower {
        position: follower.position + Length::mm(by.u),
        speed: follower.speed + Speed::mm_per_s(by.rate),
        accel: follower.accel + Accel::mm_per_s2(by.accel),
    }
}

pub(crate) fn turned(rotation: Rotation, by: Correction) -> Rotation {
    Rotation {
        angle: rotation.angle + Angle::rev(by.u),
        spin: rotation.spin + Spin::rev_per_s(by.rate),
        accel: rotation.accel + SpinAccel::rev_per_s2(by.accel),
    }
}

pub(crate) fn target(now: &Follower, ahead: &Follower, lookahead_s: f64) -> Target {
    let accel = now.accel.value();
    Target {
        position: now.position.value(),
        speed: now.speed.value(),
        accel,
        jerk: (ahead.accel.value() - accel) / lookahead_s,
    }
}
