//! The minimum zone of a profile: two parallel lines, as near to each other as may be, that hold it
//! between them.
//!
//! ```text
//!    n │  ___ upper line, through two points …      At the optimum one line goes through an edge of the convex
//!      │ ∙‾‾∙∙∙__∙                                  hull and the other through the point farthest from it; so
//!      │     ___ lower line, through one            each edge is tried.
//!      └──────────── s
//! ```
//!
//! Exact, not iterative. Source: ISO 12780-1, minimum zone reference line.

/// Two lines n = middle + slope·s ± width/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zone {
    pub(super) middle: f64,
    pub(super) slope: f64,
    pub(super) width: f64,
}

/// Of points (s, n) with rising s; `None` of fewer than two.
pub(super) fn minimum_zone(points: &[[f64; 2]]) -> Option<Zone> {
    if points.len() < 2 {
        return None;
    }
    let (lower, upper) = (half_hull(points, 1.0), half_hull(points, -1.0));
    let edges = lower.windows(2).chain(upper.windows(2));
    let slopes = edges.map(|e| (e[1][1] - e[0][1]) / (e[1][0] - e[0][0]));
    let of = |slope: f64| {
        let above = |p: &[f64; 2]| p[1] - slope * p[0];
        let top = upper.iter().map(above).fold(f64::NEG_INFINITY, f64::max);
        let bottom = lower.iter().map(above).fold(f64::INFINITY, f64::min);
        Zone { middle: f64::midpoint(top, bottom), slope, width: top - bottom }
    };
    slopes.filter(|s| s.is_finite()).map(of).min_by(|a, b| a.width.total_cmp(&b.width))
}

/// The hull's lower chain (`side` +1) or upper chain (−1).
fn half_hull(points: &[[f64; 2]], side: f64) -> Vec<[f64; 2]> {
    let mut chain: Vec<[f64; 2]> = Vec::new();
    for p in points {
        while let [.., a, b] = chain[..] {
            let turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            if turn * side > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(*p);
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_zone_of_a_parabola_is_its_height() {
        let points: Vec<_> =
            (-10..=10).map(|i| f64::from(i) / 10.0).map(|s| [s, 3.0 - s * s]).collect();
        let zone = minimum_zone(&points).expect("there are points");
        assert!((zone.width - 1.0).abs() < 1e-12 && zone.slope.abs() < 1e-12, "{zone:?}");
    }

    #[test]
    fn a_slope_is_tilt_and_not_width() {
        let points: Vec<_> =
            (0..20).map(|i| f64::from(i) * 0.3).map(|s| [s, 1.0 + 0.25 * s]).collect();
        let zone = minimum_zone(&points).expect("there are points");
        assert!(zone.width.abs() < 1e-12 && (zone.slope - 0.25).abs() < 1e-12, "{zone:?}");
        assert!((zone.middle - 1.0).abs() < 1e-12, "{zone:?}");
    }

    #[test]
    fn least_squares_would_be_wider() {
        // a step: the best pair of lines is inclined
        let points: Vec<_> =
            (0..=10).map(|i| [f64::from(i), if i < 5 { 0.0 } else { 1.0 }]).collect();
        let zone = minimum_zone(&points).expect("there are points");
        assert!((zone.width - 5.0 / 6.0).abs() < 1e-12 && zone.slope > 0.1, "{zone:?}");
    }
}
