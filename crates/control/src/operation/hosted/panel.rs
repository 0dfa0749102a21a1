//! What a panel beside the machine asks for goes where the requests of clients go.
use super::Client;
use super::lead::{Job, Lead};
use crate::operation::{Control, Request};
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl Lead {
    /// Asks for what was pressed.
    pub(super) fn ask_for_panel(&mut self) {
        while let Some(request) = self.control.next_of_panel() {
            self.ask_as_client(request);
        }
        self.shared.panel_count.store(self.control.panel_count(), Ordering::Release);
    }

    fn ask_as_client(&self, request: Request) {
        let client = Client { jobs: self.jobs.clone(), shared: Arc::clone(&self.shared) };
        let jobs = self.jobs.clone();
        let say = move |why: String| {
            let work = move |control: &mut Control| control.say_of_panel(&why);
            let _ = jobs.try_send(Job::Work(Box::new(work))); // the queue is full: others wait, too
        };
        let answered = say.clone();
        let asked = client.ask(request, move |answer| {
            if let Err(refusal) = answer {
                answered(refusal.sentence());
            }
        });
        if let Err(refusal) = asked {
            say(refusal.sentence());
        }
    }
}
