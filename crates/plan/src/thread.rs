//! How long a corner of a turned thread must be, for what the axes can do: see
//! [`motion::ThreadStretch`] for its law.

/// How far P″ goes beyond 0 and 1: at u² = 3/5, 9u/8 − 5u³/8 − ½.
const BEYOND: f64 = 0.081;

/// How the law of one axis changes at a corner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Change {
    /// By how much its slope does, mm/rev.
    pub(crate) slope: f64,
    /// By how much its bend does, mm/rev².
    pub(crate) bend: f64,
    /// The larger bend of both sides, magnitude, mm/rev².
    pub(crate) most_bend: f64,
}

impl Change {
    /// Turns to each side of a corner over which the law of an axis may change so at `n` rev/s,
    /// where that is limited to `accel`, mm/s², and `jerk`, mm/s³. Infinite where the bends alone
    /// are more than the axis can.
    pub(crate) fn half(&self, n: f64, accel: f64, jerk: f64) -> f64 {
        let (slope, bend) = (self.slope.abs(), self.bend.abs());
        let left = accel - (self.most_bend + BEYOND * bend) * n * n;
        if left <= 0.0 {
            return f64::INFINITY;
        }
        let by_accel = 0.75 * slope * n * n / left;
        // the root of jerk·h² = 9/8·|Δb|·n³·h + 3/2·|Δs|·n³
        let (b, c) = (1.125 * bend * n * n * n / jerk, 1.5 * slope * n * n * n / jerk);
        by_accel.max(b / 2.0 + libm::sqrt(b * b / 4.0 + c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use motion::{Corner, ThreadStretch};
    use proptest::prelude::*;

    proptest! {
        /// The acceleration and the jerk of a corner are what the planner has made it long enough
        /// for.
        #[test]
        fn a_corner_keeps_the_limits(
            slope in -5.0_f64..5.0, bends in (-0.5_f64..0.5, -0.5_f64..0.5), n in 1.0_f64..60.0, at in -1.0_f64..1.0,
        ) {
            let (accel, jerk) = (4e3, 3e5);
            let change = Change { slope, bend: bends.1 - bends.0, most_bend: bends.0.abs().max(bends.1.abs()) };
            let half = change.half(n, accel, jerk);
            // far longer than its corners are: the one at its end is none
            let turns = 1e3;
            let stretch = ThreadStretch {
                spindle: 0,
                start: None,
                ends: false,
                from: [0.0; 3],
                to: [(slope + bends.1 * turns / 2.0) * turns, 0.0, 0.0],
                from_turn: 0.0,
                to_turn: turns,
                bend: [bends.1, 0.0, 0.0],
                entry: Corner { bend: [bends.0, 0.0, 0.0], half, ..Corner::default() },
                exit: Corner { bend: [bends.1, 0.0, 0.0], ..Corner::default() },
            };
            let on = stretch.at(at * half);
            prop_assert!(on.bend[0].abs() * n * n <= accel * (1.0 + 1e-9));
            prop_assert!(on.third[0].abs() * n * n * n <= jerk * (1.0 + 1e-9));
        }
    }
}
