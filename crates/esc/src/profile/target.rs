//! The setpoint of position in CSP: where none comes, the drive goes on as it went last.

/// Periods that are bridged in a row; then it stays where it is.
const MOST_BRIDGED: u8 = 3;

/// Setpoint that is in force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CyclicTarget {
    pub(crate) counts: i32,
    step: i32,
    bridged: u8,
}

impl CyclicTarget {
    /// Takes the setpoint of a period; `is_told`: it has come since the last one. Another one than
    /// before has come, by whatever way.
    pub(crate) fn take(&mut self, counts: i32, is_told: bool) {
        if is_told || counts != self.told() {
            let periods = i32::from(self.bridged) + 1;
            let step = counts.wrapping_sub(self.told()) / periods;
            *self = Self { counts, step, bridged: 0 };
        } else if self.bridged < MOST_BRIDGED {
            self.counts = self.counts.wrapping_add(self.step);
            self.bridged += 1;
        }
    }

    /// The setpoint that came last.
    const fn told(&self) -> i32 {
        self.counts.wrapping_sub(self.step.wrapping_mul(self.bridged as i32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn setpoints_that_do_not_come_are_bridged_at_the_last_step() {
        let mut target = CyclicTarget::default();
        let taken = [Some(100), Some(110), None, None, Some(140), None, None, None, None, None];
        let mut last = 0;
        let counts = taken.map(|told| {
            last = told.unwrap_or(last);
            target.take(last, told.is_some());
            target.counts
        });
        assert_eq!(counts, [100, 110, 120, 130, 140, 150, 160, 170, 170, 170]);
    }

    #[test]
    fn it_goes_on_over_the_end_of_32_bits() {
        let mut target = CyclicTarget { counts: i32::MAX - 5, ..CyclicTarget::default() };
        target.take(i32::MAX - 1, true);
        target.take(i32::MAX - 1, false);
        assert_eq!(target.counts, i32::MIN + 2);
    }
}
