//! A circle takes as long as it must, and the same however many arcs it is programmed as.
use crate::setpoints::{PERIOD, inside};
use motion::{AXES, Arc, Bounds, Curve, Limits, Piece};
use path::geometry::{Joiner, Segment};
use path::law::{Config, Law, Timed};
use proptest::prelude::*;
use std::f64::consts::TAU;
use test_support::size;

/// A helix around Z, in turns from an angle on.
#[derive(Clone, Copy, Debug)]
struct Helix {
    radius: f64,
    begins: f64,
    turns: f64,
    pitch: f64,
}

impl Helix {
    fn at(&self, share: f64) -> [f64; AXES] {
        let angle = TAU * (self.begins + self.turns * share);
        let mut at = [0.0; AXES];
        (at[0], at[1]) = (self.radius * angle.cos(), self.radius * angle.sin());
        at[2] = self.pitch * self.turns * share;
        at
    }

    /// As arcs between shares of it, from 0 to 1.
    fn arcs(&self, cuts: &[f64], feed: f64, tolerance: f64) -> Vec<Segment> {
        let arc = |ends: &[f64]| {
            let sweep = TAU * self.turns * (ends[1] - ends[0]);
            let around = self.radius * sweep;
            let along = self.pitch * sweep / TAU;
            let curve = Curve::Arc(Arc {
                from: self.at(ends[0]),
                to: self.at(ends[1]),
                plane: [0, 1],
                centre: [0.0; 2],
                sweep,
                length: around.hypot(along),
            });
            Segment { curve, feed, rapid: false, tolerance, merge: 0.0, op: 0, line: 0 }
        };
        cuts.windows(2).map(arc).collect()
    }
}

fn even(parts: usize) -> Vec<f64> {
    (0..=parts).map(|k| k as f64 / parts as f64).collect()
}

fn bounds(accel: f64, jerk: f64) -> Bounds {
    Bounds { speed: [1e4; AXES], accel: [accel; AXES], jerk: [jerk; AXES] }
}

/// Joined and timed.
fn planned(segments: &[Segment], bounds: Bounds) -> (Vec<Piece>, Vec<Timed>) {
    let limits = Limits { feed: bounds, rapid: bounds };
    let (mut joiner, mut pieces) = (Joiner::new(&limits), Vec::new());
    for segment in segments {
        joiner.push(*segment, &mut |piece| pieces.push(piece));
    }
    joiner.finish(&mut |piece| pieces.push(piece));
    let mut law = Law::new(Config { limits, period: PERIOD });
    let mut phases = Vec::new();
    for piece in &pieces {
        law.push(*piece).unwrap();
        phases.extend(std::iter::from_fn(|| law.next()));
    }
    law.close();
    phases.extend(std::iter::from_fn(|| law.next()));
    (pieces, phases)
}

fn duration(phases: &[Timed]) -> f64 {
    phases.iter().map(|t| t.phase.duration).sum()
}

/// Turns, where they begin, and the least time over √(r/A) from rest to rest, as
/// `tools/optimum/circles.py` computes it by reachability on 3000 places a turn.
const LEAST: [(f64, f64, f64); 6] = [
    (1.0, 0.0, 7.1441),
    (1.0, 0.3, 7.1184),
    (1.0, 1.0, 7.0607),
    (3.0, 0.0, 19.3904),
    (3.0, 0.3, 19.3648),
    (3.0, 1.0, 19.3071),
];

#[test]
fn a_circle_takes_the_least_time_that_its_axes_allow() {
    for (turns, angle, least) in LEAST {
        for (radius, accel) in [(0.5, 1000.0), (10.0, 1000.0), (40.0, 8000.0)] {
            let helix = Helix { radius, begins: angle / TAU, turns, pitch: 0.0 };
            let wanted = least * f64::sqrt(radius / accel);
            for parts in [1, 2, 3, 7, 50] {
                let arcs = helix.arcs(&even(parts), 1e4, 1e-3);
                let took = duration(&planned(&arcs, bounds(accel, f64::INFINITY)).1);
                let ratio = took / wanted;
                assert!((0.9995..1.01).contains(&ratio), "{helix:?} in {parts}: {ratio}");
            }
        }
    }
}

fn any_helix() -> impl Strategy<Value = Helix> {
    let radius = (-0.5..2.0_f64).prop_map(|power| 10.0_f64.powf(power));
    (radius, 0.0..1.0_f64, 0.1..3.0_f64, prop_oneof![Just(0.0), -5.0..5.0_f64])
        .prop_map(|(radius, begins, turns, pitch)| Helix { radius, begins, turns, pitch })
}

fn any_cuts() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.05..1.0_f64, 2..50).prop_map(|lengths| {
        let all: f64 = lengths.iter().sum();
        let mut at = 0.0;
        let mut cuts = vec![0.0];
        cuts.extend(lengths.iter().map(|length| {
            at += length / all;
            at
        }));
        *cuts.last_mut().unwrap() = 1.0;
        cuts
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(60, 3000)))]

    /// Cut anywhere, with and without a limit of jerk, at any feed.
    #[test]
    fn however_a_circle_is_cut_it_takes_as_long(
        helix in any_helix(),
        cuts in any_cuts(),
        feed in 5.0..1000.0_f64,
        jerk in prop_oneof![Just(f64::INFINITY), 5e3..2e5_f64],
        tolerance in prop_oneof![Just(0.0), Just(0.001), Just(0.05)],
    ) {
        let bounds = bounds(1000.0, jerk);
        let (_, whole) = planned(&helix.arcs(&[0.0, 1.0], feed, tolerance), bounds);
        let (pieces, cut) = planned(&helix.arcs(&cuts, feed, tolerance), bounds);
        let (least, took) = (duration(&whole), duration(&cut));
        // or a servo period, where that is more
        prop_assert!((took - least).abs() < PERIOD.max(0.005 * least), "{took} s for {least}");
        prop_assert_eq!(pieces.len(), cuts.len() - 1);
        let [speed, accel, jerk] = inside(&pieces, &cut, &bounds);
        prop_assert!(speed < 1.001 && accel < 1.01 && jerk < 1.03, "{speed} {accel} {jerk}");
    }
}
