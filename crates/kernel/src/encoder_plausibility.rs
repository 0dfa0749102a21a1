//! Readings that cannot be: noticed within a period, and bridged until everything stands; in a tap
//! and a turned thread, where feed and spindle are tied, and in all else ([`untied`]).
//!
//! ```text
//!   place │        ╱ reading jumps by more than the drive can do in a period: slipped, or a lost line
//!         │    ___╱
//!         │  ╱   ── reading stays, though the setpoint has gone on by so much: stuck
//!         │╱ ╌╌╌╌╌ what is taken instead: the reading before, and from there on the setpoint's own steps
//!         └─────────► time
//! ```
//!
//! A loop that followed such a reading would drive spindle and feed apart with all its force, and
//! switching both off lets them run down apart. The loop whose encoder is implausible goes blind:
//! what it had learnt of the load stays, and feed-forward does the stop. That is good for the tenth
//! of a second that a stop takes. What others ask of its place is answered by the reading before
//! and the setpoint's own steps. That encoder is not used again before the control is started anew.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | Δ | step of the reading within a period | mm, rev |
//! | a | most acceleration of what carries the encoder | mm/s², rev/s² |
//! | h, q | period, one count | s; mm, rev |
//!
//! Refused: |Δ − Δ before| > 3·a·h² + 8·q, and for an axis no step at all while the setpoint goes
//! on by 2 µm or 16·q (and by what a loop needs to break away, where friction is not fed forward).
//! A spindle that does not turn may as well be stalled; its following error says so.
mod untied;

use crate::axis::AxisLoop;
use crate::config::{EncoderPlace, FeedForward, Subject};
use crate::drives::{Drives, Finding};
use crate::fault::FaultKind;
use crate::spindle::SpindleLoop;
use bus::{AXES, Feedback};
use units::Axis;
use untied::Untied;

/// Steps may differ by what the drive's most acceleration does in a period, times this: cut and
/// springs add to it.
const BEYOND_DRIVE: f64 = 3.0;
/// And by the encoder's noise, in counts.
const NOISE_COUNTS: f64 = 8.0;
/// A setpoint goes on by so much, mm, or so many counts, before a reading that stays is stuck.
const STUCK_MM: f64 = 0.002;
const STUCK_COUNTS: f64 = 16.0;
/// The same of an infeed axis, which may rest and reverse in its play, mm.
const INFEED_STUCK_MM: f64 = 0.05;

/// What is known of one encoder.
#[derive(Clone, Copy, Debug)]
struct Watched {
    last: f64,
    /// `None`: only one reading is known.
    step: Option<f64>,
    /// How far the setpoint has gone since the reading last changed.
    unmoved: f64,
    plausible: bool,
}

/// What an encoder can show.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    /// Most change of a step.
    jump: f64,
    /// Most way of the setpoint without a step.
    stuck: f64,
    /// The reading is not new.
    frame_lost: bool,
}

impl Watched {
    const fn new(reading: f64, step: f64) -> Self {
        Self { last: reading, step: Some(step), unmoved: 0.0, plausible: true }
    }

    /// Nothing is known of how it moves.
    const fn first(reading: f64) -> Self {
        Self { last: reading, step: None, unmoved: 0.0, plausible: true }
    }

    /// What is to be taken for a reading; whether it has just become implausible.
    fn judge(&mut self, reading: f64, expected: f64, bounds: Bounds) -> (f64, bool) {
        if bounds.frame_lost {
            // it is as old as the one before: as if it had gone on
            self.last += expected;
            return (self.last, false);
        }
        let step = reading - self.last;
        self.unmoved = if step == 0.0 { self.unmoved + expected.abs() } else { 0.0 };
        let jump = self.step.map_or(0.0, |before| step - before);
        let can_be = jump.abs() <= bounds.jump && self.unmoved <= bounds.stuck;
        if self.plausible && can_be {
            (self.last, self.step) = (reading, Some(step));
            return (reading, false);
        }
        self.last += expected;
        (self.last, core::mem::replace(&mut self.plausible, false))
    }
}

/// The encoders of what is coupled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EncoderPlausibility {
    of: Option<(usize, usize)>,
    axis: Option<Watched>,
    spindle: Option<Watched>,
    infeed: Option<(usize, Watched)>,
    untied: Untied,
    /// This period has brought no new readings.
    pub(crate) frame_lost: bool,
}

