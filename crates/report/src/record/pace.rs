//! How fast the axes were told to go, and what kept them from going faster.
//!
//! ```text
//!   setpoints, period by period ─► differences ─► speed along the path, and the largest share that any axis has
//!                                                 of its highest speed, acceleration and jerk
//! ```
//!
//! Along the path, speeds are kept in classes, two to each power of two, so that a picture can show
//! them in colours, and what limited them likewise. The path is that of X, Y, Z; where none of them
//! moves its speed is that of A, B, C, in degrees.
use super::{Point, Series, Track};
use bus::{AXES, Sample, State};
use canon::{Arc, Axis, Feed, Op, OpKind, Position};
use std::collections::BTreeMap;
use units::{Angle, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Time};

/// What the axes can do, X first; infinite where there is no limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Highest speed.
    pub speed: [CoordinateSpeed; AXES],
    /// Highest acceleration.
    pub accel: [CoordinateAccel; AXES],
    /// Highest jerk while cutting.
    pub jerk: [CoordinateJerk; AXES],
}

impl AxisLimits {
    /// Of axes that are not there.
    pub const NONE: Self = Self {
        speed: [CoordinateSpeed::new(f64::INFINITY); AXES],
        accel: [CoordinateAccel::new(f64::INFINITY); AXES],
        jerk: [CoordinateJerk::new(f64::INFINITY); AXES],
    };
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
    /// A thread, or another cut tied to the spindle's turns: the spindle is as fast as programmed.
    Spindle,
    /// None of these: overrides, holds, or too short to tell.
    Nothing,
}

impl Limiter {
    /// All of them, in their order.
    pub(crate) const ALL: [Self; 6] =
        [Self::Feed, Self::Speed, Self::Acceleration, Self::Jerk, Self::Spindle, Self::Nothing];
}

/// A programmed feed.
#[derive(Clone, Copy, Debug)]
enum Fed {
    /// mm/s, or degrees a second of rotary axes alone.
    PerTime(f64),
    /// mm a revolution.
    PerRevolution(f64),
    /// Tied to the spindle's angle.
    Thread,
}

/// X, Y and Z.
const LINEAR: [usize; 3] = [0, 1, 2];
/// A, B and C.
const ROTARY: [usize; 3] = [3, 4, 5];
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
    /// Programmed feed of ops to come.
    feeds: BTreeMap<u32, Fed>,
    /// Where the last of them ends.
    programmed: Option<Position>,
    /// Setpoints of the last periods, newest first, and how many of them go on into one another.
    before: [[f64; AXES]; 3],
    count: u8,
    last: Option<Time>,
    angle: Option<Angle>,
    class: u8,
    /// The path, with classes of speed.
    pub(crate) track: Track,
    /// The path, with what limited as its classes.
    pub(crate) limiting: Track,
    pub(crate) speed: Series,
    /// Of A, B, C, degrees a second, if any of them has moved.
    pub(crate) turning: Option<Series>,
    pub(crate) accel: Series,
    pub(crate) jerk: Series,
    /// Seconds by what limited, of cuts and of rapids.
    pub(crate) limited: [[f64; Limiter::ALL.len()]; 2],
}

impl Pace {
    pub(super) const fn limits(&mut self, limits: AxisLimits) {
        self.limits = Some(limits);
    }

    pub(super) fn op(&mut self, index: u32, op: &Op) {
        let (to, arc, feed) = match &op.kind {
            // a spline's own length takes more than this to know: with G93 its feed is not looked
            // at
            OpKind::Rapid { to } | OpKind::Spline { to, feed: Feed::Duration(_), .. } => {
                (to, None, None)
            }
            OpKind::Line { to, feed } | OpKind::Spline { to, feed, .. } => (to, None, Some(feed)),
            OpKind::Arc { to, arc, feed } => (to, Some(arc), Some(feed)),
            OpKind::Threading(_) => {
                self.feeds.insert(index, Fed::Thread);
                return;
            }
            _ => return, // nothing else has a feed along a path
        };
        let from = self.programmed.replace(*to);
        let fed = match feed {
            None => return,
            Some(Feed::PerTime(speed)) => Fed::PerTime(speed.value()),
            Some(Feed::PerRevolution(lead)) => Fed::PerRevolution(lead.value()),
            Some(Feed::Duration(time)) => {
                let Some(from) = from else { return };
                Fed::PerTime(length(&from, to, arc) / time.value())
            }
        };
        self.feeds.insert(index, fed);
    }

