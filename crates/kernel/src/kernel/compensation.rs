//! Between encoders and positions: where encoders count from, and the errors that are taken off.
use super::Kernel;
use crate::compensation::AxisInMotion;
use bus::{Command, Feedback, Sample};
use units::{Angle, Axis, Coordinate};

impl Kernel {
    /// What is added to an encoder's reading, near the last one, to make a position of it: zero and
    /// correction.
    pub fn shift(&self, axis: Axis) -> Coordinate {
        self.zero(axis) + Coordinate::new(self.compensation.correction(axis.index()))
    }

    /// What is added to the angle by a spindle's encoder, near the last one.
    pub fn spindle_shift(&self, spindle: usize) -> Angle {
        Angle::rev(self.compensation.correction_of_spindle(spindle))
    }

    /// What crossed the bus in the period of the last tick, with positions and angles in the place
    /// of the encoders' readings.
    pub fn in_positions(&self, sample: &mut Sample) {
        if self.homing.is_shifted() {
            self.homing.positions(&mut sample.feedback);
            self.homing.command_positions(&mut sample.command);
        }
        self.compensation.taken(&mut sample.feedback);
        self.compensation.take_back(&mut sample.command);
    }

    /// The readings as positions.
    pub(super) fn positions(&mut self, feedback: &Feedback) -> Feedback {
        let mut positions = *feedback;
        if self.homing.is_shifted() {
            self.homing.positions(&mut positions);
        }
        self.compensation.take(&mut positions, self.config.period.value());
        positions
    }

    /// What is wanted of slides and spindles, as encoders would say it.
    pub(super) fn readings(&mut self, command: &mut Command) {
        if !self.compensation.is_none() {
            let axes = &self.drives.axes;
            self.compensation.give(command, self.config.period.value(), |index| {
                let axis = axes[index].as_ref()?;
                let (accel, control) = (axis.target.accel + axis.superposed.accel, &axis.control);
                let friction = &control.friction;
                Some(AxisInMotion {
                    renamed: axis.renamed,
                    accel,
                    push: control.table_mass.value() * 1e-3 * accel - control.weight.value(),
                    friction: (friction.coulomb.value(), friction.breakaway.value()),
                    motor: control.motor_mass,
                })
            });
        }
        if self.homing.is_shifted() {
            self.homing.readings(command);
        }
    }

    /// An axis that has been homed is compensated from now on, one that is not is not: its
    /// positions get other names, and nothing moves.
    pub(super) fn count_homed(&mut self, index: usize) {
        let Some(axis) = &mut self.drives.axes[index] else { return };
        let position = axis.target.position + axis.superposed.position;
        if let Some(by) = self.compensation.count_homed(&self.homing, index, position) {
            axis.shift(by);
        }
    }
}
