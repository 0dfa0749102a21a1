//! What joining promises: near enough to what was programmed, exact at its ends, and smooth where
//! it says so.
use motion::{AXES, Bounds, Curve, Derivatives, Entry, Limits, Piece, Shape};
use motion::{Arc, Line};
use path::geometry::{Joiner, Segment, cubic};
use proptest::prelude::*;
use test_support::size;

type Point = [f64; AXES];

/// Curves are compared with 1000 chords, which are so far from them, mm.
const CHORDS: f64 = 2e-5;

fn at(x: f64, y: f64, z: f64) -> Point {
    [x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
}

fn apart(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn segment(curve: &Curve, tolerance: f64) -> Segment {
    Segment { curve: *curve, feed: 100.0, rapid: false, tolerance, merge: 0.0, op: 0, line: 0 }
}

fn line(from: Point, to: Point) -> Curve {
    Curve::Line(Line { from, to, length: apart(&from, &to) })
}

fn lines(points: &[Point], tolerance: f64) -> Vec<Segment> {
    points.windows(2).map(|w| segment(&line(w[0], w[1]), tolerance)).collect()
}

/// 200 mm/s and 1000 mm/s², with a limit of jerk.
fn limits(jerk: f64) -> Limits {
    let bounds = Bounds { speed: [200.0; AXES], accel: [1000.0; AXES], jerk: [jerk; AXES] };
    Limits { feed: bounds, rapid: bounds }
}

fn joined(segments: &[Segment], jerk: f64) -> Vec<Piece> {
    let (mut joiner, mut pieces) = (Joiner::new(&limits(jerk)), Vec::new());
    for segment in segments {
        joiner.push(*segment, &mut |piece| pieces.push(piece));
    }
    joiner.finish(&mut |piece| pieces.push(piece));
    pieces
}

fn end(piece: &Piece) -> Derivatives {
    piece.at(piece.length())
}

/// Position goes on everywhere, slope and bend where the entry says so.
fn check_joints(pieces: &[Piece]) {
    assert_eq!(pieces[0].entry, Entry::Rest);
    for pair in pieces.windows(2) {
        let (before, after) = (end(&pair[0]), pair[1].at(0.0));
        assert!(apart(&before.q, &after.q) < 1e-9, "a gap of {}", apart(&before.q, &after.q));
        let scale = 1.0 + apart(&before.q2, &[0.0; AXES]);
        if pair[1].entry != Entry::Rest {
            assert!(apart(&before.q1, &after.q1) < 1e-6, "a corner {before:?} {after:?}");
        }
        if pair[1].entry == Entry::Smooth {
            assert!(apart(&before.q2, &after.q2) < 1e-5 * scale, "a jump of the bend");
        }
    }
}

/// The programmed path as chords, each with the way to its beginning.
fn programmed(segments: &[Segment]) -> Vec<(f64, Point)> {
    let mut points = Vec::new();
    let mut begin = 0.0;
    for segment in segments {
        let length = segment.curve.length();
        let fine = match segment.curve {
            Curve::Line(_) => 1,
            _ => 1000,
        };
        for k in 0..=fine {
            let s = length * f64::from(k) / f64::from(fine);
            points.push((begin + s, segment.curve.at(s).q));
        }
        begin += length;
    }
    points
}

/// The joined path as points at most 0.02 mm apart (blends: a hundredth of their length).
fn followed(pieces: &[Piece]) -> Vec<(f64, Point)> {
    let mut points: Vec<(f64, Point)> = Vec::new();
    for piece in pieces {
        let length = piece.length();
        let count = (length / 0.02).ceil().max(100.0) as usize;
        for k in 0..=count {
            let q = piece.at(length * k as f64 / count as f64).q;
            let way = points.last().map_or(0.0, |(u, last)| u + apart(last, &q));
            points.push((way, q));
        }
    }
    points
}

/// Farthest that points are from a path of chords. Both run over nearly the same way, so the
/// nearest chord is looked for around the one of the point before; where a small loop was cut short
/// and none there is near, among all of them.
fn farthest(points: &[(f64, Point)], path: &[(f64, Point)], tolerance: f64) -> f64 {
    let nearest = |q: &Point, chords: &[(f64, Point)], until: f64| {
        let (mut near, mut place) = (f64::INFINITY, 0.0);
        for w in chords.windows(2).take_while(|w| w[0].0 <= until) {
            let (off, share) = from_chord(q, &w[0].1, &w[1].1);
            if off < near {
                (near, place) = (off, w[0].0 + share * (w[1].0 - w[0].0));
            }
        }
        (near, place)
    };
    let (mut worst, mut at) = (0.0_f64, 0.0);
    let mut before = 0.0;
    for (way, q) in points {
        at += way - before;
        before = *way;
        let first = path.partition_point(|(u, _)| *u < at - 1.0).max(1) - 1;
        let (mut near, mut place) = nearest(q, &path[first..], at + 1.0);
        if near > tolerance {
            (near, place) = nearest(q, path, f64::INFINITY);
            at = place;
        }
        worst = worst.max(near);
        at = f64::midpoint(at, place);
    }
    worst
}

/// How far a point is from a chord, and where along it.
fn from_chord(q: &Point, a: &Point, b: &Point) -> (f64, f64) {
    let along: f64 = (0..AXES).map(|i| (b[i] - a[i]).powi(2)).sum();
    let dot: f64 = (0..AXES).map(|i| (q[i] - a[i]) * (b[i] - a[i])).sum();
    let f = if along > 0.0 { (dot / along).clamp(0.0, 1.0) } else { 0.0 };
    ((0..AXES).map(|i| (q[i] - a[i] - f * (b[i] - a[i])).powi(2)).sum::<f64>().sqrt(), f)
}

/// For axes without a limit of jerk, and with one; the pieces of the latter.
fn check(segments: &[Segment], tolerance: f64) -> Vec<Piece> {
    check_with(segments, tolerance, f64::INFINITY);
    check_with(segments, tolerance, 20e3)
}

fn check_with(segments: &[Segment], tolerance: f64, jerk: f64) -> Vec<Piece> {
    let pieces = joined(segments, jerk);
    check_joints(&pieces);
    let (first, last) = (segments[0].curve, segments[segments.len() - 1].curve);
    assert!(apart(&pieces[0].at(0.0).q, &first.at(0.0).q) < 1e-9);
    assert!(apart(&end(&pieces[pieces.len() - 1]).q, &last.at(last.length()).q) < 1e-9);
    let (path, curve) = (programmed(segments), followed(&pieces));
    let far = farthest(&curve, &path, tolerance);
    assert!(far <= tolerance * 1.001 + CHORDS, "{far} mm from the path with P {tolerance}");
    // nor does it cut a place off by more than the point of a right angle, where it is P from both
    // lines
    let far = farthest(&path, &curve, tolerance);
    let corner = std::f64::consts::SQRT_2 * tolerance;
    assert!(far <= corner * 1.001 + CHORDS, "{far} mm are cut off with P {tolerance}");
    pieces
}

#[test]
fn a_corner_of_two_long_lines_is_passed_at_p_from_both() {
    let points = [at(0.0, 0.0, 0.0), at(100.0, 0.0, 0.0), at(100.0, 100.0, 0.0)];
    let pieces = check(&lines(&points, 0.1), 0.1);
    // a line, the way out, six parts of the turn, the way back, a line
    assert_eq!(pieces.len(), 10);
    // by symmetry in the middle
    let middle = end(&pieces[4]).q;
    assert!(apart(&middle, &at(99.9001, 0.0999, 0.0)) < 1e-9, "{middle:?}");
}

/// Within P of both lines it could be passed at P/sin 15°, nearly four times P.
#[test]
fn an_acute_corner_is_passed_no_farther_away_than_a_right_angle() {
    let (sin, cos) = 30_f64.to_radians().sin_cos();
    for length in [1.0, 100.0] {
        let points =
            [at(-length, 0.0, 0.0), at(0.0, 0.0, 0.0), at(-length * cos, length * sin, 0.0)];
        for jerk in [f64::INFINITY, 20e3] {
            let pieces = check_with(&lines(&points, 0.1), 0.1, jerk);
            let away =
                followed(&pieces).iter().map(|(_, q)| apart(q, &points[1])).fold(1.0, f64::min);
            assert!((0.9..1.0).contains(&(away / 0.1 / std::f64::consts::SQRT_2)), "{away} mm");
        }
    }
}

/// Nothing is fitted across a gap, where a curve would have to jump: both sides are paths of their
/// own.
#[test]
fn a_move_that_begins_elsewhere_does_not_go_on_from_the_one_before() {
    let before = lines(&[at(0.0, 0.0, 0.0), at(4.3, 11.1, 0.0), at(4.9, 11.2, 0.0)], 0.1);
    let after = lines(&[at(4.9, 11.2, 0.25), at(6.1, 11.7, 0.25), at(6.2, 11.9, 0.25)], 0.1);
    for jerk in [f64::INFINITY, 20e3] {
        let (mut joiner, mut pieces) = (Joiner::new(&limits(jerk)), Vec::new());
        for segment in before.iter().chain(&after) {
            joiner.push(*segment, &mut |piece| pieces.push(piece));
        }
        joiner.finish(&mut |piece| pieces.push(piece));
        let gap = pieces.windows(2).position(|w| apart(&end(&w[0]).q, &w[1].at(0.0).q) > 0.1);
        let (left, right) = pieces.split_at(gap.expect("the gap stays a gap") + 1);
        assert!(apart(&end(&left[left.len() - 1]).q, &at(4.9, 11.2, 0.0)) < 1e-9);
        assert_eq!(right[0].entry, Entry::Rest);
        check_joints(left);
        check_joints(right);
    }
}

#[test]
fn without_tolerance_a_corner_is_a_stop_and_a_tangent_joint_is_none() {
    let points = [at(0.0, 0.0, 0.0), at(10.0, 0.0, 0.0), at(10.0, 10.0, 0.0)];
    let pieces = check(&lines(&points, 0.0), 0.0);
    assert_eq!(pieces.iter().map(|p| p.entry).collect::<Vec<_>>(), [Entry::Rest, Entry::Rest]);
    let arc = Curve::Arc(Arc {
        from: points[1],
        to: at(15.0, 5.0, 0.0),
        plane: [0, 1],
        centre: [10.0, 5.0],
        sweep: std::f64::consts::FRAC_PI_2,
        length: 2.5 * std::f64::consts::PI,
    });
    let pieces = check(&[segment(&line(points[0], points[1]), 0.0), segment(&arc, 0.0)], 0.0);
    assert_eq!(pieces[1].entry, Entry::Tangent);
}

#[test]
fn a_line_and_an_arc_are_joined_with_one_bend_flowing_into_the_other() {
    let (a, b) = (at(0.0, 0.0, 0.0), at(10.0, 0.0, 0.0));
    let arc = Curve::Arc(Arc {
        from: b,
        to: at(15.0, 5.0, 2.0),
        plane: [0, 1],
        centre: [10.0, 5.0],
        sweep: std::f64::consts::FRAC_PI_2,
        length: (2.5 * std::f64::consts::PI).hypot(2.0),
    });
    let pieces = check(&[segment(&line(a, b), 0.01), segment(&arc, 0.01)], 0.01);
    assert!(pieces.iter().skip(1).all(|piece| piece.entry == Entry::Smooth));
}

#[test]
fn a_spline_is_run_by_its_length() {
    let mut parts = Vec::new();
    cubic(
        [at(0.0, 0.0, 0.0), at(1.0, 30.0, 0.0), at(40.0, -20.0, 5.0), at(50.0, 0.0, 0.0)],
        &mut parts,
    );
    let segments: Vec<_> = parts.iter().map(|p| segment(&Curve::Bezier(*p), 0.0)).collect();
    for piece in check(&segments, 0.0) {
        for k in 0..=10 {
            let slope = piece.at(piece.length() * f64::from(k) / 10.0).q1;
            assert!((apart(&slope, &[0.0; AXES]) - 1.0).abs() < 0.02);
        }
    }
}

#[test]
fn a_circle_chopped_ten_times_finer_bends_the_same() {
    for length in [0.1, 0.01] {
        let count = (20.0 * std::f64::consts::PI / length) as usize;
        let points: Vec<Point> = (0..=count)
            .map(|k| {
                let (sin, cos) = (k as f64 * length / 10.0).sin_cos();
                at(10.0 * cos, 10.0 * sin, 0.0)
            })
            .collect();
        let pieces = check(&lines(&points, 0.01), 0.01);
        // far from both ends, where motion is slow and bends cost nothing
        let inner = pieces.iter().filter(|p| p.at(0.0).q[0] < 0.0);
        let bends: Vec<f64> = inner.map(curvature).collect();
        // the circle's own bend is 0.1 per mm
        let mean = bends.iter().sum::<f64>() / bends.len() as f64;
        assert!((mean - 0.1).abs() < 0.003, "{mean}");
        assert!(bends.iter().all(|bend| (bend - 0.1).abs() < 0.01), "{bends:?}");
    }
}

/// In the X Y plane, in its middle, 1/mm.
fn curvature(piece: &Piece) -> f64 {
    let d = piece.at(piece.length() / 2.0);
    (d.q1[0] * d.q2[1] - d.q1[1] * d.q2[0]).abs() / d.q1[0].hypot(d.q1[1]).powi(3)
}

/// Every second point is 4 µm beside a line, P is 10 µm: the line itself is within P of all of
/// them.
#[test]
fn what_lies_within_p_of_a_straight_line_becomes_one() {
    let points: Vec<Point> = (0..=400)
        .map(|k| at(0.1 * f64::from(k), if k % 2 == 0 { 0.0 } else { 4e-3 }, 0.0))
        .collect();
    let pieces = check(&lines(&points, 0.01), 0.01);
    let inner = pieces.iter().filter(|p| (10.0..30.0).contains(&p.at(0.0).q[0]));
    let most = inner.map(curvature).fold(0.0, f64::max);
    // a wave through the points bends by 2e-3·(π/0.1)² = 2 per mm
    assert!(most < 2e-3, "{most}");
}

/// The end of a raster's row: 0.1 mm moves, a right angle, half a millimetre, and back. A piece
/// that is much shorter than the corner's reach must change the bend within it, which no limit of
/// jerk lets pass at speed.
#[test]
fn a_fitted_corner_has_no_crumbs() {
    let mut points: Vec<Point> = (0..=40).map(|k| at(0.1 * f64::from(k), 0.0, 0.0)).collect();
    points.extend((0..=40).rev().map(|k| at(0.1 * f64::from(k), 0.5, 0.1)));
    let pieces = check(&lines(&points, 0.01), 0.01);
    let least = pieces.iter().map(Shape::length).fold(f64::INFINITY, f64::min);
    assert!(least > 0.01, "a piece of {least} mm");
}

#[test]
fn reversals_duplicates_and_segments_of_a_nanometre_are_joined_too() {
    let spike = [at(0.0, 0.0, 0.0), at(10.0, 0.0, 0.0), at(0.0, 0.0, 0.0), at(5.0, 0.0, 0.0)];
    check(&lines(&spike, 0.01), 0.01);
    let mut dust = vec![at(0.0, 0.0, 0.0), at(5.0, 0.0, 0.0)];
    dust.extend((1..50).map(|k| at(5.0 + 1e-6 * f64::from(k % 3), 1e-6 * f64::from(k), 0.0)));
    dust.push(at(5.0, 5.0, 0.0));
    check(&lines(&dust, 0.01), 0.01);
}

/// The feed changes 0.06 mm behind a sharp corner, within its own blend.
#[test]
fn a_feed_that_changes_right_behind_a_sharp_corner_costs_no_memory() {
    let points = [
        at(4.426_870_332_6, -7.815_329_475, 1.860_938_465_3),
        at(4.479_623_330_4, -7.923_101_426_3, 1.816_071_570_3),
        at(4.566_348_333_9, -8.169_422_414_3, 1.732_074_969_1),
        at(4.893_685_911_6, -8.538_142_196_4, 1.710_297_796_3),
        at(6.211_446_482_1, -4.774_092_258_2, 8.927_435_901_2),
    ];
    let mut segments = lines(&points, 0.0196);
    for (segment, feed) in segments.iter_mut().zip([16.6, 40.2, 89.3, 16.6]) {
        segment.feed = feed;
    }
    let start = segment(&line(at(0.104, -0.332, -0.282), points[0]), 0.0196);
    segments.insert(0, start);
    check(&segments, 0.0196);
}

/// A long line between short ones: the curve through them swings from one side to the other within
/// one of its spans.
#[test]
fn a_fitted_curve_is_within_p_between_its_samples_too() {
    let steps = [
        (0.01, 0.0, -0.190_316_642_3),
        (17.761_163_427_6, -0.124_612_419_3, -0.026_559_243_8),
        (0.01, -0.198_469_251_3, -0.333_321_090_9),
        (0.01, 0.0, 0.0),
    ];
    let mut segments = lines(&walk(&steps), 0.2);
    for (segment, feed) in segments.iter_mut().zip([1.0, 31.9, 1.0, 31.9]) {
        segment.feed = feed;
    }
    check(&segments, 0.2);
}

fn steps() -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let size = prop_oneof![0.01..0.3_f64, 0.3..20.0_f64];
    prop::collection::vec((size, -1.6..1.6_f64, -0.5..0.5_f64), 2..60)
}

/// A walk: length, turn and climb of each step.
fn walk(steps: &[(f64, f64, f64)]) -> Vec<Point> {
    let (mut here, mut heading) = (at(0.0, 0.0, 0.0), 0.0_f64);
    let mut points = vec![here];
    for &(length, turn, climb) in steps {
        heading += turn;
        here = at(
            here[0] + length * heading.cos(),
            here[1] + length * heading.sin(),
            here[2] + length * climb,
        );
        points.push(here);
    }
    points
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(24, 1200), ..ProptestConfig::default() })]

    #[test]
    fn any_walk_is_joined_within_p(
        steps in steps(),
        feeds in prop::collection::vec(1.0..200.0_f64, 1..4),
        p in prop_oneof![Just(0.001), Just(0.01), Just(0.2)],
    ) {
        let mut segments = lines(&walk(&steps), p);
        for (segment, feed) in segments.iter_mut().zip(feeds.iter().cycle()) {
            segment.feed = *feed;
        }
        check(&segments, p);
    }

    #[test]
    fn any_walk_without_tolerance_is_followed_exactly(steps in steps()) {
        check(&lines(&walk(&steps), 0.0), 0.0);
    }
}
