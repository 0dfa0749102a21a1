//! The servo thread: one turn per period, from the rings to the rings.
use super::clock::PeriodClock;
use super::kernel_link::{KernelLink, KernelRings, Replied};
use super::machine_link::{MachineLink, MachineRequest};
use super::{
    RECORDS, REQUESTS, RealTimeOptions, Record, SAID, STEPS, Said, ServoMetrics, scheduling,
};
use crate::Plant;
use crate::executor::{answer, obey};
use crate::timings::TickTimes;
use bus::{Machine as _, Sample};
use kernel::{Kernel, Reply, Request};
use plan::Step;
use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Between two looks whether a record has come.
const LOOK: Duration = Duration::from_micros(250);

/// A servo thread that runs. Dropped, it stops and is waited for.
pub(crate) struct ServoThread {
    thread: Option<JoinHandle<(Box<Kernel>, Box<Plant>)>>,
    stop: Arc<AtomicBool>,
    is_over: Arc<AtomicBool>,
    records: Consumer<Record>,
    metrics: Arc<ServoMetrics>,
}

/// What the servo thread will hold beside kernel and machine.
pub(crate) struct Seat {
    rings: ServoRings,
    records: Consumer<Record>,
    is_over: Arc<AtomicBool>,
}

/// What the thread owns.
struct Servo {
    kernel: Box<Kernel>,
    machine: Box<Plant>,
    ticks: TickTimes,
    rings: ServoRings,
    /// A step that the kernel had no room for.
    waiting: Option<Step>,
    taken: u64,
    /// Of the steps on their way, those after this one up to that one were given up.
    given_up: (u64, u64),
    number: u64,
    metrics: Arc<ServoMetrics>,
}

/// The rings' ends on this side.
struct ServoRings {
    requests: Consumer<Request>,
    replies: Producer<Replied>,
    steps: Consumer<Step>,
    spent: Producer<Step>,
    said: Producer<Said>,
    records: Producer<Record>,
    of_machine: Consumer<MachineRequest>,
}

/// All that connects the servo thread with the control's, for this kernel and this machine.
pub(crate) fn prepare(
    kernel: &Kernel,
    machine: &Plant,
) -> (Box<KernelLink>, Box<MachineLink>, Seat) {
    let picture = kernel.picture();
    let (feedback, truth) = (machine.feedback(), machine.truth());
    let sample = Sample { feedback, truth, report: picture.report, ..Sample::default() };
    let first = Record { number: 0, sample, heard: feedback, picture, taken: 0 };
    let (mut records, mut seen) = RingBuffer::new(RECORDS);
    // the first round through the ring shall find its memory there
    while records.push(first).is_ok() {}
    while seen.pop().is_ok() {}
    let (requests, asked) = RingBuffer::new(REQUESTS);
    let (replies, replied) = RingBuffer::new(REQUESTS);
    let (steps, sent) = RingBuffer::new(STEPS);
    let (spent, back) = RingBuffer::new(STEPS + kernel::QUEUE);
    let (said, heard) = RingBuffer::new(SAID);
    let (machine_requests, of_machine) = RingBuffer::new(REQUESTS);
    let is_over = Arc::new(AtomicBool::new(false));
    let rings = KernelRings { requests, replies: replied, steps, spent: back, said: heard };
    let kernel_link = KernelLink::new(rings, Arc::clone(&is_over), &picture);
    let period = machine.period();
    let machine_link =
        MachineLink { requests: machine_requests, feedback, truth, period, lost: None };
    let rings =
        ServoRings { requests: asked, replies, steps: sent, spent, said, records, of_machine };
    let seat = Seat { rings, records: seen, is_over };
    (Box::new(kernel_link), Box::new(machine_link), seat)
}

impl Seat {
    /// The thread begins; what the operating system has refused of what real time needs.
    ///
    /// # Errors
    /// No thread can be started.
    pub(crate) fn start(
        self,
        kernel: Box<Kernel>,
        machine: Box<Plant>,
        ticks: TickTimes,
        options: RealTimeOptions,
    ) -> Result<(ServoThread, Vec<String>), String> {
        let Self { rings, records, is_over } = self;
        let metrics = Arc::new(ServoMetrics::default());
        let stop = Arc::new(AtomicBool::new(false));
        let servo = Servo {
            kernel,
            machine,
            ticks,
            rings,
            waiting: None,
            taken: 0,
            given_up: (0, 0),
            number: 0,
            metrics: Arc::clone(&metrics),
        };
        let (up, is_up) = std::sync::mpsc::sync_channel(1);
        let (told, over) = (Arc::clone(&stop), Over(Arc::clone(&is_over)));
        let thread = std::thread::Builder::new().name("servo".into());
        let thread = thread.spawn(move || {
            let _over = over;
            let _ = up.send(scheduling::ask(options.priority)); // the other side waits for it
            servo.run(&told, options.around)
        });
        let thread = thread.map_err(|e| format!("cannot start the servo thread: {e}"))?;
        let refused = is_up.recv().unwrap_or_default();
        Ok((ServoThread { thread: Some(thread), stop, is_over, records, metrics }, refused))
    }
}

/// Says that the thread has ended, however it did.
struct Over(Arc<AtomicBool>);

impl Drop for Over {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

impl Servo {
    fn run(mut self, stop: &AtomicBool, around: fn(&mut dyn FnMut())) -> (Box<Kernel>, Box<Plant>) {
        let period = Duration::from_secs_f64(self.machine.period().value());
        let mut clock = PeriodClock::new(period);
        while !stop.load(Ordering::Acquire) {
            self.period(around);
            let begun = clock.wait();
            self.metrics.begun(begun.late, period, begun.is_set_anew);
        }
        (self.kernel, self.machine)
    }

