//! What a panel's meters show, from what crossed the wire: speed and load of each drive, speed of
//! the path; a mean over [`SPAN`] each.
//!
//! ```text
//!   speed     n = Δθ/Δt                         encoder of the spindle
//!   load      |F|/Fc,  |M|/min(Mc, Pc/|ω|)      F, M: as the drive measures them, else the torque commanded
//!   thermal   θ' = (load² − θ)/T                Fc, Mc, Pc: what it can hold for ever; at θ = 1 it is as warm as it may get
//!   path      v = √(Δx² + Δy² + Δz²)/Δt         setpoints of the linear axes
//! ```
use crate::config::{Ratings, SpindleRating};
use bus::{AXES, SPINDLES, Sample};
use canon::Axis;
use units::{Angle, Force, Spin, Time, Torque};

/// A mean is taken over so long.
const SPAN: Time = Time::s(0.02);
/// Linear axes that make a path.
const PATH_AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// How hard a drive works; shares are of what it can hold for ever.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct DriveLoad {
    /// Its torque or force itself, without its sign, N·m or N.
    pub(super) effort: f64,
    /// Of its torque or force.
    pub(super) load: f64,
    /// Of the heat that this makes: a mean of the load's square over the drive's thermal time.
    pub(super) thermal: f64,
}

impl DriveLoad {
    /// Of a span with this mean effort, after that before it.
    fn after(before: Option<Self>, effort: f64, holds: f64, span: Time, warms: Time) -> Self {
        let load = effort / holds;
        let was = before.map_or(0.0, |before| before.thermal);
        let kept = (-(span.value() / warms.value())).exp();
        Self { effort, load, thermal: load * load + (was - load * load) * kept }
    }
}

/// Where a span has begun, and the sums over it.
#[derive(Clone, Copy, Debug)]
struct Span {
    time: Time,
    angles: [Angle; SPINDLES],
    place: [f64; 3],
    /// Sizes of measured forces, N; `None` from the first period in which one was not measured.
    forces: [Option<f64>; AXES],
    /// The same of measured torques, N·m.
    torques: [Option<f64>; SPINDLES],
    /// Sizes of commanded torques, N·m.
    commanded: [f64; SPINDLES],
    periods: u32,
}

/// All of them.
#[derive(Clone, Debug)]
pub(super) struct Meters {
    ratings: Ratings,
    speeds: [Spin; SPINDLES],
    axes: [Option<DriveLoad>; AXES],
    spindles: [Option<DriveLoad>; SPINDLES],
    /// mm/s.
    path_speed: f64,
    span: Option<Span>,
}

impl Meters {
    pub(super) fn new(ratings: &Ratings) -> Self {
        Self {
            ratings: *ratings,
            speeds: [Spin::ZERO; SPINDLES],
            axes: [None; AXES],
            spindles: [None; SPINDLES],
            path_speed: 0.0,
            span: None,
        }
    }

    /// A period is over.
    pub(super) fn sample(&mut self, sample: &Sample) {
        let span = self.span.get_or_insert_with(|| Span::at(sample));
        span.add(sample);
        if sample.feedback.time - span.time >= SPAN {
            let (done, next) = (*span, Span::at(sample));
            self.show(&done, &next);
            self.span = Some(next);
        }
    }

    fn show(&mut self, done: &Span, next: &Span) {
        let span = next.time - done.time;
        let periods = f64::from(done.periods);
        for (index, speed) in self.speeds.iter_mut().enumerate() {
            let turned = next.angles[index] - done.angles[index];
            *speed = Spin::rev_per_s(turned.value() / span.value());
        }
        for (index, shown) in self.axes.iter_mut().enumerate() {
            *shown = self.ratings.axes[index].zip(done.forces[index]).map(|(rating, sum)| {
                let holds = rating.continuous.value();
                DriveLoad::after(*shown, sum / periods, holds, span, rating.thermal_time)
            });
        }
        for (index, shown) in self.spindles.iter_mut().enumerate() {
            *shown = self.ratings.spindles[index].and_then(|rating| {
                let torque = done.torque(index, &rating)? / periods;
                let holds = rating.holds(self.speeds[index]).value();
                Some(DriveLoad::after(*shown, torque, holds, span, rating.thermal_time))
            });
        }
        let moved = next.place.iter().zip(done.place).map(|(to, from)| (to - from).powi(2));
        self.path_speed = moved.sum::<f64>().sqrt() / span.value();
    }

    /// Speed of the path, mm/s.
    pub(super) const fn path_speed(&self) -> f64 {
        self.path_speed
    }

    /// Speed of a spindle by its encoder.
    pub(super) fn speed(&self, spindle: usize) -> Spin {
        self.speeds.get(spindle).copied().unwrap_or(Spin::ZERO)
    }

    /// How hard the drive of an axis works; `None`: it does not measure it, or the machine's file
    /// does not say what it can hold.
    pub(super) fn axis(&self, axis: Axis) -> Option<DriveLoad> {
        self.axes[axis.index()]
    }

    /// How hard the drive of a spindle works; `None`: it is commanded by speed, and does not say
    /// its torque.
    pub(super) fn spindle(&self, spindle: usize) -> Option<DriveLoad> {
        self.spindles.get(spindle).copied().flatten()
    }
}

impl Span {
    fn at(sample: &Sample) -> Self {
        Self {
            time: sample.feedback.time,
            angles: sample.feedback.spindles.map(|spindle| spindle.angle),
            place: PATH_AXES.map(|axis| sample.command.axes[axis.index()].position.value()),
            forces: [Some(0.0); AXES],
            torques: [Some(0.0); SPINDLES],
            commanded: [0.0; SPINDLES],
            periods: 0,
        }
    }

