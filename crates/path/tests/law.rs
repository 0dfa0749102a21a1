//! What the law of time promises, checked on the setpoints that a machine would get.
use crate::setpoints::{PERIOD, inside, joined, loads, setpoints};
use motion::{AXES, Bezier, Bounds, Curve, Entry, Instant, Limits, Line, Piece, Shape};
use path::geometry::{Joiner, Segment, cubic};
use path::law::{Config, Law, Timed};
use proptest::prelude::*;
use test_support::size;

fn bounds(speed: f64, accel: f64, jerk: f64) -> Bounds {
    Bounds { speed: [speed; AXES], accel: [accel; AXES], jerk: [jerk; AXES] }
}

fn config(b: Bounds) -> Config {
    Config { limits: Limits { feed: b, rapid: b }, period: PERIOD }
}

fn line(from: [f64; 3], to: [f64; 3], feed: f64, entry: Entry) -> Piece {
    let wide = |p: [f64; 3]| core::array::from_fn(|k| if k < 3 { p[k] } else { 0.0 });
    let d: f64 = (0..3).map(|k| (to[k] - from[k]).powi(2)).sum();
    let curve = Curve::Line(Line { from: wide(from), to: wide(to), length: d.sqrt() });
    Piece { curve, begin: 0.0, length: curve.length(), feed, rapid: false, entry, op: 0, line: 0 }
}

fn timed(pieces: &[Piece], config: &Config) -> Vec<Timed> {
    let mut law = Law::new(*config);
    let mut phases = Vec::new();
    for piece in pieces {
        law.push(*piece).expect("a piece that can be moved along");
        phases.extend(std::iter::from_fn(|| law.next()));
    }
    law.close();
    phases.extend(std::iter::from_fn(|| law.next()));
    phases
}

fn duration(phases: &[Timed]) -> f64 {
    phases.iter().map(|t| t.phase.duration).sum()
}

#[test]
fn a_single_line_is_a_trapezoid() {
    // 100 mm at 50 mm/s and 500 mm/s²: 2.5 mm and 0.1 s at each end, 95 mm in 1.9 s between
    let piece = line([0.0; 3], [100.0, 0.0, 0.0], 50.0, Entry::Rest);
    let phases = timed(&[piece], &config(bounds(200.0, 500.0, f64::INFINITY)));
    assert_eq!(phases.len(), 3);
    assert!((duration(&phases) - 2.1).abs() < 1e-12);
}

/// A curve at a low feed, where the axes need little of the way to reach it: v/a longer than
/// length/v, as a line would be.
#[test]
fn a_slow_arc_from_rest_to_rest_takes_as_long_as_a_line() {
    let (radius, feed, accel) = (10.0, 10.0, 1000.0);
    let point = |x: f64, y: f64| core::array::from_fn(|k| [x, y].get(k).copied().unwrap_or(0.0));
    for turns in [0.002, 0.02, 0.25, 1.0] {
        let angle = std::f64::consts::TAU * turns;
        let arc = motion::Arc {
            from: point(radius, 0.0),
            to: point(radius * angle.cos(), radius * angle.sin()),
            plane: [0, 1],
            centre: [0.0; 2],
            sweep: angle,
            length: radius * angle,
        };
        let curve = Curve::Arc(arc);
        let length = curve.length();
        let entry = Entry::Rest;
        let arc = Piece { curve, begin: 0.0, length, feed, rapid: false, entry, op: 0, line: 0 };
        let limits = bounds(200.0, accel, f64::INFINITY);
        let phases = timed(&[arc], &config(limits));
        // where both axes go along, s̈ may be higher than for one; the bend takes 0.1 % of the
        // acceleration
        let took = duration(&phases);
        let line = length / feed + feed / accel;
        assert!(took <= line * 1.001 && took > length / feed, "{turns}: {took} for {line}");
        let [speed, acceleration, _] = inside(&[arc], &phases, &limits);
        assert!(speed < 1.0001 && acceleration < 1.02, "{turns}: {speed} {acceleration}");
    }
}

