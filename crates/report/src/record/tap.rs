//! One synchronised tap as it happened: how truly the axis followed the spindle.
//!
//! ```text
//!   stroke │            u = (θ − θ₀)·sign(lead)        turns inwards        [rev]
//!    s     │      ╱     s = (z − z₀)·sign(bottom − z₀) stroke inwards       [mm]
//!          │   ╱        e = s − |lead|·u          sync error, plus is deeper [mm]
//!          │╱
//!          └─────── u   material from u·|lead| = clearance on
//! ```
//!
//! (θ₀, z₀) is the point on the coupling that was commanded when the cycle began. Positions are the
//! real ones where a simulator knows them, else the encoders'. e is the axis' error, from the first
//! instant on; the judge's, in the material, is from the helix that fits best.
use super::series::Series;
use bus::{Sample, State};
use canon::Tap;
use units::{Angle, Length, Spin, Time, Torque};

/// The spindle that leads; taps are led by the first.
const SPINDLE: usize = 0;
/// Stretches of saturation that are drawn.
const SATURATIONS: usize = 32;

/// Curves of a tap.
#[derive(Clone, Debug)]
pub(crate) struct TapTrace {
    /// Index of its op.
    pub(crate) op: u32,
    /// Program line.
    pub(crate) line: u32,
    /// What was ordered.
    pub(crate) tap: Tap,
    /// When it began.
    pub(crate) began: Time,
    /// Turns → stroke, inwards and outwards.
    pub(crate) stroke: [Series; 2],
    /// Turns → synchronisation error (µm, plus is deeper), inwards and outwards.
    pub(crate) error: [Series; 2],
    /// Time from its beginning → spindle speed (rpm).
    pub(crate) speed: Series,
    /// Time → torque of the spindle's drive.
    pub(crate) torque: Series,
    /// Time → torque of the cut, where it can be known.
    pub(crate) cut: Series,
    /// Speed (rpm) → torque of the drive.
    pub(crate) plane: Series,
    /// When the drive was at its limit, from and to.
    pub(crate) saturated: Vec<(f64, f64)>,
    /// How long it was, altogether.
    pub(crate) saturated_for: Time,
    /// Largest synchronisation error in the material (magnitude).
    pub(crate) worst: Length,
    /// It came out again, in step.
    pub(crate) completed: bool,
    origin: (Angle, Length),
    previous: Option<(Time, Angle)>,
    coming_out: bool,
}

impl TapTrace {
    /// A tap whose first period is this.
    pub(crate) fn begin(op: u32, tap: &Tap, sample: &Sample) -> Self {
        let command = &sample.command;
        Self {
            op,
            line: sample.report.line,
            tap: *tap,
            began: sample.feedback.time,
            stroke: Default::default(),
            error: Default::default(),
            speed: Series::default(),
            torque: Series::default(),
            cut: Series::default(),
            plane: Series::default(),
            saturated: Vec::new(),
            saturated_for: Time::ZERO,
            worst: Length::ZERO,
            completed: false,
            origin: (
                command.spindles[SPINDLE].angle,
                command.axes[tap.axis.index()].position.of_linear(),
            ),
            previous: None,
            coming_out: false,
        }
    }

    /// +1 where the tap goes towards plus, −1 where it goes towards minus.
    fn inwards(&self) -> f64 {
        if self.tap.bottom < self.tap.start.along(self.tap.axis).of_linear() { -1.0 } else { 1.0 }
    }

    /// Stroke before the material begins.
    pub(crate) fn clearance(&self) -> Length {
        (self.tap.surface - self.tap.start.along(self.tap.axis).of_linear()) * self.inwards()
    }

    /// Whole stroke.
    pub(crate) fn whole(&self) -> Length {
        (self.tap.bottom - self.tap.start.along(self.tap.axis).of_linear()).abs()
    }

    /// Record a period.
    pub(crate) fn push(&mut self, sample: &Sample) {
        self.coming_out |= sample.report.state == State::TapOut;
        let (angle, z) = (sample.spindle(SPINDLE), sample.axis(self.tap.axis.index()).of_linear());
        let turned = angle - self.origin.0;
        let travelled = z - self.origin.1;
        let turns = turned.value() * self.tap.lead.value().signum();
        let stroke = travelled * self.inwards();
        let error = stroke - self.tap.lead.abs() * Angle::rev(turns);
        let side = usize::from(self.coming_out);
        self.stroke[side].push(turns, stroke.value());
        self.error[side].push(turns, error.in_um());
        if self.tap.lead.abs() * Angle::rev(turns) >= self.clearance() && error.is_finite() {
            self.worst = self.worst.max(error.abs());
        }
        self.push_drive(sample, angle);
    }

    fn push_drive(&mut self, sample: &Sample, angle: Angle) {
        let now = sample.feedback.time;
        let time = (now - self.began).value();
        let torque = sample
            .truth
            .as_ref()
            .map_or(sample.command.spindles[SPINDLE].torque, |t| t.spindle_torques[SPINDLE]);
        self.torque.push(time, torque.value());
        if let Some(speed) = self.speed_at(sample, angle) {
            self.speed.push(time, speed.in_rpm());
            self.plane.push(speed.in_rpm(), torque.value());
        }
        if let Some(truth) = &sample.truth {
            self.cut.push(time, truth.cutting_torque.value());
        }
        if sample.feedback.spindles[SPINDLE].saturated {
            let period = self.previous.map_or(0.0, |(before, _)| (now - before).value());
            self.push_saturated(time, period);
        }
        self.previous = Some((now, angle));
    }

    /// A period that ended now was at the drive's limit.
    fn push_saturated(&mut self, time: f64, period: f64) {
        self.saturated_for += Time::s(period);
        let room = self.saturated.len() < SATURATIONS;
        match self.saturated.last_mut() {
            // also when the room is used up: the last stretch then covers the rest
            Some((_, to)) if time - *to <= period * 1.5 || !room => *to = time,
            _ => self.saturated.push((time - period, time)),
        }
    }

    /// Real speed where it can be known, else the difference of two angles.
    fn speed_at(&self, sample: &Sample, angle: Angle) -> Option<Spin> {
        if let Some(truth) = &sample.truth {
            return Some(truth.spins[SPINDLE]);
        }
        let (before, was) = self.previous?;
        let period = sample.feedback.time - before;
        (period > Time::ZERO).then(|| (angle - was) / period)
    }

    /// Largest torque of the drive.
    pub(crate) fn torque_max(&self) -> Torque {
        let magnitudes = self.torque.points().into_iter().map(|(_, m)| m.abs());
        Torque::n_m(magnitudes.fold(0.0, f64::max))
    }

    /// Whether it deserves its picture more than another: a tap that did not come out before all
    /// that did, then the one with the larger error.
    pub(crate) fn is_worse_than(&self, other: &Self) -> bool {
        let severity = |t: &Self| (!t.completed, t.worst);
        severity(self) > severity(other)
    }

    /// It is over; `in_step` if the control went on as it should.
    pub(crate) fn end(&mut self, in_step: bool) {
        self.completed = in_step && self.coming_out;
    }
}
