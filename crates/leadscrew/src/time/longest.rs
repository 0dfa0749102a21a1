//! The operations that take the longest, of a program of any length.
//!
//! Steps of neighbouring operations may alternate where a corner is rounded: only what lies far
//! behind is over.
use std::collections::BTreeMap;
use units::Time;

/// Operations whose time may still grow.
const OPEN: usize = 4096;

/// An operation with its line and its time.
pub type Timed = (u32, (u32, Time));

/// Times by operation.
pub(super) struct Longest {
    /// How many of those that are over are kept.
    most: usize,
    over: Vec<Timed>,
    open: BTreeMap<u32, (u32, Time)>,
}

impl Longest {
    /// Of so many operations at most.
    pub(super) const fn new(most: usize) -> Self {
        Self { most, over: Vec::new(), open: BTreeMap::new() }
    }

    /// Time of an operation in a line.
    pub(super) fn add(&mut self, operation: u32, line: u32, time: Time) {
        self.open.entry(operation).or_insert((line, Time::ZERO)).1 += time;
        if self.open.len() >= 2 * OPEN {
            let first = self.open.keys().nth(OPEN).copied().unwrap_or(0);
            let still_open = self.open.split_off(&first);
            let over = std::mem::replace(&mut self.open, still_open);
            self.over.extend(over);
            keep(&mut self.over, self.most);
        }
    }

    /// The longest ones, in the order of the program.
    pub(super) fn all(&self) -> Vec<Timed> {
        let open = self.open.iter().map(|(operation, time)| (*operation, *time));
        let mut all: Vec<_> = self.over.iter().copied().chain(open).collect();
        keep(&mut all, self.most);
        all
    }
}

/// Leave the longest ones, by their numbers.
fn keep(all: &mut Vec<Timed>, most: usize) {
    if most < all.len() {
        all.sort_by(|a, b| b.1.1.value().total_cmp(&a.1.1.value()));
        all.truncate(most);
    }
    all.sort_by_key(|(operation, _)| *operation);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_are_found_in_a_program_of_any_length_and_little_is_kept() {
        let mut longest = Longest::new(3);
        for operation in 0..100_000_u32 {
            let time = if operation % 40_000 == 7 { 2.0 } else { 0.5 };
            longest.add(operation, operation + 1, Time::s(time));
            longest.add(operation.saturating_sub(1), 0, Time::s(0.25)); // a rounded corner
        }
        let found: Vec<_> = longest.all().iter().map(|(operation, _)| *operation).collect();
        assert_eq!(found, [7, 40_007, 80_007]);
        assert_eq!(longest.all()[1].1, (40_008, Time::s(2.25)));
        assert!(longest.over.len() <= 3 && longest.open.len() < 2 * OPEN);
    }

    #[test]
    fn all_are_kept_where_all_are_asked_for() {
        let mut longest = Longest::new(usize::MAX);
        (0..20_000).for_each(|operation| longest.add(operation, 1, Time::s(1.0)));
        assert_eq!(longest.all().len(), 20_000);
    }
}
