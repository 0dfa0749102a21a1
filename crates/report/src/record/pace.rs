//! How fast the axes were told to go, and what kept them from going faster.
//!
//! ```text
//!   setpoints of X Y Z, period by period ─► differences ─► speed along the path, and the largest share that any axis has
//!                                                          of its highest speed, acceleration and jerk
//! ```
//!
//! Along the path, speeds are kept in classes, two to each power of two, so that a picture can show them in colours.
use super::{Point, Series, Track};
use bus::{Sample, State};
use canon::{Feed, Op, OpKind};
use std::collections::BTreeMap;
use units::{Accel, Jerk, Speed, Time};

/// What axes X, Y and Z can do; infinite where there is no limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Highest speed.
    pub speed: [Speed; 3],
    /// Highest acceleration.
    pub accel: [Accel; 3],
    /// Highest jerk while cutting.
    pub jerk: [Jerk; 3],
}

/// What kept a motion from being faster; in the order in which it is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Limiter {
    /// The programmed feed is reached.
    Feed,
    /// An axis is as fast as it can be.
    Speed,
    /// An axis accelerates as much as it can.
    Acceleration,
    /// An axis' acceleration changes as fast as it can.
    Jerk,
    /// None of these: overrides, holds, or too short to tell.
    Nothing,
}

/// An axis, or the path, is at its limit from this share on.
const AT: f64 = 0.9;
/// The feed is reached from this share on.
const FED: f64 = 0.97;
/// The slowest class of speed ends here, mm/s.
const SLOWEST: f64 = 0.25;
/// Classes of speed.
pub(crate) const CLASSES: u8 = 24;

/// See the module's header.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pace {
    limits: Option<AxisLimits>,
    /// Programmed feed of ops to come, mm/s.
    feeds: BTreeMap<u32, f64>,
    /// Setpoints of the last periods, newest first, and how many of them go on into one another.
    before: [[f64; 3]; 3],
    count: u8,
    last: Option<Time>,
    class: u8,
    /// The path, with classes of speed.
    pub(crate) track: Track,
    pub(crate) speed: Series,
    pub(crate) accel: Series,
    pub(crate) jerk: Series,
    /// Seconds by what limited.
    pub(crate) limited: [f64; 5],
}

impl Pace {
    pub(super) const fn limits(&mut self, limits: AxisLimits) {
        self.limits = Some(limits);
    }

    pub(super) fn op(&mut self, index: u32, op: &Op) {
        if let OpKind::Line { feed: Feed::PerTime(feed), .. }
        | OpKind::Arc { feed: Feed::PerTime(feed), .. }
        | OpKind::Spline { feed: Feed::PerTime(feed), .. } = &op.kind
        {
            self.feeds.insert(index, feed.value());
        }
    }

    /// A period; the tip's place for the picture.
    pub(super) fn sample(&mut self, sample: &Sample, tip: Point) {
        let now = sample.feedback.time;
        let period = self.last.replace(now).map_or(0.0, |last| (now - last).value());
        let moves = matches!(sample.report.state, State::Feed | State::Rapid);
        let (Some(limits), true) = (self.limits, moves && period > 0.0) else {
            self.count = 0;
            return;
        };
        let at = [0, 1, 2].map(|i| sample.command.axes[i].position.value());
        let [q1, q2, q3] = self.before;
        self.before = [at, q1, q2];
        self.count = (self.count + 1).min(4);
        if self.count < 4 {
            return;
        }
        let by_axis = |of: &dyn Fn(usize) -> f64| [0, 1, 2].map(of);
        let v = by_axis(&|i| (at[i] - q1[i]) / period);
        let a = by_axis(&|i| (at[i] - 2.0 * q1[i] + q2[i]) / period.powi(2));
        let j = by_axis(&|i| (at[i] - 3.0 * q1[i] + 3.0 * q2[i] - q3[i]) / period.powi(3));
        let share = |x: [f64; 3], most: [f64; 3]| {
            (0..3).map(|i| x[i].abs() / most[i]).filter(|x| x.is_finite()).fold(0.0, f64::max)
        };
        let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let fast = share(v, limits.speed.map(Speed::value));
        let hard = share(a, limits.accel.map(Accel::value));
        let sudden = share(j, limits.jerk.map(Jerk::value));
        let time = now.value();
        self.speed.push(time, speed);
        self.accel.push(time, 100.0 * hard);
        self.jerk.push(time, 100.0 * sudden);
        let op = sample.report.op;
        while self.feeds.first_key_value().is_some_and(|(before, _)| *before < op) {
            self.feeds.pop_first();
        }
        let rapid = sample.report.state == State::Rapid;
        let feed = self.feeds.get(&op).filter(|_| !rapid).copied().unwrap_or(f64::INFINITY);
        let limiter = match () {
            () if speed >= FED * feed => Limiter::Feed,
            () if fast >= FED => Limiter::Speed,
            () if hard >= AT => Limiter::Acceleration,
            () if sudden >= AT => Limiter::Jerk,
            () => Limiter::Nothing,
        };
        self.limited[limiter as usize] += period;
        self.class = class_near(speed, self.class);
        self.track.push(Point { class: self.class, rapid, ..tip });
    }
}

/// The class of a speed; a speed near the border of the one before stays in it.
fn class_near(speed: f64, before: u8) -> u8 {
    let exact = 2.0 * (speed / SLOWEST).max(0.5).log2();
    let stays = exact > f64::from(before) - 1.1 && exact < f64::from(before) + 0.1;
    if stays { before } else { exact.ceil().clamp(0.0, f64::from(CLASSES - 1)) as u8 }
}

/// Where a class of speed begins and ends, mm/s.
pub(crate) fn class_bounds(class: u8) -> (f64, f64) {
    let end = SLOWEST * (f64::from(class) / 2.0).exp2();
    (if class == 0 { 0.0 } else { end / std::f64::consts::SQRT_2 }, end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_speed_lies_within_its_class() {
        for speed in [0.0, 0.2, 0.3, 1.0, 7.0, 16.6, 100.0, 499.0] {
            let (from, to) = class_bounds(class_near(speed, if speed > 10.0 { 0 } else { 23 }));
            assert!((from..=to).contains(&speed), "{speed} in {from} to {to}");
        }
        assert_eq!(class_near(16.2, class_near(15.0, 0)), class_near(15.0, 0));
    }
}
