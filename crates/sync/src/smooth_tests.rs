//! The smooth observer against closed forms, through an encoder and without one.
use super::*;
use proptest::prelude::*;
use std::vec::Vec;

const COUNT: f64 = 1.0 / 4096.0;
/// Bound of the sum of the impulse response to the angle.
const ANGLE: f64 = 2.9;

/// How θ(t) is seen through an encoder: what the observer says, and what is, over two seconds.
fn seen(
    period_s: f64,
    most: f64,
    count: Option<f64>,
    ordered: f64,
    theta: impl Fn(f64) -> (f64, f64, f64),
) -> Vec<(Rotation, (f64, f64, f64))> {
    let h = Time::s(period_s);
    let mut observer =
        SmoothObserver::new(h, Angle::rev(COUNT), SpinAccel::rev_per_s2(most), Angle::ZERO);
    let steps = (2.0 / period_s) as u32;
    (0..steps)
        .map(|k| {
            let is = theta(f64::from(k) * period_s);
            let measured = count.map_or(is.0, |count| (is.0 / count).floor() * count);
            observer.update(Angle::rev(measured), SpinAccel::rev_per_s2(ordered));
            (observer.now(), is)
        })
        .collect()
}

/// The poles of an observer: w in 1/s.
fn pole(most: f64) -> f64 {
    (2.0 * most / (RESPONSE * COUNT)).sqrt()
}

#[test]
fn an_acceleration_that_nothing_announced_costs_what_the_closed_form_says() {
    for (h, most) in [(1e-3, 13.3), (1e-3, 5.0), (250e-6, 13.3), (250e-6, 40.0)] {
        let ramp = |t: f64| (50.0 * t * t, 100.0 * t, 100.0);
        let w = pole(most);
        let off = seen(h, most, None, 0.0, ramp);
        let worst =
            off.iter().map(|(is, real)| (is.angle.value() - real.0).abs()).fold(0.0, f64::max);
        let over = worst * w * w / 100.0;
        assert!((1.9..2.6).contains(&over), "{worst} rev: {over} of Δ/w²");
        // 5/w, and as much again for the last thousandth
        let later = (15.0 / w / h) as usize;
        let last = off[later..]
            .iter()
            .map(|(is, real)| (is.angle.value() - real.0).abs())
            .fold(0.0, f64::max);
        assert!(last < worst * 1e-2, "{last} rev after {later} periods");
    }
}

#[test]
fn an_acceleration_that_is_ordered_costs_nothing() {
    let ramp = |t: f64| (50.0 * t * t, 100.0 * t, 100.0);
    for (is, real) in seen(1e-3, 13.3, None, 100.0, ramp) {
        assert!((is.angle.value() - real.0).abs() < 1e-9, "{is:?}");
    }
}

#[test]
fn a_master_that_stands_between_two_counts_is_seen_to_stand() {
    for (is, _) in seen(1e-3, 13.3, Some(COUNT), 0.0, |_| (0.0, 0.0, 0.0)) {
        assert_eq!(is, Rotation::default());
    }
}

proptest! {
    /// At a constant speed, whatever it has in common with the counts.
    #[test]
    fn counts_cost_no_more_acceleration_than_is_allowed(
        spin in -60.0..60.0f64, most in 2.0..20.0f64, fast in any::<bool>(),
    ) {
        let h = if fast { 250e-6 } else { 1e-3 };
        let over = seen(h, most, Some(COUNT), 0.0, |t| (spin * t, spin, 0.0));
        let settled = (30.0 / pole(most) / h) as usize;
        for (is, real) in &over[settled.min(over.len())..] {
            prop_assert!(is.accel.value().abs() <= most, "{} rev/s2", is.accel.value());
            // floor: half a count below in the mean
            let off = is.angle.value() - (real.0 - COUNT / 2.0);
            prop_assert!(off.abs() < ANGLE / 2.0 * COUNT, "{off} rev");
        }
    }

    /// On a ramp through a reversal: no lag, and the same bound on what is not the ramp's.
    #[test]
    fn a_reversal_is_seen_without_lag_and_as_quietly(
        accel in 20.0..100.0f64, at in 0.6..1.4f64, most in 5.0..20.0f64,
    ) {
        let theta = |t: f64| (accel * (t * t / 2.0 - at * t), accel * (t - at), accel);
        let over = seen(1e-3, most, Some(COUNT), 0.0, theta);
        let settled = (30.0 / pole(most) / 1e-3) as usize;
        for (is, real) in &over[settled.min(over.len())..] {
            prop_assert!((is.accel.value() - accel).abs() <= most, "{} rev/s2", is.accel.value());
            let off = is.angle.value() - (real.0 - COUNT / 2.0);
            prop_assert!(off.abs() < ANGLE / 2.0 * COUNT, "{off} rev");
        }
    }
}

/// A drive that brakes slower than it was told, to rest: what the observer still goes when it says
/// that it stands, in counts, and how long after the drive has come to rest it says so, s.
/// `flickers`: by how much the reading at rest is off, in counts.
fn after_a_stop(
    from: f64,
    announced: f64,
    brakes: f64,
    mut flickers: impl FnMut() -> f64,
) -> (f64, f64) {
    let h = 250e-6;
    let mut observer = SmoothObserver::new(
        Time::s(h),
        Angle::rev(COUNT),
        SpinAccel::rev_per_s2(13.3),
        Angle::ZERO,
    );
    let (begins, rest) = (0.5, 0.5 + from / brakes);
    let (mut said, mut most) = (None, 0.0_f64);
    for k in 0..((rest + 1.0) / h) as u32 {
        let t = f64::from(k) * h;
        let braked = (t.min(rest) - begins).max(0.0);
        let angle = from * t.min(rest) - 0.5 * brakes * braked * braked;
        let off = if t > rest { flickers() } else { 0.0 };
        let measured = Angle::rev(((angle / COUNT).floor() + off) * COUNT);
        let is_announced = t >= begins && t < begins + from / announced;
        let ordered = if is_announced { -announced } else { 0.0 };
        observer.update(measured, SpinAccel::rev_per_s2(ordered));
        if t > rest && said.is_none() && observer.stands() {
            said = Some((t, observer.angle));
        }
        if let Some((_, angle)) = said {
            most = most.max((observer.angle - angle).abs() / COUNT);
        }
    }
    (most, said.expect("it never said that it stands").0 - rest)
}

proptest! {
    #[test]
    fn an_observer_that_says_that_it_stands_goes_no_farther_than_a_count(
        from in 2.0..60.0_f64,
        announced in 20.0..100.0_f64,
        share in 0.7..1.2_f64,
    ) {
        let (most, later) = after_a_stop(from, announced, announced * share, || 0.0);
        prop_assert!(most < 1.0, "{most} counts");
        prop_assert!(later < 0.15 + (from / announced - from / (announced * share)).max(0.0));
    }

    /// An encoder that stands on an edge reads one count or the other.
    #[test]
    fn a_reading_that_flickers_does_not_keep_it_from_saying_so(
        from in 2.0..60.0_f64,
        seed in 1..u64::MAX,
    ) {
        let mut state = seed;
        let flicker = || {
            // Marsaglia's xorshift
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state & 1) as f64
        };
        let (_, later) = after_a_stop(from, 60.0, 51.0, flicker);
        prop_assert!(later < 0.5, "{later} s after it");
    }
}