/// An arc so flat that it is one cell, between two stops, and one after another: as the line beside
/// it.
#[test]
fn a_flat_arc_takes_as_long_as_a_line() {
    let point = |x: f64, y: f64| core::array::from_fn(|k| [x, y].get(k).copied().unwrap_or(0.0));
    let (radius, length, feed) = (1e4, 100.0, 100.0);
    let arc = |from: f64, entry: Entry| {
        let place =
            |s: f64| point(radius * (s / radius).sin(), radius * (1.0 - (s / radius).cos()));
        let curve = Curve::Arc(motion::Arc {
            from: place(from),
            to: place(from + length),
            plane: [0, 1],
            centre: [0.0, radius],
            sweep: length / radius,
            length,
        });
        Piece { curve, begin: 0.0, length, feed, rapid: false, entry, op: 0, line: 0 }
    };
    let config = config(bounds(200.0, 1000.0, f64::INFINITY));
    let one = duration(&timed(&[arc(0.0, Entry::Rest)], &config));
    assert!((one - 1.1).abs() < 0.002, "{one}");
    let two = duration(&timed(&[arc(0.0, Entry::Rest), arc(length, Entry::Smooth)], &config));
    assert!((two - 2.1).abs() < 0.002, "{two}");
}

/// The end of a spline with a short handle: bends of a ten-thousandth of a millimetre.
#[test]
fn a_spline_that_ends_in_a_sharp_bend_is_slow_there() {
    let point = |x: f64, y: f64| core::array::from_fn(|k| [x, y].get(k).copied().unwrap_or(0.0));
    let control = [point(0.0, 0.0), point(2.0, 3.0), point(2.01, -0.01), point(2.0, 0.0)];
    let mut parts = Vec::new();
    cubic(control, &mut parts);
    let entry = |k: usize| if k == 0 { Entry::Rest } else { Entry::Smooth };
    let piece = |(k, part): (usize, &Bezier)| {
        let curve = Curve::Bezier(*part);
        let (length, entry) = (curve.length(), entry(k));
        Piece { curve, begin: 0.0, length, feed: 50.0, rapid: false, entry, op: 0, line: 0 }
    };
    let pieces: Vec<Piece> = parts.iter().enumerate().map(piece).collect();
    for jerk in [f64::INFINITY, 20e3] {
        let limits = bounds(200.0, 1000.0, jerk);
        let [_, accel, most] = inside(&pieces, &timed(&pieces, &config(limits)), &limits);
        assert!(accel < 1.03 && most < 1.05, "{jerk}: {accel} {most}");
    }
}

/// Control points that cross over make a cusp: the curve turns back on the spot. One that nearly
/// does takes hardly longer.
#[test]
fn a_cusp_is_passed_nearly_at_rest_and_takes_no_time_to_plan() {
    let point = |x: f64, y: f64| core::array::from_fn(|k| [x, y].get(k).copied().unwrap_or(0.0));
    let mut both = [vec![], vec![]];
    for beside in [0.0, 1e-9, 1e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 0.03, 0.1, 0.3] {
        let control = [point(0.0, 0.0), point(4.0, 4.0 + beside), point(0.0, 4.0), point(4.0, 0.0)];
        let mut parts = Vec::new();
        cubic(control, &mut parts);
        let piece = |(k, part): (usize, &Bezier)| {
            let curve = Curve::Bezier(*part);
            let entry = if k == 0 { Entry::Rest } else { Entry::Smooth };
            let length = curve.length();
            Piece { curve, begin: 0.0, length, feed: 50.0, rapid: false, entry, op: 0, line: 0 }
        };
        let pieces: Vec<Piece> = parts.iter().enumerate().map(piece).collect();
        for (took, jerk) in both.iter_mut().zip([f64::INFINITY, 20e3]) {
            let phases = timed(&pieces, &config(bounds(200.0, 1000.0, jerk)));
            assert!(phases.len() < 5000, "{beside}, {jerk}: {} phases", phases.len());
            took.push(duration(&phases));
        }
    }
    for took in both {
        assert!(took.iter().all(|t| (t / took[0] - 1.0).abs() < 0.03), "{took:?}");
    }
}

