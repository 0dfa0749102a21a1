//! Rough paths, as worn digitisers and careless posts write them: zigzags below and above P, noise
//! on smooth curves, dust, lengths of all scales, spikes, changes of mode, with P from 0.1 µm to 10
//! mm. What the axes are told keeps speed, acceleration, jerk and P, by differences of the
//! setpoints at the servo period, whatever the operator does.
use crate::operated::{Seen, distance, loads, order, run, run_replanning, xyz};
use canon::{Feed, Op, OpKind, PathMode, Position, Span};
use kernel::Order;
use proptest::prelude::*;
use test_support::size;
use units::{Length, Speed};

/// Lines through points at a feed; from each place in `modes` on another P, mm. None: exactly.
fn program(points: &[[f64; 3]], feed: f64, modes: &[(usize, Option<f64>)]) -> Vec<Op> {
    let mut kinds = Vec::new();
    for (n, p) in points.iter().enumerate() {
        for (_, tolerance) in modes.iter().filter(|(at, _)| *at == n) {
            kinds.push(OpKind::PathMode(match tolerance {
                Some(p) => PathMode::Blend { tolerance: Some(Length::mm(*p)), merge: None },
                None => PathMode::Exact,
            }));
        }
        let to = Position::xyz(p[0], p[1], p[2]);
        kinds.push(OpKind::Line { to, feed: Feed::PerTime(Speed::mm_per_s(feed)) });
    }
    kinds.push(OpKind::End);
    let place = |line| Span { file: 0, line, start: 0, end: 0 };
    (1..).zip(kinds).map(|(line, kind)| Op { span: place(line), kind }).collect()
}

/// The farthest that a setpoint is from the programmed lines. The path goes along them: only those
/// near the last are looked at.
fn off_path(seen: &Seen, points: &[[f64; 3]]) -> f64 {
    let all: Vec<[f64; 3]> = [[0.0; 3]].iter().chain(points).copied().collect();
    let near = |p| all.windows(2).map(|w| distance(p, [w[0], w[1]])).fold(f64::INFINITY, f64::min);
    seen.at.iter().map(|(p, _)| near(xyz(*p))).fold(0.0, f64::max)
}

/// What makes a path rough.
#[derive(Clone, Copy, Debug)]
enum Rough {
    /// Every other point stands aside.
    Zigzag,
    /// Each point is off by chance.
    Noise,
    /// One point in thirty is off, and far.
    Spikes,
    /// Lengths from a tenth of a micrometre to 5 mm, each way.
    Scales,
}

/// Points along a circle (of any radius: a line, nearly), as rough as told.
fn points() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let kind =
        prop::sample::select(vec![Rough::Zigzag, Rough::Noise, Rough::Spikes, Rough::Scales]);
    let logs = (-3.5..0.0_f64, -2.0..0.5_f64, -0.3..3.0_f64);
    let chances = prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, 0.0..1.0_f64), 30..250);
    (kind, logs, chances).prop_map(|(kind, (step, share, radius), chances)| {
        let step = 10.0_f64.powf(step);
        let (aside, radius) = (step * 10.0_f64.powf(share), 10.0_f64.powf(radius));
        let mut at = [0.0; 3];
        let point = |(n, (x, y, z)): (usize, (f64, f64, f64))| {
            let angle = (n + 1) as f64 * step / radius;
            let (off, up) = match kind {
                Rough::Zigzag => (if n % 2 == 0 { aside } else { 0.0 }, 0.0),
                Rough::Noise => (aside * x, aside * y),
                Rough::Spikes => (if z < 0.03 { 10.0 * aside * x } else { 0.0 }, 0.0),
                Rough::Scales => {
                    let length = 10.0_f64.powf(7.7 * z - 7.0);
                    let to = [length * x, length * y, length * (x * y)];
                    at = core::array::from_fn(|i| at[i] + to[i]);
                    return at;
                }
            };
            [(radius + off) * angle.sin(), radius - (radius + off) * angle.cos(), up]
        };
        chances.into_iter().enumerate().map(point).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(48, 960)))]
    #[test]
    fn no_axis_leaves_its_limits_on_a_rough_path(
        points in points(),
        feed in 5.0..200.0_f64,
        tolerance in -4.0..1.0_f64,
        other in prop::option::of((0..250_usize, prop::option::of(-4.0..1.0_f64))),
        orders in prop::collection::vec((0..2000_usize, order()), 0..4),
        jerk in prop::sample::select(vec![f64::INFINITY, 50e3, 20e3]),
        ahead in any::<bool>(),
    ) {
        let p = 10.0_f64.powf(tolerance);
        let mut modes = vec![(0, Some(p))];
        modes.extend(other.map(|(at, p)| (at, p.map(|p| 10.0_f64.powf(p)))));
        let orders: Vec<(usize, Order)> = orders;
        let seen = run_replanning(&program(&points, feed, &modes), jerk, &orders, ahead);
        prop_assert_eq!(&seen.faults, &vec![]);
        prop_assert!(seen.ended);
        let [speed, accel, third] = loads(&seen, jerk);
        prop_assert!(speed < 1.001, "speed {speed}");
        prop_assert!(accel < 1.01, "acceleration {accel}");
        prop_assert!(third < 1.05, "jerk {third}");
        let most = modes.iter().filter_map(|(_, p)| *p).fold(0.0, f64::max);
        let off = off_path(&seen, &points);
        prop_assert!(off < most + 1e-6, "{off} mm from the path, P {most}");
        let last = seen.at[seen.at.len() - 1].0;
        for i in 0..3 {
            prop_assert!((last[i] - points[points.len() - 1][i]).abs() < 1e-9);
        }
    }
}

/// A zigzag of 0.04 mm in chords of 0.045 mm at F6000, P 0.05: what is run through in a period is
/// more than a control can do one by one.
#[test]
fn a_fine_zigzag_is_run_through_without_a_stop() {
    // multiples of the golden ratio, squared: as good as chance
    let noise = |n: f64| 0.04 * (2.0 * (n * n * 0.618_033_988_749_895).fract() - 1.0);
    let point = |n: f64| [0.045 * n + 0.5 * noise(n + 0.5), noise(n), 0.0];
    let points: Vec<[f64; 3]> = (1..2000).map(|n| point(f64::from(n))).collect();
    let seen = run(&program(&points, 100.0, &[(0, Some(0.05))]), f64::INFINITY, &[]);
    let [speed, accel, _] = loads(&seen, f64::INFINITY);
    assert!(speed < 1.001 && accel < 1.01, "speed {speed}, acceleration {accel}");
}
