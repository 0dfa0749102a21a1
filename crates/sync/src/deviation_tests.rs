//! Closed forms of deviations, and random tables.
use super::*;
use proptest::prelude::*;
use std::vec;

fn straight(per_unit: f64) -> DeviationTable {
    let point = |at: f64| DeviationPoint { at, up: per_unit * at, down: per_unit * at };
    DeviationTable { points: vec![point(-400.0), point(0.0)], ..DeviationTable::default() }
}

#[test]
fn a_screw_with_a_constant_error_of_lead_is_a_straight_line() {
    let screw = Deviation::new(&straight(40e-6));
    for at in [-400.0, -123.456, -1.0, 0.0] {
        let found = screw.at(at, 0.3);
        assert!((found.value - 40e-6 * at).abs() < 1e-15, "{at}: {found:?}");
        assert!((found.slope - 40e-6).abs() < 1e-18 && found.curvature.abs() < 1e-15);
    }
    assert_eq!(screw.bounds_of_points().0, 40e-6);
}

#[test]
fn play_is_half_to_each_side() {
    let table = DeviationTable { backlash: 0.02, ..DeviationTable::default() };
    let play = Deviation::new(&table);
    // driven towards plus the slide hangs back by half of the play
    for (flank, value) in [(1.0, -0.01), (0.5, 0.0), (0.0, 0.01)] {
        assert_eq!(play.at(7.0, flank).value, value);
    }
    assert_eq!((play.across(3.0), play.reversal()), (-0.02, 0.02));
}

#[test]
fn an_error_per_turn_is_its_sine() {
    let waves = vec![
        DeviationWave { order: 1, amplitude: 3e-3, phase_rev: 0.25 },
        DeviationWave { order: 2, amplitude: 1e-3, phase_rev: 0.0 },
    ];
    let screw = Deviation::new(&DeviationTable { waves, turn: 16.0, ..Default::default() });
    for at in [-33.3, 0.0, 2.0, 777.7] {
        let turn = TAU * at / 16.0;
        let expected = 3e-3 * turn.cos() + 1e-3 * (2.0 * turn).sin();
        assert!((screw.at(at, 1.0).value - expected).abs() < 1e-12, "{at}");
    }
    let (slope, curvature) = screw.bounds_of_waves();
    assert!((slope - TAU / 16.0 * 5e-3).abs() < 1e-15, "{slope}");
    assert!((curvature - (TAU / 16.0).powi(2) * 7e-3).abs() < 1e-15, "{curvature}");
}

#[test]
fn behind_its_ends_the_slope_runs_out_and_the_value_holds() {
    let screw = Deviation::new(&straight(1e-4));
    // half of the slope over an interval of 400 is left behind
    assert!((screw.at(400.0, 0.0).value - 0.02).abs() < 1e-15);
    assert_eq!(screw.at(400.0, 0.0), screw.at(1e6, 0.0));
    assert!((screw.at(-1e6, 0.0).value + 0.06).abs() < 1e-15);
}

#[test]
fn a_table_that_repeats_is_the_same_a_turn_on() {
    let points = [(0.0, 1e-3), (90.0, -2e-3), (200.0, 0.0), (300.0, 4e-3)];
    let points = points.map(|(at, up)| DeviationPoint { at, up, down: up }).to_vec();
    let table = DeviationTable { points, repeats: Some(360.0), ..Default::default() };
    let worm = Deviation::new(&table);
    for at in [0.0, 17.0, 250.0, 359.0] {
        let (here, there) = (worm.at(at, 0.0), worm.at(at + 3.0 * 360.0, 0.0));
        assert!((here.value - there.value).abs() < 1e-12, "{at}");
        assert!((worm.at(at - 720.0, 0.0).slope - here.slope).abs() < 1e-12, "{at}");
    }
    let (before, after) = (worm.at(360.0 - 1e-9, 0.0), worm.at(360.0 + 1e-9, 0.0));
    assert!((before.slope - after.slope).abs() < 1e-12, "no kink where it closes");
}

/// Tables as machines have them: slopes up to 5 %.
fn tables() -> impl Strategy<Value = DeviationTable> {
    let point = (5.0..60.0_f64, -0.05..0.05_f64, -0.02..0.02_f64);
    let wave = (1_u32..5, 0.0..1e-2_f64, 0.0..1.0_f64);
    (prop::collection::vec(point, 0..30), prop::collection::vec(wave, 0..4), 0.0..0.05_f64)
        .prop_filter("none or two at least", |(points, ..)| points.len() != 1)
        .prop_map(|(points, waves, backlash)| {
            let mut at = -500.0;
            let points = points.into_iter().map(|(further, up, apart)| {
                at += further;
                DeviationPoint { at, up, down: up + apart }
            });
            let waves = waves.into_iter().map(|(order, amplitude, phase_rev)| DeviationWave {
                order,
                amplitude,
                phase_rev,
            });
            DeviationTable {
                points: points.collect(),
                waves: waves.collect(),
                turn: 10.0,
                backlash,
                repeats: None,
            }
        })
}

proptest! {
    #[test]
    fn what_is_taken_off_is_put_on_again(
        table in tables(), at in -700.0..700.0_f64, flank in 0.0..1.0_f64
    ) {
        let screw = Deviation::new(&table);
        let slide = at + screw.at(at, flank).value;
        prop_assert!((screw.encoder_position(slide, flank) - at).abs() < 1e-9);
        let position = screw.encoder_position(at, flank);
        prop_assert!((position + screw.at(position, flank).value - at).abs() < 1e-9);
    }

    #[test]
    fn it_passes_through_its_points_and_lies_between_them(table in tables(), share in 0.0..1.0_f64) {
        let screw = Deviation::new(&DeviationTable { waves: vec![], backlash: 0.0, ..table.clone() });
        for pair in table.points.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            prop_assert!((screw.at(from.at, 1.0).value - from.up).abs() < 1e-12);
            prop_assert!((screw.at(to.at, 0.0).value - to.down).abs() < 1e-12);
            let between = screw.at(from.at + share * (to.at - from.at), 1.0).value;
            let (low, high) = (from.up.min(to.up), from.up.max(to.up));
            prop_assert!(between >= low - 1e-12 && between <= high + 1e-12);
        }
    }

    #[test]
    fn slope_and_curvature_are_derivatives_and_within_their_bounds(
        table in tables(), at in -700.0..700.0_f64, flank in 0.0..1.0_f64
    ) {
        const H: f64 = 1e-5;
        let screw = Deviation::new(&table);
        let (before, here, after) =
            (screw.at(at - H, flank), screw.at(at, flank), screw.at(at + H, flank));
        prop_assert!(((after.value - before.value) / (2.0 * H) - here.slope).abs() < 1e-6);
        // no kink: the slope is continuous
        prop_assert!((after.slope - before.slope).abs() < 1e-4);
        let ((slope, curvature), (steep, sharp)) =
            (screw.bounds_of_points(), screw.bounds_of_waves());
        prop_assert!(here.slope.abs() <= slope + steep + 1e-12);
        prop_assert!(here.curvature.abs() <= curvature + sharp + 1e-12);
        let within = screw.points().first().is_none_or(|first| *first <= at)
            && screw.points().last().is_none_or(|last| at <= *last);
        prop_assert!(!within || here.value.abs() <= screw.largest().1 + 1e-12);
    }
}
