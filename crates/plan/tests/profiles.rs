//! Profiles from rest to rest against their closed forms, their limits and a search by brute force.
use motion::{Phase, Profile};
use proptest::prelude::*;
use test_support::size;

/// States at both ends and inside of every piece.
fn samples(profile: &Profile) -> impl Iterator<Item = (Phase, motion::Instant)> + '_ {
    let inside = |p: Phase| (0..=8).map(move |i| (p, p.at(p.duration * f64::from(i) / 8.0)));
    profile.pieces().iter().copied().flat_map(inside)
}

fn assert_sound(profile: &Profile, length: f64, speed: f64, accel: f64, jerk: f64) {
    let eps = 1.0 + 1e-9;
    for (piece, now) in samples(profile) {
        assert!(now.v >= -1e-9 * speed && now.v <= speed * eps, "speed {} of {speed}", now.v);
        assert!(now.a.abs() <= accel * eps, "acceleration {} of {accel}", now.a);
        assert!(piece.j.abs() <= jerk * eps, "jerk {} of {jerk}", piece.j);
        assert!(now.s >= -1e-9 * length && now.s <= length * eps, "at {} of {length}", now.s);
    }
    for pair in profile.pieces().windows(2) {
        let (end, start) = (pair[0].end(), pair[1]);
        assert!((end.s - start.s).abs() <= 1e-9 * length, "a gap in s: {} {}", end.s, start.s);
        assert!((end.v - start.v).abs() <= 1e-9 * speed, "a gap in v: {} {}", end.v, start.v);
        if jerk.is_finite() {
            assert!((end.a - start.a).abs() <= 1e-6 * accel, "a gap in a: {} {}", end.a, start.a);
        }
    }
    let last = profile.pieces().last().expect("a profile with a length has pieces").end();
    assert!((last.s - length).abs() <= 1e-12 * length && last.v.abs() <= 1e-9 * speed);
    assert_eq!(profile.end(), motion::Instant { s: length, v: 0.0, a: 0.0 });
    assert_eq!(profile.at(profile.duration()), profile.end());
}

/// Shortest time among symmetric profiles with constant jerk phases, found by trying: `tj` of jerk,
/// `ta` level, cruise as long as it takes.
fn by_trying(length: f64, speed: f64, accel: f64, jerk: f64) -> f64 {
    let n = 120;
    let tj_most = (accel / jerk).min((speed / jerk).sqrt()).min((length / (2.0 * jerk)).cbrt());
    let ta_most = (speed / accel).min((length / accel).sqrt());
    let mut best = f64::INFINITY;
    for i in 1..=n {
        let tj = tj_most * f64::from(i) / f64::from(n);
        for k in 0..=n {
            let ta = ta_most * f64::from(k) / f64::from(n);
            let v = jerk * tj * (tj + ta);
            let ramps = v * (2.0 * tj + ta);
            if v <= speed * (1.0 + 1e-12) && ramps <= length * (1.0 + 1e-12) {
                best = best.min(2.0 * (2.0 * tj + ta) + (length - ramps) / v);
            }
        }
    }
    best
}

fn check(length: f64, speed: f64, accel: f64, jerk: f64, pieces: usize, expected: f64) {
    let profile = plan::rest_to_rest(length, speed, accel, jerk);
    assert_sound(&profile, length, speed, accel, jerk);
    assert_eq!(profile.pieces().len(), pieces);
    assert!(
        (profile.duration() - expected).abs() < 1e-12,
        "{} is not {expected}",
        profile.duration()
    );
}

/// a/j = 1, v/a = 2: ramps of 3 s and 3 m each, 4 m at 2 m/s.
#[test]
fn all_limits_reached_has_seven_pieces_and_lasts_length_over_v_plus_v_over_a_plus_a_over_j() {
    check(10.0, 2.0, 1.0, 1.0, 7, 10.0 / 2.0 + 2.0 / 1.0 + 1.0 / 1.0);
}

/// Without cruise: v²/a + v·a/j = length.
#[test]
fn a_short_way_reaches_the_acceleration_but_not_the_speed() {
    let v = -0.5 + (0.25_f64 + 4.0).sqrt();
    check(4.0, 10.0, 1.0, 1.0, 6, 2.0 * (v + 1.0));
}

/// Four equal times of jerk: length = 2·j·t³.
#[test]
fn a_very_short_way_reaches_neither() {
    check(0.25, 10.0, 1.0, 1.0, 4, 4.0 * (0.125_f64).cbrt());
}

#[test]
fn a_low_speed_is_reached_by_jerk_alone() {
    check(1.0, 0.25, 10.0, 1.0, 5, 1.0 / 0.25 + 2.0 * 0.25_f64.sqrt());
}

#[test]
fn without_a_limit_on_the_jerk_it_is_a_trapezium_or_a_triangle() {
    check(10.0, 2.0, 1.0, f64::INFINITY, 3, 10.0 / 2.0 + 2.0 / 1.0);
    check(1.0, 2.0, 1.0, f64::INFINITY, 2, 2.0);
}

#[test]
fn what_cannot_be_planned_is_empty() {
    for bad in [0.0, -1.0, f64::NAN] {
        assert_eq!(plan::rest_to_rest(bad, 1.0, 1.0, 1.0), Profile::EMPTY);
        assert_eq!(plan::rest_to_rest(1.0, bad, 1.0, 1.0), Profile::EMPTY);
        assert_eq!(plan::rest_to_rest(1.0, 1.0, bad, 1.0), Profile::EMPTY);
        assert_eq!(plan::rest_to_rest(1.0, 1.0, 1.0, bad), Profile::EMPTY);
    }
    assert_eq!(plan::rest_to_rest(f64::INFINITY, 1.0, 1.0, 1.0), Profile::EMPTY);
}

fn decades(low: i32, high: i32) -> impl Strategy<Value = f64> {
    (f64::from(low)..f64::from(high)).prop_map(|x| 10_f64.powf(x))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(256, 2560), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn limits_are_never_exceeded_and_the_end_is_exact(
        length in decades(-6, 5), speed in decades(-3, 4), accel in decades(-1, 5), jerk in decades(0, 9),
    ) {
        let profile = plan::rest_to_rest(length, speed, accel, jerk);
        assert_sound(&profile, length, speed, accel, jerk);
        assert!(profile.pieces().len() <= 7);
        let level = plan::rest_to_rest(length, speed, accel, f64::INFINITY);
        assert_sound(&level, length, speed, accel, f64::INFINITY);
        assert!(level.duration() <= profile.duration() * (1.0 + 1e-12));
    }

    #[test]
    fn no_profile_found_by_trying_is_faster(
        length in decades(-2, 2), speed in decades(-1, 1), accel in decades(-1, 1), jerk in decades(-1, 2),
    ) {
        let ours = plan::rest_to_rest(length, speed, accel, jerk).duration();
        let tried = by_trying(length, speed, accel, jerk);
        assert!(ours <= tried * (1.0 + 1e-9), "{ours} s, but {tried} s was found");
        assert!(tried <= ours * 1.05 || !tried.is_finite(), "the search is too coarse to prove anything");
    }
}
