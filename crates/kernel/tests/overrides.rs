//! Holds, overrides from 0 to 200 % and single block, at any instant of random paths: what the axes
//! are told keeps speed, acceleration, jerk and the path, by differences of the setpoints at the
//! servo period. Overrides of feeds and rapids, hold, resume, single block and abort come at any
//! instant.
use crate::operated::{ACCEL, PERIOD, Seen, distance, loads, order, run, run_replanning, xyz};
use canon::{Feed, Op, OpKind, PathMode, Position, Span};
use kernel::Order;
use proptest::prelude::*;
use test_support::size;
use units::{Length, Speed};

const TOLERANCE: f64 = 0.02;

/// Lines to these points; a feed of infinity is a rapid.
fn program(points: &[[f64; 3]], feeds: &[f64]) -> Vec<Op> {
    let place = |line| Span { file: 0, line, start: 0, end: 0 };
    let mode = PathMode::Blend { tolerance: Some(Length::mm(TOLERANCE)), merge: None };
    let cut = |(p, feed): (&[f64; 3], &f64)| {
        let to = Position::xyz(p[0], p[1], p[2]);
        let feed = Feed::PerTime(Speed::mm_per_s(*feed));
        if feed == Feed::PerTime(Speed::mm_per_s(f64::INFINITY)) {
            OpKind::Rapid { to }
        } else {
            OpKind::Line { to, feed }
        }
    };
    let cuts = points.iter().zip(feeds.iter().cycle()).map(cut);
    let all = [OpKind::PathMode(mode)].into_iter().chain(cuts).chain([OpKind::End]);
    (1..).zip(all).map(|(line, kind)| Op { span: place(line), kind }).collect()
}

/// Farthest setpoint from the programmed lines.
fn off_path(seen: &Seen, points: &[[f64; 3]]) -> f64 {
    let all: Vec<[f64; 3]> = [[0.0; 3]].iter().chain(points).copied().collect();
    let near = |p| all.windows(2).map(|w| distance(p, [w[0], w[1]])).fold(f64::INFINITY, f64::min);
    seen.at.iter().map(|(p, _)| near(xyz(*p))).fold(0.0, f64::max)
}

fn feed() -> impl Strategy<Value = f64> {
    prop_oneof![4 => 5.0..120.0_f64, 1 => Just(f64::INFINITY)]
}

fn walk() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let step = prop_oneof![
        3 => prop::array::uniform3(-8.0..8.0_f64),
        2 => prop::array::uniform3(-0.4..0.4_f64),
    ];
    prop::collection::vec(step, 3..30).prop_map(|steps| {
        let mut at = [0.0_f64; 3];
        let go = |d: [f64; 3]| {
            at = core::array::from_fn(|i| at[i] + d[i]);
            at
        };
        steps.into_iter().map(go).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(80, 1600)))]
    #[test]
    fn no_axis_leaves_its_limits_or_the_path_whatever_the_operator_does(
        points in walk(),
        feeds in prop::collection::vec(feed(), 1..5),
        orders in prop::collection::vec((0..4000_usize, order()), 0..8),
        abort in prop::option::weighted(0.2, 0..4000_usize),
        jerk in prop::sample::select(vec![f64::INFINITY, 50e3, 20e3]),
        ahead in any::<bool>(),
    ) {
        let mut orders = orders;
        orders.extend(abort.map(|at| (at, Order::Abort)));
        let seen = run_replanning(&program(&points, &feeds), jerk, &orders, ahead);
        prop_assert_eq!(&seen.faults, &vec![]);
        prop_assert!(seen.ended || abort.is_some());
        let [speed, accel, third] = loads(&seen, jerk);
        prop_assert!(speed < 1.001, "speed {speed}");
        prop_assert!(accel < 1.01, "acceleration {accel}");
        prop_assert!(third < 1.05, "jerk {third}");
        let off = off_path(&seen, &points);
        prop_assert!(off < TOLERANCE + 1e-6, "{off} mm from the path");
        let last = seen.at[seen.at.len() - 1].0;
        for i in 0..3 {
            prop_assert!(!seen.ended || (last[i] - points[points.len() - 1][i]).abs() < 1e-9);
        }
    }
}