/// Over revolutions of a fast spindle, a servo period is more of a revolution than the longest step
/// between two knots.
#[test]
fn a_period_longer_than_the_longest_step_is_no_panic() {
    let piece = line([0.0; 3], [10.0, 0.0, 0.0], 5.0, Entry::Rest);
    let limits = config(bounds(20.0, 50.0, 500.0));
    for period in [0.022_698, 0.5, 10.0] {
        let phases = timed(&[piece], &Config { period, ..limits });
        let Instant { s, v, .. } = phases[phases.len() - 1].phase.end();
        assert!((s - 10.0).abs() < 1e-9 && v.abs() < 1e-6, "{period}: ends at {s} with {v}");
    }
}

#[test]
fn a_line_in_ten_thousand_parts_takes_as_long_as_the_line() {
    let at = |k: f64| [k * 0.06, k * 0.08, 0.0];
    let parts: Vec<Piece> = (0..10_000)
        .map(|k| line(at(f64::from(k)), at(f64::from(k + 1)), 150.0, Entry::Smooth))
        .collect();
    let whole = line(at(0.0), at(10_000.0), 150.0, Entry::Rest);
    let config = config(bounds(200.0, 1000.0, f64::INFINITY));
    let (a, b) = (duration(&timed(&parts, &config)), duration(&timed(&[whole], &config)));
    assert!((a - b).abs() < 1e-9 * b, "{a} {b}");
}

#[test]
fn an_axis_that_may_not_move_is_named() {
    let mut b = bounds(200.0, 1000.0, f64::INFINITY);
    b.accel[1] = 0.0;
    let mut law = Law::new(config(b));
    assert!(law.push(line([0.0; 3], [1.0, 0.0, 0.0], 1.0, Entry::Rest)).is_ok());
    let refused = law.push(line([1.0, 0.0, 0.0], [1.0, 1.0, 0.0], 1.0, Entry::Rest)).unwrap_err();
    assert!(refused.to_string().starts_with("Y must move"), "{refused}");
}

fn any_lines() -> impl Strategy<Value = Vec<Piece>> {
    let step = (prop::array::uniform3(-20.0..20.0_f64), 1..5_usize, 1.0..300.0_f64, any::<bool>());
    prop::collection::vec(step, 1..20).prop_map(|steps| {
        let mut at = [0.0; 3];
        let mut pieces = Vec::new();
        for (step, parts, feed, tiny) in steps {
            let scale = if tiny { 1e-3 } else { 1.0 };
            for part in 0..parts {
                let to = core::array::from_fn(|k| at[k] + scale * step[k] / parts as f64);
                let entry = if part == 0 { Entry::Rest } else { Entry::Smooth };
                pieces.push(line(at, to, feed * (1.0 + part as f64), entry));
                at = to;
            }
        }
        pieces
    })
}

fn any_bounds() -> impl Strategy<Value = Bounds> {
    let axis = (10.0..500.0_f64, 100.0..10_000.0_f64);
    prop::array::uniform3(axis).prop_map(|axes| {
        let mut b = bounds(100.0, 1000.0, f64::INFINITY);
        for (k, (speed, accel)) in axes.into_iter().enumerate() {
            (b.speed[k], b.accel[k]) = (speed, accel);
        }
        b
    })
}