    /// A period; the tip's place for the picture.
    pub(super) fn sample(&mut self, sample: &Sample, tip: Point) {
        let now = sample.feedback.time;
        let period = self.last.replace(now).map_or(0.0, |last| (now - last).value());
        let moves = matches!(sample.report.state, State::Feed | State::Rapid);
        let (Some(limits), true) = (self.limits, moves && period > 0.0) else {
            self.between_moves(now);
            return;
        };
        let at: [f64; AXES] = std::array::from_fn(|i| sample.command.axes[i].position.value());
        let [q1, q2, q3] = self.before;
        self.before = [at, q1, q2];
        if self.count == 3 {
            let from = (now - Time::s(period)).value();
            self.curves().for_each(|curve| curve.rest_until(from));
        }
        self.count = (self.count + 1).min(4);
        if self.count < 4 {
            return;
        }
        let v = by_axis(|i| (at[i] - q1[i]) / period);
        let a = by_axis(|i| (at[i] - 2.0 * q1[i] + q2[i]) / period.powi(2));
        let j = by_axis(|i| (at[i] - 3.0 * q1[i] + 3.0 * q2[i] - q3[i]) / period.powi(3));
        let share = |x: [f64; AXES], most: [f64; AXES]| {
            (0..AXES).map(|i| x[i].abs() / most[i]).filter(|x| x.is_finite()).fold(0.0, f64::max)
        };
        let of = |axes: [usize; 3]| axes.iter().map(|i| v[*i] * v[*i]).sum::<f64>().sqrt();
        let (speed, turning) = (of(LINEAR), of(ROTARY));
        let fast = share(v, limits.speed.map(CoordinateSpeed::value));
        let hard = share(a, limits.accel.map(CoordinateAccel::value));
        let sudden = share(j, limits.jerk.map(CoordinateJerk::value));
        let time = now.value();
        self.speed.push(time, speed);
        if turning > 0.0 || self.turning.is_some() {
            self.turning.get_or_insert_default().push(time, turning);
        }
        self.accel.push(time, 100.0 * hard);
        self.jerk.push(time, 100.0 * sudden);
        let rapid = sample.report.state == State::Rapid;
        let angle = sample.feedback.spindles[0].angle;
        let was = self.angle.replace(angle).unwrap_or(angle);
        let seen = (angle - was).value() / period;
        let spin = sample.truth.as_ref().map_or(seen, |truth| truth.spins[0].value()).abs();
        let fed = if rapid { None } else { self.fed(sample.report.op, spin) };
        let along = if speed > 0.0 { speed } else { turning };
        let limiter = match () {
            () if fed.is_some_and(|feed| along >= FED * feed) => Limiter::Feed,
            () if fast >= FED => Limiter::Speed,
            () if hard >= AT => Limiter::Acceleration,
            () if sudden >= AT => Limiter::Jerk,
            () if self.is_thread(sample.report.op) => Limiter::Spindle,
            () => Limiter::Nothing,
        };
        self.limited[usize::from(rapid)][limiter as usize] += period;
        self.class = class_near(speed, self.class);
        self.track.push(Point { class: self.class, rapid, line: 0, ..tip });
        self.limiting.push(Point { class: limiter as u8, rapid, line: 0, ..tip });
    }

    /// The curves fall to zero where the moves end: drawn through to the next move they would show
    /// what never was.
    fn between_moves(&mut self, now: Time) {
        if self.count == 4 {
            self.curves().for_each(|curve| curve.push(now.value(), 0.0));
        }
        self.count = 0;
    }

    fn curves(&mut self) -> impl Iterator<Item = &mut Series> {
        let Self { speed, accel, jerk, turning, .. } = self;
        [speed, accel, jerk].into_iter().chain(turning)
    }

    fn is_thread(&self, op: u32) -> bool {
        matches!(self.feeds.get(&op), Some(Fed::Thread))
    }

    /// The programmed feed of the op under way, per second; `spin`: revolutions per second.
    fn fed(&mut self, op: u32, spin: f64) -> Option<f64> {
        while self.feeds.first_key_value().is_some_and(|(before, _)| *before < op) {
            self.feeds.pop_first();
        }
        match self.feeds.get(&op)? {
            Fed::PerTime(feed) => Some(*feed),
            Fed::PerRevolution(lead) => Some(lead * spin),
            Fed::Thread => None,
        }
    }
}

