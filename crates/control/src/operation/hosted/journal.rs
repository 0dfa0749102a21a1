//! The last events, numbered: any number of clients read them, each from where it has come to.
use crate::operation::Event;
use std::collections::VecDeque;
use std::sync::Arc;
use units::Time;

/// Events that are kept.
pub const MOST_EVENTS: usize = 1024;

/// An event, when it happened, and its number: the first is 1.
#[derive(Clone, Debug)]
pub struct Journaled {
    /// Its number.
    pub id: u64,
    /// Machine time.
    pub time: Time,
    /// What has happened.
    pub event: Arc<Event>,
}

/// The last events.
#[derive(Debug, Default)]
pub struct Journal {
    kept: VecDeque<Journaled>,
    last: u64,
}

impl Journal {
    /// One more; the oldest goes.
    pub(super) fn push(&mut self, time: Time, event: Event) {
        self.last += 1;
        if self.kept.len() == MOST_EVENTS {
            self.kept.pop_front();
        }
        self.kept.push_back(Journaled { id: self.last, time, event: Arc::new(event) });
    }

    /// What has happened after an event, oldest first; how many are no longer kept; the last one
    /// that there is.
    pub fn after(&self, id: u64) -> (Vec<Journaled>, u64, u64) {
        let oldest = self.kept.front().map_or(self.last + 1, |event| event.id);
        let lost = oldest.saturating_sub(id.saturating_add(1));
        let skipped = (id.saturating_add(1)).saturating_sub(oldest);
        let skipped = usize::try_from(skipped).unwrap_or(usize::MAX);
        (self.kept.iter().skip(skipped).cloned().collect(), lost, self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(count: u64) -> Journal {
        let mut journal = Journal::default();
        for number in 1..=count {
            journal.push(Time::s(number as f64), Event::Notice(number.to_string()));
        }
        journal
    }

    #[test]
    fn a_client_reads_on_from_where_it_has_come_to() {
        let journal = of(5);
        let (events, lost, last) = journal.after(3);
        assert_eq!(events.iter().map(|e| e.id).collect::<Vec<_>>(), [4, 5]);
        assert_eq!((lost, last), (0, 5));
        assert!(journal.after(5).0.is_empty());
        assert!(journal.after(u64::MAX).0.is_empty());
    }

    #[test]
    fn a_client_that_comes_too_late_is_told_how_much_it_has_missed() {
        let journal = of(MOST_EVENTS as u64 + 10);
        let (events, lost, _) = journal.after(4);
        assert_eq!((events.len(), lost), (MOST_EVENTS, 6), "1 to 10 are gone, 5 to 10 not read");
    }
}
