//! A kernel that is in the servo thread, seen from the control's: its picture, and rings to and
//! from it.
use crate::clock::now;
use bus::{Report, State};
use kernel::{
    Answered, Event, Fault, FaultKind, Full, Picture, RecordRequest, Reply, Request, Subject,
};
use plan::Step;
use rtrb::{Consumer, Producer};
use servo::{LaneStop, Record, Replied, Said, StopLane};
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Acquire};
use std::time::Duration;
use units::Time;

/// The other thread answers a request within a period; one that has not after so long is gone.
const ANSWER: Duration = Duration::from_secs(2);
/// Between two looks whether it has.
const LOOK: Duration = Duration::from_micros(20);
/// Nor is it gone before so many looks: where the computer itself has stood still, the clock says
/// nothing of that thread.
const LOOKS: u32 = 10_000;

/// The rings' ends on this side.
pub(super) struct KernelRings {
    pub(super) requests: Producer<Request>,
    pub(super) replies: Consumer<Replied>,
    pub(super) steps: Producer<Step>,
    pub(super) spent: Consumer<Step>,
    pub(super) said: Consumer<Said>,
}

/// See the module's header.
pub struct KernelLink {
    rings: KernelRings,
    is_over: Arc<AtomicBool>,
    stops: Arc<StopLane>,
    /// Requests that have no reply yet: that of one that was given up may still come, before those
    /// of the requests after it.
    owed: usize,
    picture: Picture,
    /// Periods that were over when the picture was taken.
    number: u64,
    faults: Vec<Fault>,
    events: VecDeque<Event>,
    answered: Option<Answered>,
    record_requests: VecDeque<RecordRequest>,
    /// Steps that were sent, and of these, those that the kernel's queue has taken.
    sent: u64,
    taken: u64,
    /// Of the steps on their way, those after this one up to that one were given up.
    given_up: (u64, u64),
    /// Up to when records were looked at.
    seen: Time,
}

impl KernelLink {
    pub(super) fn new(
        rings: KernelRings,
        is_over: Arc<AtomicBool>,
        stops: Arc<StopLane>,
        picture: &Picture,
    ) -> Self {
        let mut link = Self {
            rings,
            is_over,
            stops,
            owed: 0,
            picture: *picture,
            number: 0,
            faults: Vec::new(),
            events: VecDeque::new(),
            answered: None,
            record_requests: VecDeque::new(),
            sent: 0,
            taken: 0,
            given_up: (0, 0),
            seen: Time::ZERO,
        };
        link.keep_faults();
        link
    }

    pub(crate) fn picture(&self) -> &Picture {
        &self.picture
    }

    pub(crate) fn faults(&self) -> &[Fault] {
        &self.faults
    }

    /// Steps that wait or run, those on their way among them.
    pub(crate) fn steps(&self) -> usize {
        let (after, last) = self.given_up;
        let given_up = last - after.max(self.taken).min(last);
        self.picture.steps + (self.sent - self.taken - given_up) as usize
    }

    /// Steps on their way that were given up are not gone yet.
    pub(crate) const fn is_giving_up(&self) -> bool {
        self.taken < self.given_up.1
    }

    /// [`Kernel::give_up`](kernel::Kernel::give_up), of all that were sent.
    pub(crate) fn give_up(&mut self, steps: usize, at: Option<f64>) -> bool {
        if self.is_giving_up() {
            return false; // one after the other
        }
        let given_up = (self.sent - (steps as u64).min(self.sent), self.sent);
        let is_done =
            matches!(self.ask(Request::GiveUp { steps, at }), Some(Reply::Is(done)) if done);
        if is_done {
            self.given_up = given_up;
        }
        is_done
    }

    pub(crate) fn is_full(&self) -> bool {
        self.rings.steps.is_full()
    }

    pub(crate) fn push(&mut self, step: &Step) -> Result<(), Full> {
        while self.rings.spent.pop().is_ok() {}
        self.rings.steps.push(step.clone()).map_err(|_| Full::Steps)?;
        self.sent += 1;
        Ok(())
    }

    /// A record is looked at.
    pub(crate) fn see(&mut self, record: &Record) {
        self.seen = record.sample.feedback.time;
        if record.number > self.number {
            (self.picture, self.number, self.taken) = (record.picture, record.number, record.taken);
            self.keep_faults();
        }
    }

    fn keep_faults(&mut self) {
        self.faults.clear();
        self.faults.extend(self.picture.faults.iter().flatten());
    }

    /// Ask, and wait for the reply: less than a period. A request that is not taken is not lost
    /// without a word: an alarm halts the machine.
    pub(crate) fn ask(&mut self, request: Request) -> Option<Reply> {
        let reply = self.ask_once(request);
        if reply.is_none() && !self.is_over.load(Acquire) {
            self.stops.ask(LaneStop::NotTaken);
        }
        reply
    }