/// Length of a move, as its feed counts it: along X, Y, Z, else in degrees.
fn length(from: &Position, to: &Position, arc: Option<&Arc>) -> f64 {
    let linear = |i: usize| (to.linear[i] - from.linear[i]).value();
    if let Some(Arc { plane, centre, sweep }) = arc {
        let [first, second, normal] = plane.axes();
        let to_centre = |axis: Axis, c: usize| from.along(axis).value() - centre[c].value();
        let radius = to_centre(first, 0).hypot(to_centre(second, 1));
        return (radius * sweep.in_rad()).hypot(linear(normal.index()));
    }
    let norm =
        |of: &dyn Fn(usize) -> f64| LINEAR.iter().map(|i| of(*i).powi(2)).sum::<f64>().sqrt();
    match norm(&linear) {
        0.0 => norm(&|i| 360.0 * (to.rotary[i] - from.rotary[i]).value()),
        straight => straight,
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

/// Returns a value for each axis.
fn by_axis(of: impl Fn(usize) -> f64) -> [f64; AXES] {
    std::array::from_fn(of)
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

    /// C alone, half a turn in 9 s: 20 degrees a second, whatever X, Y and Z may do.
    #[test]
    fn a_rotary_axis_alone_is_limited_by_its_feed_in_degrees() {
        let mut pace = Pace::default();
        pace.limits(AxisLimits { speed: [CoordinateSpeed::new(100.0); AXES], ..AxisLimits::NONE });
        let at = |deg: f64| Position {
            rotary: [Angle::ZERO, Angle::ZERO, Angle::deg(deg)],
            ..Position::default()
        };
        let op = |kind: OpKind| Op { span: canon::Span::default(), kind };
        pace.op(0, &op(OpKind::Rapid { to: at(0.0) }));
        let feed = Feed::Duration(Time::s(9.0));
        pace.op(1, &op(OpKind::Line { to: at(180.0), feed }));
        let tip = Point { at: [0.0; 3], rapid: false, lifted: false, class: 0, line: 0 };
        for period in 0..1003 {
            let mut sample = Sample::default();
            sample.feedback.time = Time::s(f64::from(period) * 1e-3);
            (sample.report.state, sample.report.op) = (State::Feed, 1);
            sample.command.axes[Axis::C.index()].position =
                units::Coordinate::new(20e-3 * f64::from(period));
            pace.sample(&sample, tip);
        }
        assert!(
            (pace.limited[0][Limiter::Feed as usize] - 0.999).abs() < 2e-3,
            "{:?}",
            pace.limited
        );
        let turning = pace.turning.expect("C turns").points();
        assert!(turning.iter().all(|(_, speed)| (speed - 20.0).abs() < 1e-6), "{turning:?}");
    }

    /// Two rapids with a second of dwell between them.
    #[test]
    fn between_moves_the_curves_lie_at_zero() {
        let mut pace = Pace::default();
        pace.limits(AxisLimits { speed: [CoordinateSpeed::new(100.0); AXES], ..AxisLimits::NONE });
        let tip = Point { at: [0.0; 3], rapid: false, lifted: false, class: 0, line: 0 };
        for period in 0..3000 {
            let mut sample = Sample::default();
            sample.feedback.time = Time::s(f64::from(period) * 1e-3);
            let dwells = (1000..2000).contains(&period);
            sample.report.state = if dwells { State::Dwell } else { State::Rapid };
            let moved = if period < 2000 { period.min(1000) } else { period - 1000 };
            sample.command.axes[0].position = units::Coordinate::new(0.05 * f64::from(moved));
            pace.sample(&sample, tip);
        }
        let speed = pace.speed.points();
        let between: Vec<_> = speed.iter().filter(|(t, _)| (1.0..2.0).contains(t)).collect();
        assert!(!between.is_empty() && between.iter().all(|(_, v)| *v == 0.0), "{between:?}");
        let falls = speed.windows(2).filter(|pair| pair[0].1 > 0.0 && pair[1].1 == 0.0);
        assert!(falls.clone().all(|pair| pair[1].0 - pair[0].0 < 0.02) && falls.count() == 1);
        let rises = speed.windows(2).filter(|pair| pair[0].1 == 0.0 && pair[1].1 > 0.0);
        assert!(rises.clone().all(|pair| pair[1].0 - pair[0].0 < 0.02) && rises.count() == 2);
    }

    #[test]
    fn a_move_is_as_long_as_its_feed_counts_it() {
        let from = Position::xyz(10.0, 0.0, 0.0);
        let to = Position { rotary: [Angle::deg(90.0); 3], ..Position::xyz(13.0, 4.0, 0.0) };
        assert!((length(&from, &to, None) - 5.0).abs() < 1e-12);
        // half a turn about the origin, 3 mm up: √((10π)² + 3²)
        let arc = Arc {
            plane: canon::Plane::XY,
            centre: [units::Length::ZERO; 2],
            sweep: Angle::rev(0.5),
        };
        let up = length(&from, &Position::xyz(-10.0, 0.0, 3.0), Some(&arc));
        assert!((up - (10.0 * std::f64::consts::PI).hypot(3.0)).abs() < 1e-9, "{up}");
    }
}
