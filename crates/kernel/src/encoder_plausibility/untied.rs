//! The encoders of everything that no tap or thread ties: axes in moves, jogs and at rest, spindles
//! that turn or stand.
//!
//! ```text
//!   stuck at Z-3, in a plain drilled hole:  the loop sees an error that grows, and pushes with all its force
//!   a jump of half a millimetre:            the loop takes it back at once, through the work
//! ```
//!
//! The bounds are those of a tap, but for the way that an axis may be told to go before its reading
//! changes: what friction, play and the stretch of the screw take, and all of the following error
//! where the speed is not fed forward. An axis that pushes on purpose, against a hard stop, is not
//! looked at. A reading that is no number is an alarm of its own.
use super::{Bounds, EncoderPlausibility, Tied, Watched, axis_bounds, spindle_bounds};
use crate::axis::AxisLoop;
use crate::config::Subject;
use crate::drives::{Drives, Finding};
use crate::fault::FaultKind;
use bus::{AXES, Feedback, SPINDLES};
use units::{Angle, Axis, Coordinate};

/// Friction, play and stiffness may be off by so much.
const SPRINGS: f64 = 2.0;

/// What is known of the encoders that nothing ties.
#[derive(Clone, Copy, Debug)]
pub(super) struct Untied {
    axes: [Option<Watched>; AXES],
    spindles: [Option<Watched>; SPINDLES],
    /// What the encoder of an axis can show that goes its own way.
    bounds: [Option<Bounds>; AXES],
}

impl Untied {
    pub(super) fn new(axes: &[Option<AxisLoop>; AXES], period_s: f64) -> Self {
        let bounds = |index: usize| axes[index].as_ref().map(|axis| bounds(axis, period_s));
        let bounds = core::array::from_fn(bounds);
        Self { axes: [None; AXES], spindles: [None; SPINDLES], bounds }
    }
}

impl EncoderPlausibility {
    /// The readings to go by, of what is not tied; and what is wrong.
    pub(crate) fn bridge_untied(
        &mut self,
        tied: Tied,
        taken: &mut Feedback,
        drives: &mut Drives,
        period_s: f64,
    ) -> Option<Finding> {
        let pairs = [tied.pair, self.of];
        let infeeds = [tied.infeed, self.infeed.map(|(axis, _)| axis)];
        let (mut finding, frame_lost) = (None, self.frame_lost);
        for index in 0..AXES {
            let (Some(loop_), Some(bounds)) = (&mut drives.axes[index], self.untied.bounds[index])
            else {
                continue;
            };
            let slot = &mut self.untied.axes[index];
            let said = &mut taken.axes[index];
            let is_tied = pairs.iter().flatten().any(|(axis, _)| *axis == index)
                || infeeds.contains(&Some(index));
            let was_plausible = slot.is_none_or(|watched| watched.plausible);
            let usable = said.ready && said.position.is_finite() && loop_.force_limit.is_infinite();
            if is_tied || was_plausible && !usable {
                *slot = None;
                continue;
            }
            let speed = loop_.target.speed + loop_.superposed.speed;
            let accel = loop_.target.accel + loop_.superposed.accel;
            let expected = period_s * (speed + period_s * accel / 2.0);
            let reading = said.position.value() - loop_.shifted;
            let Some(watched) = slot else {
                *slot = Some(Watched::first(reading));
                continue;
            };
            let bounds = Bounds { frame_lost, ..bounds };
            let (place, lost) = watched.judge(reading, expected, bounds);
            said.position = Coordinate::new(place + loop_.shifted);
            loop_.blind |= lost;
            if lost {
                let of = Subject::Axis(Axis::ALL[index]);
                finding = Some((FaultKind::ReadingImplausible, of, reading - place, 0.0));
            }
        }
        for index in 0..SPINDLES {
            let Some(loop_) = &mut drives.spindles[index] else { continue };
            let slot = &mut self.untied.spindles[index];
            let said = &mut taken.spindles[index];
            let is_tied = pairs.iter().flatten().any(|(_, spindle)| *spindle == index);
            let was_plausible = slot.is_none_or(|watched| watched.plausible);
            if is_tied || was_plausible && !(said.ready && said.angle.is_finite()) {
                *slot = None;
                continue;
            }
            let expected = period_s * loop_.now().spin.value();
            let reading = said.angle.value();
            let Some(watched) = slot else {
                *slot = Some(Watched::first(reading));
                continue;
            };
            let bounds = spindle_bounds(loop_, period_s, frame_lost);
            let (angle, lost) = watched.judge(reading, expected, bounds);
            said.angle = Angle::rev(angle);
            loop_.blind |= lost;
            if lost {
                let of = Subject::Spindle(index as u8);
                finding = Some((FaultKind::ReadingImplausible, of, reading - angle, 0.0));
            }
        }
        finding
    }
}

/// What the encoder of an axis can show that goes its own way.
fn bounds(axis: &AxisLoop, period_s: f64) -> Bounds {
    let control = &axis.control;
    let bounds = axis_bounds(axis, None, period_s);
    // a loop that speed is not fed to begins to move when its error asks for it
    let lags = control.feed_forward.speed < 1.0;
    let late = if lags { control.windows.following_stop.value() } else { 0.0 };
    let springs = control.backlash.value()
        + 2.0 * control.friction.breakaway.value() / control.stiffness.value();
    Bounds { stuck: (SPRINGS * (bounds.stuck + springs)).max(late), ..bounds }
}