    fn ask_once(&mut self, request: Request) -> Option<Reply> {
        self.rings.requests.push(request).ok()?;
        self.owed += 1;
        let (end, mut looks) = (now() + ANSWER, 0);
        let replied = loop {
            if let Ok(replied) = self.rings.replies.pop() {
                self.owed -= 1;
                if self.owed == 0 {
                    break replied;
                }
                continue; // of an earlier one
            }
            if self.is_over.load(Acquire) || looks > LOOKS && now() > end {
                return None;
            }
            looks += 1;
            std::thread::sleep(LOOK);
        };
        let Replied { reply, number, picture, taken } = replied;
        (self.picture, self.number, self.taken) = (picture, number, taken);
        self.keep_faults();
        Some(reply)
    }

    /// The servo thread has ended by itself: nothing is commanded any more.
    pub(crate) fn lose(&mut self) {
        if self.faults.iter().any(|fault| fault.kind == FaultKind::ServoThreadEnded) {
            return;
        }
        let Report { op, line, .. } = self.picture.report;
        let (kind, subject) = (FaultKind::ServoThreadEnded, Subject::Machine);
        let time = self.seen;
        self.faults.push(Fault { kind, subject, value: 0.0, limit: 0.0, time, op, line });
        self.picture = Picture {
            report: Report { state: State::Faulted, ..self.picture.report },
            is_over: true,
            is_ready: false,
            is_standing: true,
            is_flowing: false,
            is_moving_manually: false,
            is_moving_on_lease: false,
            is_homing: [false; bus::AXES],
            waiting: None,
            ..self.picture
        };
    }

    /// What the kernel has said up to the record that is looked at.
    fn hear(&mut self) {
        while let Ok(said) = self.rings.said.pop() {
            match said {
                Said::Event(event) => self.events.push_back(event),
                Said::Answered(answered) => self.answered = Some(answered),
                Said::Record(request) => self.record_requests.push_back(request),
            }
        }
    }

    pub(crate) fn next_event(&mut self) -> Option<Event> {
        self.hear();
        self.events.pop_front_if(|event| event.time <= self.seen)
    }

    pub(crate) fn take_answer(&mut self) -> Option<Answered> {
        self.hear();
        self.answered.take()
    }

    pub(crate) fn next_record_request(&mut self) -> Option<RecordRequest> {
        self.hear();
        self.record_requests.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config;
    use kernel::Kernel;
    use rtrb::RingBuffer;
    use std::sync::atomic::Ordering::Release;

    #[test]
    fn the_late_reply_to_a_request_that_was_given_up_is_not_taken_for_that_to_the_next() {
        let file = config::machine_file::load("tapping-center").expect("a built-in machine");
        let picture = Kernel::new(config::control(&file, None, false)).picture();
        let (requests, mut asked) = RingBuffer::new(4);
        let (mut replies, replied) = RingBuffer::new(4);
        let (steps, _sent) = RingBuffer::new(4);
        let (_back, spent) = RingBuffer::new(4);
        let (_saying, said) = RingBuffer::new(4);
        let rings = KernelRings { requests, replies: replied, steps, spent, said };
        let is_over = Arc::new(AtomicBool::new(true));
        let mut link = KernelLink::new(rings, Arc::clone(&is_over), Arc::default(), &picture);
        assert!(link.ask(Request::ClearOutputs).is_none(), "it has replied to nothing");
        is_over.store(false, Release);
        for (number, reply) in [(1, Reply::Done), (2, Reply::Is(true))] {
            replies.push(Replied { reply, number, picture, taken: 0 }).expect("room for it");
        }
        assert!(matches!(link.ask(Request::Clear), Some(Reply::Is(true))));
        assert_eq!((link.number, std::iter::from_fn(|| asked.pop().ok()).count()), (2, 2));
        assert_eq!(link.stops.take(), 0, "every request was answered, or the thread was over");
    }

    #[test]
    fn a_request_that_is_not_taken_halts_the_machine_with_an_alarm() {
        let file = config::machine_file::load("tapping-center").expect("a built-in machine");
        let picture = Kernel::new(config::control(&file, None, false)).picture();
        let (requests, _asked) = RingBuffer::new(0);
        let (_replies, replied) = RingBuffer::new(4);
        let (steps, _sent) = RingBuffer::new(4);
        let (_back, spent) = RingBuffer::new(4);
        let (_saying, said) = RingBuffer::new(4);
        let rings = KernelRings { requests, replies: replied, steps, spent, said };
        let stops = Arc::<StopLane>::default();
        let mut link = KernelLink::new(rings, Arc::default(), Arc::clone(&stops), &picture);
        assert!(link.ask(Request::ClearOutputs).is_none(), "there is no room for it");
        let mut kernel = Kernel::new(config::control(&file, None, false));
        servo::stop(&mut kernel, stops.take());
        let mut feedback = bus::Feedback::default();
        for axis in &mut feedback.axes {
            axis.ready = true;
        }
        for spindle in &mut feedback.spindles {
            spindle.ready = true;
        }
        for _ in 0..10 {
            kernel.tick(&feedback);
            feedback.time += file.control.period;
        }
        let kinds: Vec<_> = kernel.faults().iter().map(|fault| fault.kind).collect();
        assert_eq!(kinds, [FaultKind::RequestsNotTaken]);
    }
}
