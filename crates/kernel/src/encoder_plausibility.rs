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
//! switching both off lets them run down apart. What the loop does without its encoder is in
//! [`crate::sight`]. What others ask of its place is answered by the model: the reading before and
//! the setpoint's own steps, or the speed that it had.
//!
//! **Usable again.** An encoder whose readings go on in steps that the drive can make, for
//! three in a row, is read again. Where readings were missing its place is what it says, if
//! the model may be off by that; one that has jumped is taken to have slipped, and from there on
//! counts from where the model has come to. One that is stuck has to move first, and one that fails
//! for the fourth time is not used again before the control is started anew.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | Δ | step of the reading within a period | mm, rev |
//! | a | most acceleration of what carries the encoder | mm/s², rev/s² |
//! | h, q | period, one count | s; mm, rev |
//! | n | periods without a usable reading | 1 |
//!
//! Refused: |Δ − Δ before| > 3·a·h² + 8·q, and for an axis no step at all while the setpoint goes
//! on by 2 µm or 16·q (and by what a loop needs to break away, where friction is not fed forward;
//! and by the way that is under way to drives on a network).
//! An axis that nothing ties is stuck as well if its reading stays for 10 ms while its drive pushes
//! by more than friction takes, though the setpoint stands.
//! A spindle is stuck, or blocked, if its reading stays while its drive pushes by what would have
//! turned it ([`SpindleLoop::notes_stuck`]). The model may be off by a·(n·h)²/8 + 8·q.
mod untied;
mod watched;

use crate::axis::AxisLoop;
use crate::config::{EncoderPlace, FeedForward, Subject};
use crate::drives::{Drives, Finding};
use crate::fault::FaultKind;
use crate::sight::{Sight, Without};
use crate::spindle::SpindleLoop;
use bus::{AXES, Feedback};
use units::Axis;
use untied::Untied;
use watched::{Bounds, Change, Watched};

/// A setpoint goes on by so much, mm, or so many counts, before a reading that stays is stuck.
const STUCK_MM: f64 = 0.002;
const STUCK_COUNTS: f64 = 16.0;
/// The same of an infeed axis, which may rest and reverse in its play, mm.
const INFEED_STUCK_MM: f64 = 0.05;

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

    /// One of the encoders of the pair is not as it was.
    fn any(&self) -> bool {
        [self.axis, self.spindle].iter().flatten().any(|watched| !watched.is_sound())
    }

    /// No frames come any more: no encoder is usable until they do.
    pub(crate) fn lose_all(&mut self) {
        let infeed = self.infeed.as_mut().map(|(_, watched)| watched);
        let tied = self.axis.iter_mut().chain(&mut self.spindle).chain(infeed);
        tied.for_each(Watched::lose);
        self.untied.lose_all();
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
            let ordered = period_s * (loop_.target.speed + period_s * loop_.target.accel / 2.0);
            let reading = taken.axes[axis].position.value();
            let watched = self.axis.get_or_insert(Watched::new(reading - ordered, ordered));
            let expected = expected_of_axis(loop_, ordered, watched);
            let bounds = Bounds { frame_lost, ..axis_bounds(loop_, shares, period_s) };
            let (place, change) = watched.judge(reading, expected, bounds);
            taken.axes[axis].position = units::Coordinate::new(place);
            look(loop_, change, Without::Model, (place != reading, period_s));
            // a drive that is gone says so itself
            if change == Change::Lost && taken.axes[axis].ready {
                let of = Subject::Axis(Axis::ALL[axis]);
                finding = Some((FaultKind::ReadingImplausible, of, reading - place, 0.0));
            }
        }
        if let Some(loop_) = &mut drives.spindles[spindle] {
            let turns = period_s * loop_.now().spin.value();
            let reading = taken.spindles[spindle].angle.value();
            let watched = self.spindle.get_or_insert(Watched::new(reading - turns, turns));
            let expected = expected_of_spindle(loop_, watched, period_s);
            let is_stuck = !frame_lost && loop_.notes_stuck(reading, true);
            let bounds = Bounds { is_stuck, frame_lost, ..spindle_bounds(loop_, period_s) };
            let (angle, change) = watched.judge(reading, expected, bounds);
            taken.spindles[spindle].angle = units::Angle::rev(angle);
            look_at_spindle(loop_, change, Without::Model, (angle, period_s));
            if change == Change::Lost && taken.spindles[spindle].ready {
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
        let spoilt = self.infeed.is_some_and(|(_, watched)| !watched.is_sound());
        if self.infeed.map(|(axis, _)| axis) != infeed && !spoilt {
            self.infeed = None;
        }
        let axis = self.infeed.map(|(axis, _)| axis).or(infeed)?;
        let loop_ = drives.axes[axis].as_mut()?;
        let ordered = ordered_way(loop_, period_s);
        let reading = taken.axes[axis].position.value();
        let (_, watched) =
            self.infeed.get_or_insert((axis, Watched::new(reading - ordered, ordered)));
        let expected = expected_of_axis(loop_, ordered, watched);
        let bounds = axis_bounds(loop_, None, period_s);
        // a loop that speed is not fed to begins to move when its error asks for it
        let lags = loop_.control.feed_forward.speed < 1.0;
        let late = if lags { loop_.control.windows.following_stop.value() } else { 0.0 };
        let stuck = bounds.stuck.max(INFEED_STUCK_MM).max(late);
        let bounds = Bounds { stuck, frame_lost: self.frame_lost, ..bounds };
        let (place, change) = watched.judge(reading, expected, bounds);
        taken.axes[axis].position = units::Coordinate::new(place);
        self.untied.taken_over[axis] |=
            look(loop_, change, Without::Nothing, (place != reading, period_s));
        (change == Change::Lost && taken.axes[axis].ready).then_some((
            FaultKind::ReadingImplausible,
            Subject::Axis(Axis::ALL[axis]),
            reading - place,
            0.0,
        ))
    }

    /// An axis that was free has been taken over as it moves, since this was last asked.
    pub(crate) fn was_taken_over(&mut self, index: usize) -> bool {
        core::mem::take(&mut self.untied.taken_over[index])
    }
}

