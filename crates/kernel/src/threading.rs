//! Turning a thread: the axes are a function of the spindle's turns, from the start angle on.
//!
//! ```text
//!   spindle θ (its setpoint where it is led by angle, else the observer's) ─► φ = ±θ − origin ─► stretch ─► X, Y, Z
//! ```
//!
//! The origin is the next place at which the spindle stands at the start angle and the run-in still fits before it.
//! Nothing but the spindle moves the axes: overrides do not act, a hold waits for the chain's end, and a stop for an
//! alarm brings spindle and axes to rest together, on the thread.
use crate::config::Subject;
use crate::drives::{Drives, Finding};
use crate::fault::FaultKind;
use crate::moving::stand_at;
use path::AXES;
use plan::{THREADING_AXES, ThreadStretch};
use units::Time;

/// The chain under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chain {
    /// −1 where the spindle turns counter-clockwise.
    sense: f64,
    /// `sense`·angle of the spindle where the chain's turns count from zero.
    origin: f64,
}

/// Begin a stretch: wait for the start angle, or go on in the chain.
pub(crate) fn begin(stretch: &ThreadStretch, drives: &mut Drives) -> Result<(), Finding> {
    let of = Subject::Spindle(stretch.spindle);
    let spindle = usize::from(stretch.spindle);
    if !drives.spindles.get(spindle).is_some_and(Option::is_some) {
        return Err((FaultKind::NotConfigured, of, 0.0, 0.0));
    }
    let Some(start) = stretch.start else {
        return match drives.chain {
            Some(_) => Ok(()),
            None => Err((FaultKind::SetpointJump, of, 0.0, 0.0)),
        };
    };
    let mut place = [0.0; AXES];
    for (index, axis) in drives.axes.iter().enumerate() {
        place[index] = match axis {
            _ if index < THREADING_AXES => stretch.from[index],
            Some(axis) => axis.target.position,
            None => 0.0,
        };
    }
    stand_at(&place, drives)?;
    drives.pace(spindle, f64::INFINITY);
    let master = drives.master(spindle);
    let sense = if master.spin.value() < 0.0 { -1.0 } else { 1.0 };
    let now = sense * master.angle.value() - stretch.begins();
    let first = sense * start.value();
    drives.chain = Some(Chain { sense, origin: first + libm::ceil(now - first) });
    Ok(())
}

/// Go on; whether the stretch is done.
pub(crate) fn advance(stretch: &ThreadStretch, period: Time, drives: &mut Drives) -> bool {
    let Some(chain) = drives.chain else { return true };
    let spindle = usize::from(stretch.spindle);
    let master = drives.master_after_steps(spindle, period);
    let turn = chain.sense * master.angle.value() - chain.origin;
    let (n, growth) = (chain.sense * master.spin.value(), chain.sense * master.accel.value());
    let over = turn >= stretch.is_over_at();
    let begun = turn >= stretch.begins();
    let on = stretch.at(turn);
    for i in 0..THREADING_AXES {
        let Some(axis) = &mut drives.axes[i] else { continue };
        axis.target.position = on.q[i];
        axis.target.speed = on.rate[i] * n;
        axis.target.accel = on.bend[i] * n * n + on.rate[i] * growth;
        axis.target.jerk = on.third[i] * n * n * n + 3.0 * on.bend[i] * n * growth;
    }
    drives.flowing = begun && !(over && stretch.ends);
    if over && stretch.ends {
        drives.rest_axes();
        drives.chain = None;
        drives.leave(spindle);
    }
    over
}
