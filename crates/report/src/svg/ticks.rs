//! Ticks at round numbers: the step is 1, 2 or 5 times a power of ten.
//!
//! ```text
//!   step = smallest of {1, 2, 5} · 10ⁿ with (to − from) / step ≤ at_most
//! ```

/// Where an axis has its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    /// Distance from one to the next.
    pub(crate) step: f64,
    /// Their values, rising, all within the range.
    pub(crate) values: Vec<f64>,
    /// Decimals that their labels need.
    pub(crate) decimals: usize,
}

/// Ticks of a range: at most `at_most` steps. A range that is empty or no number has none.
pub(crate) fn ticks(from: f64, to: f64, at_most: usize) -> Ticks {
    let span = to - from;
    if !(span.is_finite() && span > 0.0) || at_most == 0 {
        return Ticks { step: 1.0, values: Vec::new(), decimals: 0 };
    }
    let raw = span / at_most as f64;
    let power = raw.log10().floor() as i32;
    // 1e-9: a step that fits but for rounding is taken
    let fits = |factor: f64| factor * 10f64.powi(power) >= raw * (1.0 - 1e-9);
    let (factor, power) = match [1.0, 2.0, 5.0].into_iter().find(|&f| fits(f)) {
        Some(factor) => (factor, power),
        None => (1.0, power + 1),
    };
    let step = factor * 10f64.powi(power);
    let first = (from / step - 1e-9).ceil() as i64;
    let last = (to / step + 1e-9).floor() as i64;
    let values = (first..=last).take(at_most + 2).map(|i| i as f64 * step).collect();
    Ticks { step, values, decimals: (-power).max(0) as usize }
}

/// Ticks of a logarithmic axis whose ends are these logarithms: 1, 2, 5 and 10 times powers of ten,
/// only the powers where that would be too many; round numbers between where there is less than one
/// of them.
pub(crate) fn powers(from: f64, to: f64, at_most: usize) -> Vec<f64> {
    if !(from.is_finite() && to.is_finite() && to > from) {
        return Vec::new();
    }
    let (low, high) = (from.floor() as i32, to.ceil() as i32);
    let within = |value: &f64| {
        let at = value.log10();
        at >= from - 1e-9 && at <= to + 1e-9
    };
    let of = |factors: &[f64], step: i32| -> Vec<f64> {
        (low..=high)
            .filter(|power| power.rem_euclid(step) == 0)
            .flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)))
            .filter(within)
            .collect()
    };
    let fine = of(&[1.0, 2.0, 5.0], 1);
    if fine.len() < 3 {
        return ticks(10f64.powf(from), 10f64.powf(to), at_most).values;
    }
    if fine.len() <= at_most {
        return fine;
    }
    (1..=600)
        .map(|step| of(&[1.0], step))
        .find(|ticks| ticks.len() <= at_most.max(2))
        .unwrap_or_default()
}

/// A tick's label: as many decimals as it has.
pub(crate) fn plain(value: f64) -> String {
    let decimals = (0..9).find(|d| {
        let scaled = value * 10f64.powi(*d);
        (scaled - scaled.round()).abs() < 1e-6 * scaled.abs()
    });
    super::fixed(value, decimals.unwrap_or(9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::fixed;

    fn check(from: f64, to: f64, at_most: usize) -> String {
        let found = ticks(from, to, at_most);
        let labels: Vec<_> = found.values.iter().map(|v| fixed(*v, found.decimals)).collect();
        labels.join(" ")
    }

    #[test]
    fn ticks_stand_at_one_two_or_five_times_a_power_of_ten() {
        insta::assert_snapshot!(check(0.0, 10.0, 5), @"0 2 4 6 8 10");
        insta::assert_snapshot!(check(-14.2, 13.9, 6), @"-10 -5 0 5 10");
        insta::assert_snapshot!(check(0.0, 0.31, 7), @"0.00 0.05 0.10 0.15 0.20 0.25 0.30");
        insta::assert_snapshot!(check(0.0, 6000.0, 6), @"0 1000 2000 3000 4000 5000 6000");
        insta::assert_snapshot!(check(-412.7, -388.1, 5), @"-410 -405 -400 -395 -390");
    }

    #[test]
    fn a_range_that_is_empty_or_no_number_has_no_ticks() {
        for (from, to) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert_eq!(ticks(from, to, 5).values, Vec::<f64>::new());
        }
    }

    #[test]
    fn there_are_two_ticks_at_least_and_never_more_steps_than_asked_for() {
        for k in 1..400 {
            let span = 1e-4 * 1.07f64.powi(k);
            for at_most in [5, 6, 8] {
                let found = ticks(-0.3 * span, 0.7 * span, at_most);
                assert!((2..=at_most + 1).contains(&found.values.len()), "{span} {at_most}");
            }
        }
    }
}
