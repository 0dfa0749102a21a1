//! What a program says to its operator: `(MSG, …)`, `(DEBUG, …)`, Fanuc's `#3006`.
//!
//! Operations are read ahead of the machine. A message waits until the machine has come to the
//! operation behind it, so that it is heard where it was written.
use std::collections::VecDeque;

/// Messages that wait; of more the oldest are heard early.
const MOST: usize = 256;

/// A message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Its line.
    pub line: u32,
    /// What it says.
    pub text: Box<str>,
}

/// Messages that were read and not heard yet, by the number of their operation.
#[derive(Debug, Default)]
pub(crate) struct Messages(VecDeque<(u32, Message)>);

impl Messages {
    pub(crate) fn push(&mut self, op: u32, message: Message) {
        self.0.push_back((op, message));
    }

    /// The next one whose place the machine has come to; `is_over`: it comes to no other one.
    pub(crate) fn next(&mut self, op: u32, is_over: bool) -> Option<Message> {
        let is_due = |(of, _): &mut (u32, Message)| *of < op || is_over;
        let early = self.0.len() > MOST;
        let next = if early { self.0.pop_front() } else { self.0.pop_front_if(is_due) };
        next.map(|(_, message)| message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: u32) -> Message {
        Message { line, text: format!("line {line}").into() }
    }

    #[test]
    fn a_message_is_heard_when_the_machine_has_come_to_what_follows_it() {
        let mut messages = Messages::default();
        messages.push(3, of(7));
        messages.push(8, of(12));
        assert_eq!(messages.next(3, false), None);
        assert_eq!(messages.next(4, false), Some(of(7)));
        assert_eq!(messages.next(4, false), None);
        assert_eq!(messages.next(4, true), Some(of(12)));
    }

    #[test]
    fn a_program_that_says_more_than_it_moves_fills_no_memory() {
        let mut messages = Messages::default();
        for line in 0..10_000 {
            messages.push(line, of(line));
            while messages.next(0, false).is_some() {}
        }
        assert_eq!(messages.0.len(), MOST);
    }
}
