//! The servo thread: one turn per period, from the rings to the rings.
use super::kernel_link::{KernelLink, KernelRings};
use super::machine_link::{MachineLink, MachineRequest};
use super::{RECORDS, REQUESTS, RealTimeOptions, SAID, STEPS, ServoMetrics, scheduling};
use crate::clock::PeriodClock;
use crate::executor::{Ticked, answer, obey};
use crate::timings::TickTimes;
use crate::{Drives, Refused};
use bus::Sample;
use kernel::{Kernel, Request};
use plan::{Boxed, Step};
use rtrb::{Consumer, Producer, RingBuffer};
use servo::{LaneStop, Record, Replied, Rings, Said, StopLane};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::Duration;

/// Between two looks whether a record has come.
const LOOK: Duration = Duration::from_micros(250);

/// What a servo thread takes, and gives back at its end.
pub(crate) type KernelAndMachine = (Box<Kernel>, Box<dyn Drives>);

/// A servo thread that runs. Dropped, it stops and is waited for.
pub(crate) struct ServoThread {
    thread: Option<JoinHandle<KernelAndMachine>>,
    stop: Arc<AtomicBool>,
    is_over: Arc<AtomicBool>,
    records: Consumer<Record>,
    metrics: Arc<ServoMetrics>,
    /// Why it has ended by itself, where that is known.
    why: Arc<OnceLock<String>>,
}

/// What the servo thread will hold beside kernel and machine.
pub(crate) struct Prepared {
    rings: ServoRings,
    records: Consumer<Record>,
    is_over: Arc<AtomicBool>,
}

/// What the thread owns.
struct Servo {
    seat: servo::Seat<ServoRings>,
    machine: Box<dyn Drives>,
    /// The last period.
    ticked: Box<Ticked>,
    ticks: TickTimes,
    metrics: Arc<ServoMetrics>,
    /// Why it has ended.
    why: Arc<OnceLock<String>>,
}

/// The rings' ends on this side.
pub(super) struct ServoRings {
    pub(super) requests: Consumer<Request>,
    pub(super) replies: Producer<Replied>,
    pub(super) steps: Consumer<Step>,
    pub(super) spent: Producer<Step>,
    pub(super) said: Producer<Said>,
    pub(super) records: Producer<Record>,
    pub(super) of_machine: Consumer<MachineRequest>,
    pub(super) stops: Arc<StopLane>,
}

/// All that connects the servo thread with the control's, for this kernel and this machine.
pub(crate) fn prepare(
    kernel: &Kernel,
    machine: &mut dyn Drives,
    stops: &Arc<StopLane>,
) -> (Box<KernelLink>, Box<MachineLink>, Prepared) {
    let picture = kernel.picture();
    let (feedback, truth) = (*machine.feedback(), machine.truth().copied());
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
    let kernel_link = KernelLink::new(rings, Arc::clone(&is_over), Arc::clone(stops), &picture);
    let period = machine.period();
    let retained = machine.seat().and_then(|seat| seat.retained());
    let machine_link =
        MachineLink::new(machine_requests, Arc::clone(stops), &sample, period, retained);
    let rings = ServoRings {
        requests: asked,
        replies,
        steps: sent,
        spent,
        said,
        records,
        of_machine,
        stops: Arc::clone(stops),
    };
    let prepared = Prepared { rings, records: seen, is_over };
    (Box::new(kernel_link), Box::new(machine_link), prepared)
}

impl Prepared {
    /// The thread begins; what the operating system has refused of what real time needs.
    ///
    /// # Errors
    /// No thread can be started.
    pub(crate) fn start(
        self,
        kernel: Box<Kernel>,
        mut machine: Box<dyn Drives>,
        ticks: TickTimes,
        options: RealTimeOptions,
    ) -> Result<(ServoThread, Vec<String>), String> {
        let Self { rings, records, is_over } = self;
        let metrics = Arc::new(ServoMetrics::default());
        let stop = Arc::new(AtomicBool::new(false));
        let why = Arc::new(OnceLock::new());
        if machine.seat().is_some() {
            let over = Over(Arc::clone(&is_over));
            let bridge = (Arc::clone(&stop), Arc::clone(&metrics), Arc::clone(&why));
            let thread = super::bridge::start(rings, (kernel, machine), bridge, over)?;
            let thread = ServoThread { thread: Some(thread), stop, is_over, records, metrics, why };
            return Ok((thread, Vec::new()));
        }
        let servo = Servo {
            seat: servo::Seat::new(kernel, rings),
            machine,
            ticked: Box::default(),
            ticks,
            metrics: Arc::clone(&metrics),
            why: Arc::clone(&why),
        };
        let (up, is_up) = std::sync::mpsc::sync_channel(1);
        let (told, over) = (Arc::clone(&stop), Over(Arc::clone(&is_over)));
        let thread = std::thread::Builder::new().name("servo".into());
        let thread = thread.spawn(move || {
            let _over = over;
            let _ = up.send(scheduling::run_by_deadline(options.priority)); // the other side waits for it
            servo.run(&told, options.around)
        });
        let thread = thread.map_err(|e| format!("cannot start the servo thread: {e}"))?;
        let refused = is_up.recv().unwrap_or_default();
        Ok((ServoThread { thread: Some(thread), stop, is_over, records, metrics, why }, refused))
    }
}