/// From rest to rest in seven phases, in closed form.
fn rest_to_rest(length: f64, feed: f64, accel: f64, jerk: f64) -> f64 {
    let half = accel * accel / (2.0 * jerk);
    let level = accel * length / ((half * half + accel * length).sqrt() + half);
    let peak =
        if level >= 2.0 * half { level } else { (length * jerk.sqrt() / 2.0).cbrt().powi(2) };
    let v = peak.min(feed);
    let ramp =
        if v > accel * accel / jerk { v / accel + accel / jerk } else { 2.0 * (v / jerk).sqrt() };
    2.0 * ramp + (length - v * ramp) / v
}

#[test]
fn with_jerk_a_line_takes_as_long_as_its_closed_form() {
    for (length, feed) in
        [(0.01, 100.0), (1.0, 100.0), (10.0, 200.0), (100.0, 100.0), (1000.0, 200.0)]
    {
        let piece = line([0.0; 3], [length, 0.0, 0.0], feed, Entry::Rest);
        let took = duration(&timed(&[piece], &config(bounds(200.0, 1000.0, 20e3))));
        let ratio = took / rest_to_rest(length, feed, 1000.0, 20e3);
        assert!((ratio - 1.0).abs() < 1e-9, "{length} mm: {ratio}");
    }
}

#[test]
fn with_jerk_ten_thousand_parts_of_a_line_take_hardly_longer_than_the_line() {
    let at = |k: f64| [k * 0.06, k * 0.08, 0.0];
    let parts: Vec<Piece> = (0..10_000)
        .map(|k| line(at(f64::from(k)), at(f64::from(k + 1)), 150.0, Entry::Smooth))
        .collect();
    let config = config(bounds(200.0, 1000.0, 50e3));
    let phases = timed(&parts, &config);
    joined(&parts, &phases);
    // 1250 mm/s² and 62.5 m/s³ along (3, 4)
    let ratio = duration(&phases) / rest_to_rest(1000.0, 150.0, 1250.0, 62.5e3);
    assert!((0.999..1.005).contains(&ratio), "{ratio}");
}

/// Nothing happens on most of the way: neither the plan nor what is handed out grows with the time
/// that it takes.
#[test]
fn with_jerk_a_slow_arc_takes_as_long_as_its_feed_and_few_phases() {
    let (radius, jerk) = (50.0, 20e3);
    let point = |x: f64, y: f64| core::array::from_fn(|k| [x, y].get(k).copied().unwrap_or(0.0));
    let (start, length) = (point(radius, 0.0), radius * std::f64::consts::TAU);
    let (sweep, centre) = (std::f64::consts::TAU, [0.0; 2]);
    let arc = motion::Arc { from: start, to: start, plane: [0, 1], centre, sweep, length };
    for feed in [100.0, 10.0, 1.0, 0.1, 0.01] {
        let (curve, entry) = (Curve::Arc(arc), Entry::Rest);
        let arc = Piece { curve, begin: 0.0, length, feed, rapid: false, entry, op: 0, line: 0 };
        let phases = timed(&[arc], &config(bounds(200.0, 1000.0, jerk)));
        joined(&[arc], &phases);
        let ratio = duration(&phases) / rest_to_rest(length, feed, 1000.0, jerk);
        assert!((0.99..1.003).contains(&ratio), "F{feed}: {ratio}");
        assert!(phases.len() < 3000, "F{feed}: {} phases", phases.len());
    }
}

/// A slow cut that goes on as a rapid too short for its own speed: the cut holds its feed up to the
/// rapid.
#[test]
fn with_jerk_a_slow_line_before_a_rapid_takes_few_phases() {
    let (jerk, ends) = (20e3, [0.0, 20.0, 30.0].map(|x| [x, 0.0, 0.0]));
    let pieces =
        [line(ends[0], ends[1], 10.0, Entry::Rest), line(ends[1], ends[2], 200.0, Entry::Smooth)];
    let phases = timed(&pieces, &config(bounds(200.0, 1000.0, jerk)));
    joined(&pieces, &phases);
    let stopping = rest_to_rest(20.0, 10.0, 1000.0, jerk) + rest_to_rest(10.0, 200.0, 1000.0, jerk);
    assert!(duration(&phases) < stopping, "{} s of {stopping}", duration(&phases));
    assert!(phases.len() < 400, "{} phases", phases.len());
}

