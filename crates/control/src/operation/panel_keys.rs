//! Keys of a panel beside the machine, and what each asks for when it is pressed.
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
use super::request::Request;
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

impl PanelKeys {
    /// Takes what is pressed now; what is to be said of it.
    pub(super) fn take(&mut self, now: Panel, execution: Execution) -> Option<&'static str> {
        let before = self.before.replace(now);
        if now.single_block != before.unwrap_or_default().single_block {
            self.ask(Request::SingleBlock(now.single_block));
        }
        let before = before?;
        let has_program = execution.is_under_way();
        if now.stop && !before.stop {
            self.ask(if has_program { Request::Stop } else { Request::JogStop });
        }
        if now.hold && !before.hold {
            self.ask(if has_program { Request::FeedHold } else { Request::JogStop });
        }
        if now.reset && !before.reset {
            self.ask(Request::Reset);
        }
        if !now.cycle_start || before.cycle_start {
            return None;
        }
        if now.hold || now.stop {
            return Some("hold or stop is pressed: release it, then press cycle start");
        }
        self.ask(match execution {
            Execution::ProgramStopped | Execution::OptionalStop => Request::Confirm,
            _ if has_program => Request::Resume,
            _ => Request::Start,
        });
        None
    }

    fn ask(&mut self, request: Request) {
        if self.asked.len() < MOST {
            self.asked.push_back(request);
        }
    }

    /// What is asked for next.
    pub(super) fn next(&mut self) -> Option<Request> {
        self.asked.pop_front()
    }
}

/// What is said of a key that came to nothing.
pub(super) fn said_of_panel(why: &str) -> String {
    format!("a key of the panel was pressed: {why}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Panel = Panel {
        feed_inhibit: false,
        spindle_inhibit: [false; bus::SPINDLES],
        cycle_start: false,
        hold: false,
        stop: false,
        reset: false,
        single_block: false,
    };
    const CYCLE_START: Panel = Panel { cycle_start: true, ..NONE };

    /// What is asked for when this is pressed after nothing was.
    fn asked(now: Panel, execution: Execution) -> Vec<Request> {
        let mut keys = PanelKeys::default();
        keys.take(NONE, execution);
        keys.take(now, execution);
        keys.take(now, execution); // it is asked for once
        std::iter::from_fn(|| keys.next()).collect()
    }

    #[test]
    fn each_key_asks_for_what_can_be_meant() {
        assert_eq!(asked(CYCLE_START, Execution::Ready), [Request::Start]);
        assert_eq!(asked(CYCLE_START, Execution::FeedHold), [Request::Resume]);
        assert_eq!(asked(CYCLE_START, Execution::ProgramStopped), [Request::Confirm]);
        let stop = Panel { stop: true, ..NONE };
        assert_eq!(asked(stop, Execution::Active), [Request::Stop]);
        assert_eq!(asked(stop, Execution::Ready), [Request::JogStop]);
        assert_eq!(asked(Panel { hold: true, ..NONE }, Execution::Active), [Request::FeedHold]);
        assert_eq!(asked(Panel { reset: true, ..NONE }, Execution::Stopped), [Request::Reset]);
        let both = Panel { stop: true, ..CYCLE_START };
        assert_eq!(asked(both, Execution::Active), [Request::Stop], "never a start beside a stop");
    }

    #[test]
    fn a_key_that_is_stuck_when_the_control_begins_asks_for_nothing() {
        let mut keys = PanelKeys::default();
        for _ in 0..3 {
            keys.take(CYCLE_START, Execution::Ready);
        }
        assert_eq!(keys.next(), None);
        keys.take(NONE, Execution::Ready);
        keys.take(CYCLE_START, Execution::Ready);
        assert_eq!(keys.next(), Some(Request::Start));
    }

    #[test]
    fn a_key_that_is_hammered_waits_for_no_more_than_so_many_answers() {
        let mut keys = PanelKeys::default();
        for at in 0..1000 {
            keys.take(Panel { cycle_start: at % 2 == 1, ..NONE }, Execution::Ready);
        }
        assert_eq!(std::iter::from_fn(|| keys.next()).count(), MOST);
    }
}