    fn period(&mut self, around: fn(&mut dyn FnMut())) {
        self.ask_machine();
        let mut answered = None;
        around(&mut || {
            self.serve();
            self.take_steps();
            let answer = answer(&mut self.kernel, &self.machine, &self.ticks);
            self.say();
            answered = Some((answer, self.kernel.picture()));
        });
        let Some((answer, picture)) = answered else { return };
        let sample = answer.sample;
        obey(&mut self.kernel, &mut self.machine, &answer);
        self.number += 1;
        self.metrics.period();
        let heard = self.machine.feedback();
        let record = Record { number: self.number, sample, heard, picture, taken: self.taken };
        if self.rings.records.push(record).is_err() {
            self.metrics.unobserved();
        }
    }

    /// What is asked of the machine: at most what the ring holds.
    fn ask_machine(&mut self) {
        while let Ok(request) = self.rings.of_machine.pop() {
            match request {
                MachineRequest::Strike(fault) => self.machine.strike(fault),
                MachineRequest::Repair(fault) => self.machine.repair(fault),
                MachineRequest::Mend => self.machine.mend(),
                MachineRequest::Engage(engagement) => self.machine.engage(engagement),
            }
        }
    }

    /// Requests to the kernel, each with its reply.
    fn serve(&mut self) {
        while !self.rings.replies.is_full()
            && let Ok(request) = self.rings.requests.pop()
        {
            let mut reply = match request {
                Request::GiveUp { steps, at } => Reply::Is(self.give_up(steps, at)),
                request => self.kernel.serve(request),
            };
            if let Reply::HandedBack(Some(back)) = &mut reply {
                back.steps += self.hand_back_waiting();
            }
            let (number, picture, taken) = (self.number, self.kernel.picture(), self.taken);
            // there was room before the request was taken
            let _ = self.rings.replies.push(Replied { reply, number, picture, taken });
        }
    }

    /// The last ones of all steps that were sent are not wanted any more, if the kernel agrees.
    fn give_up(&mut self, steps: usize, at: Option<f64>) -> bool {
        let on_their_way = self.rings.steps.slots() + usize::from(self.waiting.is_some());
        let last = self.taken + on_their_way as u64;
        let of_kernel = steps.saturating_sub(on_their_way);
        if self.taken < self.given_up.1 || (steps < on_their_way && at.is_some()) {
            return false;
        }
        if (of_kernel > 0 || at.is_some() || steps == on_their_way)
            && !self.kernel.give_up(of_kernel, at)
        {
            return false;
        }
        self.given_up = (last - (steps - of_kernel) as u64, last);
        true
    }

    /// Steps on their way go back; how many.
    fn hand_back_waiting(&mut self) -> usize {
        let mut count = 0;
        while let Some(step) = self.waiting.take().or_else(|| self.rings.steps.pop().ok()) {
            count += usize::from(!self.is_given_up());
            self.release(step);
        }
        count
    }

    /// Steps into the kernel's queue, as long as it has room.
    fn take_steps(&mut self) {
        while !self.kernel.is_full() {
            let Some(step) = self.waiting.take().or_else(|| self.rings.steps.pop().ok()) else {
                return;
            };
            if self.is_given_up() {
                self.release(step);
                continue;
            }
            if self.kernel.push(&step).is_err() {
                self.waiting = Some(step); // no room for a plan of its kind: again after the next tick
                return;
            }
            self.release(step);
        }
    }

    /// The next step on its way was given up.
    fn is_given_up(&self) -> bool {
        (self.given_up.0..self.given_up.1).contains(&self.taken)
    }

    /// The memory of a step is released by the thread that took it. Its ring has room for all steps that there are at a time.
    fn release(&mut self, step: Step) {
        self.taken += 1;
        if let Err(rtrb::PushError::Full(step)) = self.rings.spent.push(step) {
            core::mem::forget(step); // rather lose its memory than release it here
        }
    }

    fn say(&mut self) {
        let Self { kernel, rings: ServoRings { said, .. }, .. } = self;
        let mut say = |what| {
            let _ = said.push(what); // a thread that does not listen misses it
        };
        if let Some(answered) = kernel.take_answer() {
            say(Said::Answered(answered));
        }
        while let Some(request) = kernel.next_record_request() {
            say(Said::Record(request));
        }
        while let Some(event) = kernel.next_event() {
            say(Said::Event(event));
        }
    }
}

impl ServoThread {
    /// The next record, once there is one; `None`: the thread has ended.
    pub(crate) fn next(&mut self) -> Option<Record> {
        loop {
            if let Ok(record) = self.records.pop() {
                return Some(record);
            }
            if self.is_over.load(Ordering::Acquire) {
                return self.records.pop().ok();
            }
            std::thread::sleep(LOOK);
        }
    }

    /// Records that wait to be looked at.
    pub(crate) fn waiting(&self) -> usize {
        self.records.slots()
    }

    /// How it keeps its time.
    pub(crate) fn metrics(&self) -> &Arc<ServoMetrics> {
        &self.metrics
    }

    /// It ends; what it had comes back, unless it has broken down.
    pub(crate) fn end(mut self) -> Option<(Box<Kernel>, Box<Plant>)> {
        self.stop.store(true, Ordering::Release);
        self.thread.take()?.join().ok()
    }
}

impl Drop for ServoThread {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join(); // it has nothing more to say
        }
    }
}
