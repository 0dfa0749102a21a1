//! A panel beside the machine asks for what the page asks for.
use super::control::Control;
use super::panel_keys::{PanelContext, said_of_panel};
use super::request::Request;

impl Control {
    /// What was pressed since the last period.
    pub(super) fn follow_panel(&mut self) {
        let now = self.executor.machine.feedback().panel;
        let context = self.panel_context();
        if let Some(why) = self.panel.take(now, &context) {
            self.say_of_panel(&why);
        }
    }

    fn panel_context(&self) -> PanelContext {
        let (operator, machine) = (self.executor.kernel.operator(), &self.base.machine);
        let limits = &machine.control.overrides;
        let fastest = machine.axes.each_ref().map(|axis| {
            let file = axis.as_ref()?;
            Some(if self.is_homed(file.letter) { file.rapid } else { file.homing.slow })
        });
        PanelContext {
            time: self.now(),
            execution: self.execution,
            overrides: [operator.share(false), operator.share(true), operator.spindle_share()],
            ranges: [
                (0.0, limits.feed_most_share),
                (0.0, 1.0),
                (limits.spindle_least_share, limits.spindle_most_share),
            ],
            fastest,
        }
    }

    /// Says why something that the panel has asked for came to nothing.
    pub(super) fn say_of_panel(&mut self, why: &str) {
        self.events.notice(said_of_panel(why));
    }

    /// How often the panel has begun or changed something.
    pub(super) const fn panel_count(&self) -> u64 {
        self.panel.count()
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
                self.say_of_panel(&refusal.to_string());
            }
        }
    }
}
