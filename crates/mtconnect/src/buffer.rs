//! Observations in the order of their sequence numbers: so many are kept, and what was true at each
//! of those.
//!
//! ```text
//!   before the first │ first … last │ next         state before the first + what follows = state at any of them
//! ```
use std::collections::VecDeque;
use std::sync::Arc;

/// Observations that are kept; then the oldest go.
pub const MOST_OBSERVATIONS: usize = 65_536;

/// An alarm, as a condition has it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FaultValue {
    /// This alarm, among those that are there.
    pub(crate) id: String,
    /// Number in the alarm list.
    pub(crate) native_code: String,
    /// What has happened, and what to do.
    pub(crate) text: String,
}

/// What was observed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Unavailable,
    Word(&'static str),
    Text(Arc<str>),
    Number(f64),
    Count(u64),
    /// Of a condition: nothing is wrong.
    Normal,
    /// Of a condition: one thing more is wrong.
    Fault(Arc<FaultValue>),
    /// Assets of a type, each a key of a set.
    Assets(u64),
}

/// An observation.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Observation {
    pub(crate) sequence: u64,
    /// When, ms since 1970.
    pub(crate) unix_ms: u64,
    /// Number of its data item.
    pub(crate) item: usize,
    pub(crate) value: Value,
}

/// What is true: of each data item its last observation, of a condition all that is wrong.
#[derive(Clone, Debug)]
pub(crate) struct StateAt(Vec<Vec<Observation>>);

impl StateAt {
    fn apply(&mut self, observation: &Observation) {
        let is_fault = |value: &Value| matches!(value, Value::Fault(_));
        let of = &mut self.0[observation.item];
        if !(is_fault(&observation.value) && of.iter().all(|before| is_fault(&before.value))) {
            of.clear();
        }
        of.push(observation.clone());
    }

    /// Of a data item.
    pub(crate) fn of(&self, item: usize) -> &[Observation] {
        &self.0[item]
    }

    /// All, in the order of the data items.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Observation> {
        self.0.iter().flatten()
    }
}

/// Observations that are kept.
#[derive(Debug)]
pub(crate) struct Buffer {
    kept: VecDeque<Observation>,
    most: usize,
    /// Before the oldest one that is kept.
    before: StateAt,
    latest: StateAt,
    next: u64,
    last_ms: u64,
}

impl Buffer {
    /// Of so many data items.
    pub(crate) fn new(items: usize, most: usize) -> Self {
        let none = StateAt(vec![Vec::new(); items]);
        let (before, latest) = (none.clone(), none);
        Self { kept: VecDeque::new(), most, before, latest, next: 1, last_ms: 0 }
    }

    /// One more, unless it says what is known.
    pub(crate) fn observe(&mut self, item: usize, unix_ms: u64, value: Value) {
        let is_known = matches!(self.latest.of(item), [last] if last.value == value);
        if !is_known {
            self.push(item, unix_ms, value);
        }
    }

    /// One more, in any case. Time never goes back.
    pub(crate) fn push(&mut self, item: usize, unix_ms: u64, value: Value) {
        self.last_ms = self.last_ms.max(unix_ms);
        let observation = Observation { sequence: self.next, unix_ms: self.last_ms, item, value };
        self.next += 1;
        self.latest.apply(&observation);
        if self.kept.len() == self.most
            && let Some(oldest) = self.kept.pop_front()
        {
            self.before.apply(&oldest);
        }
        self.kept.push_back(observation);
    }

    /// Number of the first that is kept; of the next one where none is.
    pub(crate) fn first(&self) -> u64 {
        self.kept.front().map_or(self.next, |observation| observation.sequence)
    }

    pub(crate) const fn next(&self) -> u64 {
        self.next
    }

    pub(crate) const fn most(&self) -> usize {
        self.most
    }

    /// What is true now.
    pub(crate) const fn latest(&self) -> &StateAt {
        &self.latest
    }

    /// What was true when this one had been made; `None`: it is not kept.
    pub(crate) fn at(&self, sequence: u64) -> Option<StateAt> {
        if !(self.first()..self.next).contains(&sequence) {
            return None;
        }
        let mut state = self.before.clone();
        for observation in self.kept.iter().take_while(|kept| kept.sequence <= sequence) {
            state.apply(observation);
        }
        Some(state)
    }

    /// What was true before this one was made; `None`: it is not kept, nor is it the next.
    pub(crate) fn before(&self, sequence: u64) -> Option<StateAt> {
        if sequence == self.first() {
            return Some(self.before.clone());
        }
        self.at(sequence.checked_sub(1)?)
    }

    /// From this one on.
    pub(crate) fn from(&self, sequence: u64) -> impl DoubleEndedIterator<Item = &Observation> {
        let skipped = usize::try_from(sequence.saturating_sub(self.first())).unwrap_or(usize::MAX);
        self.kept.range(skipped.min(self.kept.len())..)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fault(number: u64) -> Value {
        let id = number.to_string();
        Value::Fault(Arc::new(FaultValue { native_code: id.clone(), text: id.clone(), id }))
    }

    #[test]
    fn what_says_nothing_new_has_no_number_and_faults_stand_beside_one_another() {
        let mut buffer = Buffer::new(2, 100);
        for value in [Value::Normal, fault(1), fault(2), Value::Normal] {
            buffer.observe(1, 5, value);
        }
        buffer.observe(0, 4, Value::Count(3));
        buffer.observe(0, 9, Value::Count(3));
        assert_eq!((buffer.first(), buffer.next()), (1, 6));
        let of = |sequence| buffer.at(sequence).expect("kept").of(1).len();
        assert_eq!([1, 2, 3, 4].map(of), [1, 1, 2, 1]);
        assert_eq!(buffer.latest().of(0)[0].unix_ms, 5, "time does not go back");
        assert!(buffer.at(0).is_none() && buffer.at(6).is_none());
    }

    proptest! {
        #[test]
        fn a_short_buffer_knows_what_a_long_one_knows(
            values in proptest::collection::vec((0_usize..4, 0_u64..6), 1..80),
            most in 1_usize..20,
        ) {
            let (mut short, mut long) = (Buffer::new(4, most), Buffer::new(4, 1000));
            for (item, value) in values {
                let value = match (item, value) {
                    (3, 0) => Value::Normal,
                    (3, number) => fault(number),
                    (_, number) => Value::Count(number),
                };
                short.observe(item, 0, value.clone());
                long.observe(item, 0, value);
            }
            prop_assert_eq!(short.next(), long.next());
            for sequence in short.first()..short.next() {
                let (short, long) = (short.at(sequence), long.at(sequence));
                prop_assert_eq!(short.map(|s| s.0), long.map(|s| s.0));
            }
            for sequence in short.first()..=short.next() {
                let (short, long) = (short.before(sequence), long.before(sequence));
                prop_assert!(short.is_some());
                prop_assert_eq!(short.map(|s| s.0), long.map(|s| s.0));
            }
            let kept: Vec<u64> = short.from(short.first()).map(|o| o.sequence).collect();
            prop_assert_eq!(kept, (short.first()..short.next()).collect::<Vec<_>>());
        }
    }
}
