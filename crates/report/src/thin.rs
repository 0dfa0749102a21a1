//! Thinning a line of points: which of them a straight stretch may leave out, one point at a time.
//!
//! ```text
//!                       _ - ´|      from the anchor each point is seen within a cone of half-angle
//!               _ - ´  ·  ·  |      tolerance / distance. As long as the next point lies in the
//!   anchor ●´ ·   ·  ·   ·   ●      intersection of all cones so far, one straight line from the
//!               ` - _        |      anchor to it passes every point between within the tolerance.
//!                     ` - _  |      Of the intersection a cone inside it is kept: constant room.
//! ```
//!
//! (Williams, *An efficient algorithm for the piecewise linear approximation of planar curves*,
//! 1978, with discs for sectors, so that it works in space.)

/// Sees a line from its last kept point.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sieve {
    anchor: [f64; 3],
    /// Direction of the cone's axis, and the sine of its half-angle.
    cone: Option<([f64; 3], f64)>,
    /// How far from the anchor the line has been.
    reach: f64,
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn length(a: [f64; 3]) -> f64 {
    (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt()
}

impl Sieve {
    /// Begin anew at a point that is kept.
    pub(crate) fn begin(&mut self, anchor: [f64; 3]) {
        *self = Self { anchor, cone: None, reach: 0.0 };
    }

    /// Whether the line from the anchor may go straight to this point. If not, the point before
    /// must be kept and the sieve begun there.
    pub(crate) fn passes(&mut self, at: [f64; 3], tolerance: f64) -> bool {
        let away = minus(at, self.anchor);
        let distance = length(away);
        if distance < self.reach - tolerance {
            return false; // it turns back
        }
        self.reach = f64::max(self.reach, distance);
        if distance <= tolerance {
            return true; // too near to say in which direction
        }
        let seen = away.map(|v| v / distance);
        let wide = tolerance / distance;
        let Some((axis, radius)) = self.cone else {
            self.cone = Some((seen, wide));
            return true;
        };
        let apart = length(minus(seen, axis));
        if apart > radius {
            return false;
        }
        self.cone = Some(common(axis, radius, seen, wide, apart));
        true
    }
}

/// The largest disc inside two that overlap, their centres so far apart.
fn common(a: [f64; 3], ra: f64, b: [f64; 3], rb: f64, apart: f64) -> ([f64; 3], f64) {
    if apart + rb <= ra {
        return (b, rb);
    }
    if apart + ra <= rb {
        return (a, ra);
    }
    let radius = (ra + rb - apart) / 2.0;
    let share = (ra - radius) / apart; // how far from a towards b its centre lies
    let centre: [f64; 3] = std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share);
    let size = length(centre);
    (centre.map(|v| v / size), radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The points kept of a line.
    fn thinned(points: &[[f64; 3]], tolerance: f64) -> Vec<[f64; 3]> {
        let mut sieve = Sieve::default();
        sieve.begin(points[0]);
        let (mut kept, mut last) = (vec![points[0]], points[0]);
        for &at in &points[1..] {
            if !sieve.passes(at, tolerance) {
                kept.push(last);
                sieve.begin(last);
                assert!(
                    sieve.passes(at, tolerance),
                    "the first point after the anchor always passes"
                );
            }
            last = at;
        }
        kept.push(last);
        kept
    }

    fn distance_to_segment(p: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
        let (ab, ap) = (minus(b, a), minus(p, a));
        let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let t = (dot(ap, ab) / dot(ab, ab).max(1e-30)).clamp(0.0, 1.0);
        length(minus(ap, ab.map(|v| v * t)))
    }

    #[test]
    fn a_straight_line_that_trembles_within_the_tolerance_is_two_points() {
        let line: Vec<_> = (0..=1000)
            .map(|i| [f64::from(i) * 0.01, if i % 2 == 0 { 0.002 } else { -0.002 }, 0.0])
            .collect();
        assert_eq!(thinned(&line, 0.02).len(), 2);
    }

    #[test]
    fn every_point_of_a_helix_lies_within_the_tolerance_of_the_line_kept() {
        let helix: Vec<_> = (0..=7200)
            .map(|i| f64::from(i).to_radians() / 10.0)
            .map(|a| [20.0 * a.cos(), 20.0 * a.sin(), a])
            .collect();
        let kept = thinned(&helix, 0.05);
        assert!((20..400).contains(&kept.len()), "{}", kept.len());
        for &point in &helix {
            let nearest = kept
                .windows(2)
                .map(|s| distance_to_segment(point, s[0], s[1]))
                .fold(f64::MAX, f64::min);
            assert!(nearest <= 0.05 * 1.01, "{point:?} is {nearest} away");
        }
    }

    #[test]
    fn a_line_that_turns_back_keeps_its_turning_point() {
        let line: Vec<_> =
            (0..=50).chain((0..50).rev()).map(|i| [0.0, f64::from(i), 0.0]).collect();
        assert_eq!(thinned(&line, 0.1), [[0.0; 3], [0.0, 50.0, 0.0], [0.0; 3]]);
    }
}
