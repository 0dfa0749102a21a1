//! What the drives themselves watch: no command is obeyed that no control would give.
//!
//! ```text
//!   command ─► setpoints within the machine? a period's way from the last? readings no faster than the axes run? ─► drives
//!                                 └ no: the control is cut off, and the drives stop by themselves from the last good command
//! ```
//!
//! It knows the machine's file, the last command and the encoders; nothing of the control. Its
//! limits are wider than the control's own monitor has them, so that of a control in order it says
//! nothing:
//!
//! | what | most |
//! |---|---|
//! | setpoint of an axis | its hard stops |
//! | from one setpoint to the next | 1.25·V for as long as passed between the readings that they answer, and 0.1 mm |
//! | speed that is ordered: of an axis, of a spindle | 1.25·V; 1.25 of the highest |
//! | speed of an axis by its encoder | 1.5·V, and 20 mm/s |
//!
//! V is the largest speed that the file states for the axis: rapids, feeds, approach. Lengths of
//! rotary axes are degrees. Numbers that are none do not come so far ([`wire`]).
use bus::{AXES, Command, Feedback};
use store::machine::{Axis, MachineFile};
use units::{Coordinate, Spin, Time};

/// Shares of the largest speed, for setpoints and for readings.
const ORDERED: f64 = 1.25;
const RUNS: f64 = 1.5;
/// What an encoder that is referenced may give another name, mm.
const RENAMED_MM: f64 = 0.1;
/// What counts and noise of an encoder make of a period's way, mm/s.
const NOISE_MM_PER_S: f64 = 20.0;

/// See the module's header.
#[derive(Clone, Debug)]
pub(super) struct CommandMonitor {
    period_s: f64,
    axes: [Option<AxisBounds>; AXES],
    spins: Vec<Spin>,
    /// Setpoints of the last command, of axes that were on.
    last: [Option<f64>; AXES],
    /// Readings of the last period.
    read: Option<[f64; AXES]>,
    /// Times of the last two readings that the control was told.
    told: [Time; 2],
}

/// What an axis can be asked for.
#[derive(Clone, Copy, Debug)]
struct AxisBounds {
    letter: canon::Axis,
    speed: f64,
    stops: Option<[f64; 2]>,
}

impl AxisBounds {
    fn of(axis: &Axis) -> Self {
        let speed = axis.rapid.max(axis.feed_most).max(axis.approach.speed).value();
        let beyond = axis.ends.map(|ends| ends.hard_stops);
        let stops =
            beyond.map(|by| [axis.travel.from - by, axis.travel.to + by].map(Coordinate::value));
        Self { letter: axis.letter, speed, stops }
    }
}

impl CommandMonitor {
    pub(super) fn new(file: &MachineFile) -> Self {
        let axes = canon::Axis::ALL.map(|letter| file.axis(letter).map(AxisBounds::of));
        let spins = file.spindles.iter().map(|spindle| spindle.max.max(spindle.tapping_max));
        Self {
            period_s: file.control.period.value(),
            axes,
            spins: spins.collect(),
            last: [None; AXES],
            read: None,
            told: [Time::ZERO; 2],
        }
    }

    /// Another control: there is no command before.
    pub(super) const fn begin_session(&mut self) {
        (self.last, self.read) = ([None; AXES], None);
    }

    /// The control is told readings of this time: its next command answers them. One that has
    /// missed periods goes on from where it would be.
    pub(super) const fn tell(&mut self, time: Time) {
        self.told = [self.told[1], time];
    }

    /// Whether it can be obeyed.
    ///
    /// # Errors
    /// One sentence.
    pub(super) fn check(&mut self, command: &Command, feedback: &Feedback) -> Result<(), String> {
        let readings = core::array::from_fn(|i| feedback.axes[i].position.value());
        let before = self.read.replace(readings);
        for (index, bounds) in self.axes.iter().enumerate() {
            let order = &command.axes[index];
            let Some(bounds) = bounds.filter(|_| order.enable) else {
                self.last[index] = None;
                continue;
            };
            let (to, speed) = (order.position.value(), order.speed.value());
            let last = self.last[index].replace(to);
            let passed = (self.told[1] - self.told[0]).max(Time::s(self.period_s));
            bounds.check(to, last, (speed, passed))?;
            if let Some(before) = before {
                bounds.check_runs((readings[index] - before[index]) / self.period_s)?;
            }
        }
        for (index, (order, most)) in command.spindles.iter().zip(&self.spins).enumerate() {
            let most = *most * ORDERED;
            if order.enable && order.spin.abs() > most {
                return Err(format!(
                    "spindle {index}: {:.0} rpm are ordered, and its drive obeys {:.0} at most",
                    order.spin.in_rpm(),
                    most.in_rpm()
                ));
            }
        }
        Ok(())
    }
}

