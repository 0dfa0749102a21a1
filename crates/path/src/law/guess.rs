//! Where the search for a jerk-limited law begins: below what may be reached at most, and without that bound's corners, at
//! which the jerk would be many times too large.
use alloc::vec::Vec;

/// So many neighbours on either side are looked at for the slowest.
const SLOWEST: usize = 4;

/// How often values are mixed with their neighbours.
const MIXED: usize = 8;

/// Share of what may be reached at most.
const SHARE: f64 = 0.5;

/// Turns bounds into such a guess.
#[derive(Clone, Debug, Default)]
pub(super) struct Guess {
    from: Vec<f64>,
    to: Vec<f64>,
}

impl Guess {
    /// For each of `most` a value below it.
    pub(super) fn below(&mut self, most: &mut [f64]) {
        self.from.clear();
        self.from.extend_from_slice(most);
        self.to.clear();
        self.to.extend_from_slice(most);
        for _ in 0..SLOWEST {
            self.pass(|a, b, c| less(less(a, b), c));
        }
        for _ in 0..MIXED {
            self.pass(|a, b, c| 0.25 * (a + c) + 0.5 * b);
        }
        for (most, mixed) in most.iter_mut().zip(&self.from) {
            *most = SHARE * less(*most, *mixed);
        }
    }

    fn pass(&mut self, of: impl Fn(f64, f64, f64) -> f64) {
        for (to, w) in self.to.iter_mut().skip(1).zip(self.from.windows(3)) {
            *to = of(w[0], w[1], w[2]);
        }
        core::mem::swap(&mut self.from, &mut self.to);
    }
}

fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_guess_is_above_zero_and_below_what_may_be_reached(
            bounds in proptest::collection::vec(1e-6..1e6f64, 1..60),
        ) {
            let mut guess = bounds.clone();
            Guess::default().below(&mut guess);
            for (guess, most) in guess.iter().zip(&bounds) {
                prop_assert!(*guess > 0.0 && guess <= most, "{guess} of {most}");
            }
        }
    }

    #[test]
    fn a_step_becomes_a_slope() {
        let mut guess: Vec<f64> = (0..40).map(|k| if k < 20 { 1.0 } else { 100.0 }).collect();
        Guess::default().below(&mut guess);
        let steepest = guess.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        assert!(steepest < 15.0, "{steepest} of 49.5 at once");
    }
}
