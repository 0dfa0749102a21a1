//! Motion in closed form, and what the axes are told of it.
use super::*;
use core::cell::Cell;
use proptest::prelude::*;
use std::vec::Vec;

const DT: f64 = 1e-3;
const ACCEL: f64 = 1000.0;
/// Each period that is looked at is looked at twice; so are the one under way and the first one of
/// each try.
const MOST_LOOKS: usize = 2 * SIGHT + 2 * (TRIES + 2);

fn limits(jerk: f64) -> Limits {
    let bounds = Bounds { speed: [200.0; AXES], accel: [ACCEL; AXES], jerk: [jerk; AXES] };
    Limits { feed: bounds, rapid: bounds }
}

/// A straight line along X at a speed, or a circle in X and Y.
#[derive(Clone, Copy)]
enum Plan {
    Line { speed: f64 },
    Circle { radius: f64, speed: f64 },
}

#[derive(Clone, Copy)]
struct Along<'a> {
    plan: Plan,
    at: f64,
    /// Planned time up to which it is known.
    known: f64,
    looks: &'a Cell<usize>,
}

impl Motion for Along<'_> {
    fn pass(&mut self, time: f64) -> bool {
        self.at += time;
        self.at < self.known
    }

    fn place(&self) -> PlannedPoint {
        self.looks.set(self.looks.get() + 1);
        let mut place = PlannedPoint::default();
        match self.plan {
            Plan::Line { speed } => (place.q[0], place.v[0]) = (speed * self.at, speed),
            Plan::Circle { radius, speed } => {
                let (sin, cos) = libm::sincos(self.at * speed / radius);
                (place.q[0], place.v[0]) = (radius * cos, -speed * sin);
                (place.q[1], place.v[1]) = (radius * sin, speed * cos);
            }
        }
        place
    }
}

/// Setpoints and rates of each period, with the rates that are wanted from some periods on.
fn run(plan: Plan, jerk: f64, wanted: &[(usize, f64)], periods: usize) -> Vec<([f64; AXES], f64)> {
    run_known(plan, jerk, wanted, periods, f64::INFINITY)
}

/// The same where the plan is known for so many seconds of its time.
fn run_known(
    plan: Plan,
    jerk: f64,
    wanted: &[(usize, f64)],
    periods: usize,
    ahead: f64,
) -> Vec<([f64; AXES], f64)> {
    let looks = Cell::new(0);
    let mut along = Along { plan, at: 0.0, known: f64::INFINITY, looks: &looks };
    let mut time_scaling = TimeScaling::FULL;
    let limits = limits(jerk);
    let mut seen = Vec::new();
    for n in 0..periods {
        let wanted = wanted.iter().rev().find(|(at, _)| *at <= n).map_or(1.0, |(_, rate)| *rate);
        looks.set(0);
        along.known = along.at + ahead;
        time_scaling.advance(wanted, along, &limits, Period { length: DT, planned: DT });
        assert!(looks.get() <= MOST_LOOKS, "{} looks in a period", looks.get());
        along.pass(DT * time_scaling.rate());
        let place = along.place();
        time_scaling.reached(&place.q, place.rapid);
        if n == 0 {
            // it has gone on for long
            time_scaling.told.first = place.v.map(|v| v * DT);
            time_scaling.told.second = [0.0; AXES];
        }
        seen.push((place.q, time_scaling.rate()));
    }
    seen
}

/// Largest acceleration and jerk, over their limits.
fn loads(seen: &[([f64; AXES], f64)], jerk: f64) -> (f64, f64) {
    let mut most = (0.0_f64, 0.0_f64);
    for four in seen.windows(4) {
        for i in 0..2 {
            let q: [f64; 4] = core::array::from_fn(|k| four[k].0[i]);
            most.0 = most.0.max((q[2] - 2.0 * q[1] + q[0]).abs() / DT.powi(2) / ACCEL);
            let third = q[3] - 3.0 * q[2] + 3.0 * q[1] - q[0];
            most.1 = most.1.max(third.abs() / DT.powi(3) / jerk);
        }
    }
    most
}

/// From 100 mm/s an axis needs v/A + A/J to stand, or 2·√(v/J) where A is not reached; v/A without
/// a limit of jerk.
#[test]
fn a_hold_on_a_straight_line_takes_as_long_as_the_limits_ask_for() {
    for (jerk, least) in [(f64::INFINITY, 0.1), (20e3, 0.15), (5e3, 2.0 * libm::sqrt(0.02))] {
        let seen = run(Plan::Line { speed: 100.0 }, jerk, &[(100, 0.0)], 1000);
        let stands = seen.iter().position(|(_, rate)| *rate == 0.0).unwrap();
        let took = (stands - 100) as f64 * DT;
        assert!(took > least * 0.97 && took < least * 1.06 + 2.0 * DT, "{jerk}: {took} s, {least}");
        let (accel, third) = loads(&seen, jerk);
        assert!(accel < 1.004 && third < 1.021, "{accel} {third}");
    }
}

