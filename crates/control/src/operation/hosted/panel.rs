//! What a panel beside the machine asks for goes where the requests of clients go.
use super::lead::Lead;
use super::{Client, held};
use crate::operation::panel_keys::said_of_panel;
use crate::operation::{Event, Request};
use std::sync::Arc;

impl Lead {
    /// Asks for what was pressed.
    pub(super) fn ask_for_panel(&mut self) {
        while let Some(request) = self.control.next_of_panel() {
            self.ask_as_client(request);
        }
    }

    fn ask_as_client(&self, request: Request) {
        let (time, shared) = (self.control.now(), Arc::clone(&self.shared));
        let client = Client { jobs: self.jobs.clone(), shared: Arc::clone(&self.shared) };
        let say = move |why: &str| {
            held(&shared.journal).push(time, Event::Notice(said_of_panel(why)));
        };
        let told = say.clone();
        let asked = client.ask(request, move |answer| {
            if let Err(refusal) = answer {
                told(&refusal.sentence());
            }
        });
        if let Err(refusal) = asked {
            say(&refusal.sentence());
        }
    }
}
