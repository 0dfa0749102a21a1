//! Chip removal, as it was seen: ordered is not done.
//!
//! ```text
//!   spindle  ──╲            ╱──     seen: after the order, and before the next one, the spindle's real speed
//!                ╲        ╱         came to the ordered one against the cut, within 2 %
//!                  ╲____╱
//! ```
use bus::Sample;
use std::collections::VecDeque;
use units::{Angle, Spin, Time};

/// Of the ordered speed, what must be reached.
const REACHED: f64 = 0.98;

/// One order that has not been seen obeyed.
#[derive(Clone, Copy, Debug)]
struct OrderedRemoval {
    op: u32,
    /// First op of the feature that it follows.
    feature: u32,
    throw: Spin,
}

/// Orders still to be seen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Removals {
    ordered: VecDeque<OrderedRemoval>,
    before: Option<(Time, Angle)>,
}

impl Removals {
    /// An op orders it, after a feature that began with op `feature`.
    pub(crate) fn order(&mut self, op: u32, feature: u32, throw: Spin) {
        self.ordered.push_back(OrderedRemoval { op, feature, throw });
    }

    /// One servo period; the first op of the feature whose chips have just been thrown off.
    pub(crate) fn sample(&mut self, sample: &Sample) -> Option<u32> {
        let (time, angle) = (sample.feedback.time, sample.spindle(0));
        let (since, from) = self.before.replace((time, angle))?;
        let op = sample.report.op;
        while self.ordered.get(1).is_some_and(|next| next.op <= op) {
            self.ordered.pop_front(); // too late for the one before
        }
        let order = *self.ordered.front().filter(|order| order.op <= op)?;
        let spin = (angle - from) / (time - since);
        if spin / order.throw >= REACHED {
            self.ordered.pop_front();
            return Some(order.feature);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What was seen of a spindle that turns at these speeds, rev/s, a millisecond each, all in
    /// op 5.
    fn seen(speeds: &[f64]) -> Option<u32> {
        let mut removals = Removals::default();
        removals.order(5, 3, Spin::rev_per_s(-10.0));
        let (mut sample, mut found) = (Sample::default(), None);
        sample.report.op = 5;
        for speed in speeds {
            sample.feedback.time += Time::s(1e-3);
            sample.feedback.spindles[0].angle += Angle::rev(speed * 1e-3);
            found = found.or(removals.sample(&sample));
        }
        found
    }

    #[test]
    fn a_reversal_counts_once_its_speed_is_reached() {
        assert_eq!(seen(&[50.0, 20.0, -5.0, -9.9, 0.0, 50.0]), Some(3));
    }

    #[test]
    fn a_stop_or_half_a_reversal_does_not() {
        assert_eq!(seen(&[50.0, 20.0, -5.0, -9.0, 0.0, 50.0]), None);
        assert_eq!(seen(&[50.0, 10.0, 0.0, 10.0]), None);
    }
}
