//! A panel beside the machine asks for what the page asks for.
use super::control::Control;
use super::event::Event;
use super::panel_keys::said_of_panel;
use super::request::Request;

impl Control {
    /// What was pressed since the last period.
    pub(super) fn follow_panel(&mut self) {
        let now = self.executor.machine.feedback().panel;
        if let Some(why) = self.panel.take(now, self.execution) {
            self.events.notice(said_of_panel(why));
        }
    }

    /// What the panel asks for next: whoever leads the control asks it, as it asks what comes from
    /// a client.
    pub fn next_of_panel(&mut self) -> Option<Request> {
        self.panel.next()
    }

    /// Asks what the panel has asked for, for who leads the control in its own thread.
    pub fn answer_panel(&mut self) {
        while let Some(request) = self.next_of_panel() {
            if let Err(refusal) = self.request(&request) {
                self.events.push(Event::Notice(said_of_panel(&refusal.to_string())));
            }
        }
    }
}
