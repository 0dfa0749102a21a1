//! Splines are operations: followed as they are, by the planner, with one end each.
use crate::common;
use crate::common::{line, mm, planner_at, steps_of, turn};
use canon::{Feed, OpKind, PathMode, Position, Spline};
use motion::Shape;
use plan::{Step, StepKind};
use units::{Length, Speed, Time};

/// y = x²/20 from the origin to (20, 20), as G5.1 writes it, raised to the fifth degree: points
/// (4·k, k·(k − 1)).
fn parabola(feed: Feed) -> OpKind {
    let point = |k: i32| [mm(f64::from(4 * k)), mm(f64::from(k * (k - 1)))];
    OpKind::Spline {
        to: Position::xyz(20.0, 20.0, 0.0),
        spline: Spline { pieces: vec![[1, 2, 3, 4, 5].map(point)] },
        feed,
    }
}

const FEED: Feed = Feed::PerTime(Speed::mm_per_s(100.0));

fn follow(mode: PathMode) -> Vec<Step> {
    let ops = [OpKind::PathMode(mode), turn(1000.0), parabola(FEED), line(40.0, 60.0, 0.0, 6000.0)];
    steps_of(planner_at(Position::default(), 0), ops)
}

/// X, Y and ṡ each millisecond, and how often it comes to rest in position.
fn run(steps: &[Step]) -> (Vec<[f64; 3]>, usize) {
    let (mut places, mut stops) = (Vec::new(), 0);
    for step in steps {
        let StepKind::Follow(follow) = &step.kind else { continue };
        stops += usize::from(follow.exact_stop);
        let periods = (follow.duration() * 1e3).ceil() as usize;
        for n in 0..=periods {
            let (s, v, ..) = follow.at((n as f64 * 1e-3).min(follow.duration()));
            let [x, y, ..] = follow.piece.at(s).q;
            places.push([x, y, v]);
        }
    }
    (places, stops)
}

fn off(places: &[[f64; 3]]) -> f64 {
    let on_spline = places.iter().filter(|[x, _, _]| *x <= 20.0);
    on_spline.map(|[x, y, _]| (y - x * x / 20.0).abs()).fold(0.0, f64::max)
}

#[test]
fn on_the_exact_path_a_spline_is_followed_as_it_is_and_left_along_its_slope_without_a_stop() {
    // it ends with slope 2, and so does the line behind it begin
    let (places, stops) = run(&follow(PathMode::Exact));
    assert!(off(&places) < 1e-9, "{} mm off", off(&places));
    assert_eq!(stops, 1);
    let slowest = places.iter().filter(|[x, _, _]| (1.0..39.0).contains(x));
    let slowest = slowest.map(|[_, _, v]| *v).fold(f64::INFINITY, f64::min);
    assert!(slowest > 50.0, "{slowest} mm/s");
}

/// Whatever it is cut into. From rest to rest at v a ramp adds √(v/j) at either end: v = 29.6 mm /
/// 4 s, j = 500 m/s³.
#[test]
fn with_inverse_time_a_spline_lasts_as_long_as_programmed() {
    let spline = parabola(Feed::Duration(Time::s(4.0)));
    let ops = [OpKind::PathMode(PathMode::Exact), turn(1000.0), spline];
    let steps = steps_of(planner_at(Position::default(), 0), ops);
    let follows = steps.iter().filter_map(|step| match &step.kind {
        StepKind::Follow(follow) => Some(follow.duration()),
        _ => None,
    });
    let took: f64 = follows.sum();
    let ramps = 2.0 * (29.6_f64 / 4.0 / 5e5).sqrt();
    assert!((took - 4.0 - ramps).abs() < 0.005, "{took} s");
}

#[test]
fn with_exact_stops_there_is_one_at_the_end_of_a_spline_and_none_on_its_way() {
    let steps = follow(PathMode::ExactStop);
    let (places, _) = run(&steps);
    assert!(off(&places) < 1e-9, "{} mm off", off(&places));
    let of_spline = steps.iter().filter(|step| step.op == 2);
    let stops = of_spline.filter(|step| matches!(&step.kind, StepKind::Follow(f) if f.exact_stop));
    assert_eq!(stops.count(), 1);
    let resting = places.iter().filter(|[x, _, v]| (0.1..19.9).contains(x) && *v < 1.0);
    assert_eq!(resting.count(), 0);
}

#[test]
fn blended_it_is_within_p() {
    let mode = PathMode::Blend { tolerance: Some(Length::mm(0.01)), merge: None };
    let (places, stops) = run(&follow(mode));
    assert!(off(&places) < 0.0225, "{} mm off along Y, slope 2", off(&places));
    assert_eq!(stops, 1);
}

#[test]
fn a_spline_that_bulges_beyond_the_travel_is_refused_with_how_far() {
    // a parabola from Y190 over Y210 and back
    let control = [[4.0, 206.0], [8.0, 214.0], [12.0, 214.0], [16.0, 206.0], [20.0, 190.0]];
    let spline = OpKind::Spline {
        to: Position::xyz(20.0, 190.0, 0.0),
        spline: Spline { pieces: vec![control.map(|point| point.map(mm))] },
        feed: Feed::PerTime(Speed::mm_per_s(100.0)),
    };
    let start = line(0.0, 190.0, 0.0, 6000.0);
    let said = common::findings([turn(1000.0), start, spline]);
    assert!(said.contains("M0301") && said.contains("Y would go to 210 mm"), "{said}");
}
