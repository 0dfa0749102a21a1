//! What has happened on a control, for a panel, a log or a client: in order, and never more than
//! are kept.
use super::state::{Execution, Mode};
use kernel::Fault;
use std::collections::VecDeque;
use units::Time;
use verify::Feature;

/// Events that are kept for a client that has not asked yet; then the oldest go, and are counted.
const MOST_EVENTS: usize = 1024;

/// An alarm: what stopped the machine, and what mends it.
#[derive(Clone, Debug, PartialEq)]
pub struct Alarm {
    /// Number in the alarm list.
    pub number: u16,
    /// What has happened, to what, with its numbers.
    pub text: String,
    /// What to do.
    pub remedy: String,
    /// The program that was under way, if one was.
    pub program: Option<String>,
    /// Its line; 0 is none.
    pub line: u32,
    /// Machine time.
    pub time: Time,
    /// A reset has cleared it.
    pub is_cleared: bool,
}

impl Alarm {
    /// Of a fault of the kernel.
    pub(super) fn of(fault: &Fault, program: Option<String>) -> Self {
        Self {
            number: fault.kind.number(),
            text: fault.to_string(),
            remedy: fault.kind.remedy().to_owned(),
            program,
            line: fault.line,
            time: fault.time,
            is_cleared: false,
        }
    }
}

/// What has happened.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// What the program does has changed.
    Execution(Execution),
    /// Who leads the axes has changed.
    Mode(Mode),
    /// The drives are up.
    DrivesReady,
    /// An alarm has stopped the machine.
    Alarm(Alarm),
    /// Something that the operator should know.
    Notice(String),
    /// A feature was cut and judged.
    Feature(Box<Feature>),
}

/// Time without a notice's cause after which the same notice is given again.
const QUIET: Time = Time::s(1.0);
/// Notices whose causes are watched; of more the one that was given first is forgotten.
const MOST_CAUSES: usize = 32;

/// Events that wait to be asked for.
///
/// What a client asks for again and again, or what comes and goes many times a second, gives one
/// notice: the same one comes again after another event, or when its cause has been gone for a
/// second.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    waiting: VecDeque<Event>,
    lost: u64,
    /// Machine time.
    now: Time,
    /// Causes of notices, and when each has come last.
    causes: VecDeque<(String, Time)>,
}

impl Events {
    /// Sets the machine time.
    pub(super) const fn at(&mut self, now: Time) {
        self.now = now;
    }

    pub(super) fn push(&mut self, event: Event) {
        self.causes.clear();
        self.keep(event);
    }

    fn keep(&mut self, event: Event) {
        if self.waiting.len() == MOST_EVENTS {
            self.waiting.pop_front();
            self.lost += 1;
        }
        self.waiting.push_back(event);
    }

    /// Gives a notice whose text is its cause.
    pub(super) fn notice(&mut self, text: impl Into<String>) {
        let text = text.into();
        self.notice_of(&text.clone(), text);
    }

    /// Gives a notice whose text has numbers that change while its cause lasts.
    pub(super) fn notice_of(&mut self, cause: &str, text: impl Into<String>) {
        let known = self.causes.iter().position(|(known, _)| known == cause);
        let last = known.and_then(|index| self.causes.remove(index));
        if last.is_none() && self.causes.len() == MOST_CAUSES {
            self.causes.pop_front();
        }
        self.causes.push_back((cause.to_owned(), self.now));
        if last.is_none_or(|(_, last)| (self.now - last).abs() > QUIET) {
            self.keep(Event::Notice(text.into()));
        }
    }

    /// Gives what a program says, as often as it says it.
    pub(super) fn message(&mut self, text: String) {
        self.keep(Event::Notice(text));
    }

    pub(super) fn pop(&mut self) -> Option<Event> {
        self.waiting.pop_front()
    }

    /// How many were not asked for in time.
    pub(super) const fn lost(&self) -> u64 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(events: &mut Events) -> Vec<String> {
        let notice = |event| match event {
            Event::Notice(text) => Some(text),
            _ => None,
        };
        core::iter::from_fn(|| events.pop()).filter_map(notice).collect()
    }

    #[test]
    fn a_cause_that_lasts_gives_one_notice_and_another_one_when_it_comes_back() {
        let mut events = Events::default();
        for tenth in 0..100 {
            events.at(Time::s(f64::from(tenth) / 10.0));
            events.notice("X stands on its limit switch");
            events.notice_of("following X", format!("X: following error {tenth}"));
        }
        assert_eq!(given(&mut events), ["X stands on its limit switch", "X: following error 0"]);
        events.at(Time::s(11.5));
        events.notice("X stands on its limit switch");
        assert_eq!(given(&mut events).len(), 1);
        events.push(Event::DrivesReady);
        events.notice("X stands on its limit switch");
        assert_eq!(given(&mut events).len(), 1, "something else has changed");
    }

    #[test]
    fn what_a_program_says_twice_is_given_twice_and_what_nobody_asks_for_is_bounded() {
        let mut events = Events::default();
        for number in 0..3000 {
            events.message("part done".into());
            events.notice(format!("number {number}"));
        }
        assert!(events.causes.len() <= MOST_CAUSES);
        assert_eq!(events.lost(), 6000 - MOST_EVENTS as u64);
        assert_eq!(given(&mut events).len(), MOST_EVENTS);
    }
}
