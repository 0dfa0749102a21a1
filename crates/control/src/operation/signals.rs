//! Signals of a control: what a scope shows, a value each servo period.
use super::control::Control;
use canon::Axis;
use units::{AxisKind, Coordinate};

/// Where a value comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    Setpoint(Axis),
    Position(Axis),
    FollowingError(Axis),
    MeasuredForce(Axis),
    OrderedSpeed(usize),
    SpindleAngle(usize),
    MeasuredTorque(usize),
    SyncError,
}

/// The signals that a control has; their names end in their units.
#[derive(Clone, Debug)]
pub struct Signals {
    names: Vec<String>,
    sources: Vec<Source>,
}

impl Signals {
    /// Of a control.
    pub fn of(control: &Control) -> Self {
        let mut all = Vec::new();
        for file in control.machine().axes.iter().flatten() {
            let axis = file.letter;
            let (letter, unit) = (axis.letter(), axis.kind().unit_name());
            let error = match axis.kind() {
                AxisKind::Linear => "um",
                AxisKind::Rotary => "mdeg",
            };
            all.push((format!("{letter}.setpoint_{unit}"), Source::Setpoint(axis)));
            all.push((format!("{letter}.position_{unit}"), Source::Position(axis)));
            all.push((format!("{letter}.following_error_{error}"), Source::FollowingError(axis)));
            if control.machine().measures_force(axis.index()) {
                let what = match axis.kind() {
                    AxisKind::Linear => "force_n",
                    AxisKind::Rotary => "torque_n_m",
                };
                all.push((format!("{letter}.measured_{what}"), Source::MeasuredForce(axis)));
            }
        }
        for spindle in 0..control.machine().spindles.len() {
            all.push((format!("spindle{spindle}.ordered_rpm"), Source::OrderedSpeed(spindle)));
            all.push((format!("spindle{spindle}.angle_deg"), Source::SpindleAngle(spindle)));
            if control.machine().measures_torque(spindle) {
                let name = format!("spindle{spindle}.measured_torque_n_m");
                all.push((name, Source::MeasuredTorque(spindle)));
            }
        }
        all.push(("sync_error_um".to_owned(), Source::SyncError));
        let (names, sources) = all.into_iter().unzip();
        Self { names, sources }
    }

    /// Their names, in the order of their values.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The values as they are now, at the end of a row; a signal that has none is NaN.
    pub fn read(&self, control: &Control, row: &mut Vec<f32>) {
        let kernel = &control.executor.kernel;
        let feedback = control.executor.machine.feedback();
        let position =
            |axis: Axis| (feedback.axes[axis.index()].position + kernel.shift(axis)).value();
        let setpoint = |axis: Axis| kernel.setpoint(axis).map_or(f64::NAN, Coordinate::value);
        row.extend(self.sources.iter().map(|source| {
            match *source {
                Source::Setpoint(axis) => setpoint(axis) as f32,
                Source::Position(axis) => position(axis) as f32,
                Source::FollowingError(axis) => ((setpoint(axis) - position(axis)) * 1e3) as f32,
                Source::OrderedSpeed(spindle) => kernel.ordered_spin(spindle).in_rpm() as f32,
                Source::SpindleAngle(spindle) => feedback
                    .spindles
                    .get(spindle)
                    .map(|said| said.angle + kernel.spindle_shift(spindle))
                    .map_or(f32::NAN, |angle| (angle.value().rem_euclid(1.0) * 360.0) as f32),
                Source::MeasuredForce(axis) => {
                    let unit = match axis.kind() {
                        AxisKind::Linear => 1.0,
                        AxisKind::Rotary => store::machine::RAD_PER_M,
                    };
                    let force = feedback.axes[axis.index()].force;
                    force.map_or(f32::NAN, |force| (force.value() / unit) as f32)
                }
                Source::MeasuredTorque(spindle) => {
                    let torque = feedback.spindles.get(spindle).and_then(|said| said.torque);
                    torque.map_or(f32::NAN, |torque| torque.value() as f32)
                }
                Source::SyncError => {
                    kernel.report().sync_error.map_or(f32::NAN, |e| e.in_um() as f32)
                }
            }
        }));
    }
}