/// The way that an axis is ordered in a period.
fn ordered_way(axis: &AxisLoop, period_s: f64) -> f64 {
    let speed = axis.target.speed + axis.superposed.speed;
    let accel = axis.target.accel + axis.superposed.accel;
    period_s * (speed + period_s * accel / 2.0)
}

/// The way that an axis is expected to go in a period.
fn expected_of_axis(axis: &AxisLoop, ordered: f64, watched: &Watched) -> f64 {
    match axis.sight {
        Sight::Closed | Sight::Carried(_) => ordered,
        Sight::Free(_) => watched.model_step().unwrap_or(ordered),
        Sight::Off => 0.0,
    }
}

/// The way that a spindle is expected to turn in a period.
fn expected_of_spindle(spindle: &SpindleLoop, watched: &Watched, period_s: f64) -> f64 {
    let turns = period_s * spindle.now().spin.value();
    let (Some(step), ordered) = (watched.model_step(), spindle.ordered()) else { return turns };
    match (spindle.sight, spindle.control.own_ramps) {
        (Sight::Closed, _) => turns,
        (Sight::Off, _) => 0.0,
        (Sight::Free(_), _) => step,
        // its drive goes to the speed that it was ordered
        (Sight::Carried(_), Some(own)) => {
            let most = own.accel.max(own.decel).value() * period_s * period_s;
            step + (ordered.spin.value() * period_s - step).clamp(-most, most)
        }
        (Sight::Carried(_), None) if ordered.spin.value() == 0.0 => 0.0,
        (Sight::Carried(_), None) => step + ordered.accel.value() * period_s * period_s,
    }
}

/// A loop takes notice of what has become of its axis' encoder. True if the axis is taken over as
/// it moves.
fn look(
    axis: &mut AxisLoop,
    change: Change,
    without: Without,
    (bridged, period_s): (bool, f64),
) -> bool {
    axis.bridged = bridged && change != Change::Slipped;
    match change {
        Change::None | Change::Slipped => false,
        Change::Lost => {
            axis.sight.lose(without);
            false
        }
        Change::Regained(step) => {
            axis.bridged = false;
            axis.regain(step / period_s)
        }
    }
}

/// The same of a spindle.
fn look_at_spindle(
    spindle: &mut SpindleLoop,
    change: Change,
    without: Without,
    (angle, period_s): (f64, f64),
) {
    match change {
        Change::None | Change::Slipped => {}
        // a drive that makes its own ramps comes to rest without the control's encoder
        Change::Lost if spindle.control.own_ramps.is_some() => {
            spindle.sight.lose(Without::Model);
        }
        Change::Lost => spindle.sight.lose(without),
        Change::Regained(step) => spindle.regain(angle, step / period_s),
    }
}

/// What the encoder of a spindle can show.
fn spindle_bounds(spindle: &SpindleLoop, period_s: f64) -> Bounds {
    Bounds {
        accel_way: spindle.accel_at_rest() * period_s * period_s,
        count: spindle.control.encoder_count.value(),
        ..Bounds::NONE
    }
}

/// The way that has been ordered and cannot be read yet.
fn under_way(axis: &AxisLoop) -> f64 {
    (axis.target.speed + axis.superposed.speed).abs() * axis.late_s
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
        accel_way: accel * period_s * period_s,
        count,
        stuck: STUCK_MM.max(STUCK_COUNTS * count) + sticks + under_way(axis),
        ..Bounds::NONE
    }
}
