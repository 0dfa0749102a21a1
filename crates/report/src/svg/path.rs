//! Lines as path data, and thinning of lines that have more points than a picture can show.
use super::coordinate;
use crate::thin::Sieve;

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

/// The points without those that a straight line may leave out, within a tolerance.
pub(crate) fn thinned(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let mut sieve = Sieve::default();
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let mut last = None;
    for &(x, y) in points {
        let at = [x, y, 0.0];
        if kept.is_empty() {
            kept.push((x, y));
            sieve.begin(at);
            continue;
        }
        if !sieve.passes(at, tolerance) {
            kept.extend(last);
            let (x, y) = last.unwrap_or((x, y));
            sieve.begin([x, y, 0.0]);
            sieve.passes(at, tolerance); // the first one always does
        }
        last = Some((x, y));
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
}
