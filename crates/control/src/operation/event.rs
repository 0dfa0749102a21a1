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

/// Events that wait to be asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    waiting: VecDeque<Event>,
    lost: u64,
}

impl Events {
    pub(super) fn push(&mut self, event: Event) {
        if self.waiting.len() == MOST_EVENTS {
            self.waiting.pop_front();
            self.lost += 1;
        }
        self.waiting.push_back(event);
    }

    pub(super) fn notice(&mut self, text: impl Into<String>) {
        self.push(Event::Notice(text.into()));
    }

    pub(super) fn pop(&mut self) -> Option<Event> {
        self.waiting.pop_front()
    }

    /// How many were not asked for in time.
    pub(super) const fn lost(&self) -> u64 {
        self.lost
    }
}