impl AxisBounds {
    fn check(
        &self,
        to: f64,
        last: Option<f64>,
        (speed, passed): (f64, Time),
    ) -> Result<(), String> {
        let letter = self.letter.letter();
        let most = ORDERED * self.speed;
        if speed.abs() > most {
            return Err(format!(
                "axis {letter}: a speed of {speed:.1} is ordered, and its drive obeys {most:.1} at most"
            ));
        }
        if let Some([from, up_to]) = self.stops.filter(|[a, b]| to < *a || to > *b) {
            return Err(format!(
                "axis {letter}: the setpoint {to:.3} is beyond its stops at {from:.3} and {up_to:.3}"
            ));
        }
        let way = most * passed.value() + RENAMED_MM;
        if let Some(last) = last.filter(|last| (to - last).abs() > way) {
            return Err(format!(
                "axis {letter}: the setpoint jumps from {last:.3} to {to:.3}, and {way:.3} is its way in that time"
            ));
        }
        Ok(())
    }

    fn check_runs(&self, speed: f64) -> Result<(), String> {
        let most = RUNS * self.speed + NOISE_MM_PER_S;
        if speed.abs() > most {
            let letter = self.letter.letter();
            return Err(format!(
                "axis {letter} runs at {speed:.1}, and at most {most:.1} are allowed"
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control::config::machine_file;
    use units::CoordinateSpeed;

    const Z: usize = 2;

    /// The last of some commands for Z and the first spindle, and what its encoder reads then:
    /// setpoint, speed, rpm, reading.
    fn said(commands: &[(f64, f64, f64, f64)]) -> Result<(), String> {
        let file = machine_file::load("tapping-center").unwrap();
        let mut monitor = CommandMonitor::new(&file);
        let mut result = Ok(());
        for &(position, speed, rpm, reading) in commands {
            let mut command = Command::default();
            command.axes[Z].enable = true;
            command.axes[Z].position = Coordinate::new(position);
            command.axes[Z].speed = CoordinateSpeed::new(speed);
            command.spindles[0].enable = true;
            command.spindles[0].spin = Spin::rpm(rpm);
            let mut feedback = Feedback::default();
            feedback.axes[Z].position = Coordinate::new(reading);
            result = monitor.check(&command, &feedback);
        }
        result
    }

    fn why(commands: &[(f64, f64, f64, f64)]) -> String {
        said(commands).unwrap_err()
    }

    #[test]
    fn what_a_control_in_order_says_is_obeyed() {
        let rest = (-100.0, 0.0, 0.0, -100.0);
        assert_eq!(said(&[rest, rest]), Ok(()));
        // 1 m/s and 6000 rpm, on a machine that can
        assert_eq!(said(&[(-100.0, 800.0, 6000.0, -100.0), (-99.8, 800.0, 6000.0, -99.8)]), Ok(()));
    }

    #[test]
    fn a_setpoint_that_jumps_or_lies_beyond_the_stops_is_refused() {
        let rest = (-100.0, 0.0, 0.0, -100.0);
        assert!(
            why(&[rest, (-102.0, 0.0, 0.0, -100.0)]).contains("jumps from -100.000 to -102.000")
        );
        assert!(why(&[(-1605.0, 0.0, 0.0, -100.0)]).contains("beyond its stops"));
        assert!(why(&[(-1_324_678.0, 0.0, 0.0, -100.0)]).contains("axis Z"));
    }

    #[test]
    fn more_speed_than_the_machine_has_is_refused_ordered_or_seen() {
        let rest = (-100.0, 0.0, 0.0, -100.0);
        assert!(why(&[(-100.0, 5000.0, 0.0, -100.0)]).contains("a speed of 5000.0 is ordered"));
        assert!(why(&[rest, (-100.0, 0.0, 90_000.0, -100.0)]).contains("90000 rpm are ordered"));
        assert!(why(&[rest, (-100.0, 0.0, 0.0, -102.0)]).contains("axis Z runs at -8000.0"));
    }

    #[test]
    fn a_control_that_has_missed_periods_goes_on_from_where_it_would_be() {
        let file = machine_file::load("tapping-center").unwrap();
        let mut monitor = CommandMonitor::new(&file);
        let mut at = |ms: f64, position: f64| {
            let mut command = Command::default();
            command.axes[Z].enable = true;
            command.axes[Z].position = Coordinate::new(position);
            monitor.tell(Time::s(ms * 1e-3));
            monitor.check(&command, &Feedback::default())
        };
        assert_eq!((at(0.0, -100.0), at(0.25, -100.2)), (Ok(()), Ok(())));
        assert_eq!(at(2.25, -101.8), Ok(()));
        assert!(at(2.5, -103.4).is_err());
    }
}
