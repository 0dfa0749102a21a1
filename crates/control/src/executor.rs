//! One servo period: the kernel answers what the machine has said ([`servo::answer`]), and the
//! machine obeys.
//!
//! ```text
//!   feedback ─► servo::answer ─► command ─► observe ─► exchange ─► next feedback
//!                     ▲                                    │
//!                     └── readings of periods that were missed
//! ```
//!
//! In lock-step all of it happens in [`Executor::period`]; in real time the servo thread does it by
//! the clock, and [`Executor::period`] looks at what it has done, period by period.
use crate::handles::{KernelHandle, MachineHandle};
use crate::missed::missed;
use crate::real_time::{self, KernelLink, RealTimeOptions, ServoThread};
use crate::timings::TickTimes;
use crate::{Drives, RealTimeFigures};
use bus::{Command, Feedback, Sample, State};
use kernel::{Kernel, Request};
use servo::StopLane;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Duration;
use units::Axis;

/// What is said of a servo thread that has ended by itself.
const BROKEN_DOWN: &str = "the servo thread has broken down";

/// A kernel, and the machine that it controls.
pub struct Executor {
    /// The kernel.
    pub kernel: KernelHandle,
    /// The machine.
    pub machine: MachineHandle,
    /// How long its ticks take.
    pub ticks: TickTimes,
    /// Stops that wait in no queue.
    pub stops: Arc<StopLane>,
    /// What the operating system has refused of what real time needs, in sentences.
    pub refused: Vec<String>,
    time: TimeKeeping,
    /// What was said and commanded in the last period.
    last: Box<Ticked>,
}

/// What gives the time.
enum TimeKeeping {
    /// The calls of [`Executor::period`].
    LockStep,
    /// The clock, from the next period on.
    Asked(RealTimeOptions),
    /// The clock.
    RealTime(Box<ServoThread>),
    /// The clock, until the servo thread has ended by itself.
    Ended,
}

impl Executor {
    /// In lock-step.
    pub fn new(kernel: Kernel, machine: Box<dyn Drives>) -> Self {
        Self {
            kernel: kernel.into(),
            machine: machine.into(),
            ticks: TickTimes::new(false),
            stops: Arc::default(),
            refused: Vec::new(),
            time: TimeKeeping::LockStep,
            last: Box::default(),
        }
    }

    /// The machine, if it is in this thread.
    pub fn into_machine(self) -> Option<Box<dyn Drives>> {
        match self.machine {
            MachineHandle::Here(machine) => Some(machine),
            MachineHandle::There(_) => None,
        }
    }

    /// From the next period on in real time.
    pub fn keep_time(&mut self, options: RealTimeOptions) {
        if matches!(self.time, TimeKeeping::LockStep) {
            self.ticks = TickTimes::new(true);
            self.time = TimeKeeping::Asked(options);
        }
    }

    /// It is, or will be from the next period on, in real time.
    pub const fn keeps_time(&self) -> bool {
        !matches!(self.time, TimeKeeping::LockStep)
    }

    /// Begin real time now, if it was asked for.
    pub fn begin_real_time(&mut self) {
        let TimeKeeping::Asked(options) = self.time else { return };
        let (Some(kernel), Some(machine)) = (self.kernel.here(), self.machine.here()) else {
            return;
        };
        let is_elsewhere = machine.seat().is_some();
        let (kernel_link, machine_link, prepared) =
            real_time::prepare(kernel, machine, &self.stops);
        let kernel = std::mem::replace(&mut self.kernel, KernelHandle::There(kernel_link));
        let machine = std::mem::replace(&mut self.machine, MachineHandle::There(machine_link));
        let (KernelHandle::Here(kernel), MachineHandle::Here(machine)) = (kernel, machine) else {
            return;
        };
        let before = KernelBefore::of(&kernel);
        match prepared.start(kernel, machine, self.ticks.clone(), options) {
            Ok((thread, refused)) => {
                self.time = TimeKeeping::RealTime(Box::new(thread));
                self.refused = refused;
                if is_elsewhere && let KernelHandle::There(link) = &mut self.kernel {
                    before.hand_over(link);
                }
            }
            Err(why) => {
                self.time = TimeKeeping::Ended;
                self.kernel.lose();
                self.machine.lose(&why);
            }
        }
    }

    /// Back to lock-step; kernel and machine are here again. Why not, if they are not.
    pub fn end_real_time(&mut self) -> Option<String> {
        let TimeKeeping::RealTime(thread) =
            std::mem::replace(&mut self.time, TimeKeeping::LockStep)
        else {
            return None;
        };
        if let Some((kernel, machine)) = thread.end() {
            self.kernel = KernelHandle::Here(kernel);
            self.machine = MachineHandle::Here(machine);
            return None;
        }
        self.time = TimeKeeping::Ended;
        self.kernel.lose();
        self.machine.lose(BROKEN_DOWN);
        Some(BROKEN_DOWN.into())
    }

    /// How the servo thread keeps its time; `None` in lock-step.
    pub fn real_time(&self) -> Option<RealTimeFigures> {
        match &self.time {
            TimeKeeping::RealTime(thread) => Some(thread.metrics().figures(&self.ticks)),
            TimeKeeping::LockStep | TimeKeeping::Asked(_) | TimeKeeping::Ended => None,
        }
    }

