//! A program on a machine, from the first period to its end, or to the alarm that ends it.
use crate::Drives;
use crate::Refused;
use crate::config;
use crate::job::Operations;
use crate::job::Session;
use crate::job::preflight::planner;
use crate::job::restart::Restart;
use crate::messages::Message;
use crate::observers::{self, Observing, ToolUseCount, TraceThread, Workpiece};
use crate::outcome::{EndedRun, Outcome, unobserved};
use crate::services::RecordWriter;
use crate::stall::StallGuard;
use crate::{Executor, Feeder, KernelHandle, Observers, RealTimeFigures, Services};
use bus::{EngagedTool, Sample, State};
use kernel::{Event, Fault, Kernel};
use std::ops::ControlFlow;
use std::sync::Arc;
use units::Time;
use verify::Feature;

/// Servo periods between two looks of the progress bar.
const PROGRESS_EVERY: u64 = 4096;

/// A program that is ready to run. What is usual stands in it from the beginning; a caller changes
/// what is not.
pub struct ProgramRun {
    /// Kernel and machine.
    pub executor: Executor,
    /// Operations, planner and steps.
    pub feeder: Feeder,
    /// What answers the kernel.
    pub services: Services,
    /// What looks on.
    pub observers: Observers,
    /// It looks on in a thread of its own, also in lock-step: worth while where a core is idle.
    pub observes_beside: bool,
    /// Asked every period: whether the run is to end at once.
    pub is_interrupted: fn() -> bool,
    planned: Option<Time>,
}

/// What a run cannot do without.
pub struct Loaded<'a> {
    /// What the program meets.
    pub session: &'a Session,
    /// The program's operations.
    pub operations: &'a Arc<Operations>,
    /// Where it is begun, if not at its beginning.
    pub restart: Option<&'a Restart>,
    /// What the planner is told.
    pub options: plan::Options,
    /// How long it is planned to take, if that is known.
    pub planned: Option<Time>,
}

impl ProgramRun {
    /// Of this program, on this machine, judged by this: nothing stops it, nothing is kept, nothing
    /// is learnt.
    pub fn new(loaded: &Loaded<'_>, machine: Box<dyn Drives>, judge: verify::Config) -> Self {
        let Loaded { session, operations, restart, options, planned } = *loaded;
        let kernel = Kernel::new(config::control(&session.machine, None, false));
        let ops = operations.for_run(restart, 0);
        Self {
            executor: Executor::new(kernel, machine),
            feeder: Feeder::new(ops, planner(session, options)),
            services: Services::new(session),
            observers: Observers::new(session, Workpiece::new(judge)),
            observes_beside: false,
            is_interrupted: || false,
            planned,
        }
    }

    /// Run it; an alarm is a refusal.
    ///
    /// # Errors
    /// The alarm, and what a run cannot begin or go on with.
    pub fn run_without_alarm(self) -> Result<Outcome, Refused> {
        let outcome = self.run(&mut |_| {})?;
        match outcome.faults.first() {
            Some(fault) => Err(Refused::because(fault.to_string())),
            None => Ok(outcome),
        }
    }

    /// Run to the end of the program, or to the alarm that ends it. `progress` hears now and then
    /// how long the machine has been at it.
    ///
    /// # Errors
    /// The trace cannot be written.
    pub fn run(self, progress: &mut dyn FnMut(Time)) -> Result<Outcome, store::Error> {
        let is_interrupted = self.is_interrupted;
        let (mut running, mut executor) = self.begin();
        while !is_interrupted() && running.period(&mut executor).is_continue() {
            if running.periods.is_multiple_of(PROGRESS_EVERY) {
                progress(running.now);
            }
        }
        running.end_real_time(&mut executor);
        running.end().finish(&mut executor)
    }

    /// The first period is about to come, of this kernel and machine.
    pub fn begin(self) -> (Running, Executor) {
        let Self { mut executor, feeder, services, observers, observes_beside, planned, .. } = self;
        let begun = executor.machine.feedback().time;
        let stall = Some(StallGuard::new(planned, begun));
        let running = Running::with((feeder, services, observers), stall, &mut executor);
        (Running { observes_beside, ..running }, executor)
    }
}