/// 60 mm at 10 mm/s, twice as fast from 1 s on: 10 mm, then 50 mm at 20 mm/s.
#[test]
fn twice_the_feed_from_one_second_on_takes_half_of_what_is_left() {
    for jerk in [f64::INFINITY, 20e3] {
        let orders = [(1000, Order::FeedOverride(2.0))];
        let seen = run(&program(&[[60.0, 0.0, 0.0]], &[10.0]), jerk, &orders);
        let moving = seen.at.windows(2).filter(|w| w[1].0 != w[0].0).count() as f64 * PERIOD;
        let ramps = 20.0 / ACCEL + if jerk.is_finite() { ACCEL / jerk } else { 0.0 };
        assert!((moving - 3.5).abs() < ramps + 2.0 * PERIOD, "{moving} s");
    }
}

/// The same, planned anew from a quarter of a second ahead: 12.5 mm, then 47.5 mm at 20 mm/s. The
/// move is longer than that, and is cut.
#[test]
fn a_long_move_is_planned_anew_from_a_moment_ahead_where_planning_takes_time() {
    for jerk in [f64::INFINITY, 20e3] {
        let orders = [(1000, Order::FeedOverride(2.0))];
        let seen = run_replanning(&program(&[[60.0, 0.0, 0.0]], &[10.0]), jerk, &orders, true);
        assert_eq!(seen.faults, vec![]);
        let moving = seen.at.windows(2).filter(|w| w[1].0 != w[0].0).count() as f64 * PERIOD;
        let ramps = 20.0 / ACCEL + if jerk.is_finite() { ACCEL / jerk } else { 0.0 };
        assert!((moving - 3.625).abs() < ramps + 2.0 * PERIOD, "{moving} s");
    }
}

/// From 100 to 200 % within two seconds, a step each 20 ms: the speed follows, no more than 50 ms
/// late; on a curve without a limit of jerk, whose law of time changes its speed more gently, 300
/// ms.
#[test]
fn a_knob_that_is_turned_steadily_is_followed_while_it_turns() {
    const BEGINS: usize = 1000;
    const STEPS: usize = 100;
    let share = |step: usize| 1.0 + step as f64 / STEPS as f64;
    let turned: Vec<(usize, Order)> =
        (1..=STEPS).map(|step| (BEGINS + 20 * step, Order::FeedOverride(share(step)))).collect();
    let points: Vec<[f64; 3]> =
        (1..=190).map(|n| [f64::from(n), 5.0 * (f64::from(n) / 30.0).sin(), 0.0]).collect();
    for (points, jerk, late) in [
        (&points[..], f64::INFINITY, 300),
        (&points[..], 20e3, 50),
        (&[[190.0, 0.0, 0.0]], f64::INFINITY, 50),
        (&[[190.0, 0.0, 0.0]], 20e3, 50),
    ] {
        let seen = run(&program(points, &[40.0]), jerk, &turned);
        let [speed, accel, third] = loads(&seen, jerk);
        assert!(speed < 1.001 && accel < 1.01 && third < 1.05, "{speed} {accel} {third}");
        for (tick, two) in seen.at.windows(2).enumerate().skip(BEGINS).take(20 * STEPS) {
            let speed = distance(xyz(two[0].0), [xyz(two[1].0); 2]) / PERIOD;
            let of = |late: usize| 40.0 * share((tick - BEGINS).saturating_sub(late) / 20);
            let (slowest, fastest) = (of(late), of(0));
            assert!(
                (slowest - 0.5..fastest + 0.5).contains(&speed),
                "period {tick}, jerk {jerk}: {speed} mm/s is not within {slowest} to {fastest}"
            );
        }
    }
}