/// Whose encoders are watched.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tied {
    /// An axis and its spindle, that a tap or a thread ties together.
    pub(crate) pair: Option<(usize, usize)>,
    /// The axis that takes a tool off the work.
    pub(crate) infeed: Option<usize>,
}

impl EncoderPlausibility {
    /// Nothing has been read yet, of these axes.
    pub(crate) fn new(axes: &[Option<AxisLoop>; AXES], period_s: f64) -> Self {
        let untied = Untied::new(axes, period_s);
        Self { of: None, axis: None, spindle: None, infeed: None, untied, frame_lost: false }
    }

    /// One of the encoders is implausible.
    fn any(&self) -> bool {
        [self.axis, self.spindle].iter().flatten().any(|watched| !watched.plausible)
    }

    /// Readings become those to go by: as they are, but for what cannot be of the pair that is
    /// coupled; and what is wrong.
    pub(crate) fn bridge(
        &mut self,
        tied: Tied,
        taken: &mut Feedback,
        drives: &mut Drives,
        period_s: f64,
    ) -> Option<Finding> {
        let frame_lost = self.frame_lost;
        let of_infeed = self.bridge_infeed(tied.infeed, taken, drives, period_s);
        if self.of != tied.pair && !(self.any() && tied.pair.is_none()) {
            (self.of, self.axis, self.spindle) = (tied.pair, None, None);
        }
        let Some((axis, spindle)) = self.of else { return of_infeed };
        let mut finding = of_infeed;
        let shares = drives.follower.and_then(|(_, shares)| shares);
        if let Some(loop_) = &mut drives.axes[axis] {
            let expected = period_s * (loop_.target.speed + period_s * loop_.target.accel / 2.0);
            let reading = taken.axes[axis].position.value();
            let watched = self.axis.get_or_insert(Watched::new(reading - expected, expected));
            let bounds = Bounds { frame_lost, ..axis_bounds(loop_, shares, period_s) };
            let (place, lost) = watched.judge(reading, expected, bounds);
            taken.axes[axis].position = units::Coordinate::new(place);
            loop_.blind |= lost;
            // a drive that is gone says so itself
            if lost && taken.axes[axis].ready {
                let of = Subject::Axis(Axis::ALL[axis]);
                finding = Some((FaultKind::ReadingImplausible, of, reading - place, 0.0));
            }
        }
        if let Some(loop_) = &mut drives.spindles[spindle] {
            // a drive that is only told a speed has a way of its own there
            let expected = period_s * loop_.now().spin.value();
            let reading = taken.spindles[spindle].angle.value();
            let watched = self.spindle.get_or_insert(Watched::new(reading - expected, expected));
            let bounds = spindle_bounds(loop_, period_s, frame_lost);
            let (angle, lost) = watched.judge(reading, expected, bounds);
            taken.spindles[spindle].angle = units::Angle::rev(angle);
            loop_.blind |= lost;
            if lost && taken.spindles[spindle].ready {
                let of = Subject::Spindle(spindle as u8);
                finding = Some((FaultKind::ReadingImplausible, of, reading - angle, 0.0));
            }
        }
        finding
    }

    /// The same for an infeed axis, which follows no master, or a table that is superposed on it.
    fn bridge_infeed(
        &mut self,
        infeed: Option<usize>,
        taken: &mut Feedback,
        drives: &mut Drives,
        period_s: f64,
    ) -> Option<Finding> {
        let implausible = self.infeed.is_some_and(|(_, watched)| !watched.plausible);
        if self.infeed.map(|(axis, _)| axis) != infeed && !implausible {
            self.infeed = None;
        }
        let axis = self.infeed.map(|(axis, _)| axis).or(infeed)?;
        let loop_ = drives.axes[axis].as_mut()?;
        let (speed, accel) = (
            loop_.target.speed + loop_.superposed.speed,
            loop_.target.accel + loop_.superposed.accel,
        );
        let expected = period_s * (speed + period_s * accel / 2.0);
        let reading = taken.axes[axis].position.value();
        let (_, watched) =
            self.infeed.get_or_insert((axis, Watched::new(reading - expected, expected)));
        let bounds = axis_bounds(loop_, None, period_s);
        // a loop that speed is not fed to begins to move when its error asks for it
        let lags = loop_.control.feed_forward.speed < 1.0;
        let late = if lags { loop_.control.windows.following_stop.value() } else { 0.0 };
        let stuck = bounds.stuck.max(INFEED_STUCK_MM).max(late);
        let bounds = Bounds { stuck, frame_lost: self.frame_lost, ..bounds };
        let (place, lost) = watched.judge(reading, expected, bounds);
        taken.axes[axis].position = units::Coordinate::new(place);
        loop_.blind |= lost;
        (lost && taken.axes[axis].ready).then_some((
            FaultKind::ReadingImplausible,
            Subject::Axis(Axis::ALL[axis]),
            reading - place,
            0.0,
        ))
    }
}

