//! When each operation of a program ends, as it was planned: what is left of it is known to the
//! operation that is executed.
//!
//! ```text
//!   0 ──op 0──┤──op 1──┤────── op 2 ──────┤ … ┤ planned
//!                             ▲
//!                             └ since it began, at most as long as it is planned to take
//! ```
use plan::{Clock, MachineLimits, Step};
use units::Time;

/// Ends of operations that take time, in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Timeline {
    ends: Vec<(u32, Time)>,
}

impl Timeline {
    /// A step of this operation ends then.
    pub(super) fn note(&mut self, op: u32, end: Time) {
        match self.ends.last_mut() {
            Some(last) if last.0 >= op => last.1 = end,
            _ => self.ends.push((op, end)),
        }
    }

    /// From start to end.
    pub(super) fn planned(&self) -> Time {
        self.ends.last().map_or(Time::ZERO, |(_, end)| *end)
    }

    /// What is left when this operation has been executed for so long.
    pub(super) fn left(&self, op: u32, since: Time) -> Time {
        let next = self.ends.partition_point(|(known, _)| *known < op);
        let begins = next.checked_sub(1).map_or(Time::ZERO, |before| self.ends[before].1);
        let own_end = self.ends.get(next).filter(|(known, _)| *known == op).map(|(_, end)| *end);
        let planned = self.planned();
        let done = own_end.map_or(Time::ZERO, |end| since.min(end - begins));
        (planned - begins - done).max(Time::ZERO)
    }
}

/// Makes the timeline of steps as they are planned.
pub(super) struct Noting {
    limits: MachineLimits,
    clock: Clock,
    pub(super) timeline: Timeline,
}

impl Noting {
    /// On a machine with these limits.
    pub(super) fn new(limits: MachineLimits) -> Self {
        Self { limits, clock: Clock::default(), timeline: Timeline::default() }
    }

    /// The next step.
    pub(super) fn step(&mut self, step: &Step) {
        self.clock.count(step, &self.limits);
        self.timeline.note(step.op, self.clock.elapsed());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_falls_with_time_and_waits_where_an_operation_takes_longer_than_planned() {
        let mut timeline = Timeline::default();
        for (op, end) in [(0, 2.0), (2, 3.0), (2, 5.0), (7, 9.0)] {
            timeline.note(op, Time::s(end));
        }
        let left = |op, since| timeline.left(op, Time::s(since)).value();
        assert_eq!(left(0, 0.0), 9.0);
        assert_eq!(left(0, 0.5), 8.5);
        assert_eq!(left(0, 60.0), 7.0, "it is held");
        assert_eq!(left(1, 3.0), 7.0, "an operation that takes no time");
        assert_eq!(left(2, 1.0), 6.0);
        assert_eq!(left(7, 9.0), 0.0);
        assert_eq!(left(8, 0.0), 0.0);
        assert_eq!(Timeline::default().left(3, Time::ZERO), Time::ZERO);
    }
}
