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
//! looked at. A reading that is no number has an alarm of its own.
use super::watched::{Bounds, Change, Watched};
use super::{
    EncoderPlausibility, Tied, axis_bounds, expected_of_axis, expected_of_spindle, look,
    look_at_spindle, ordered_way, spindle_bounds, under_way,
};
use crate::axis::AxisLoop;
use crate::config::Subject;
use crate::drives::{Drives, Finding};
use crate::fault::FaultKind;
use crate::sight::Without;
use bus::{AXES, Feedback, SPINDLES};
use units::{Angle, Axis, Coordinate};

/// Friction, play and stiffness may be off by so much.
const SPRINGS: f64 = 2.0;

/// By this many times its breakaway force, and this share of its most, a drive may push more before
/// a reading that stays is stuck.
const PUSHES: f64 = 3.0;
const LEAST_PUSH: f64 = 0.02;

/// What is known of the encoders that nothing ties.
#[derive(Clone, Copy, Debug)]
pub(super) struct Untied {
    axes: [Option<Watched>; AXES],
    spindles: [Option<Watched>; SPINDLES],
    /// What the encoder of an axis can show that goes its own way.
    bounds: [Option<Bounds>; AXES],
    /// Axes that were free and have been taken over as they move.
    pub(super) taken_over: [bool; AXES],
}

impl Untied {
    pub(super) fn new(axes: &[Option<AxisLoop>; AXES], period_s: f64) -> Self {
        let bounds = |index: usize| axes[index].as_ref().map(|axis| bounds(axis, period_s));
        let bounds = core::array::from_fn(bounds);
        Self { axes: [None; AXES], spindles: [None; SPINDLES], bounds, taken_over: [false; AXES] }
    }

    /// No encoder is usable any more.
    pub(super) fn lose_all(&mut self) {
        self.axes.iter_mut().flatten().for_each(Watched::lose);
        self.spindles.iter_mut().flatten().for_each(Watched::lose);
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
            let was_sound = slot.is_none_or(|watched| watched.is_sound());
            let usable = said.ready && loop_.force_limit.is_infinite();
            if is_tied || was_sound && !usable {
                *slot = None;
                continue;
            }
            let ordered = ordered_way(loop_, period_s);
            let reading = said.position.value() - loop_.shifted;
            let Some(watched) = slot else {
                *slot = reading.is_finite().then(|| Watched::first(reading));
                continue;
            };
            let expected = expected_of_axis(loop_, ordered, watched);
            let (error, force) = (loop_.error(), loop_.force() + loop_.control.weight.value());
            let stuck = bounds.stuck + under_way(loop_);
            let bounds = Bounds { stuck, error, force, frame_lost, ..bounds };
            let (place, change) = watched.judge(reading, expected, bounds);
            said.position = Coordinate::new(place + loop_.shifted);
            self.untied.taken_over[index] |=
                look(loop_, change, Without::Nothing, (place != reading, period_s));
            if change == Change::Lost {
                let of = Subject::Axis(Axis::ALL[index]);
                finding = Some((without_reading(reading), of, reading - place, 0.0));
            }
        }
        for index in 0..SPINDLES {
            let Some(loop_) = &mut drives.spindles[index] else { continue };
            let slot = &mut self.untied.spindles[index];
            let said = &mut taken.spindles[index];
            let is_tied = pairs.iter().flatten().any(|(_, spindle)| *spindle == index);
            let was_sound = slot.is_none_or(|watched| watched.is_sound());
            if is_tied || was_sound && !said.ready {
                *slot = None;
                continue;
            }
            let reading = said.angle.value();
            let Some(watched) = slot else {
                *slot = reading.is_finite().then(|| Watched::first(reading));
                continue;
            };
            let expected = expected_of_spindle(loop_, watched, period_s);
            let is_stuck = !frame_lost && loop_.notes_stuck(reading, false);
            let bounds = Bounds { is_stuck, frame_lost, ..spindle_bounds(loop_, period_s) };
            let (angle, change) = watched.judge(reading, expected, bounds);
            said.angle = Angle::rev(angle);
            look_at_spindle(loop_, change, Without::Nothing, (angle, period_s));
            if change == Change::Lost {
                let of = Subject::Spindle(index as u8);
                finding = Some((without_reading(reading), of, reading - angle, 0.0));
            }
        }
        finding
    }
}

/// The alarm for a reading that cannot be used.
const fn without_reading(reading: f64) -> FaultKind {
    if reading.is_finite() { FaultKind::ReadingImplausible } else { FaultKind::FeedbackInvalid }
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
    let push =
        (PUSHES * control.friction.breakaway.value()).max(LEAST_PUSH * control.peak_force.value());
    Bounds { stuck: (SPRINGS * (bounds.stuck + springs)).max(late), push, ..bounds }
}