/// What the encoder of a spindle can show.
fn spindle_bounds(spindle: &SpindleLoop, period_s: f64, frame_lost: bool) -> Bounds {
    let jump = BEYOND_DRIVE * spindle.accel_at_rest() * period_s * period_s
        + NOISE_COUNTS * spindle.control.encoder_count.value();
    Bounds { jump, stuck: f64::INFINITY, frame_lost }
}

fn axis_bounds(axis: &AxisLoop, shares: Option<FeedForward>, period_s: f64) -> Bounds {
    let control = &axis.control;
    // a loop that friction is not fed to breaks away when its error has grown to what friction
    // takes
    let fed = shares.unwrap_or(control.feed_forward).friction;
    let per_mm = (control.motor_mass + control.table_mass).value()
        * 1e-3
        * core::f64::consts::TAU
        * control.velocity_bandwidth_hz
        * control.position_gain;
    let sticks = 2.0 * (1.0 - fed).max(0.0) * control.friction.breakaway.value() / per_mm;
    // what carries the encoder may swing against the rest
    let mass = match control.encoder.place {
        EncoderPlace::Motor => control.motor_mass,
        EncoderPlace::Scale => control.table_mass,
    };
    let accel = control.peak_force.value() / (mass.value() * 1e-3).max(f64::MIN_POSITIVE);
    let count = control.encoder.count.value();
    Bounds {
        jump: BEYOND_DRIVE * accel * period_s * period_s + NOISE_COUNTS * count,
        stuck: STUCK_MM.max(STUCK_COUNTS * count) + sticks,
        frame_lost: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const BOUNDS: Bounds = Bounds { jump: 0.006, stuck: 0.005, frame_lost: false };

    /// Readings of an axis that goes 4 µm a period, spoilt; what is taken, and in which period it
    /// became implausible.
    fn taken(spoil: impl Fn(usize, f64) -> f64) -> (Vec<f64>, Option<usize>) {
        let mut watched = Watched::new(-0.004, 0.004);
        let judge = |i| watched.judge(spoil(i, i as f64 * 0.004), 0.004, BOUNDS);
        let all: Vec<(f64, bool)> = (0..20).map(judge).collect();
        (all.iter().map(|(x, _)| *x).collect(), all.iter().position(|(_, lost)| *lost))
    }

    #[track_caller]
    fn goes_on(taken: &[f64]) {
        for (i, x) in taken.iter().enumerate() {
            assert!((x - i as f64 * 0.004).abs() < 0.004, "period {i}: {x}");
        }
    }

    #[test]
    fn a_reading_that_can_be_is_taken_as_it_is() {
        let swing = |i: usize, x: f64| x + 0.001 * (i as f64).sin();
        let (all, lost) = taken(swing);
        assert_eq!(lost, None);
        assert_eq!(all[7], swing(7, 7.0 * 0.004));
    }

    #[test]
    fn a_jump_is_noticed_in_its_period_and_never_used_again() {
        let (all, lost) = taken(|i, x| if i < 10 { x } else { x + 0.05 });
        assert_eq!(lost, Some(10));
        goes_on(&all);
    }

    #[test]
    fn a_reading_that_is_no_number_is_bridged() {
        let (all, lost) = taken(|i, x| if i < 10 { x } else { f64::NAN });
        assert_eq!(lost, Some(10));
        goes_on(&all);
    }

    #[test]
    fn a_reading_that_stays_is_noticed_when_the_setpoint_has_gone_on() {
        let (all, lost) = taken(|i, x| x.min(0.036 + 0.0 * i as f64));
        assert_eq!(lost, Some(11));
        assert!((all[19] - 0.036 - 9.0 * 0.004).abs() < 1e-9, "{}", all[19]);
    }
}
