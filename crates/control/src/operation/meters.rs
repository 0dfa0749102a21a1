//! What a panel's meters show, from what crossed the wire: speed and load of each spindle, speed of
//! the path; a mean over [`SPAN`] each.
//!
//! ```text
//!   speed   n = Δθ/Δt                           encoder of the spindle
//!   load    |M| / min(Mc, Pc/|ω|)               M: torque reference; Mc, Pc: what the drive can hold for ever
//!   Pc      = Ppeak·Mc/Mpeak                    a drive's curve keeps its form
//!   path    v = √(Δx² + Δy² + Δz²)/Δt           setpoints of the linear axes
//! ```
use bus::{SPINDLES, Sample};
use canon::Axis;
use store::machine::{MachineFile, Spindle};
use units::{Angle, Spin, Time, Torque};

/// A mean is taken over so long.
const SPAN: Time = Time::s(0.02);
/// Linear axes that make a path.
const PATH_AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// A spindle's meters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SpindleMeter {
    /// By its encoder.
    pub(super) speed: Spin,
    /// Torque reference, without sign.
    torque: Torque,
}

/// Where a span has begun.
#[derive(Clone, Copy, Debug)]
struct Begun {
    time: Time,
    angles: [Angle; SPINDLES],
    place: [f64; 3],
    torques: [f64; SPINDLES],
    periods: u32,
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Meters {
    spindles: [SpindleMeter; SPINDLES],
    /// mm/s.
    path_speed: f64,
    begun: Option<Begun>,
}

impl Meters {
    /// A period is over.
    pub(super) fn sample(&mut self, sample: &Sample) {
        let now = sample.feedback.time;
        let begun = self.begun.get_or_insert_with(|| Begun::at(sample));
        begun.periods += 1;
        for (sum, command) in begun.torques.iter_mut().zip(&sample.command.spindles) {
            *sum += command.torque.value().abs();
        }
        let span = now - begun.time;
        if span < SPAN {
            return;
        }
        let next = Begun::at(sample);
        for (index, meter) in self.spindles.iter_mut().enumerate() {
            let turned = next.angles[index] - begun.angles[index];
            meter.speed = Spin::rev_per_s(turned.value() / span.value());
            meter.torque = Torque::n_m(begun.torques[index] / f64::from(begun.periods));
        }
        let moved = next.place.iter().zip(begun.place).map(|(to, from)| (to - from).powi(2));
        self.path_speed = moved.sum::<f64>().sqrt() / span.value();
        *begun = next;
    }

    /// Speed of the path, mm/s.
    pub(super) const fn path_speed(&self) -> f64 {
        self.path_speed
    }

    /// Speed of a spindle by its encoder.
    pub(super) fn speed(&self, spindle: usize) -> Spin {
        self.spindles.get(spindle).map_or(Spin::ZERO, |meter| meter.speed)
    }

    /// Share of the torque that a spindle's drive can hold for ever at its speed; `None`: its drive
    /// is told a speed, and does not say its torque.
    pub(super) fn load(&self, machine: &MachineFile, spindle: usize) -> Option<f64> {
        let file = machine.spindles.get(spindle).filter(|file| file.own_ramps.is_none())?;
        let meter = self.spindles.get(spindle)?;
        Some(meter.torque.value() / holds_for_ever(file, meter.speed).value())
    }
}

impl Begun {
    fn at(sample: &Sample) -> Self {
        let mut angles = [Angle::ZERO; SPINDLES];
        for (angle, feedback) in angles.iter_mut().zip(&sample.feedback.spindles) {
            *angle = feedback.angle;
        }
        let place = PATH_AXES.map(|axis| sample.command.axes[axis.index()].position.value());
        let time = sample.feedback.time;
        Self { time, angles, place, torques: [0.0; SPINDLES], periods: 0 }
    }
}

/// The torque that a spindle's drive can hold for ever at a speed.
fn holds_for_ever(spindle: &Spindle, speed: Spin) -> Torque {
    let share = spindle.continuous_torque.value() / spindle.peak_torque.value();
    let power = spindle.peak_power.value() * share;
    let by_power = power / speed.abs().in_rad_per_s().max(f64::MIN_POSITIVE);
    Torque::n_m(spindle.continuous_torque.value().min(by_power))
}

#[cfg(test)]
mod tests {
    use super::*;
    use store::machine::MachineFile;

    fn machine() -> MachineFile {
        let options = crate::job::ProgramOptions::on("tapping-center");
        let session = crate::job::Session::load(&options, std::path::Path::new("-"), b"");
        session.unwrap_or_else(|refused| panic!("{}", refused.sentence())).machine
    }

    /// A spindle at 1200 rev/min with this torque, X and Y at 3 and 4 mm/s: samples of 30 ms.
    fn seen(torque: f64) -> Meters {
        let mut meters = Meters::default();
        for period in 0..=120 {
            let t = f64::from(period) * 0.00025;
            let mut sample = Sample::default();
            sample.feedback.time = Time::s(t);
            sample.feedback.spindles[0].angle = Angle::rev(20.0 * t);
            sample.command.spindles[0].torque = Torque::n_m(-torque);
            sample.command.axes[0].position = units::Coordinate::new(3.0 * t);
            sample.command.axes[1].position = units::Coordinate::new(4.0 * t);
            meters.sample(&sample);
        }
        meters
    }

    #[test]
    fn speed_is_turns_by_time_and_the_path_is_the_root_of_the_squares() {
        let meters = seen(0.0);
        assert!((meters.speed(0).in_rpm() - 1200.0).abs() < 1e-6);
        assert!((meters.path_speed() - 5.0).abs() < 1e-9);
    }

    #[test]
    fn what_a_drive_holds_for_ever_is_a_load_of_one_whatever_its_sign() {
        let machine = machine();
        let file = &machine.spindles[0];
        let (torque, spin) = (file.continuous_torque, Spin::rpm(1200.0));
        let power = file.peak_power.value() * torque.value() / file.peak_torque.value();
        let held = torque.value().min(power / spin.in_rad_per_s());
        let load = seen(held).load(&machine, 0).expect("a drive that is told a torque");
        assert!((load - 1.0).abs() < 1e-9, "{load}");
        let fastest = holds_for_ever(file, file.max).power_at(file.max).value();
        assert!(fastest <= power * (1.0 + 1e-9), "{fastest} W of {power} W");
    }
}
