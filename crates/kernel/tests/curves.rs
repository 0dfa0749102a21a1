//! What `overrides` looks at, on curves: arcs and helices in all planes, splines, C beside them or
//! alone, G93, G61, G61.1 and G64 with P and Q, with overrides, holds and single block at any
//! instant.
//!
//! ```text
//!   by differences of the setpoints    speed to 0.1 %, acceleration to 1 %, jerk to 5 % above the limits
//!   from the programmed path           of X, Y, Z: P at most; with G61 two nanometres
//!   at the end                         exact
//! ```
use crate::operated::{C, loads, order, run, run_replanning};
use bus::AXES;
use canon::{Arc, Axis, Feed, Op, OpKind, PathMode, Plane, Position, Span, Spline};
use proptest::prelude::*;
use test_support::size;
use units::{Angle, Length, Speed, Time};

/// A part of a path, from where the part before it has ended.
#[derive(Clone, Copy, Debug)]
enum Part {
    Line { by: [f64; 3], turn: f64 },
    Arc { plane: Plane, radius: f64, at: f64, sweep: f64, rise: f64, turn: f64 },
    Spline { by: [f64; 2], bulge: [[f64; 2]; 4] },
}

/// How fast.
#[derive(Clone, Copy, Debug)]
enum Pace {
    PerTime(f64),
    Lasting(f64),
    Rapid,
}

/// The programmed curve of a part: all axes at 0…1 of it.
#[derive(Clone, Copy, Debug)]
struct Curve {
    from: [f64; AXES],
    part: Part,
}

impl Curve {
    fn at(&self, t: f64) -> [f64; AXES] {
        let mut q = self.from;
        match self.part {
            Part::Line { by, turn } => {
                (0..3).for_each(|i| q[i] += by[i] * t);
                q[C] += turn * t;
            }
            Part::Arc { plane, radius, at, sweep, rise, turn } => {
                let [first, second, normal] = plane.axes().map(Axis::index);
                let angle = at + sweep * t;
                q[first] += radius * (angle.cos() - at.cos());
                q[second] += radius * (angle.sin() - at.sin());
                q[normal] += rise * t;
                q[C] += turn * t;
            }
            Part::Spline { .. } => {
                let mut points = self.control();
                for left in (1..6).rev() {
                    for k in 0..left {
                        let [a, b] = [points[k], points[k + 1]];
                        points[k] = [0, 1].map(|i| a[i] + (b[i] - a[i]) * t);
                    }
                }
                [q[0], q[1]] = points[0];
            }
        }
        q
    }

    /// Of a spline.
    fn control(&self) -> [[f64; 2]; 6] {
        let Part::Spline { by, bulge } = self.part else { return [[0.0; 2]; 6] };
        core::array::from_fn(|k| {
            [0, 1].map(|i| {
                let off = if (1..5).contains(&k) { bulge[k - 1][i] } else { 0.0 };
                self.from[i] + by[i] * k as f64 / 5.0 + off
            })
        })
    }

    fn op(&self, pace: Pace) -> OpKind {
        let q = self.at(1.0);
        let rotary = [Angle::ZERO, Angle::ZERO, Angle::deg(q[C])];
        let to = Position { rotary, ..Position::xyz(q[0], q[1], q[2]) };
        let feed = match pace {
            Pace::Lasting(seconds) => Feed::Duration(Time::s(seconds)),
            Pace::PerTime(feed) => Feed::PerTime(Speed::mm_per_s(feed)),
            Pace::Rapid => Feed::PerTime(Speed::mm_per_s(200.0)),
        };
        match self.part {
            Part::Line { .. } if matches!(pace, Pace::Rapid) => OpKind::Rapid { to },
            Part::Line { .. } => OpKind::Line { to, feed },
            Part::Arc { plane, radius, at, sweep, .. } => {
                let [first, second, _] = plane.axes().map(Axis::index);
                let centre = [
                    Length::mm(self.from[first] - radius * at.cos()),
                    Length::mm(self.from[second] - radius * at.sin()),
                ];
                OpKind::Arc {
                    to,
                    arc: Arc { plane, centre, sweep: Angle::rev(sweep / core::f64::consts::TAU) },
                    feed,
                }
            }
            Part::Spline { .. } => {
                let [_, a, b, c, d, e] = self.control().map(|point| point.map(Length::mm));
                OpKind::Spline { to, spline: Spline { pieces: vec![[a, b, c, d, e]] }, feed }
            }
        }
    }