#[test]
fn another_share_is_reached_exactly_and_kept() {
    for jerk in [f64::INFINITY, 20e3] {
        let seen = run(Plan::Line { speed: 150.0 }, jerk, &[(10, 0.37), (400, 0.9)], 900);
        assert_eq!((seen[399].1, seen[899].1), (0.37, 0.9));
        // it gets there from one side
        assert!(seen[..400].iter().all(|(_, rate)| *rate >= 0.37));
        assert!(seen[400..].iter().all(|(_, rate)| *rate <= 0.9));
    }
}

/// On a circle that takes all of the acceleration, or all of the jerk, no axis has anything left at
/// rate 1: a change has to be begun where the axes leave room for it.
#[test]
fn a_hold_comes_where_both_limits_are_used_up() {
    // v²/r = A; v³/r² = J
    for (jerk, speed) in [(f64::INFINITY, 100.0), (20e3, 100.0)] {
        let by_accel = speed * speed / ACCEL;
        let by_jerk = libm::sqrt(speed * speed * speed / jerk);
        let radius = f64::max(by_accel, by_jerk);
        let seen = run(Plan::Circle { radius, speed }, jerk, &[(200, 0.0)], 2000);
        let stands = seen.iter().position(|(_, rate)| *rate == 0.0).unwrap();
        assert!(stands < 200 + 500, "{jerk}: {stands}");
        let (accel, third) = loads(&seen[3..], jerk);
        assert!(accel < 1.004 && third < 1.021, "{accel} {third}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(test_support::size::of(64, 1280)))]
    #[test]
    fn whatever_rates_are_wanted_on_a_circle_the_limits_hold(
        wanted in prop::collection::vec((0..1500_usize, 0.0..1.0_f64), 1..8),
        load in 0.3..1.0_f64,
        radius in 2.0..50.0_f64,
        jerk in prop::sample::select(std::vec![f64::INFINITY, 50e3, 20e3]),
    ) {
        let by_jerk = libm::cbrt(jerk * radius * radius);
        let speed = load * f64::min(libm::sqrt(ACCEL * radius), by_jerk).min(200.0);
        let mut wanted = wanted;
        wanted.sort_by_key(|(at, _)| *at);
        let seen = run(Plan::Circle { radius, speed }, jerk, &wanted, 3000);
        let (accel, third) = loads(&seen[3..], jerk);
        prop_assert!(accel < 1.004 && third < 1.021, "{accel} {third}");
        prop_assert_eq!(seen[2999].1, wanted[wanted.len() - 1].1);
    }
}

/// What comes behind the last step that is known may leave no room for a change that is still under
/// way there.
#[test]
fn a_change_ends_within_what_is_known_of_the_plan() {
    for ahead in [0.01, 0.02, 0.04] {
        let plan = Plan::Circle { radius: 4.0, speed: 60.0 };
        let wanted = [(200, 0.0), (900, 1.0)];
        let seen = run_known(plan, 20e3, &wanted, 3000, ahead);
        let (accel, third) = loads(&seen[3..], 20e3);
        assert!(accel < 1.004 && third < 1.021, "{ahead} s: {accel} {third}");
        assert_eq!((seen[899].1, seen[2999].1), (0.0, 1.0));
    }
}

/// Where a plan asks for more than it may, an order is obeyed all the same.
#[test]
fn a_plan_beyond_its_limits_can_be_held() {
    let seen = run(Plan::Circle { radius: 5.0, speed: 120.0 }, 20e3, &[(100, 0.0)], 4000);
    assert_eq!(seen[3999].1, 0.0);
}

/// An easing that ends beside the wanted rate by rounding has come to it: else a hold would never
/// be one.
#[test]
fn a_rate_that_is_wanted_but_for_rounding_is_reached() {
    let looks = Cell::new(0);
    for wanted in [0.0, 0.37] {
        let plan = Plan::Line { speed: 50.0 };
        let along = Along { plan, at: 0.0, known: f64::INFINITY, looks: &looks };
        let mut time_scaling =
            TimeScaling { rate: wanted + 1e-13, settles: wanted + 1e-13, ..TimeScaling::FULL };
        let period = Period { length: DT, planned: DT };
        time_scaling.advance(wanted, along, &limits(20e3), period);
        assert!(time_scaling.is_steady(wanted), "{}", time_scaling.rate());
    }
}