/// A wave of 2 mm, F9000, P 1 µm: it takes as long however finely it was chopped, and as few
/// pieces; within 0.2 % and a tenth.
#[test]
fn a_wave_takes_as_long_however_it_is_chopped() {
    for jerk in [f64::INFINITY, 50e3, 20e3] {
        let b = bounds(200.0, 1000.0, jerk);
        let both = [0.1, 0.05, 0.02].map(|step: f64| {
            let (mut joiner, mut pieces) = (Joiner::new(&config(b).limits), Vec::new());
            let point = |n: usize| [n as f64 * step, 2.0 * (n as f64 * step * 0.5).sin(), 0.0];
            for n in 0..(150.0 / step) as usize {
                let curve = line(point(n), point(n + 1), 150.0, Entry::Smooth).curve;
                let (tolerance, merge, feed, rapid) = (0.001, 0.0, 150.0, false);
                let segment = Segment { curve, feed, rapid, tolerance, merge, op: 0, line: 0 };
                joiner.push(segment, &mut |piece| pieces.push(piece));
            }
            joiner.finish(&mut |piece| pieces.push(piece));
            (duration(&timed(&pieces, &config(b))), pieces.len() as f64)
        });
        for (took, count) in both {
            let (longer, more) = (took / both[0].0 - 1.0, count / both[0].1 - 1.0);
            assert!(longer.abs() < 0.002 && more.abs() < 0.1, "{jerk}: {both:?}");
        }
    }
}

/// A blend's parameter is longer than its way: what F counts is the way.
#[test]
fn at_a_low_feed_corners_are_passed_at_the_feed() {
    let (step, feed) = (2.0, 10.0);
    for (jerk, corner) in [(f64::INFINITY, 0.002), (20e3, 0.025)] {
        let b = bounds(200.0, 1000.0, jerk);
        let (mut joiner, mut pieces) = (Joiner::new(&config(b).limits), Vec::new());
        let stair = |n: usize| [step * n.div_ceil(2) as f64, step * (n / 2) as f64, 0.0];
        for n in 0..40 {
            let curve = line(stair(n), stair(n + 1), feed, Entry::Smooth).curve;
            let (op, line) = (n as u32, n as u32);
            let (tolerance, merge) = (0.01, 0.0);
            let segment = Segment { curve, feed, rapid: false, tolerance, merge, op, line };
            joiner.push(segment, &mut |piece| pieces.push(piece));
        }
        joiner.finish(&mut |piece| pieces.push(piece));
        let phases = timed(&pieces, &config(b));
        for pair in setpoints(&pieces, &phases).windows(2) {
            let way = (0..AXES).map(|k| (pair[1][k] - pair[0][k]).powi(2)).sum::<f64>().sqrt();
            assert!(way <= feed * PERIOD * 1.001, "{} mm/s", way / PERIOD);
        }
        // each corner cuts off less than P; a stop costs v/a, or 2·√(v/j)
        let (took, least) = (duration(&phases), 40.0 * (step - 0.01) / feed);
        let stop = if jerk.is_finite() { 2.0 * (feed / jerk).sqrt() } else { feed / 1000.0 };
        assert!(corner < 0.6 * stop && took > least, "{took} of {least}");
        assert!(took < 40.0 * (step / feed + corner), "{took} s with {jerk}");
    }
}