/// M49: the program lets no override act.
#[test]
fn where_the_program_switches_overrides_off_the_feed_is_as_programmed() {
    let mut ops = program(&[[30.0, 0.0, 0.0]], &[10.0]);
    let off = OpKind::Overrides { feed: false, spindle: false };
    ops.insert(0, Op { span: ops[0].span, kind: off });
    for share in [0.3, 2.0] {
        let seen = run(&ops, f64::INFINITY, &[(500, Order::FeedOverride(share))]);
        let moving = seen.at.windows(2).filter(|w| w[1].0 != w[0].0).count() as f64 * PERIOD;
        assert!((moving - 3.01).abs() < 0.02, "{share}: {moving} s");
    }
}

#[test]
fn single_block_stops_exactly_at_the_end_of_every_line() {
    let points = [[20.0, 0.0, 0.0], [20.0, 15.0, 0.0], [0.0, 15.0, 5.0]];
    let seen = run(&program(&points, &[50.0]), 20e3, &[(0, Order::SingleBlock(true))]);
    for p in points {
        let there = |q: [f64; bus::AXES]| (0..3).all(|i| (q[i] - p[i]).abs() < 1e-9);
        let stands = seen.at.windows(2).any(|w| there(w[0].0) && there(w[1].0));
        assert!(stands, "does not stand at {p:?}");
    }
}

/// Switched on under way, on a curve that is fitted through many short lines: it stops at the end
/// of each line that is far enough ahead, nowhere else, and each time at the place of the curve
/// that is nearest to it.
#[test]
fn single_block_on_a_fitted_curve_stops_where_each_line_ends() {
    let point = |n: u32| {
        let (sin, cos) = (f64::from(n) * 0.08).sin_cos();
        [10.0 - 10.0 * cos, 10.0 * sin, 0.1 * f64::from(n)]
    };
    let points: Vec<[f64; 3]> = (1..=60).map(point).collect();
    for jerk in [f64::INFINITY, 20e3] {
        let ops = program(&points, &[40.0]);
        let seen = run(&ops, jerk, &[(300, Order::SingleBlock(true))]);
        assert!(seen.ended && seen.faults.is_empty(), "{:?}", seen.faults);
        let [_, accel, third] = loads(&seen, jerk);
        assert!(accel < 1.01 && third < 1.05, "{accel} {third}");
        let mut stops: Vec<[f64; 3]> = Vec::new();
        for two in seen.at.windows(2).skip(300).filter(|w| w[0].0 == w[1].0) {
            if stops.last() != Some(&xyz(two[0].0)) {
                stops.push(xyz(two[0].0));
            }
        }
        let far = |a: [f64; 3], b: [f64; 3]| distance(a, [b, b]);
        let first = points.iter().position(|p| far(*p, stops[0]) < TOLERANCE).unwrap();
        assert!(first > 10 && first < 20, "the first stop is at point {first}");
        assert_eq!(stops.len(), points.len() - first);
        for (stop, point) in stops.iter().zip(&points[first..]) {
            assert!(far(*stop, *point) < TOLERANCE, "{stop:?} is none of {point:?}");
        }
    }
}

/// Single block comes on the blend of a corner, before and behind the place where the line ends.
#[test]
fn single_block_behind_the_end_of_a_line_does_not_go_back_to_it() {
    let last = [4.929_517_146_153_264, -1.690_567_476_501_653, 6.005_005_025_338_085];
    let points =
        [[-1.030_802_327_703_445_7, -4.138_634_340_721_112, 6.005_005_025_338_085], last, last];
    let orders = [
        (330, Order::FeedHold),
        (2874, Order::Resume),
        (2921, Order::SingleBlock(true)),
        (208, Order::FeedOverride(1.542_428_349_330_323)),
    ];
    for single in 2880..2930 {
        let mut orders = orders;
        orders[2].0 = single;
        let seen = run(&program(&points, &[20.186_718_694_284_508]), f64::INFINITY, &orders);
        let [speed, accel, _] = loads(&seen, f64::INFINITY);
        assert!(speed < 1.001 && accel < 1.01, "{single}: {speed} {accel}");
        assert!(seen.ended && seen.faults.is_empty());
    }
}