/// Says that the thread has ended, however it did.
pub(super) struct Over(Arc<AtomicBool>);

impl Drop for Over {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

impl Servo {
    fn run(mut self, stop: &AtomicBool, around: fn(&mut dyn FnMut())) -> KernelAndMachine {
        let period = Duration::from_secs_f64(self.machine.period().value());
        let mut clock = PeriodClock::new(period);
        while !stop.load(Ordering::Acquire) {
            if let Err(refused) = self.period(around) {
                let _ = self.why.set(refused.to_string()); // it ends once
                break;
            }
            let begun = clock.wait();
            self.metrics.begun(begun.late, period, begun.is_set_anew);
        }
        (self.seat.kernel, self.machine)
    }

    /// What is asked of the machine is taken after what is asked of the kernel: who has asked the
    /// machine first finds it done first.
    fn period(&mut self, around: fn(&mut dyn FnMut())) -> Result<(), Refused> {
        let mut answered = None;
        around(&mut || {
            let stops = self.seat.before_tick();
            strike(&mut *self.machine, stops);
            answer(&mut self.seat.kernel, &*self.machine, &self.ticks, &mut self.ticked);
            let number = self.seat.after_tick();
            answered = Some((number, self.seat.kernel.picture()));
        });
        self.ask_machine()?;
        let Some((number, picture)) = answered else { return Ok(()) };
        let sample = *self.ticked.sample();
        obey(&mut self.seat.kernel, &mut *self.machine, &self.ticked);
        self.metrics.period();
        let heard = *self.machine.feedback();
        let record = Record { number, sample, heard, picture, taken: self.seat.taken() };
        if self.seat.rings.records.push(record).is_err() {
            self.metrics.unobserved();
        }
        Ok(())
    }

    /// What is asked of the machine: at most what the ring holds.
    fn ask_machine(&mut self) -> Result<(), Refused> {
        while let Ok(request) = self.seat.rings.of_machine.pop() {
            match request {
                MachineRequest::Clamp(grinding) => self.machine.clamp(*grinding)?,
                MachineRequest::ClampStock(stock) => self.machine.clamp_stock(&stock.0, stock.1),
                MachineRequest::RenewTool(number) => self.machine.renew_tool(number),
                MachineRequest::RenewWork => self.machine.renew_work(),
                MachineRequest::Strike(fault) => self.machine.strike(fault),
                MachineRequest::Repair(fault) => self.machine.repair(fault),
                MachineRequest::Mend => self.machine.mend(),
                MachineRequest::Engage(engagement) => self.machine.engage(engagement),
            }
        }
        Ok(())
    }
}

/// The chain of a simulated machine opens with the stop that was asked for.
pub(crate) fn strike(machine: &mut dyn Drives, stops: u32) {
    if LaneStop::EmergencyStop.is_in(stops) {
        machine.strike(sim::Fault::EmergencyStop);
    }
}

impl Rings for ServoRings {
    type Storage = Boxed;

    fn next_request(&mut self) -> Option<Request> {
        if self.replies.is_full() { None } else { self.requests.pop().ok() }
    }

    fn reply(&mut self, replied: Replied) {
        let _ = self.replies.push(replied); // there was room before the request was taken
    }

    fn next_step(&mut self) -> Option<Step> {
        self.steps.pop().ok()
    }

    fn steps_waiting(&self) -> usize {
        self.steps.slots()
    }

    /// The memory of a step is released by the thread that took it. Its ring has room for all steps
    /// that there are at a time.
    fn release(&mut self, step: Step) {
        if let Err(rtrb::PushError::Full(step)) = self.spent.push(step) {
            core::mem::forget(step); // rather lose its memory than release it here
        }
    }

    fn can_say(&self) -> bool {
        !self.said.is_full()
    }

    fn say(&mut self, said: Said) {
        let _ = self.said.push(said); // there was room before
    }

    fn stops(&mut self) -> u32 {
        self.stops.take()
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

    /// Why it has ended by itself, where that is known.
    pub(crate) fn why(&self) -> Option<&str> {
        self.why.get().map(String::as_str)
    }

    /// How it keeps its time.
    pub(crate) fn metrics(&self) -> &Arc<ServoMetrics> {
        &self.metrics
    }

    /// It ends; what it had comes back, unless it has broken down.
    pub(crate) fn end(mut self) -> Option<KernelAndMachine> {
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
