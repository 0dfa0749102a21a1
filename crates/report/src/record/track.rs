//! The tool's path in a fixed room: where the tip went, and whether it went there rapidly.
//!
//! ```text
//!   kept ●───────────────● kept      a tube of ± tolerance is laid from the last kept point along
//!          ·  ·   ·   ·     ╲        the direction in which the path leaves it; the last point
//!        within the tube     ● kept  inside the tube is kept when the path leaves the tube
//! ```
//!
//! When the room is full the tolerance is doubled and what was kept passes through the same sieve
//! again: a short program is drawn to 20 µm, a long one as finely as the room allows.

/// Points kept at most.
const POINTS: usize = 20_000;
/// Tolerance to begin with, mm.
const FINEST: f64 = 0.02;

/// A point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    /// Tool tip, mm.
    pub(crate) at: [f64; 3],
    /// How the tool came here.
    pub(crate) rapid: bool,
    /// The pen is lifted before this point: another tool begins.
    pub(crate) lifted: bool,
}

/// The path, recorded sample by sample.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    points: Vec<Point>,
    /// The last point inside the tube.
    last: Option<Point>,
    direction: Option<[f64; 3]>,
    reach: f64,
    tolerance: f64,
}

impl Default for Track {
    fn default() -> Self {
        Self { points: Vec::new(), last: None, direction: None, reach: 0.0, tolerance: FINEST }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Track {
    /// Record where the tip is. What is no number is left out.
    pub(crate) fn push(&mut self, point: Point) {
        if !point.at.iter().all(|v| v.is_finite()) {
            return;
        }
        self.sieve(point);
        if self.points.len() >= POINTS {
            self.coarsen();
        }
    }

    fn sieve(&mut self, point: Point) {
        let Some(anchor) = self.points.last().map(|p| p.at) else {
            self.points.push(Point { lifted: true, ..point });
            return;
        };
        let changed = point.lifted || self.last.is_some_and(|last| last.rapid != point.rapid);
        if changed {
            self.keep_last();
        }
        if point.lifted {
            self.points.push(point);
            self.direction = None;
            self.reach = 0.0;
        } else if changed || !self.inside(anchor, point.at) {
            self.keep_last();
            let anchor = self.points.last().map_or(point.at, |p| p.at);
            self.lay_tube(minus(point.at, anchor));
            self.last = Some(point);
        } else {
            self.last = Some(point);
        }
    }

    /// Whether a point lies in the tube that leaves the anchor; lays the tube if there is none yet.
    fn inside(&mut self, anchor: [f64; 3], at: [f64; 3]) -> bool {
        let away = minus(at, anchor);
        let Some(direction) = self.direction else {
            self.lay_tube(away);
            return true;
        };
        let along = dot(away, direction);
        let off_squared = dot(away, away) - along * along;
        let inside =
            off_squared <= self.tolerance * self.tolerance && along >= self.reach - self.tolerance;
        self.reach = f64::max(self.reach, along);
        inside
    }

    fn lay_tube(&mut self, away: [f64; 3]) {
        let distance = dot(away, away).sqrt();
        let far = distance > self.tolerance;
        self.direction = far.then(|| away.map(|v| v / distance));
        self.reach = if far { distance } else { 0.0 };
    }

    fn keep_last(&mut self) {
        self.points.extend(self.last.take());
        self.direction = None;
        self.reach = 0.0;
    }

    fn coarsen(&mut self) {
        let last = self.last.take();
        let points = std::mem::take(&mut self.points);
        self.tolerance *= 2.0;
        self.direction = None;
        self.reach = 0.0;
        for &point in &points {
            self.sieve(point);
        }
        self.keep_last();
        if self.points.len() > POINTS * 3 / 4 {
            // nothing but short moves of changing kind: every other point has to go
            let pairs = self.points.chunks(2).map(|pair| {
                let lifted = pair.iter().any(|p| p.lifted);
                Point { lifted, ..pair[pair.len() - 1] }
            });
            self.points = pairs.collect();
        }
        if let Some(last) = last {
            self.sieve(last);
        }
    }

    /// The path's points, in order.
    pub(crate) fn points(&self) -> impl Iterator<Item = Point> + '_ {
        self.points.iter().copied().chain(self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feed(at: [f64; 3]) -> Point {
        Point { at, rapid: false, lifted: false }
    }

    #[test]
    fn a_straight_move_of_a_thousand_periods_is_two_points() {
        let mut track = Track::default();
        for i in 0..=1000 {
            let wobble = if i % 2 == 0 { 0.004 } else { -0.004 };
            track.push(feed([f64::from(i) * 0.1, wobble, 0.0]));
        }
        let kept: Vec<_> = track.points().map(|p| p.at[0]).collect();
        assert_eq!(kept, [0.0, 100.0]);
    }

    #[test]
    fn a_drilling_stroke_keeps_its_turning_point_and_its_kind() {
        let mut track = Track::default();
        for i in 0..=100 {
            track.push(feed([0.0, 0.0, -0.1 * f64::from(i)]));
        }
        for i in (0..100).rev() {
            track.push(Point { rapid: true, ..feed([0.0, 0.0, -0.1 * f64::from(i)]) });
        }
        let kept: Vec<_> = track.points().map(|p| (p.at[2], p.rapid)).collect();
        assert_eq!(kept, [(0.0, false), (-10.0, false), (0.0, true)]);
    }

    #[test]
    fn another_tool_begins_a_new_line() {
        let mut track = Track::default();
        track.push(feed([0.0; 3]));
        track.push(feed([10.0, 0.0, 0.0]));
        track.push(Point { lifted: true, ..feed([10.0, 0.0, 30.0]) });
        track.push(feed([20.0, 0.0, 30.0]));
        let kept: Vec<_> = track.points().map(|p| (p.at[0], p.lifted)).collect();
        assert_eq!(kept, [(0.0, true), (10.0, false), (10.0, true), (20.0, false)]);
    }

    #[test]
    fn a_path_that_never_is_straight_stays_within_its_room() {
        let mut track = Track::default();
        for i in 0..500_000u32 {
            let t = f64::from(i) * 0.7;
            let at = [100.0 * t.sin(), 100.0 * (t * 1.3).cos(), t * 0.001];
            track.push(Point { at, rapid: i % 3 == 0, lifted: false });
        }
        let kept = track.points().count();
        assert!((5_000..=POINTS + 1).contains(&kept), "{kept}");
    }
}
