//! A machine that is in the servo thread, seen from the control's.
use bus::{Feedback, Truth};
use rtrb::Producer;
use servo::Record;
use shm::{RetainedState, ToolInWork};
use sim::Fault;
use units::Time;
use wire::Engagement;

/// What is asked of the machine beside its commands.
#[derive(Clone, Debug)]
pub(super) enum MachineRequest {
    Clamp(Box<sim::Grinding>),
    Strike(Fault),
    Repair(Fault),
    Mend,
    Engage(Option<Engagement>),
}

/// See the module's header.
pub struct MachineLink {
    pub(super) requests: Producer<MachineRequest>,
    pub(super) feedback: Feedback,
    pub(super) truth: Option<Truth>,
    pub(super) period: Time,
    /// What a component of HAL keeps of a tool in the work: written and read without the servo
    /// thread.
    pub(super) retained: Option<shm::RetainedMemory>,
    pub(super) lost: Option<String>,
}

impl MachineLink {
    pub(crate) fn see(&mut self, record: &Record) {
        (self.feedback, self.truth) = (record.heard, record.sample.truth);
    }

    fn ask(&mut self, request: MachineRequest) {
        if self.requests.push(request).is_err() {
            self.lose("the servo thread does not take requests any more");
        }
    }

    pub(crate) fn lose(&mut self, why: &str) {
        self.lost.get_or_insert_with(|| why.into());
    }

    /// A period has passed of which nothing is heard.
    pub(crate) fn pass(&mut self) {
        self.feedback.time += self.period;
    }

    pub(crate) const fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    pub(crate) const fn truth(&self) -> Option<&Truth> {
        self.truth.as_ref()
    }

    pub(crate) fn period(&self) -> Time {
        self.period
    }

    pub(crate) fn clamp(&mut self, grinding: sim::Grinding) {
        self.ask(MachineRequest::Clamp(Box::new(grinding)));
    }

    pub(crate) fn strike(&mut self, fault: Fault) {
        self.ask(MachineRequest::Strike(fault));
    }

    pub(crate) fn repair(&mut self, fault: Fault) {
        self.ask(MachineRequest::Repair(fault));
    }

    pub(crate) fn mend(&mut self) {
        self.ask(MachineRequest::Mend);
    }

    /// What a component of HAL keeps; a machine of another kind has said it in its welcome.
    pub(crate) fn retained(&self) -> Option<RetainedState> {
        self.retained.as_ref().map(shm::RetainedMemory::state)
    }

    pub(crate) fn engage(&mut self, engagement: Option<Engagement>) {
        if let Some(retained) = &self.retained {
            let tool = |of: Engagement| ToolInWork {
                tool: of.tool,
                touches: of.touches,
                may_be_broken: of.may_be_broken,
                sync_error: of.sync_error,
            };
            return retained.engage(engagement.map(|of| (of.number, tool(of))));
        }
        self.ask(MachineRequest::Engage(engagement));
    }

    pub(crate) fn lost(&self) -> Option<String> {
        self.lost.clone()
    }
}