    fn add(&mut self, sample: &Sample) {
        self.periods += 1;
        let added = |sum: Option<f64>, measured: Option<f64>| {
            Some(sum? + measured.filter(|value| value.is_finite())?.abs())
        };
        for (sum, axis) in self.forces.iter_mut().zip(&sample.feedback.axes) {
            *sum = added(*sum, axis.force.map(Force::value));
        }
        for (sum, spindle) in self.torques.iter_mut().zip(&sample.feedback.spindles) {
            *sum = added(*sum, spindle.torque.map(Torque::value));
        }
        for (sum, spindle) in self.commanded.iter_mut().zip(&sample.command.spindles) {
            *sum += spindle.torque.value().abs();
        }
    }

    /// Sum of a spindle's torques, N·m, as far as they are known.
    fn torque(&self, spindle: usize, rating: &SpindleRating) -> Option<f64> {
        self.torques[spindle].or(rating.is_torque_commanded.then_some(self.commanded[spindle]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{AxisRating, ratings};
    use units::Power;

    const TORQUE_COMMANDED: SpindleRating = SpindleRating {
        continuous: Torque::n_m(20.0),
        power: Power::w(7000.0),
        thermal_time: Time::s(60.0),
        is_torque_commanded: true,
    };

    fn rated(spindle: SpindleRating) -> Meters {
        let mut ratings = Ratings::default();
        ratings.spindles[0] = Some(spindle);
        let thermal_time = Time::s(30.0);
        ratings.axes[2] = Some(AxisRating { continuous: Force::n(1000.0), thermal_time });
        Meters::new(&ratings)
    }

    /// A spindle at 1200 rev/min with a torque commanded, X and Y at 3 and 4 mm/s.
    fn sample(t: f64, commanded: f64) -> Sample {
        let mut sample = Sample::default();
        sample.feedback.time = Time::s(t);
        sample.feedback.spindles[0].angle = Angle::rev(20.0 * t);
        sample.command.spindles[0].torque = Torque::n_m(-commanded);
        sample.command.axes[0].position = units::Coordinate::new(3.0 * t);
        sample.command.axes[1].position = units::Coordinate::new(4.0 * t);
        sample
    }

    /// Periods of a quarter of a millisecond until a time.
    fn see(meters: &mut Meters, until_s: f64, sample: impl Fn(f64) -> Sample) {
        for period in 0..=(until_s / 0.000_25) as u32 {
            meters.sample(&sample(f64::from(period) * 0.000_25));
        }
    }

    #[test]
    fn speed_is_turns_by_time_and_the_path_is_the_root_of_the_squares() {
        let mut meters = rated(TORQUE_COMMANDED);
        see(&mut meters, 0.03, |t| sample(t, 0.0));
        assert!((meters.speed(0).in_rpm() - 1200.0).abs() < 1e-6);
        assert!((meters.path_speed() - 5.0).abs() < 1e-9);
    }

    #[test]
    fn what_a_drive_holds_for_ever_is_a_load_of_one_whatever_its_sign() {
        // 7000 W at 1200 rev/min are 55.7 N·m, so torque is the limit; then power is
        for (power, held) in [(7000.0, 20.0), (1200.0, 1200.0 / (40.0 * std::f64::consts::PI))] {
            let mut meters = rated(SpindleRating { power: Power::w(power), ..TORQUE_COMMANDED });
            see(&mut meters, 0.03, |t| sample(t, held));
            let load = meters.spindle(0).unwrap().load;
            assert!((load - 1.0).abs() < 1e-9, "{load}");
        }
    }

    #[test]
    fn the_commanded_torque_stands_for_a_measured_one_only_where_torque_is_commanded() {
        let measuring = |t| {
            let mut sample = sample(t, 3.0);
            sample.feedback.spindles[0].torque = Some(Torque::n_m(-10.0));
            sample.feedback.axes[2].force = Some(Force::n(-1500.0));
            sample
        };
        let own_ramps = SpindleRating { is_torque_commanded: false, ..TORQUE_COMMANDED };
        let mut meters = rated(own_ramps);
        see(&mut meters, 0.03, |t| sample(t, 3.0));
        assert_eq!((meters.spindle(0), meters.axis(Axis::Z)), (None, None));
        see(&mut meters, 0.05, |t| measuring(0.04 + t));
        let (spindle, z) = (meters.spindle(0).unwrap(), meters.axis(Axis::Z).unwrap());
        assert!((spindle.load - 0.5).abs() < 1e-9, "{spindle:?}");
        assert!((z.load - 1.5).abs() < 1e-9, "{z:?}");
        assert_eq!(meters.axis(Axis::X), None, "its continuous force is not stated");
    }

    #[test]
    fn a_drive_warms_by_the_square_of_its_load_over_its_thermal_time() {
        let mut meters = rated(TORQUE_COMMANDED);
        see(&mut meters, 60.0, |t| sample(t, 30.0));
        let thermal = meters.spindle(0).unwrap().thermal;
        let closed = 1.5 * 1.5 * (1.0 - (-1.0_f64).exp());
        assert!((thermal - closed).abs() < 2e-3, "{thermal} and {closed}");
    }

    #[test]
    fn at_its_fastest_a_spindle_holds_no_more_than_its_continuous_power() {
        let options = crate::job::ProgramOptions::on("tapping-center");
        let session = crate::job::Session::load(&options, std::path::Path::new("-"), b"");
        let machine = session.unwrap_or_else(|refused| panic!("{}", refused.sentence())).machine;
        let (rating, file) = (ratings(&machine).spindles[0].unwrap(), &machine.spindles[0]);
        let power = rating.holds(file.max).power_at(file.max).value();
        let share = file.continuous_torque.value() / file.peak_torque.value();
        assert!(power <= file.peak_power.value() * share * (1.0 + 1e-9), "{power} W");
    }
}
