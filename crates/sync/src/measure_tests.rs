//! Measuring profiles whose phase error is known.
use super::*;
use proptest::prelude::*;

const NODES: usize = 720;

/// An automotive lift: 9(1 − u²)³ over 65° each side of 180°.
fn lift(turn: f64) -> f64 {
    let u = (turn - libm::floor(turn) - 0.5) * 360.0 / 65.0;
    if u.abs() < 1.0 { 9.0 * (1.0 - u * u).powi(3) } else { 0.0 }
}

fn lobes(turn: f64) -> f64 {
    1.5 * f64::cos(TAU * 3.0 * (turn - 20.0 / 360.0))
}

fn eccentric(turn: f64) -> f64 {
    4.0 * f64::cos(TAU * turn)
}

fn nodes(f: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..NODES).map(|i| f(i as f64 / NODES as f64)).collect()
}

#[test]
fn samples_are_brought_to_the_angles_of_the_nodes() {
    // 60 rpm at 250 µs, from an angle that is no node, two and a half turns
    let pairs: Vec<Pair> = (0..10_000)
        .map(|i| {
            let turn = 0.3333 + f64::from(i) * 250e-6;
            Pair { angle: Angle::rev(turn), position: Length::mm(lift(turn)) }
        })
        .collect();
    let profile = fold(&pairs, NODES).unwrap();
    for (i, x) in profile.iter().enumerate() {
        let is = lift(i as f64 / NODES as f64);
        assert!((x - is).abs() < 1e-6, "node {i}: {x} instead of {is}");
    }
}

#[test]
fn a_master_that_turns_backwards_gives_the_same_profile() {
    let pairs: Vec<Pair> = (0..10_000)
        .map(|i| {
            let turn = 0.1 - f64::from(i) * 250e-6;
            Pair { angle: Angle::rev(turn), position: Length::mm(lift(turn)) }
        })
        .collect();
    let profile = fold(&pairs, NODES).unwrap();
    assert!((profile[400] - lift(400.0 / 720.0)).abs() < 1e-6);
}

#[test]
fn less_than_a_turn_a_stop_and_a_reading_that_is_no_number_are_refused() {
    let pair = |turn: f64| Pair { angle: Angle::rev(turn), position: Length::ZERO };
    let part: Vec<Pair> = (0..900).map(|i| pair(f64::from(i) / 1000.0)).collect();
    assert!(matches!(fold(&part, NODES), Err(MeasureError::TooShort { .. })));
    let mut stop: Vec<Pair> = (0..2000).map(|i| pair(f64::from(i) / 1000.0)).collect();
    stop[500..600].fill(pair(0.5));
    assert!(matches!(fold(&stop, NODES), Err(MeasureError::NotTurning { .. })));
    stop[7] = pair(f64::NAN);
    assert_eq!(fold(&stop, NODES), Err(MeasureError::NotFinite { sample: 7 }));
    assert!(matches!(fold(&[], NODES), Err(MeasureError::TooShort { .. })));
}

#[test]
fn a_round_part_has_no_phase() {
    assert_eq!(phase_error(&[3.0; NODES], &[3.0; NODES], 0.5), Err(MeasureError::Round));
}

#[test]
fn lobes_that_are_alike_give_the_shift_next_to_zero() {
    // 100° late is 20° early for three lobes
    let measured = nodes(|t| lobes(t - 100.0 / 360.0));
    let error = phase_error(&nodes(lobes), &measured, 0.5).unwrap();
    assert_eq!(error.lobes, 3);
    for estimate in [error.least_squares, error.flanks, error.maximum] {
        assert!((estimate.shift.in_deg() + 20.0).abs() < 0.01, "{error:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(test_support::size::of(40, 800)))]
    #[test]
    fn a_pure_lag_is_found_by_all_three(deg in -15.0..15.0f64, which in 0usize..3) {
        let profile = [lift, lobes, eccentric][which];
        let measured = nodes(|t| profile(t - deg / 360.0));
        let error = phase_error(&nodes(profile), &measured, 0.5).unwrap();
        let off = |e: Estimate| (e.shift.in_deg() - deg).abs();
        prop_assert!(off(error.least_squares) < 1e-3, "{error:?} {deg}");
        prop_assert!(off(error.flanks) < 0.01, "{error:?} {deg}");
        prop_assert!(off(error.maximum) < 0.05, "{error:?} {deg}");
    }

    #[test]
    fn noise_of_a_micrometre_stays_within_what_is_stated(deg in -5.0..5.0f64, seed in any::<u64>()) {
        let mut state = seed | 1;
        let mut noise = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state as f64 / u64::MAX as f64 - 0.5) * 0.002
        };
        let measured: Vec<f64> = nodes(|t| lift(t - deg / 360.0)).iter().map(|x| x + noise()).collect();
        let error = phase_error(&nodes(lift), &measured, 0.5).unwrap();
        prop_assert!((error.noise.in_um() - 0.577).abs() < 0.15, "{}", error.noise.in_um());
        for e in [error.least_squares, error.flanks] {
            let off = (e.shift.in_deg() - deg).abs();
            prop_assert!(off < 6.0 * e.sigma.in_deg() + 1e-3, "{e:?} {deg}");
        }
        prop_assert!((error.least_squares.shift.in_deg() - deg).abs() < 0.01);
    }
}
