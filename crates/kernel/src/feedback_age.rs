//! Whether what the machine says is new: the time of its feedback goes on by a period in a period.
//!
//! ```text
//!   time │        ╱   a frame that is lost, or two, are lived through; a third is too old to close a loop with
//!        │   ____╱    time that goes back, or jumps by more than [`JUMP`] periods, is no time
//!        └────────► ticks
//! ```
//!
//! A control that was late fills in the readings that it missed before it ticks, so that a jump is
//! none to the kernel.
use crate::config::Subject;
use crate::drives::Finding;
use crate::fault::FaultKind;
use units::Time;

/// So many periods in a row may bring nothing new: single frames of a field bus are lost.
const LOST: u32 = 2;
/// Time that goes on by so many periods at once has jumped.
const JUMP: f64 = 10.0;
/// Time has gone on if it has by this share of a period.
const GOES_ON: f64 = 0.5;

/// The time of the last feedback.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FeedbackAge {
    last: Option<Time>,
    lost: u32,
    found: bool,
}

impl FeedbackAge {
    /// The last feedback brought nothing new.
    pub(crate) const fn is_lost(&self) -> bool {
        self.lost > 0
    }

    /// Periods in a row that have brought nothing new.
    pub(crate) const fn lost(&self) -> u32 {
        self.lost
    }

    /// Whether a feedback of this time is new; `runs`: the loops are closed. It is said once.
    pub(crate) fn check(&mut self, time: Time, period: Time, runs: bool) -> Result<(), Finding> {
        let Some(last) = self.last.replace(time).filter(|_| runs) else {
            *self = Self { last: Some(time), ..Self::default() };
            return Ok(());
        };
        let by = time - last;
        self.lost = if by < period * GOES_ON { self.lost + 1 } else { 0 };
        let stale = |value: Time, limit: Time| {
            Err((FaultKind::FeedbackStale, Subject::Machine, value.value(), limit.value()))
        };
        if self.found {
            return Ok(());
        }
        self.found = true;
        if by < Time::ZERO {
            stale(by, Time::ZERO)
        } else if by > period * JUMP {
            stale(by, period * JUMP)
        } else if self.lost > LOST {
            stale(period * f64::from(self.lost), period * f64::from(LOST))
        } else {
            self.found = false;
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The periods in which something is found wrong with these times, in periods.
    fn found(times: &[f64]) -> Option<usize> {
        let period = Time::s(250e-6);
        let mut age = FeedbackAge::default();
        times.iter().position(|at| age.check(period * *at, period, true).is_err())
    }

    #[test]
    fn time_that_goes_on_is_new() {
        assert_eq!(found(&[0.0, 1.0, 2.0, 3.0, 4.1, 5.0]), None);
    }

    #[test]
    fn two_lost_frames_are_lived_through_and_a_third_is_too_old() {
        assert_eq!(found(&[0.0, 1.0, 1.0, 1.0, 4.0, 5.0, 5.0, 5.0, 8.0]), None);
        assert_eq!(found(&[0.0, 1.0, 1.0, 1.0, 1.0]), Some(4));
    }

    #[test]
    fn time_that_goes_back_or_jumps_is_none() {
        assert_eq!(found(&[7.0, 8.0, 7.0]), Some(2));
        assert_eq!(found(&[0.0, 1.0, 12.0]), Some(2));
    }
}