/// A program that is under way.
pub struct Running {
    feeder: Feeder,
    services: Services,
    observers: Observing,
    observes_beside: bool,
    is_attended: bool,
    begun: Time,
    now: Time,
    stall: Option<StallGuard>,
    /// Time since which it is held.
    held_since: Option<Time>,
    periods: u64,
    /// The last period.
    sample: Sample,
    real_time: Option<RealTimeFigures>,
    faults: Vec<Fault>,
    broke_off: Vec<String>,
    /// What the kernel has said, for an operator who has not looked yet.
    heard: Vec<Event>,
}

impl Running {
    /// A program begins on a machine whose kernel is at work, before an operator who resumes what
    /// is held, confirms stops and takes tools out.
    ///
    /// Its operations are numbered from `first` on: those of what was done to the workpiece before
    /// come first.
    pub fn attended(
        loaded: &Loaded<'_>,
        workpiece: Workpiece,
        first: u32,
        executor: &mut Executor,
    ) -> Self {
        let Loaded { session, operations, restart, options, .. } = *loaded;
        let ops = operations.for_run(restart, first);
        let feeder = Feeder::new(ops, planner(session, options));
        let parts = (feeder, Services::new(session), Observers::new(session, workpiece));
        Self::with(parts, None, executor)
    }

    /// The next thing that the program says to its operator; `is_over`: the machine goes no
    /// further.
    pub fn next_message(&mut self, op: u32, is_over: bool) -> Option<Message> {
        self.feeder.messages.next(op, is_over)
    }

