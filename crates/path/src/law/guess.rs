//! Where the search for a jerk-limited law begins: below what may be reached at most, and without
//! that bound's corners, at which the jerk would be many times too large.
use alloc::collections::VecDeque;
use alloc::vec::Vec;

/// No cell takes longer than so many times as far as is looked: a search does not find out of rest.
const LONGEST: f64 = 40.0;

/// Share of what may be reached at most.
const SHARE: f64 = 0.5;

/// Turns bounds into such a guess.
#[derive(Clone, Debug, Default)]
pub(super) struct Guess {
    /// When each cell begins, as fast as it may be at most, and when the last one ends.
    edge: Vec<f64>,
    /// The slowest near it, its integral up to each edge, and its mean.
    value: Vec<f64>,
    sum: Vec<f64>,
    mean: Vec<f64>,
    /// Cells of a window, slowest first.
    slowest: VecDeque<usize>,
}

impl Guess {
    /// For each of `most`, the largest ṡ² of cells of such lengths, a value below it: the mean,
    /// over a time on either side, of the slowest so near; but no standstill.
    pub(super) fn below(
        &mut self,
        most: &mut [f64],
        lengths: impl Iterator<Item = f64> + Clone,
        near: f64,
    ) {
        self.edge.clear();
        self.edge.push(0.0);
        let mut at = 0.0;
        for (most, length) in most.iter().zip(lengths.clone()) {
            at += (length / libm::sqrt(*most)).min(LONGEST * near);
            self.edge.push(at);
        }
        self.slow(most, near);
        self.average(near);
        for ((most, mean), length) in most.iter_mut().zip(&self.mean).zip(lengths) {
            // there is none over no time
            let below = SHARE * if *mean < *most { *mean } else { *most };
            let least = length / (LONGEST * near);
            *most = below.max(least * least);
        }
    }

    /// The slowest of what is so near in time.
    fn slow(&mut self, most: &[f64], near: f64) {
        self.value.clear();
        self.slowest.clear();
        let mut next = 0;
        for i in 0..most.len() {
            while next < most.len() && self.edge[next] <= self.edge[i + 1] + near {
                while self.slowest.back().is_some_and(|last| most[*last] >= most[next]) {
                    self.slowest.pop_back();
                }
                self.slowest.push_back(next);
                next += 1;
            }
            while self.slowest.front().is_some_and(|k| self.edge[k + 1] < self.edge[i] - near) {
                self.slowest.pop_front();
            }
            self.value.push(self.slowest.front().map_or(most[i], |k| most[*k]));
        }
    }

    /// The mean over what is so near in time to each cell's middle.
    fn average(&mut self, near: f64) {
        self.sum.clear();
        self.sum.push(0.0);
        let mut sum = 0.0;
        for (value, edges) in self.value.iter().zip(self.edge.windows(2)) {
            sum += value * (edges[1] - edges[0]);
            self.sum.push(sum);
        }
        let (count, end) = (self.value.len(), self.edge[self.value.len()]);
        let (mut low, mut high) = (0, 0);
        let until = |at: f64, cell: &mut usize| {
            while *cell + 1 < count && self.edge[*cell + 1] < at {
                *cell += 1;
            }
            let [from, to] = [self.edge[*cell], self.edge[*cell + 1]];
            let share = if to > from { (at - from) / (to - from) } else { 0.0 };
            self.sum[*cell] + share * (self.sum[*cell + 1] - self.sum[*cell])
        };
        self.mean.clear();
        for i in 0..count {
            let middle = f64::midpoint(self.edge[i], self.edge[i + 1]);
            let (from, to) = ((middle - near).max(0.0), (middle + near).min(end));
            self.mean.push((until(to, &mut high) - until(from, &mut low)) / (to - from));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_guess_moves_and_is_below_what_may_be_reached_unless_that_is_nearly_rest(
            cells in proptest::collection::vec((1e-6..1e6f64, -7..1i32), 1..60),
        ) {
            let (bounds, widths): (Vec<f64>, Vec<i32>) = cells.into_iter().unzip();
            let mut guess = bounds.clone();
            let lengths = widths.iter().map(|width| 10.0_f64.powi(*width));
            Guess::default().below(&mut guess, lengths.clone(), 0.006);
            for ((guess, most), length) in guess.iter().zip(&bounds).zip(lengths) {
                let time = length / guess.sqrt();
                prop_assert!(guess <= most || time > 0.2, "{guess} of {most}");
                prop_assert!(time < 0.25, "{time} s");
            }
        }
    }

    /// From 10 to 100 mm/s at once, in cells of 1 ms and, where it happens, of a thousandth of
    /// that.
    #[test]
    fn a_step_becomes_a_slope_in_time_however_long_the_cells_are() {
        let speed = |k: usize| if k < 20 { 10.0 } else { 100.0 };
        let length = |k: usize| speed(k) * if (18..22).contains(&k) { 1e-6 } else { 1e-3 };
        let mut guess: Vec<f64> = (0..40).map(|k| speed(k) * speed(k)).collect();
        Guess::default().below(&mut guess, (0..40).map(length), 5e-3);
        let steepest = guess.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        assert!(steepest < 600.0, "{steepest} of 4950 at once");
        let least = guess[17..22].windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        assert!(least < 300.0, "{least} within a microsecond");
    }
}
