//! Moving along a planned path.
//!
//! ```text
//!   time since the start ──► profile: s, v, a ──► path: every axis' position, speed, acceleration
//!   (or revolutions, G95)
//! ```
//!
//! The same is evaluated a moment ahead, for the feed-forwards; the difference is handed on as a jerk.
//! For a move per revolution the profile's rates are per revolution, so that v = v′·|ω| and a = a′·ω².
use crate::config::Subject;
use crate::drives::{Drives, Finding, LINEAR};
use crate::fault::FaultKind;
use crate::spindle::SpindleLoop;
use canon::{Axis, Position};
use plan::{Instant, Motion, Move};

/// A step may begin this far from where the axis stands, mm; the difference is smoothed away.
pub(crate) const JUMP_MM: f64 = 0.050;

/// A move under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving {
    /// Seconds or revolutions done.
    at: f64,
    /// Where the spindle stood at the start, for moves per revolution.
    origin_rev: f64,
}

impl Moving {
    /// It stands by the operator's hold, somewhere along its path.
    pub(crate) const fn is_held(&self) -> bool {
        false
    }

    /// Begin, if the axes stand where the move begins.
    pub(crate) fn begin(order: &Move, drives: &mut Drives) -> Result<Self, Finding> {
        stand_at(order.path.from(), drives)?;
        for index in LINEAR {
            let axis = Axis::ALL[index];
            let moves = order.path.from().along(axis) != order.path.to().along(axis);
            if moves && drives.axes[index].is_none() {
                return Err((FaultKind::NotConfigured, Subject::Axis(axis), 0.0, 0.0));
            }
        }
        let origin_rev = match &drives.spindles[0] {
            Some(spindle) => spindle.now().angle.value(),
            None if order.per_revolution => {
                return Err((FaultKind::NotConfigured, Subject::Spindle(0), 0.0, 0.0));
            }
            None => 0.0,
        };
        Ok(Self { at: 0.0, origin_rev })
    }

    /// Go on for `dt` seconds; the seconds that were left over when it is done.
    pub(crate) fn advance(&mut self, order: &Move, dt: f64, drives: &mut Drives) -> Option<f64> {
        let lookahead = drives.lookahead_s();
        let spin = if order.per_revolution {
            let now = drives.spindles[0].as_ref().map_or_else(Default::default, SpindleLoop::now);
            let turned = (now.angle.value() - self.origin_rev).abs();
            self.at = self.at.max(turned);
            now.spin.value().abs()
        } else {
            self.at += dt;
            1.0
        };
        let now = scaled(order.profile.at(self.at), spin);
        let ahead = scaled(order.profile.at(self.at + lookahead * spin), spin);
        let over = self.at - order.profile.duration();
        if over >= 0.0 {
            set(&order.path.motion(order.profile.end()), None, lookahead, drives);
            drives.rest_axes();
            return Some(if order.per_revolution { 0.0 } else { over });
        }
        set(&order.path.motion(now), Some(&order.path.motion(ahead)), lookahead, drives);
        None
    }
}

/// The profile's rates, per second.
fn scaled(at: Instant, spin: f64) -> Instant {
    Instant { s: at.s, v: at.v * spin, a: at.a * spin * spin }
}

/// The axes shall stand at a place to within [`JUMP_MM`]; what little is missing is smoothed away.
pub(crate) fn stand_at(place: &Position, drives: &mut Drives) -> Result<(), Finding> {
    for index in LINEAR {
        let axis = Axis::ALL[index];
        let Some(control) = &mut drives.axes[index] else { continue };
        let jump = place.along(axis).value() - control.target.position;
        if jump.is_nan() || jump.abs() > JUMP_MM {
            return Err((FaultKind::SetpointJump, Subject::Axis(axis), jump, JUMP_MM));
        }
    }
    for index in LINEAR {
        if let Some(control) = &mut drives.axes[index] {
            control.rebase(place.along(Axis::ALL[index]).value());
        }
    }
    Ok(())
}

fn set(now: &Motion, ahead: Option<&Motion>, lookahead: f64, drives: &mut Drives) {
    for index in LINEAR {
        let Some(axis) = &mut drives.axes[index] else { continue };
        let accel = now.accel[index].value();
        axis.target.position = now.position[index].value();
        axis.target.speed = now.speed[index].value();
        axis.target.accel = accel;
        axis.target.jerk = ahead.map_or(0.0, |m| (m.accel[index].value() - accel) / lookahead);
    }
}
