//! Lines as path data, and thinning of lines that have more points than a picture can show.
use super::coordinate;

/// Path data through points in picture units. A point that is no number lifts the pen; a point that
/// rounds to the one before it is left out.
pub(crate) fn path_data(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut data = String::new();
    let mut pen: Option<(i64, i64)> = None;
    for (x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            pen = None;
            continue;
        }
        let here = ((x * 10.0).round() as i64, (y * 10.0).round() as i64);
        if pen == Some(here) {
            continue;
        }
        data.push(if pen.is_none() { 'M' } else { ' ' });
        coordinate(&mut data, x);
        data.push(' ');
        coordinate(&mut data, y);
        pen = Some(here);
    }
    data
}

/// The points without those that lie closer than `tolerance` to the line which leaves them out.
///
/// ```text
///   kept ●───────────────● kept      a strip of ± tolerance is laid from the last kept point along
///          ·  ·   ·   ·     ╲        the direction in which the line leaves it; the last point
///        within the strip    ● kept  inside the strip is kept when the line leaves the strip
/// ```
///
/// (Reumann and Witkam, *Optimizing curve segmentation in computer graphics*, 1974.)
pub(crate) fn thinned(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let mut last: Option<(f64, f64)> = None; // the last point inside the strip
    let mut direction: Option<(f64, f64)> = None;
    let mut reach = 0.0; // how far along the strip the last point lies
    for &(x, y) in points {
        let Some(&(ax, ay)) = kept.last() else {
            kept.push((x, y));
            continue;
        };
        let (dx, dy) = (x - ax, y - ay);
        let inside = direction.is_none_or(|(ux, uy)| {
            let along = dx * ux + dy * uy;
            (dx * uy - dy * ux).abs() <= tolerance && along >= reach - tolerance
        });
        if inside {
            let distance = dx.hypot(dy);
            if direction.is_none() && distance > tolerance {
                direction = Some((dx / distance, dy / distance));
            }
            reach = f64::max(reach, distance);
            last = Some((x, y));
        } else if let Some((lx, ly)) = last {
            kept.push((lx, ly));
            let (dx, dy) = (x - lx, y - ly);
            let distance = dx.hypot(dy);
            direction = (distance > tolerance).then(|| (dx / distance, dy / distance));
            reach = distance;
            last = Some((x, y));
        }
    }
    kept.extend(last);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_rounded_to_tenths_and_lifts_the_pen_at_what_is_no_number() {
        let points =
            [(0.0, 0.0), (0.01, 0.02), (10.0, 5.25), (f64::NAN, 1.0), (3.0, -4.0), (5.0, 5.0)];
        insta::assert_snapshot!(path_data(points), @"M0 0 10 5.3M3 -4 5 5");
        assert_eq!(path_data([(f64::INFINITY, f64::NAN)]), "");
    }

    #[test]
    fn a_straight_line_is_thinned_to_its_ends_and_corners_stay() {
        let mut points: Vec<_> = (0..=100).map(|i| (f64::from(i), 0.0)).collect();
        points.extend((1..=100).map(|i| (100.0, f64::from(i))));
        assert_eq!(thinned(&points, 0.1), [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0)]);
    }

    #[test]
    fn a_line_that_turns_back_keeps_its_turning_point() {
        let there_and_back: Vec<_> =
            (0..=50).chain((0..50).rev()).map(|i| (0.0, f64::from(i))).collect();
        assert_eq!(thinned(&there_and_back, 0.1), [(0.0, 0.0), (0.0, 50.0), (0.0, 0.0)]);
    }

    #[test]
    fn no_point_of_a_circle_is_farther_from_the_thinned_line_than_the_tolerance_allows() {
        let circle: Vec<_> = (0..=3600)
            .map(|i| f64::from(i).to_radians() / 10.0)
            .map(|a| (100.0 * a.cos(), 100.0 * a.sin()))
            .collect();
        let kept = thinned(&circle, 0.1);
        assert!(kept.len() < 200, "{}", kept.len());
        for pair in kept.windows(2) {
            let middle = (f64::midpoint(pair[0].0, pair[1].0), f64::midpoint(pair[0].1, pair[1].1));
            let sagitta = 100.0 - middle.0.hypot(middle.1);
            assert!(sagitta < 0.2, "{sagitta}"); // the strip is 2 × 0.1 wide
        }
    }
}
