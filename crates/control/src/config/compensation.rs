//! Errors of screws and encoders that the machine's file states, for the kernel and for the
//! simulated machine.
use kernel::{AxisCompensation, DeviationTables, SpindleCompensation};
use store::machine::{self, Axis, MachineFile, Spindle, TakesUpPlay};
use units::Coordinate;

/// Least way back at which the flank changes, mm or degrees: what a setpoint that follows an
/// encoder may waver by.
const LEAST_WAY_BACK: f64 = 1e-4;

/// What the kernel takes off of readings.
pub(super) fn compensation(machine: &MachineFile) -> DeviationTables {
    let mut spindles = [const { None }; bus::SPINDLES];
    for (slot, file) in spindles.iter_mut().zip(&machine.spindles) {
        *slot = spindle(file);
    }
    let axes = machine.axes.each_ref();
    DeviationTables { axes: axes.map(|file| file.as_ref().and_then(axis)), spindles }
}

fn axis(file: &Axis) -> Option<AxisCompensation> {
    let stated = file.compensation.as_ref()?;
    let count = file.position_from.resolution().value();
    Some(AxisCompensation {
        table: stated.of_control(),
        reversal: stated.reversal,
        turns_after: Coordinate::new(stated.turns_after.value().max(count).max(LEAST_WAY_BACK)),
    })
}

fn spindle(file: &Spindle) -> Option<SpindleCompensation> {
    let table = file.encoder_errors.clone()?;
    Some(SpindleCompensation { table, from_index: file.encoder_index })
}

/// Play that the kernel's model of the screw has: one that compensation states is taken up there.
pub(super) fn modelled_play(file: &Axis) -> Coordinate {
    match takes_up(file) {
        Some(_) => Coordinate::ZERO,
        None => file.structure.backlash,
    }
}

/// Play of the simulated machine: one that its drive takes up is none.
pub(super) fn play_behind_drive(file: &Axis) -> Coordinate {
    let play = file.structure.backlash;
    match (&file.compensation, takes_up(file)) {
        (Some(stated), Some(TakesUpPlay::Drive)) => {
            Coordinate::new((play.value() - stated.table.backlash).abs())
        }
        _ => play,
    }
}

/// True where play or errors of a screw are compensated of an axis that is said to have a scale:
/// its drive, of HAL or of a network, reports the motor.
pub(super) fn is_at_motor(file: &Axis) -> bool {
    file.compensation.as_ref().is_some_and(machine::StatedDeviations::is_of_motor)
}

fn takes_up(file: &Axis) -> Option<machine::TakesUpPlay> {
    file.compensation.as_ref()?.takes_up
}