/// Moves that a program could have, joined within a tolerance.
fn any_joined() -> impl Strategy<Value = Vec<Piece>> {
    let step = (prop::array::uniform3(1.0..10.0_f64), 5.0..200.0_f64, any::<[bool; 3]>());
    let jerk = prop::sample::select(vec![f64::INFINITY, 20e3]);
    (prop::collection::vec(step, 1..15), 0.005..0.1_f64, jerk).prop_map(
        |(steps, tolerance, jerk)| {
            let limits = config(bounds(200.0, 1000.0, jerk)).limits;
            let (mut joiner, mut pieces) = (Joiner::new(&limits), Vec::new());
            let mut at = [0.0; 3];
            for (step, feed, back) in steps {
                let to = core::array::from_fn(|k| at[k] + if back[k] { -step[k] } else { step[k] });
                let curve = line(at, to, feed, Entry::Rest).curve;
                let segment =
                    Segment { curve, feed, rapid: false, tolerance, merge: 0.0, op: 0, line: 0 };
                joiner.push(segment, &mut |piece| pieces.push(piece));
                at = to;
            }
            joiner.finish(&mut |piece| pieces.push(piece));
            pieces
        },
    )
}

/// Limits of which some axes have one of jerk, from far below to far above what the others can.
fn mixed_bounds() -> impl Strategy<Value = Bounds> {
    let decades = |from: f64, to: f64| (from..to).prop_map(|exponent| 10.0_f64.powf(exponent));
    let jerk = prop_oneof![Just(f64::INFINITY), decades(3.0, 5.0), decades(1.0, 9.0)];
    let axis = (decades(0.5, 3.3), decades(1.0, 5.0), jerk);
    prop::array::uniform3(axis).prop_map(|axes| {
        let mut b = bounds(100.0, 1000.0, f64::INFINITY);
        for (k, (speed, accel, jerk)) in axes.into_iter().enumerate() {
            (b.speed[k], b.accel[k], b.jerk[k]) = (speed, accel, jerk);
        }
        b
    })
}

