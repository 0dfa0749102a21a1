//! Keys of a panel beside the machine: each asks for what the page asks for, when it is pressed.
//!
//! | pressed | asks for |
//! |---|---|
//! | cycle start | go on with what is held, or at M0 or M1; else start the program that is loaded |
//! | hold | hold the feed; without a program: what is moved by hand comes to rest |
//! | stop | give the program up; without one the same |
//! | reset | clear alarms |
//! | single block | hold after each block as long as it is set |
//!
//! A key that was pressed before the control began asks for nothing, and cycle start for nothing
//! while hold or stop is pressed.
use super::control::Control;
use super::event::Event;
use super::request::{Refusal, Request};
use super::state::Execution;
use bus::Panel;
use std::collections::VecDeque;

/// Requests that wait; keys that are pressed faster than they are answered are left out.
const MOST: usize = 16;

/// The panel, as it was, and what it asks for.
#[derive(Debug, Default)]
pub(super) struct PanelKeys {
    before: Option<Panel>,
    asked: VecDeque<Request>,
}

impl Control {
    /// What was pressed since the last period.
    pub(super) fn follow_panel(&mut self) {
        let now = self.executor.machine.feedback().panel;
        let before = self.panel.before.replace(now);
        let single_block = before.unwrap_or_default().single_block;
        if now.single_block != single_block {
            self.ask_by_panel(Request::SingleBlock(now.single_block));
        }
        let Some(before) = before else { return };
        let has_program = self.under_way.is_some();
        if now.stop && !before.stop {
            self.ask_by_panel(if has_program { Request::Stop } else { Request::JogStop });
        }
        if now.hold && !before.hold {
            self.ask_by_panel(if has_program { Request::FeedHold } else { Request::JogStop });
        }
        if now.reset && !before.reset {
            self.ask_by_panel(Request::Reset);
        }
        if now.cycle_start && !before.cycle_start {
            if now.hold || now.stop {
                let why = "cycle start on the panel: hold or stop is pressed: release it first";
                self.events.notice(why);
            } else {
                self.ask_by_panel(self.cycle_start());
            }
        }
    }

    fn cycle_start(&self) -> Request {
        match self.execution {
            Execution::ProgramStopped | Execution::OptionalStop => Request::Confirm,
            _ if self.under_way.is_some() => Request::Resume,
            _ => Request::Start,
        }
    }

    fn ask_by_panel(&mut self, request: Request) {
        if self.panel.asked.len() < MOST {
            self.panel.asked.push_back(request);
        }
    }

    /// What the panel asks for next: whoever leads the control asks it, as it asks what comes from a
    /// client.
    pub fn next_of_panel(&mut self) -> Option<Request> {
        self.panel.asked.pop_front()
    }

    /// Asks what the panel has asked for, for who leads the control in its own thread.
    pub fn answer_panel(&mut self) {
        while let Some(request) = self.next_of_panel() {
            if let Err(refusal) = self.request(&request) {
                self.events.push(Event::Notice(refused(&refusal)));
            }
        }
    }
}

/// What is said of a key that came to nothing.
fn refused(refusal: &Refusal) -> String {
    said_of_panel(&refusal.to_string())
}

pub(super) fn said_of_panel(why: &str) -> String {
    format!("a key of the panel was pressed: {why}")
}
