//! The rows of a trace, column by column: what of a sample is kept, and in which steps.
use super::{Columns, GROUP_ROWS};
use crate::machine::rotary::RAD_PER_M;
use bus::{Sample, State};
use units::{Angle, AxisKind, Force, Time, Torque};

/// Rows in the making, column by column, in the order of [`Columns::names`].
pub struct Rows {
    columns: Columns,
    /// Since the machine was started, s.
    pub time_s: Vec<f64>,
    /// Four to an axis, then five to a spindle, then one to a drive that measures what it gives, as
    /// the table of the module has them.
    pub numbers: Vec<Vec<f64>>,
    /// The kernel's monitor, µm, in the rows in which it has a value.
    pub sync_error_um: Vec<f64>,
    /// In which rows it has one: 1.
    pub sync_error_known: Vec<i16>,
    /// Program line at work, 0 for none.
    pub line: Vec<i32>,
    /// What the kernel was doing.
    pub state: Vec<State>,
    /// Time and spindle angles of the sample before, for speeds that the sample itself does not
    /// hold.
    before: Option<(Time, [Angle; bus::SPINDLES])>,
}

impl Rows {
    /// None yet.
    pub fn new(columns: Columns) -> Self {
        let column = || Vec::with_capacity(GROUP_ROWS);
        let numbers = columns.names().len();
        Self {
            columns,
            time_s: column(),
            numbers: (0..numbers).map(|_| column()).collect(),
            sync_error_um: Vec::new(),
            sync_error_known: Vec::with_capacity(GROUP_ROWS),
            line: Vec::with_capacity(GROUP_ROWS),
            state: Vec::with_capacity(GROUP_ROWS),
            before: None,
        }
    }

    /// None yet, to go on after these.
    #[must_use]
    pub fn next(&self) -> Self {
        Self { before: self.before, ..Self::new(self.columns.clone()) }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// None.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// As many as are written together.
    pub fn is_full(&self) -> bool {
        self.len() >= GROUP_ROWS
    }

    /// Which axes and spindles they have.
    pub const fn columns(&self) -> &Columns {
        &self.columns
    }

    /// Append the row of one servo period.
    pub fn push(&mut self, sample: &Sample) {
        let mut numbers = self.numbers.iter_mut();
        let mut put = |value: f64| {
            if let Some(column) = numbers.next() {
                column.push(value);
            }
        };
        for (index, _) in &self.columns.axes {
            let (index, command) = (*index, &sample.command.axes[*index]);
            let force = sample.truth.as_ref().map_or(command.force, |t| t.axis_forces[index]);
            let setpoint = if is_rotary(index) { ROTARY_SETPOINT } else { SETPOINT };
            let real = sample.truth.as_ref().map_or(f64::NAN, |t| t.axes[index].value());
            put(setpoint.snap(command.position.value()));
            put(NM.snap(real));
            put(NM.snap(sample.feedback.axes[index].position.value()));
            if is_rotary(index) {
                put(TORQUE.snap(force.value() / RAD_PER_M));
            } else {
                put(FORCE.snap(force.value()));
            }
        }
        for index in 0..self.columns.spindles.len() {
            let command = &sample.command.spindles[index];
            let torque = sample.truth.as_ref().map_or(command.torque, |t| t.spindle_torques[index]);
            let real = sample.truth.as_ref().map_or(f64::NAN, |t| t.spindles[index].value());
            put(ANGLE.snap(command.angle.value()));
            put(ANGLE.snap(real));
            put(ANGLE.snap(sample.feedback.spindles[index].angle.value()));
            put(SPEED.snap(rpm(sample, index, self.before.as_ref())));
            put(TORQUE.snap(torque.value()));
        }
        for index in &self.columns.measured.axes {
            let force = sample.feedback.axes[*index].force.map_or(f64::NAN, Force::value);
            if is_rotary(*index) {
                put(TORQUE.snap(force / RAD_PER_M));
            } else {
                put(FORCE.snap(force));
            }
        }
        for index in &self.columns.measured.spindles {
            let torque = sample.feedback.spindles[*index].torque.map_or(f64::NAN, Torque::value);
            put(TORQUE.snap(torque));
        }
        self.before = Some((sample.feedback.time, sample.feedback.spindles.map(|s| s.angle)));
        self.push_report(sample);
    }

    fn push_report(&mut self, sample: &Sample) {
        let report = &sample.report;
        self.time_s.push(sample.feedback.time.value());
        self.sync_error_known.push(i16::from(report.sync_error.is_some()));
        self.sync_error_um.extend(report.sync_error.map(|e| ERROR.snap(e.in_um())));
        self.line.push(i32::try_from(report.line).unwrap_or(i32::MAX));
        self.state.push(report.state);
    }

    /// None again; the sample before is remembered.
    pub fn clear(&mut self) {
        self.time_s.clear();
        self.numbers.iter_mut().for_each(Vec::clear);
        self.sync_error_um.clear();
        self.sync_error_known.clear();
        self.line.clear();
        self.state.clear();
    }
}

/// Rounds to a multiple of a power of two.
///
/// The sum x + 1.5·2⁵²·step has no bits left below `step`, so the addition itself rounds; the
/// subtraction is exact. Good for |x| < 2⁵¹·step; larger numbers pass through.
struct Steps {
    big: f64,
}

impl Steps {
    const fn new(per_unit: f64) -> Self {
        const ONE_AND_A_HALF_TIMES_2_TO_THE_52: f64 = 6_755_399_441_055_744.0;
        Self { big: ONE_AND_A_HALF_TIMES_2_TO_THE_52 / per_unit }
    }

