//! What drives can hold for ever, and how fast they warm: what their load is a share of.
use bus::{AXES, SPINDLES};
use store::machine::MachineFile;
use units::{Force, Power, Spin, Time, Torque};

/// A drive of an axis that measures its force, and whose file says what it can hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisRating {
    /// Force that it can hold for ever.
    pub continuous: Force,
    /// Time in which it warms.
    pub thermal_time: Time,
}

/// A drive of a spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleRating {
    /// Torque that it can hold for ever, below its base speed.
    pub continuous: Torque,
    /// Power that it can hold for ever: its curve keeps its form.
    pub power: Power,
    /// Time in which it warms.
    pub thermal_time: Time,
    /// It is commanded by torque. Otherwise its load is known only where it measures it.
    pub is_torque_commanded: bool,
}

impl SpindleRating {
    /// The torque that it can hold for ever at a speed.
    pub fn holds(&self, speed: Spin) -> Torque {
        let rad_per_s = speed.abs().in_rad_per_s().max(f64::MIN_POSITIVE);
        Torque::n_m(self.continuous.value().min(self.power.value() / rad_per_s))
    }
}

/// Of all drives, by their index on the bus.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ratings {
    /// By axis.
    pub axes: [Option<AxisRating>; AXES],
    /// By spindle.
    pub spindles: [Option<SpindleRating>; SPINDLES],
}

/// The ratings of a machine's drives.
pub fn ratings(machine: &MachineFile) -> Ratings {
    let mut ratings = Ratings::default();
    for (index, (rating, axis)) in ratings.axes.iter_mut().zip(&machine.axes).enumerate() {
        let drive = axis.as_ref().map(|axis| axis.drive);
        let drive = drive.filter(|_| machine.measures_force(index));
        *rating = drive.and_then(|drive| {
            let continuous = drive.continuous_force?;
            Some(AxisRating { continuous, thermal_time: drive.thermal_time })
        });
    }
    for (rating, spindle) in ratings.spindles.iter_mut().zip(&machine.spindles) {
        let share = spindle.continuous_torque.value() / spindle.peak_torque.value();
        *rating = Some(SpindleRating {
            continuous: spindle.continuous_torque,
            power: Power::w(spindle.peak_power.value() * share),
            thermal_time: spindle.thermal_time,
            is_torque_commanded: spindle.own_ramps.is_none() && !spindle.closes_position,
        });
    }
    ratings
}