    /// How far a point is from it, at most: looked for around every place that is nearer than its
    /// neighbours. Turns of an arc may lie on one another, and a spline may all but return on
    /// itself, so there is more than one.
    fn distance<const PLACES: usize>(&self, p: &[f64; AXES]) -> f64 {
        let far = |t: f64| {
            let q = self.at(t);
            (0..3).map(|i| (q[i] - p[i]).powi(2)).sum::<f64>()
        };
        let step = 1.0 / PLACES as f64;
        let places: Vec<f64> = (0..=PLACES).map(|k| far(k as f64 * step)).collect();
        let nearest = (0..=PLACES).filter(|&k| {
            let beside = &places[k.saturating_sub(1)..=(k + 1).min(PLACES)];
            beside.iter().all(|far| *far >= places[k])
        });
        let around = |k: usize| {
            let t = k as f64 * step;
            let (mut low, mut high) = ((t - step).max(0.0), (t + step).min(1.0));
            for _ in 0..40 {
                let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if far(a) < far(b) { high = b } else { low = a }
            }
            places[k].min(far(low))
        };
        nearest.map(around).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// The lowest and the highest that each axis gets, and a little more.
    fn extent(&self) -> [[f64; 2]; AXES] {
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; AXES];
        for k in 0..=96 {
            let q = self.at(f64::from(k) / 96.0);
            for (i, [low, high]) in extent.iter_mut().enumerate() {
                (*low, *high) = (low.min(q[i] - 0.1), high.max(q[i] + 0.1));
            }
        }
        extent
    }
}

/// Farthest setpoint from the programmed path. Where a spline all but returns on itself a coarse
/// look finds too much: what is beyond the tolerance is looked at again, finely.
fn off_path(at: &[([f64; AXES], u32)], curves: &[Curve], tolerance: f64) -> f64 {
    let extents: Vec<_> = curves.iter().map(Curve::extent).collect();
    let near = |p: &[f64; AXES]| {
        let inside = |e: &[[f64; 2]; AXES]| (0..3).all(|i| p[i] >= e[i][0] && p[i] <= e[i][1]);
        let close =
            || curves.iter().zip(&extents).filter(|(_, e)| inside(e)).map(|(curve, _)| curve);
        let coarse = close().map(|curve| curve.distance::<256>(p)).fold(f64::INFINITY, f64::min);
        if coarse < tolerance + 1e-6 {
            return coarse;
        }
        close().map(|curve| curve.distance::<16384>(p)).fold(f64::INFINITY, f64::min)
    };
    at.iter().step_by(7).map(|(p, _)| near(p)).fold(0.0, f64::max)
}

fn part() -> impl Strategy<Value = Part> {
    let turn = || prop_oneof![3 => Just(0.0), 1 => -20.0..20.0_f64];
    let plane = prop::sample::select(vec![Plane::XY, Plane::ZX, Plane::YZ]);
    let rise = prop_oneof![2 => Just(0.0), 1 => -3.0..3.0_f64];
    let sweep = prop_oneof![3 => 0.2..6.0_f64, 3 => -6.0..-0.2_f64, 1 => 7.0..15.0_f64];
    let bulge = prop::array::uniform4(prop::array::uniform2(-0.8..0.8_f64));
    let by = (1.0..10.0_f64, 0.0..6.3_f64).prop_map(|(l, w)| [l * w.cos(), l * w.sin()]);
    prop_oneof![
        3 => (prop::array::uniform3(-8.0..8.0_f64), turn()).prop_map(|(by, turn)| Part::Line { by, turn }),
        2 => (prop::array::uniform3(-0.4..0.4_f64), turn()).prop_map(|(by, turn)| Part::Line { by, turn: turn / 20.0 }),
        1 => turn().prop_map(|turn| Part::Line { by: [0.0; 3], turn }),
        5 => (plane, 0.2..8.0_f64, 0.0..6.0_f64, sweep, rise, turn())
            .prop_map(|(plane, radius, at, sweep, rise, turn)| Part::Arc { plane, radius, at, sweep, rise, turn }),
        3 => (by, bulge).prop_map(|(by, bulge)| Part::Spline { by, bulge }),
    ]
}

fn pace() -> impl Strategy<Value = Pace> {
    prop_oneof![
        5 => (5.0..120.0_f64).prop_map(Pace::PerTime),
        2 => (0.02..0.6_f64).prop_map(Pace::Lasting),
        1 => Just(Pace::Rapid),
    ]
}

/// The mode, and how far the path may be from the programmed one.
fn mode() -> impl Strategy<Value = (PathMode, f64)> {
    let blend = |p: f64, q: Option<f64>| {
        let (tolerance, merge) = (Some(Length::mm(p)), q.map(Length::mm));
        (PathMode::Blend { tolerance, merge }, p)
    };
    prop_oneof![
        4 => Just(blend(0.02, None)),
        1 => Just(blend(0.005, Some(0.0))),
        1 => Just(blend(0.05, Some(0.01))),
        1 => Just((PathMode::Exact, 0.0)),
        1 => Just((PathMode::ExactStop, 0.0)),
    ]
}