    fn snap(&self, x: f64) -> f64 {
        // a third of big is 2⁵¹·step
        if x.abs() < self.big / 3.0 { (x + self.big) - self.big } else { x }
    }
}

/// An axis of the bus that turns.
pub(super) fn is_rotary(index: usize) -> bool {
    canon::Axis::ALL[index].kind() == AxisKind::Rotary
}

/// Jerk by third differences of setpoints at 125 µs is off by 4 steps / T³: 31 m/s³.
const SETPOINT: Steps = Steps::new((1 << 26) as f64);
/// Of a rotary axis, whose limit of jerk may be tens of thousands of °/s³.
const ROTARY_SETPOINT: Steps = Steps::new((1 << 30) as f64);
const NM: Steps = Steps::new((1 << 20) as f64);
const FORCE: Steps = Steps::new((1 << 7) as f64);
const ANGLE: Steps = Steps::new((1 << 24) as f64);
const SPEED: Steps = Steps::new((1 << 10) as f64);
const TORQUE: Steps = Steps::new((1 << 14) as f64);
const ERROR: Steps = Steps::new((1 << 10) as f64);

/// Real speed of a spindle, or what two angles say of it.
fn rpm(sample: &Sample, index: usize, before: Option<&(Time, [Angle; bus::SPINDLES])>) -> f64 {
    if let Some(truth) = &sample.truth {
        return truth.spins[index].in_rpm();
    }
    let Some((time, angles)) = before else { return 0.0 };
    let elapsed = sample.feedback.time - *time;
    if elapsed <= Time::ZERO {
        return 0.0;
    }
    ((sample.feedback.spindles[index].angle - angles[index]) / elapsed).in_rpm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_stored_at_most_half_a_step_off() {
        for x in [0.0, 1e-9, -0.123_456_789, 499.999_999_9, -1e4, 8.5e5] {
            let off = (NM.snap(x) - x).abs();
            assert!(off <= 0.5 / f64::from(1 << 20), "{x} {off}");
        }
    }

    #[test]
    fn a_multiple_of_the_step_is_stored_exactly() {
        assert_eq!(NM.snap(-299.5), -299.5);
        assert_eq!(NM.snap(3.0 / f64::from(1 << 20)), 3.0 / f64::from(1 << 20));
    }

    #[test]
    fn what_is_too_large_or_no_number_passes_through() {
        assert_eq!(ANGLE.snap(1e12), 1e12);
        assert!(ANGLE.snap(f64::NAN).is_nan());
        assert_eq!(ANGLE.snap(f64::INFINITY), f64::INFINITY);
    }
}