    /// What the kernel has said since the last time; without an operator nothing is kept.
    pub fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.heard)
    }

    fn with(
        (feeder, services, observers): (Feeder, Services, Observers),
        stall: Option<StallGuard>,
        executor: &mut Executor,
    ) -> Self {
        if services.record_writer.is_some() {
            executor.kernel.keep_records();
        }
        let begun = executor.machine.feedback().time;
        let mut observers = Box::new(observers);
        observers.timings.start();
        let mut running = Self {
            feeder,
            services,
            observers: Observing::Here(observers),
            observes_beside: false,
            is_attended: stall.is_none(),
            begun,
            now: begun,
            stall,
            held_since: None,
            periods: 0,
            sample: Sample::default(),
            real_time: None,
            faults: Vec::new(),
            broke_off: Vec::new(),
            heard: Vec::new(),
        };
        running.orders_from_the_beginning(executor);
        running
    }

    /// What is ordered from the beginning is known before the first move is planned.
    fn orders_from_the_beginning(&mut self, executor: &mut Executor) {
        let Executor { kernel, machine, .. } = executor;
        let (feedback, report) = (*machine.feedback(), kernel.report());
        let truth = machine.truth().copied();
        let first = Sample { feedback, report, truth, ..Sample::default() };
        self.services.stops.act(&first, kernel, machine);
        self.feeder.follow_overrides(kernel);
    }

    /// Since when it runs.
    pub const fn begun(&self) -> Time {
        self.begun
    }

    /// How long what is planned and waits will take.
    pub fn ahead(&self) -> Time {
        self.feeder.ahead.time()
    }

    /// How long the machine has been at it.
    pub const fn now(&self) -> Time {
        self.now
    }

    /// It is interpreted while the machine executes.
    pub fn is_live(&self) -> bool {
        self.feeder.ops.is_live()
    }

    /// The last period, as it was observed.
    pub const fn sample(&self) -> &Sample {
        &self.sample
    }

    /// How often what may never happen did.
    pub fn breach_count(&self) -> usize {
        self.observers.breach_count()
    }

    /// What was cut and judged so far.
    pub fn judged_so_far(&self) -> &[Feature] {
        self.observers.features()
    }

    /// Places of features whose verdict was changed after they were judged: those of the changes
    /// from this one on.
    pub fn changed_since(&self, change: usize) -> &[usize] {
        self.observers.changed_since(change)
    }

    /// Before the first period: who reads [`Running::next_mark`] answers the kernel.
    pub const fn record_marks(&mut self, recorded: bool) {
        self.services.sequences.is_recorded = recorded;
    }

    /// The next mark of a sequence that the kernel has come to and waits at.
    pub fn next_mark(&mut self) -> Option<crate::services::sequence::ReachedMark> {
        self.services.sequences.next_reached()
    }

    /// Before the first period: keep what pictures need, and every period.
    pub fn record(&mut self, recorder: report::Recorder, trace: TraceThread) {
        if let Some(observers) = self.observers.here() {
            (observers.recorder, observers.trace) = (recorder, Some(trace));
        }
    }

    /// Before the first period: keep the sync record.
    pub fn keep_sync_record(&mut self, writer: RecordWriter, executor: &mut Executor) {
        self.services.record_writer = Some(writer);
        executor.kernel.keep_records();
    }

    /// Of the sync record's writer: number of the machine's last engagement, and the tool in its
    /// work.
    pub fn engaged(&self) -> Option<(u64, Option<EngagedTool>)> {
        self.services.record_writer.as_ref().map(RecordWriter::engaged)
    }

    /// What each tool had cut when the last feature was judged, or since.
    pub fn tool_use(&self) -> std::collections::BTreeMap<u32, canon::ToolUse> {
        self.observers.tool_use()
    }

    /// Before the first period: count what each tool cuts; this one is in the spindle.
    pub fn count_tool_use(&mut self, tool: u32) {
        if let Some(observers) = self.observers.here() {
            observers.tool_use = Some(ToolUseCount::with(tool));
        }
    }

    /// One servo period; it breaks off when the program is over.
    pub fn period(&mut self, executor: &mut Executor) -> ControlFlow<()> {
        if self.is_stopped(executor) {
            // said now: the handle to a servo thread is gone when the run has ended
            let lost = executor.machine.lost().filter(|why| !self.broke_off.contains(why));
            self.broke_off.extend(lost);
            if self.is_attended {
                return ControlFlow::Break(());
            }
            let held = self.nobody_resumes(executor);
            match self.deal_with_stop(executor) {
                Ok(true) => {}
                Ok(false) => {
                    self.broke_off.extend(held);
                    return ControlFlow::Break(());
                }
                Err(why) => {
                    self.broke_off.push(format!("the tool could not be taken out: {why}"));
                    return ControlFlow::Break(());
                }
            }
        }
        if executor.keeps_time() {
            self.broke_off.extend(self.observers.begin_beside(1).err());
        } else if self.observes_beside {
            // without a thread they look on from here
            self.observes_beside = self.observers.begin_beside(observers::BATCH).is_ok();
        }
        let Self { feeder, services, observers, is_attended, heard, .. } = self;
        feeder.fill(&mut executor.kernel, services, observers);
        self.sample = *executor.period(|kernel, machine, sample| {
            services.sample(sample, kernel);
            observers.sample(sample);
            services.stops.act(sample, kernel, machine);
            observers.spindle_override(kernel.operator().spindle_share());
            feeder.follow_overrides(kernel);
            services.serve(kernel, machine, &mut feeder.planner, sample);
            if let Some(answered) = kernel.take_answer() {
                feeder.answer(&answered);
            }
            while let Some(event) = kernel.next_event() {
                observers.event(&event);
                if *is_attended {
                    heard.push(event);
                }
            }
        });
        if executor.kernel.is_idle() && !self.feeder.refused().is_empty() {
            let said = self.feeder.refused().iter();
            self.broke_off.extend(said.map(|d| format!("line {}: {}", d.span.line, d.message)));
            return ControlFlow::Break(());
        }
        self.feeder.done(&executor.kernel);
        self.periods += 1;
        self.now = executor.machine.feedback().time;
        let is_held = executor.kernel.report().state == State::Held;
        self.held_since = is_held.then(|| self.held_since.unwrap_or(self.now));
        let (times, kernel) = ((self.begun, self.now), &executor.kernel);
        let given_up =
            self.stall.as_mut().and_then(|stall| stall.ends(&self.sample.command, times, kernel));
        let given_up = given_up.map(|why| self.nobody_resumes(executor).unwrap_or(why));
        let given_up = given_up.or_else(|| self.nobody_confirms(&executor.kernel));
        match given_up {
            Some(why) => {
                self.broke_off.push(why);
                ControlFlow::Break(())
            }
            None => ControlFlow::Continue(()),
        }
    }

    /// Nothing more will happen by itself: the program is over, the control is gone, or it is held
    /// and no order to resume will come.
    fn is_stopped(&self, executor: &Executor) -> bool {
        let Executor { kernel, machine, .. } = executor;
        let rests = kernel.operator().wants_rest() && kernel.is_standing();
        let held = rests && kernel.report().state == State::Held && !self.is_attended;
        kernel.is_over() || machine.is_abandoned() || held && self.services.stops.no_orders_left()
    }

    /// The program is held, and no order to resume is left.
    fn nobody_resumes(&self, executor: &Executor) -> Option<String> {
        let kernel = &executor.kernel;
        let is_held = kernel.report().state == State::Held && kernel.faults().is_empty();
        let (line, since) = (kernel.report().line, self.held_since.unwrap_or(self.now).value());
        let by = if kernel.operator().is_held_after_block() { " after a block" } else { "" };
        is_held.then(|| {
            format!(
                "line {line}: held{by} at {since:.3} s, and nobody resumes it: --operator \"resume at {:.0}s\" would do",
                since.ceil() + 1.0
            )
        })
    }

    /// Something waits to be confirmed, and no order to confirm is left.
    fn nobody_confirms(&self, kernel: &KernelHandle) -> Option<String> {
        if self.is_attended || !self.services.stops.no_orders_left() {
            return None;
        }
        let waiting = kernel.waiting().filter(|waiting| waiting.what.is_for_operator())?;
        let (what, line) = (waiting.what, kernel.report().line);
        Some(format!(
            "line {line} waits for {what}, and no order to confirm is left: --operator \"confirm at {:.0}s\" would do",
            waiting.since.value() + 1.0
        ))
    }

    /// Let the machine run down, take a tap out if that is asked for; whether the program goes on.
    fn deal_with_stop(&mut self, executor: &mut Executor) -> Result<bool, String> {
        if !executor.keeps_time() {
            self.observers.come_back();
        }
        let Self { feeder, services, observers, faults, .. } = self;
        let Executor { kernel, machine, .. } = executor;
        let here = (kernel.here(), machine.here(), observers.here());
        let (Some(kernel), Some(machine), Some(observers)) = here else {
            faults.extend_from_slice(executor.kernel.faults());
            return Ok(false); // in real time nothing is tried that needs a machine to be stopped and copied
        };
        let known = kernel.faults().len();
        faults.extend_from_slice(kernel.faults());
        if matches!(kernel.report().state, State::Ended) {
            return Ok(false);
        }
        let stopped = kernel.report().op;
        let Observers { judge, recorder, trace, others, watch, .. } = observers;
        let goes_on = services.stops.deal_with(kernel, machine, judge, &mut |sample| {
            watch.sample(sample);
            recorder.sample(sample);
            if let Some(trace) = trace {
                trace.push(sample);
            }
            for other in &mut *others {
                other.sample(sample);
            }
        })?;
        if !goes_on || !kernel.is_over() {
            faults.extend_from_slice(kernel.faults().get(known..).unwrap_or(&[]));
            return Ok(false);
        }
        kernel.go_on();
        feeder.send_again_after(stopped);
        Ok(true)
    }

    /// Kernel and machine come back from the servo thread.
    fn end_real_time(&mut self, executor: &mut Executor) {
        self.real_time = executor.real_time();
        self.broke_off.extend(executor.end_real_time());
        self.broke_off.extend(self.real_time.as_ref().and_then(unobserved));
    }

    /// Nothing more is executed: the observers have looked at all there was.
    pub fn end(self) -> EndedRun {
        let Self {
            feeder,
            services,
            observers,
            begun,
            now,
            faults,
            broke_off,
            periods,
            real_time,
            ..
        } = self;
        let observers = *observers.end();
        EndedRun { feeder, services, observers, begun, now, faults, broke_off, periods, real_time }
    }
}