    /// Periods that are over and were not looked at yet; in lock-step there are none.
    pub fn periods_waiting(&self) -> usize {
        match &self.time {
            TimeKeeping::RealTime(thread) => thread.waiting(),
            TimeKeeping::LockStep | TimeKeeping::Asked(_) | TimeKeeping::Ended => 0,
        }
    }

    /// One servo period. In real time: the next one that is over; it is waited for.
    pub fn period(
        &mut self,
        observe: impl FnOnce(&mut KernelHandle, &mut MachineHandle, &Sample),
    ) -> &Sample {
        self.begin_real_time();
        let Self { kernel, machine, ticks, stops, time, last, .. } = self;
        if let TimeKeeping::RealTime(thread) = time {
            if let Some(record) = thread.next() {
                kernel.see(&record);
                machine.see(&record);
                observe(kernel, machine, &record.sample);
                last.answer.sample = record.sample;
                return last.sample();
            }
            kernel.lose();
            machine.lose(thread.why().unwrap_or(BROKEN_DOWN));
        }
        let (Some(ticked), Some(moved)) = (kernel.here(), machine.here()) else {
            // time passes all the same: what waits with a limit does not wait for ever
            std::thread::sleep(Duration::from_secs_f64(machine.period().value()));
            machine.pass();
            let report = bus::Report { state: State::Faulted, ..kernel.report() };
            let feedback = *machine.feedback();
            last.answer.sample = Sample { feedback, report, ..Sample::default() };
            return last.sample();
        };
        let flags = stops.take();
        servo::stop(ticked, flags);
        real_time::strike(moved, flags);
        answer(ticked, moved, ticks, last);
        observe(kernel, machine, last.sample());
        if let (Some(kernel), Some(machine)) = (kernel.here(), machine.here()) {
            obey(kernel, machine, last);
        }
        last.sample()
    }
}

/// What was done to a kernel before the first period, for the one in another process that takes its
/// place.
struct KernelBefore {
    is_off: bool,
    not_homed: Vec<Axis>,
}

impl KernelBefore {
    fn of(kernel: &Kernel) -> Self {
        let not_homed = Axis::ALL.into_iter().filter(|axis| !kernel.is_homed(*axis)).collect();
        Self { is_off: kernel.is_off(), not_homed }
    }

    fn hand_over(self, link: &mut KernelLink) {
        if self.is_off {
            link.ask(Request::SwitchOff);
        }
        for axis in self.not_homed {
            link.ask(Request::ForgetHome(axis));
        }
    }
}

/// What the machine has said in a period, and what the kernel has answered.
#[derive(Default)]
pub(crate) struct Ticked {
    answer: servo::PeriodAnswer,
    /// What the machine had said, in its own counts.
    feedback: Feedback,
    /// A machine whose control is gone (a simulated failure) goes on without a tick.
    is_abandoned: bool,
}

impl Ticked {
    /// What observers see: positions.
    pub(crate) const fn sample(&self) -> &Sample {
        &self.answer.sample
    }
}

/// The first half of a period: what the machine has said, and what the kernel commands, in the
/// place of the period before.
pub(crate) fn answer(
    kernel: &mut Kernel,
    machine: &dyn Drives,
    ticks: &TickTimes,
    ticked: &mut Ticked,
) {
    let Ticked { answer, feedback, is_abandoned } = ticked;
    *feedback = *machine.feedback();
    *is_abandoned = machine.is_abandoned();
    if *is_abandoned {
        let report = bus::Report { state: State::Faulted, ..kernel.report() };
        answer.sample = Sample { feedback: *feedback, report, ..Sample::default() };
        answer.command = Command::default();
        kernel.in_positions(&mut answer.sample);
    } else {
        ticks.time(|| servo::answer(kernel, feedback, answer));
    }
    answer.sample.truth = machine.truth().copied();
}

/// The second half: the machine obeys, and the kernel lives through the periods that were missed
/// meanwhile.
pub(crate) fn obey(kernel: &mut Kernel, machine: &mut dyn Drives, ticked: &Ticked) {
    if ticked.is_abandoned {
        return machine.wait();
    }
    let period = machine.period();
    let heard = machine.exchange(&ticked.answer.command);
    // where frames were lost the kernel has lived through these periods already
    let lived = kernel.ticks_without_news() as usize;
    for between in missed(&ticked.feedback, heard, period).skip(lived) {
        servo::answer(kernel, &between, &mut servo::PeriodAnswer::default());
    }
}

/// One servo period of a kernel and a machine that are here. `observe` sees what was heard and what
/// is commanded before the command is sent; if it breaks off, nothing is sent.
pub fn period<B>(
    kernel: &mut Kernel,
    machine: &mut dyn Drives,
    observe: impl FnOnce(&mut Kernel, &mut dyn Drives, &Sample) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let mut ticked = Ticked::default();
    answer(kernel, machine, &TickTimes::new(false), &mut ticked);
    observe(kernel, machine, ticked.sample())?;
    obey(kernel, machine, &ticked);
    ControlFlow::Continue(())
}
