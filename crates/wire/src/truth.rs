//! What only a simulator knows.
use crate::bytes::{Reader, Writer};
use crate::message::{indices, mask};
use bus::{AXES, SPINDLES, ToolBreak, Truth};
use units::{Angle, Coordinate, Force, Length, Spin, Torque};

pub(crate) fn write_truth(w: &mut Writer<'_>, truth: &Truth) {
    let axes: [(Coordinate, Force); AXES] =
        core::array::from_fn(|i| (truth.axes[i], truth.axis_forces[i]));
    w.u16(mask(&axes));
    for (place, force) in axes.iter().filter(|one| **one != Default::default()) {
        w.f64s([place.value(), force.value()]);
    }
    let spindles: [(Angle, Spin, Torque); SPINDLES] =
        core::array::from_fn(|i| (truth.spindles[i], truth.spins[i], truth.spindle_torques[i]));
    w.u16(mask(&spindles));
    for (angle, spin, torque) in spindles.iter().filter(|one| **one != Default::default()) {
        w.f64s([angle.value(), spin.value(), torque.value()]);
    }
    w.f64s([
        truth.tool_deflection.value(),
        truth.tool_turn.value(),
        truth.cutting_torque.value(),
        truth.cutting_force.value(),
    ]);
    w.u8(truth.tool_broken.into());
    match truth.broken_by {
        None => w.u8(0),
        Some(ToolBreak::Stress { torque, force, most_torque, most_force }) => {
            w.u8(1);
            w.f64s([torque.value(), force.value(), most_torque.value(), most_force.value()]);
        }
        Some(ToolBreak::Sideways { by, most }) => {
            w.u8(2);
            w.f64s([by.value(), most.value()]);
        }
    }
}

pub(crate) fn read_truth(r: &mut Reader<'_>) -> Option<Truth> {
    let mut truth = Truth::default();
    for index in indices(r.u16()?, AXES)? {
        truth.axes[index] = Coordinate::new(r.f64()?);
        truth.axis_forces[index] = Force::n(r.f64()?);
    }
    for index in indices(r.u16()?, SPINDLES)? {
        truth.spindles[index] = Angle::rev(r.f64()?);
        truth.spins[index] = Spin::rev_per_s(r.f64()?);
        truth.spindle_torques[index] = Torque::n_m(r.f64()?);
    }
    truth.tool_deflection = Length::mm(r.f64()?);
    truth.tool_turn = Angle::rev(r.f64()?);
    truth.cutting_torque = Torque::n_m(r.f64()?);
    truth.cutting_force = Force::n(r.f64()?);
    truth.tool_broken = r.flag()?;
    truth.broken_by = match r.u8()? {
        0 => None,
        1 => Some(ToolBreak::Stress {
            torque: Torque::n_m(r.f64()?),
            force: Force::n(r.f64()?),
            most_torque: Torque::n_m(r.f64()?),
            most_force: Force::n(r.f64()?),
        }),
        2 => Some(ToolBreak::Sideways { by: Length::mm(r.f64()?), most: Length::mm(r.f64()?) }),
        _ => return None,
    };
    Some(truth)
}
