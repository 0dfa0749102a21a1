//! Strokes at random over a stock at random: what is not in it where it was ordered never passes.
use crate::common::{self, Record, config, drilling, hole_ops, judge_with, stock_at, tools};
use proptest::prelude::*;
use test_support::size;
use units::Length;
use verify::{Config, Feature, Judge, Stock};

/// Coordinate of the tip where the records have the program's zero.
const ZERO_MM: f64 = common::SURFACE_MM - common::LENGTH_MM;

/// How far the tool goes from one sample of the records to the next, at most.
const SAMPLE_WAY_MM: f64 = 0.03;

/// A hole 12 mm deep, drilled as ordered.
fn drilled(stock: Stock) -> Feature {
    let mut judge = Judge::new(Config { stock: Some(stock), ..config(tools()) });
    for (index, op) in hole_ops(7, [30.0, 20.0], 12.0).iter().enumerate() {
        judge.op(index as u32, op);
    }
    for sample in drilling(0, 1, [30.0, 20.0], 12.0) {
        judge.sample(&sample);
    }
    judge.finish().remove(0)
}

/// An M6, 14 mm deep, cut as ordered.
fn tapped(stock: Stock) -> Feature {
    let config = Config { stock: Some(stock), ..config(tools()) };
    judge_with(config, &Record::new(2, 1.0), |_, _| 0.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(48, 960)))]

    #[test]
    fn a_zero_that_is_off_the_works_fails_by_just_as_much_and_one_that_is_not_passes(
        off_mm in prop_oneof![-40.0..-0.11, 0.11..40.0], above_mm in 0.0..1.8_f64,
    ) {
        // what is to be faced off lies above the zero, and below the R plane
        let clamped = |zero: f64| stock_at(zero + above_mm, zero);
        for (cut, ordered) in [(drilled as fn(Stock) -> Feature, 12.0_f64), (tapped, 14.0)] {
            prop_assert!(cut(clamped(ZERO_MM)).verdict.is_pass());
            let shifted = cut(clamped(ZERO_MM + off_mm));
            prop_assert!(!shifted.verdict.is_pass(), "{off_mm}: {shifted:?}");
            // how far it really was in the stock
            let reach = shifted.contact.reach.map_or(f64::NAN, Length::value);
            let really = f64::clamp(ordered + above_mm + off_mm, 0.0, 40.0);
            prop_assert!((reach - really).abs() < SAMPLE_WAY_MM, "{reach} mm, really {really} mm");
            // what was in the stock by less than that may lie between two samples: it may be seen
            // or not
            if really == 0.0 || really > SAMPLE_WAY_MM {
                prop_assert_eq!(shifted.contact.is_cut(), really > 0.0, "{} mm", really);
            }
        }
    }

    #[test]
    fn a_hole_is_good_only_where_the_stock_is_all_around_it(side_mm in -10.0..70.0_f64, axis in 0..2_usize) {
        let whole = stock_at(ZERO_MM, ZERO_MM);
        let mut to = whole.to;
        to[axis] = Length::mm(side_mm);
        let stock = Stock { to, ..whole };
        let at = [30.0, 20.0][axis];
        for (cut, radius) in [(drilled as fn(Stock) -> Feature, 2.5), (tapped, 3.0)] {
            let feature = cut(stock);
            prop_assert_eq!(feature.verdict.is_pass(), side_mm >= at + radius, "{:?}", feature);
            prop_assert_eq!(feature.contact.is_cut(), side_mm > at - radius);
        }
    }
}
