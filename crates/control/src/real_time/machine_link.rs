//! A machine that is in the servo thread, seen from the control's.
//!
//! What is asked of it goes through a ring that the servo thread empties in each period. It may
//! find that full: a busy computer lets the control look at many periods at once. So what finds no
//! room waits here for the next look. The engaged tool is no message but a state: only when it
//! differs from what was sent last is it sent, and of several states the last.
use bus::{EngagedTool, Feedback, Sample, Truth};
use rtrb::Producer;
use servo::{LaneStop, Record, StopLane};
use shm::RetainedState;
use sim::Fault;
use std::collections::VecDeque;
use std::sync::Arc;
use units::Time;

/// Requests that wait for room in the ring; one more, and the machine is halted with an alarm.
const WAITING: usize = 64;

/// What is asked of the machine beside its commands.
#[derive(Clone, Debug)]
pub(super) enum MachineRequest {
    Clamp(Box<sim::Grinding>),
    ClampStock(Box<(sim::Stock, Option<sim::Bar>)>),
    RenewWork,
    RenewTool(u32),
    Strike(Fault),
    Repair(Fault),
    Mend,
    Engage(Option<EngagedTool>),
}

/// See the module's header.
pub struct MachineLink {
    requests: Producer<MachineRequest>,
    waiting: VecDeque<MachineRequest>,
    stops: Arc<StopLane>,
    /// The tool that the machine shall know to be in its work, and the one that was sent last.
    engagement: (Option<EngagedTool>, Option<EngagedTool>),
    feedback: Feedback,
    truth: Option<Truth>,
    period: Time,
    /// What a component of HAL keeps of a tool in the work: written and read without the servo
    /// thread.
    retained: Option<shm::RetainedMemory>,
    lost: Option<String>,
}

impl MachineLink {
    pub(super) fn new(
        requests: Producer<MachineRequest>,
        stops: Arc<StopLane>,
        first: &Sample,
        period: Time,
        retained: Option<shm::RetainedMemory>,
    ) -> Self {
        let (feedback, truth) = (first.feedback, first.truth);
        let (waiting, engagement) = (VecDeque::new(), (None, None));
        Self { requests, waiting, stops, engagement, feedback, truth, period, retained, lost: None }
    }

    pub(crate) fn see(&mut self, record: &Record) {
        (self.feedback, self.truth) = (record.heard, record.sample.truth);
        self.send();
    }

    fn ask(&mut self, request: MachineRequest) {
        if self.waiting.len() == WAITING {
            self.stops.ask(LaneStop::NotTaken);
        } else {
            self.waiting.push_back(request);
        }
        self.send();
    }

    /// As much of what waits as there is room for.
    fn send(&mut self) {
        while !self.requests.is_full()
            && let Some(request) = self.waiting.pop_front()
        {
            let _ = self.requests.push(request); // there is room
        }
        let (wanted, sent) = &mut self.engagement;
        if wanted != sent && self.requests.push(MachineRequest::Engage(*wanted)).is_ok() {
            *sent = *wanted;
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

    pub(crate) fn renew_tool(&mut self, number: u32) {
        self.ask(MachineRequest::RenewTool(number));
    }

    pub(crate) fn clamp_stock(&mut self, stock: sim::Stock, bar: Option<sim::Bar>) {
        self.ask(MachineRequest::ClampStock(Box::new((stock, bar))));
    }

    pub(crate) fn renew_work(&mut self) {
        self.ask(MachineRequest::RenewWork);
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

    pub(crate) fn engage(&mut self, engagement: Option<EngagedTool>) {
        if let Some(retained) = &self.retained {
            return retained.engage(engagement);
        }
        self.engagement.0 = engagement;
        self.send();
    }

    /// The servo thread has been sent which tool is in the work: it knows before it takes a request
    /// to the kernel that comes after.
    pub(crate) fn has_engaged(&self) -> bool {
        self.engagement.0 == self.engagement.1
    }

    pub(crate) fn lost(&self) -> Option<String> {
        self.lost.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtrb::{Consumer, RingBuffer};

    fn link(room: usize) -> (MachineLink, Consumer<MachineRequest>, Arc<StopLane>) {
        let (requests, taken) = RingBuffer::new(room);
        let stops = Arc::<StopLane>::default();
        let link =
            MachineLink::new(requests, Arc::clone(&stops), &Sample::default(), Time::s(1e-3), None);
        (link, taken, stops)
    }

    fn tool(sync_error: f64) -> EngagedTool {
        let sync_error = units::Length::mm(sync_error);
        EngagedTool { number: 7, tool: 3, sync_error, ..EngagedTool::default() }
    }

    #[test]
    fn a_tool_that_stays_in_the_work_is_sent_once_however_often_it_is_said() {
        let (mut link, mut taken, stops) = link(2);
        for _ in 0..1000 {
            link.engage(Some(tool(0.0)));
        }
        assert!(link.has_engaged());
        assert_eq!(std::iter::from_fn(|| taken.pop().ok()).count(), 1);
        assert_eq!((stops.take(), link.lost()), (0, None));
    }

    #[test]
    fn of_states_that_find_the_ring_full_the_last_is_sent_with_the_next_period() {
        let (mut link, mut taken, stops) = link(2);
        for error in 1..1000 {
            link.engage(Some(tool(f64::from(error))));
        }
        assert!(!link.has_engaged(), "the ring is full");
        while taken.pop().is_ok() {}
        link.send();
        assert!(link.has_engaged());
        let last = taken.pop().map(|request| format!("{request:?}"));
        assert_eq!(last, Ok(format!("{:?}", MachineRequest::Engage(Some(tool(999.0))))));
        assert_eq!((stops.take(), link.lost()), (0, None));
    }

    #[test]
    fn requests_that_find_the_ring_full_wait_in_their_order_and_too_many_are_an_alarm() {
        let (mut link, mut taken, stops) = link(1);
        link.mend();
        link.strike(Fault::EmergencyStop);
        link.repair(Fault::EmergencyStop);
        for expected in ["Mend", "Strike", "Repair"] {
            let request = format!("{:?}", taken.pop());
            assert!(request.contains(expected), "{request}");
            link.send();
        }
        for _ in 0..=WAITING {
            link.mend();
        }
        assert_eq!(stops.take(), 0);
        link.mend();
        assert!(LaneStop::NotTaken.is_in(stops.take()));
        assert_eq!(link.lost(), None, "the machine is there");
    }
}