fn curves(parts: &[Part]) -> Vec<Curve> {
    let mut from = [0.0; AXES];
    let mut next = |part: &Part| {
        let curve = Curve { from, part: *part };
        from = curve.at(1.0);
        curve
    };
    parts.iter().map(&mut next).collect()
}

/// A program of curves, each with the next pace.
fn ops(curves: &[Curve], paces: &[Pace], mode: PathMode) -> Vec<Op> {
    let moves = curves.iter().zip(paces.iter().cycle()).map(|(curve, pace)| curve.op(*pace));
    let all = [OpKind::PathMode(mode)].into_iter().chain(moves).chain([OpKind::End]);
    let place = |line| Span { file: 0, line, start: 0, end: 0 };
    (1..).zip(all).map(|(line, kind)| Op { span: place(line), kind }).collect()
}

/// Beside a spline that ends in a sharp bend a blend's knots lie close, and where motion is slow a
/// bend costs nothing: it may not become so sharp that the acceleration passes its limit there.
#[test]
#[allow(clippy::unreadable_literal)] // as it was found by chance
fn a_blend_beside_a_spline_is_within_the_limits() {
    let blend = PathMode::Blend { tolerance: Some(Length::mm(0.02)), merge: None };
    let spline = |by, bulge| Part::Spline { by, bulge };
    let arc = |radius, at, sweep| {
        let (plane, rise, turn) = (Plane::YZ, 0.0, 0.0);
        Part::Arc { plane, radius, at, sweep, rise, turn }
    };
    let first = [
        spline(
            [1.78168137549125, -1.993141469851347],
            [
                [-0.48352426983252444, -0.3274365037893687],
                [0.1429900071750185, -0.35516979262800946],
                [-0.4806726359189722, -0.4591235133450602],
                [0.5906580616955388, -0.49053297569241344],
            ],
        ),
        arc(5.7824159323683455, 0.23522943327759713, 13.65305150398186),
    ];
    let second = [
        spline(
            [-0.39035987021008384, -5.709060895847661],
            [
                [0.38905690936783793, 0.6951077712240652],
                [0.09226601271032457, 0.7722168870537233],
                [0.7318000184056692, 0.1892369955278503],
                [0.371063771131345, -0.37992114189918086],
            ],
        ),
        spline(
            [0.7696417736072187, 0.8975882830754819],
            [
                [0.006471670219342097, -0.6486093027610954],
                [-0.4688737725392086, -0.2501485852936212],
                [-0.31288139062678744, -0.4417509206164856],
                [0.2202747851953, 0.6399073648132196],
            ],
        ),
    ];
    let paces = [
        [0.10095692625680888, 0.2634575550949544].map(Pace::Lasting),
        [Pace::PerTime(114.94865266705452), Pace::Lasting(0.5064693361645253)],
    ];
    for (parts, paces) in [first, second].iter().zip(paces) {
        let curves = curves(parts);
        let [speed, accel, _] =
            loads(&run(&ops(&curves, &paces, blend), f64::INFINITY, &[]), f64::INFINITY);
        assert!(speed < 1.001 && accel < 1.01, "speed {speed}, acceleration {accel}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(80, 1600)))]
    #[test]
    fn no_axis_leaves_its_limits_or_the_curve_whatever_the_operator_does(
        parts in prop::collection::vec(part(), 2..9),
        paces in prop::collection::vec(pace(), 1..5),
        (mode, tolerance) in mode(),
        orders in prop::collection::vec((0..3000_usize, order()), 0..7),
        jerk in prop::sample::select(vec![f64::INFINITY, 50e3, 20e3]),
        ahead in any::<bool>(),
    ) {
        let curves = curves(&parts);
        let seen = run_replanning(&ops(&curves, &paces, mode), jerk, &orders, ahead);
        prop_assert_eq!(&seen.faults, &vec![]);
        prop_assert!(seen.ended);
        let [speed, accel, third] = loads(&seen, jerk);
        prop_assert!(speed < 1.001, "speed {speed}");
        prop_assert!(accel < 1.01, "acceleration {accel}");
        prop_assert!(third < 1.05, "jerk {third}");
        let off = off_path(&seen.at, &curves, tolerance);
        prop_assert!(off < tolerance + 2e-6, "{off} mm from the path");
        let (last, end) = (seen.at[seen.at.len() - 1].0, curves[curves.len() - 1].at(1.0));
        for i in 0..AXES {
            prop_assert!((last[i] - end[i]).abs() < 1e-9, "axis {i} ends at {}, not {}", last[i], end[i]);
        }
    }
}
