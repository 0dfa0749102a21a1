//! The tool's path in a fixed room: where the tip went, and whether it went there rapidly.
//!
//! ```text
//!   rapid ╲  ╱ rapid      kept are the ends of straight stretches, and the points where the way of
//!          ╲╱             moving or the tool changes
//!           │ feed
//! ```
//!
//! When the room is full the tolerance is doubled and what was kept passes through the same sieve
//! again: a short program is drawn to 20 µm, a long one as finely as the room allows.

use crate::thin::Sieve;

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
    /// Program line that ordered it; 0: a line of another file.
    pub(crate) line: u32,
    /// Class of the speed with which it came, if that matters.
    pub(crate) class: u8,
}

/// The path, recorded sample by sample.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    points: Vec<Point>,
    /// The last point that a straight line may still pass.
    last: Option<Point>,
    sieve: Sieve,
    tolerance: f64,
}

impl Default for Track {
    fn default() -> Self {
        Self { points: Vec::new(), last: None, sieve: Sieve::default(), tolerance: FINEST }
    }
}

impl Track {
    /// Record where the tip is. What is no number is left out.
    pub(crate) fn push(&mut self, point: Point) {
        if !point.at.iter().all(|v| v.is_finite()) {
            return;
        }
        self.take(point);
        if self.points.len() >= POINTS {
            self.coarsen();
        }
    }

    fn take(&mut self, point: Point) {
        let lifted = point.lifted || self.points.is_empty();
        let kind = |p: &Point| (p.rapid, p.class, p.line);
        let changed = self.last.is_some_and(|last| kind(&last) != kind(&point));
        if lifted {
            self.keep_last();
            self.keep(Point { lifted, ..point });
            return;
        }
        if changed || !self.sieve.passes(point.at, self.tolerance) {
            self.keep_last();
            self.sieve.passes(point.at, self.tolerance); // the first one always does
        }
        self.last = Some(point);
    }

    fn keep(&mut self, point: Point) {
        self.points.push(point);
        self.sieve.begin(point.at);
    }

    fn keep_last(&mut self) {
        if let Some(last) = self.last.take() {
            self.keep(last);
        }
    }

    fn coarsen(&mut self) {
        let last = self.last.take();
        let points = std::mem::take(&mut self.points);
        self.tolerance *= 2.0;
        for &point in &points {
            self.take(point);
        }
        self.keep_last();
        if self.points.len() > POINTS * 3 / 4 {
            // nothing but short moves of changing kind: every other point has to go
            let pairs = self.points.chunks(2).map(|pair| {
                let lifted = pair.iter().any(|p| p.lifted);
                Point { lifted, ..pair[pair.len() - 1] }
            });
            self.points = pairs.collect();
            let anchor = self.points[self.points.len() - 1].at; // it is far from empty
            self.sieve.begin(anchor);
        }
        if let Some(last) = last {
            self.take(last);
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
        Point { at, rapid: false, lifted: false, class: 0, line: 1 }
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
            track.push(Point { at, rapid: i % 3 == 0, lifted: false, class: 0, line: 1 });
        }
        let kept = track.points().count();
        assert!((5_000..=POINTS + 1).contains(&kept), "{kept}");
    }
}
