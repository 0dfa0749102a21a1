//! The highest speed, acceleration and jerk of any axis, from setpoints at the servo period.
use path::{AXES, Shape};
use plan::{StepKind, coordinate};
use serde_json::{Value, json};

/// Of one axis.
#[derive(Clone, Copy, Debug, Default)]
struct Peak {
    speed: f64,
    accel: f64,
    jerk: f64,
}

/// Samples what steps order, one after another; where their time is the spindle's turns, at the speed that is ordered.
pub(super) struct Peaks {
    period: f64,
    /// From the step's start to its first sample.
    next: f64,
    /// The last setpoints.
    last: Vec<[f64; AXES]>,
    axes: [Peak; AXES],
}

impl Peaks {
    pub(super) fn new(period: f64) -> Self {
        Self { period, next: 0.0, last: Vec::new(), axes: [Peak::default(); AXES] }
    }

    pub(super) fn step(&mut self, kind: &StepKind) {
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
                    order.path.motion(order.profile.at(t * n)).position.map(units::Length::value)
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

    fn moved(&self) -> impl Iterator<Item = (char, &Peak)> {
        let letters = canon::Axis::ALL.map(canon::Axis::letter);
        letters.into_iter().zip(&self.axes).filter(|(_, peak)| peak.speed > 0.0)
    }

    pub(super) fn json(&self) -> Value {
        let of = |(letter, peak): (char, &Peak)| {
            let Peak { speed, accel, jerk } = peak;
            if is_rotary(letter) {
                return json!({
                    "axis": letter.to_string(),
                    "speed_deg_per_s": speed,
                    "acceleration_deg_per_s2": accel,
                    "jerk_deg_per_s3": jerk,
                });
            }
            json!({
                "axis": letter.to_string(),
                "speed_mm_per_s": speed,
                "acceleration_mm_per_s2": accel,
                "jerk_m_per_s3": jerk / 1e3,
            })
        };
        self.moved().map(of).collect()
    }

    pub(super) fn text(&self) -> String {
        let of = |(letter, peak): (char, &Peak)| {
            let Peak { speed, accel, jerk } = peak;
            if is_rotary(letter) {
                return format!(
                    "  {letter} at most {speed:.1} °/s, {accel:.0} °/s², {jerk:.0} °/s³\n"
                );
            }
            let jerk = jerk / 1e3;
            format!("  {letter} at most {speed:.1} mm/s, {accel:.0} mm/s², {jerk:.1} m/s³\n")
        };
        self.moved().map(of).collect()
    }
}

const fn is_rotary(letter: char) -> bool {
    matches!(letter, 'A' | 'B' | 'C')
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::Position;
    use plan::{Move, Path, Profile};

    /// 10 mm from rest to rest at 1000 mm/s²: 0.1 s up, 0.1 s down, wherever a period ends.
    #[test]
    fn a_move_that_ends_between_two_setpoints_has_no_more_acceleration_than_its_profile() {
        for length in [10.0, 10.01, 10.03, 10.05, 10.07] {
            let path =
                Path::Line { from: Position::default(), to: Position::xyz(length, 0.0, 0.0) };
            let profile = Profile::rest_to_rest(length, 1e3, 1e3, f64::INFINITY);
            let mut peaks = Peaks::new(1e-3);
            peaks.step(&StepKind::Move(Move {
                path,
                profile,
                rapid: true,
                per_revolution: false,
                exact_stop: true,
                floats: false,
                programmed: None,
            }));
            let accel = peaks.axes[0].accel;
            assert!((999.0..1000.0 + 1e-3).contains(&accel), "{length}: {accel}");
        }
    }

    /// 10 mm at 0.5 mm a revolution, 20 revolutions a second: 10 mm/s.
    #[test]
    fn a_feed_per_revolution_is_as_fast_as_the_spindle_turns() {
        let path = Path::Line { from: Position::default(), to: Position::xyz(10.0, 0.0, 0.0) };
        let profile = Profile::rest_to_rest(10.0, 0.5, 1e3, f64::INFINITY);
        let mut peaks = Peaks::new(1e-3);
        peaks.step(&StepKind::Move(Move {
            path,
            profile,
            rapid: false,
            per_revolution: true,
            exact_stop: true,
            floats: false,
            programmed: Some(plan::Programmed { feed: 0.5, turning: 20.0 }),
        }));
        assert!((peaks.axes[0].speed - 10.0).abs() < 1e-6, "{}", peaks.axes[0].speed);
    }
}