/// Moves, some of which leave an axis where it is, joined within a tolerance for these limits.
fn mixed() -> impl Strategy<Value = (Vec<Piece>, Bounds)> {
    let coordinate = prop_oneof![3 => -10.0..10.0_f64, 1 => Just(0.0), 1 => -0.1..0.1_f64];
    let step = (prop::array::uniform3(coordinate), 0.5..200.0_f64, any::<bool>());
    let tolerance = prop_oneof![Just(0.0), 1e-4..0.1_f64];
    (prop::collection::vec(step, 1..12), tolerance, mixed_bounds()).prop_map(
        |(steps, tolerance, b)| {
            let limits = config(b).limits;
            let (mut joiner, mut pieces) = (Joiner::new(&limits), Vec::new());
            let mut at = [0.0; 3];
            for (step, feed, rapid) in steps {
                let to = core::array::from_fn(|k| at[k] + step[k]);
                if to == at {
                    continue;
                }
                let curve = line(at, to, feed, Entry::Rest).curve;
                let segment = Segment { curve, feed, rapid, tolerance, merge: 0.0, op: 0, line: 0 };
                joiner.push(segment, &mut |piece| pieces.push(piece));
                at = to;
            }
            joiner.finish(&mut |piece| pieces.push(piece));
            (pieces, b)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(48, 960)))]

    #[test]
    fn whatever_the_limits_of_each_axis_a_plan_takes_little_and_keeps_them((pieces, b) in mixed()) {
        prop_assume!(!pieces.is_empty());
        let phases = timed(&pieces, &config(b));
        let most = 20_000.0 + 8.0 * duration(&phases) / PERIOD;
        prop_assert!((phases.len() as f64) < most, "{} phases of {most}", phases.len());
        joined(&pieces, &phases);
        let [speed, accel, jerk] = loads(&setpoints(&pieces, &phases), &b);
        prop_assert!(speed < 1.001 && accel < 1.01 && jerk < 1.03, "{speed} {accel} {jerk}");
        let [speed, accel, jerk] = inside(&pieces, &phases, &b);
        prop_assert!(
            speed < 1.001 && accel < 1.02 && jerk < 1.04,
            "{speed} {accel} {jerk} within a phase"
        );
    }

    #[test]
    fn on_blended_paths_no_axis_exceeds_its_speed_and_acceleration(
        pieces in any_joined(),
        b in any_bounds(),
    ) {
        let phases = timed(&pieces, &config(b));
        joined(&pieces, &phases);
        let [speed, accel, _] = loads(&setpoints(&pieces, &phases), &b);
        prop_assert!(speed < 1.001, "{speed}");
        prop_assert!(accel < 1.01, "{accel}");
        let [speed, accel, _] = inside(&pieces, &phases, &b);
        prop_assert!(speed < 1.001, "{speed} within a phase");
        prop_assert!(accel < 1.02, "{accel} within a phase");
    }

    #[test]
    fn with_jerk_no_axis_exceeds_its_limits_on_lines(
        pieces in any_lines(),
        b in any_bounds(),
        jerk in 5e3..500e3_f64,
    ) {
        let b = Bounds { jerk: [jerk; AXES], ..b };
        let phases = timed(&pieces, &config(b));
        joined(&pieces, &phases);
        let [speed, accel, jerk] = loads(&setpoints(&pieces, &phases), &b);
        prop_assert!(speed < 1.001, "{speed}");
        prop_assert!(accel < 1.01, "{accel}");
        prop_assert!(jerk < 1.03, "{jerk}");
    }

    #[test]
    fn with_jerk_parts_of_any_length_take_no_longer_than_the_line_that_they_are(
        parts in prop::collection::vec((1e-3..1.0_f64, 0..4_i32, prop::bool::weighted(0.02)), 2..200),
        feed in 1.0..200.0_f64,
        jerk in 5e3..500e3_f64,
    ) {
        let (mut at, mut slow) = (0.0, false);
        let place = |x: f64| [0.6 * x, 0.8 * x, 0.0];
        let pieces = parts.iter().map(|(part, size, other)| {
            let from = at;
            at += part * 10.0_f64.powi(-size);
            slow ^= other;
            let feed = if slow { 0.8 * feed } else { feed };
            line(place(from), place(at), feed, Entry::Smooth)
        });
        let pieces: Vec<Piece> = pieces.collect();
        let b = bounds(200.0, 1000.0, jerk);
        let phases = timed(&pieces, &config(b));
        joined(&pieces, &phases);
        let [speed, accel, most] = loads(&setpoints(&pieces, &phases), &b);
        prop_assert!(speed < 1.001, "{speed}");
        prop_assert!(accel < 1.01, "{accel}");
        prop_assert!(most < 1.03, "{most}");
        // 1250 mm/s² along (3, 4)
        let least = rest_to_rest(at, feed, 1250.0, 1.25 * jerk);
        let most = rest_to_rest(at, 0.8 * feed, 1250.0, 1.25 * jerk);
        let took = duration(&phases);
        prop_assert!(took > 0.999 * least && took < 1.05 * most, "{took} s of {least} to {most}");
    }

    #[test]
    fn with_jerk_no_axis_exceeds_its_limits_on_blended_paths(
        pieces in any_joined(),
        b in any_bounds(),
        jerk in 5e3..500e3_f64,
    ) {
        let b = Bounds { jerk: [jerk; AXES], ..b };
        let phases = timed(&pieces, &config(b));
        joined(&pieces, &phases);
        let [speed, accel, jerk] = loads(&setpoints(&pieces, &phases), &b);
        prop_assert!(speed < 1.001, "{speed}");
        prop_assert!(accel < 1.01, "{accel}");
        prop_assert!(jerk < 1.03, "{jerk}");
    }

    #[test]
    fn without_a_limit_of_jerk_no_axis_exceeds_its_speed_and_acceleration(
        pieces in any_lines(),
        b in any_bounds(),
    ) {
        let phases = timed(&pieces, &config(b));
        joined(&pieces, &phases);
        let [speed, accel, _] = loads(&setpoints(&pieces, &phases), &b);
        prop_assert!(speed < 1.0 + 1e-6, "{speed}");
        prop_assert!(accel < 1.0 + 1e-4, "{accel}");
    }
}
