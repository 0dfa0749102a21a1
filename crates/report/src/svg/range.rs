//! What an axis of a chart shows: its title, its ends, and where its ticks stand.
use super::{fixed, plain, powers, ticks};

/// What an axis shows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Range {
    /// Title with unit.
    pub(crate) title: String,
    /// Value at its left or lower end.
    pub(crate) from: f64,
    /// Value at its right or upper end.
    pub(crate) to: f64,
    /// The values are powers of ten: ticks stand at 1, 2, 5 and 10, and so are labelled.
    pub(crate) powers: bool,
    /// The values are counted: ticks stand at whole numbers.
    pub(crate) counted: bool,
}

impl Range {
    /// The range of some values; those that are no numbers are passed over, and without any it is 0
    /// to 1.
    pub(crate) fn of(title: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let finite = values.into_iter().filter(|v| v.is_finite());
        let (from, to) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let (from, to) = if from <= to { (from, to) } else { (0.0, 1.0) };
        let (from, to) = if to - from > 1e-9 { (from, to) } else { (from - 0.5, to + 0.5) };
        Self { title: title.into(), from, to, powers: false, counted: false }
    }

    /// The same, its values being the logarithms of what is shown.
    pub(crate) const fn powers_of_ten(mut self) -> Self {
        self.powers = true;
        self
    }

    /// The same, of what is counted.
    pub(crate) const fn counted(mut self) -> Self {
        self.counted = true;
        self
    }

    /// Where its ticks stand, and their labels.
    pub(super) fn labels(&self, at_most: usize) -> Vec<(f64, String)> {
        if self.powers {
            return powers(self.from, self.to, at_most)
                .into_iter()
                .map(|value| (value.log10(), plain(value)))
                .collect();
        }
        let found = ticks(self.from, self.to, at_most);
        if self.counted && found.step < 1.0 {
            let whole = found.values.iter().filter(|value| value.round() == **value);
            return whole.map(|value| (*value, fixed(*value, 0))).collect();
        }
        found.values.iter().map(|value| (*value, fixed(*value, found.decimals))).collect()
    }

    /// With a share of its span added at each end.
    pub(crate) fn padded(mut self, share: f64) -> Self {
        let more = (self.to - self.from) * share;
        self.from -= more;
        self.to += more;
        self
    }

    pub(super) const fn span(&self) -> f64 {
        self.to - self.from
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_is_labelled_with_plain_numbers() {
        let labels = |from: f64, to: f64| -> Vec<String> {
            let range = Range::of("", [from.log10(), to.log10()]).powers_of_ten();
            range.labels(9).into_iter().map(|(_, text)| text).collect()
        };
        assert_eq!(labels(0.2, 20.0), ["0.2", "0.5", "1", "2", "5", "10", "20"]);
        assert_eq!(labels(0.01, 1000.0), ["0.01", "0.1", "1", "10", "100", "1000"]);
        assert_eq!(labels(3.0, 4.0), ["3", "3.2", "3.4", "3.6", "3.8", "4"]);
    }

    #[test]
    fn what_is_counted_has_ticks_at_whole_numbers() {
        let labels: Vec<_> = Range::of("", [0.5, 3.5]).counted().labels(8);
        assert_eq!(labels, [1.0, 2.0, 3.0].map(|n| (n, format!("{n:.0}"))));
        assert_eq!(Range::of("", [0.5, 100.5]).counted().labels(5)[0].1, "20");
    }

    #[test]
    fn the_range_of_nothing_or_of_one_value_is_still_a_range() {
        for values in [vec![], vec![f64::NAN], vec![7.0], vec![7.0, 7.0]] {
            let range = Range::of("", values.clone());
            assert!(range.to > range.from, "{values:?}");
        }
    }
}
