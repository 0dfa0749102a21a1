//! The highest speed, acceleration and jerk of any axis, from setpoints at the servo period.
use motion::{AXES, Shape, coordinate};
use plan::StepKind;

/// Of one axis: mm or degrees, and seconds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Peak {
    /// Highest speed.
    pub speed: f64,
    /// Highest acceleration.
    pub accel: f64,
    /// Highest jerk.
    pub jerk: f64,
}

/// Samples what steps order, one after another; where their time is the spindle's turns, at the
/// speed that is ordered.
pub struct Peaks {
    period: f64,
    /// From the step's start to its first sample.
    next: f64,
    /// The last setpoints.
    last: Vec<[f64; AXES]>,
    axes: [Peak; AXES],
}

impl Peaks {
    /// Of nothing yet, with a servo period of so many seconds.
    pub fn new(period: f64) -> Self {
        Self { period, next: 0.0, last: Vec::new(), axes: [Peak::default(); AXES] }
    }

    /// One more step.
    pub fn step(&mut self, kind: &StepKind) {
        match kind {
            StepKind::Follow(order) => {
                let n = if order.per_revolution { order.pace.turning } else { 1.0 };
                self.sample(order.duration() / n, |t| order.piece.at(order.at(t * n).0).q);
                if order.exact_stop {
                    self.stop(order.piece.at(order.piece.length).q);
                }
            }
            StepKind::Move(order) => {
                let programmed = order.programmed.filter(|_| order.per_revolution);
                let n = programmed.map_or(1.0, |programmed| programmed.turning);
                let place = |p: &canon::Position| canon::Axis::ALL.map(|axis| coordinate(p, axis));
                let motion = |t| {
                    order
                        .path
                        .motion(order.profile.at(t * n))
                        .position
                        .map(units::Coordinate::value)
                };
                self.last.resize(3, place(order.path.from()));
                self.sample(order.profile.duration() / n, motion);
                self.stop(place(order.path.to()));
            }
            _ => self.rest(),
        }
    }

    fn sample(&mut self, duration: f64, place: impl Fn(f64) -> [f64; AXES]) {
        while self.next < duration {
            let q = place(self.next);
            self.next += self.period;
            self.point(q);
        }
        self.next -= duration;
    }

    /// Motion has ended here: the setpoint of the next period, and of those after it.
    fn stop(&mut self, end: [f64; AXES]) {
        (0..3).for_each(|_| self.point(end));
        self.last.clear();
        self.next = 0.0;
    }

    /// Everything stands: what comes next begins from here.
    fn rest(&mut self) {
        if let Some(last) = self.last.last().copied() {
            self.stop(last);
        }
    }

    fn point(&mut self, q: [f64; AXES]) {
        if self.last.is_empty() {
            self.last = vec![q; 3];
        }
        let [a, b, c] = [self.last[0], self.last[1], self.last[2]];
        let t = self.period;
        for (i, peak) in self.axes.iter_mut().enumerate() {
            let (x, y, z) = (q[i] - c[i], c[i] - b[i], b[i] - a[i]);
            peak.speed = peak.speed.max((x / t).abs());
            peak.accel = peak.accel.max(((x - y) / (t * t)).abs());
            peak.jerk = peak.jerk.max(((x - 2.0 * y + z) / (t * t * t)).abs());
        }
        self.last = vec![b, c, q];
    }

    /// Each axis that moves, by its letter.
    pub fn moved(&self) -> impl Iterator<Item = (char, &Peak)> {
        let letters = canon::Axis::ALL.map(canon::Axis::letter);
        letters.into_iter().zip(&self.axes).filter(|(_, peak)| peak.speed > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::Position;
    use motion::{Move, Path};

    /// 10 mm from rest to rest at 1000 mm/s²: 0.1 s up, 0.1 s down, wherever a period ends.
    #[test]
    fn a_move_that_ends_between_two_setpoints_has_no_more_acceleration_than_its_profile() {
        for length in [10.0, 10.01, 10.03, 10.05, 10.07] {
            let path =
                Path::Line { from: Position::default(), to: Position::xyz(length, 0.0, 0.0) };
            let profile = plan::rest_to_rest(length, 1e3, 1e3, f64::INFINITY);
            let mut peaks = Peaks::new(1e-3);
            peaks.step(&StepKind::Move(Box::new(Move {
                path,
                profile,
                rapid: true,
                per_revolution: false,
                exact_stop: true,
                floats: false,
                programmed: None,
            })));
            let accel = peaks.axes[0].accel;
            assert!((999.0..1000.0 + 1e-3).contains(&accel), "{length}: {accel}");
        }
    }

    /// 10 mm at 0.5 mm a revolution, 20 revolutions a second: 10 mm/s.
    #[test]
    fn a_feed_per_revolution_is_as_fast_as_the_spindle_turns() {
        let path = Path::Line { from: Position::default(), to: Position::xyz(10.0, 0.0, 0.0) };
        let profile = plan::rest_to_rest(10.0, 0.5, 1e3, f64::INFINITY);
        let mut peaks = Peaks::new(1e-3);
        peaks.step(&StepKind::Move(Box::new(Move {
            path,
            profile,
            rapid: false,
            per_revolution: true,
            exact_stop: true,
            floats: false,
            programmed: Some(motion::Programmed { feed: 0.5, turning: 20.0 }),
        })));
        assert!((peaks.axes[0].speed - 10.0).abs() < 1e-6, "{}", peaks.axes[0].speed);
    }
}
