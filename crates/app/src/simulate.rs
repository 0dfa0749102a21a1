//! The run: kernel and machine hand each other a command and a feedback each servo period, and everybody
//! who wants to know listens.
//!
//! ```text
//!   Ops ─► Planner ─► queue ─► Kernel::tick ──Command──► SimulatedMachine
//!    │                              ▲                          │
//!    │                              └────────Feedback──────────┤ Sample
//!    └──────────────► Judge, Recorder ◄────────────────────────┘──► trace, log
//! ```
//!
//! One thread does all of it, period by period: two runs of the same inputs are the same to the last bit.
use crate::cam_host::CamHost;
use crate::interrupt;
use crate::keeper::Keeper;
use crate::log::Log;
use crate::pace::Paced;
use crate::patience::Patience;
use crate::plant::Plant;
use crate::polygon::host::PolygonHost;
use crate::program::Ops;
use crate::refused::Refused;
use crate::session::Session;
use crate::stops::Stops;
use crate::timings::Timings;
use crate::trace_thread::TraceThread;
use bus::{Machine, Sample};
use canon::Op;
use indicatif::ProgressBar;
use kernel::{Event, EventKind, Fault, Kernel};
use plan::{Planner, Step, StepKind};
use report::Recorder;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use units::Time;
use verify::{Feature, Judge, Watch};

/// Servo periods between two looks of the progress bar.
const PROGRESS_EVERY: u64 = 4096;

/// Everything a run is made of.
pub(crate) struct Simulation<'a> {
    /// The program's operations.
    pub(crate) ops: Ops<'a>,
    /// Who plans them.
    pub(crate) planner: Planner,
    /// Who executes the plan.
    pub(crate) kernel: Kernel,
    /// Who obeys.
    pub(crate) machine: Plant,
    /// Who writes down what taking a tap out needs.
    pub(crate) keeper: Option<Keeper>,
    /// Who measures and teaches cams.
    pub(crate) cams: CamHost,
    /// Who measures and compensates oscillations of polygons.
    pub(crate) polygons: PolygonHost,
    /// An op that waits for a measurement.
    pub(crate) waiting: Option<(u32, Op)>,
    /// Who judges.
    pub(crate) judge: Judge,
    /// Who looks for what may never happen.
    pub(crate) watch: Watch,
    /// Who looks at a wheel's idle turns, if anybody does.
    pub(crate) idle: Option<verify::IdleTurns>,
    /// Who keeps what pictures need.
    pub(crate) recorder: Recorder,
    /// Who keeps everything.
    pub(crate) trace: Option<TraceThread>,
    /// Who prints what happens.
    pub(crate) log: Option<Log>,
    /// What comes from outside to stop it.
    pub(crate) stops: Stops,
    /// Steps that the kernel has and has not done.
    pub(crate) sent: VecDeque<Step>,
    /// Who measures how long it takes.
    pub(crate) timings: Timings,
    /// How long it is planned to take.
    pub(crate) planned: Time,
    /// Indices of the ops that tap.
    pub(crate) taps: BTreeSet<u32>,
}

/// What came of it.
pub(crate) struct Outcome {
    /// What was cut.
    pub(crate) features: Vec<Feature>,
    /// What pictures need.
    pub(crate) recorder: Recorder,
    /// What may never happen, and whether it did.
    pub(crate) watch: Watch,
    /// How long the machine took.
    pub(crate) cycle_time: Time,
    /// The program came to its end.
    pub(crate) ended: bool,
    /// Alarms.
    pub(crate) faults: Vec<Fault>,
    /// Warnings at run time.
    pub(crate) warnings: Vec<Event>,
    /// What kept each tap from being faster, by the index of its op.
    pub(crate) limiting: BTreeMap<u32, String>,
    /// Drills and taps that were at the spindle drive's limit, by the index of their op.
    pub(crate) saturated: BTreeMap<u32, u32>,
    /// Holes that the program tapped but did not drill.
    pub(crate) assumed_holes: usize,
    /// What repeated taps have learnt.
    pub(crate) lessons: Vec<sync::Lesson>,
    /// What was measured and taught of cams.
    pub(crate) cams: CamHost,
    /// What a wheel's idle turns would have ground.
    pub(crate) idle: Vec<verify::GroundCam>,
    /// How long it took here.
    pub(crate) timings: Timings,
    /// What stopped it from outside, and what became of that.
    pub(crate) happened: Vec<String>,
    /// Faults that were told to happen and have not, in sentences.
    pub(crate) not_triggered: Vec<String>,
    /// Stops in a thread, and the ways out.
    pub(crate) stops: Vec<report::ThreadStop>,
    /// Tools taken off work that they were not screwed to.
    pub(crate) withdrawn: Vec<crate::stops::Withdrawn>,
    /// Why the iron is gone, if it is; why the record is not on the disk, if it is not.
    pub(crate) broke_off: Vec<String>,
}

/// A run of a design helper: nobody stops it, nothing is kept.
pub(crate) struct Trial<'a> {
    /// What the program meets.
    pub(crate) session: &'a Session,
    /// The program.
    pub(crate) text: &'a [u8],
    /// What the interpreter is told.
    pub(crate) setup: &'a interp::Setup,
    /// What the planner is told.
    pub(crate) options: plan::Options,
    /// How long it is planned to take.
    pub(crate) planned: Time,
    /// Who obeys.
    pub(crate) iron: sim::SimulatedMachine,
    /// What is judged by.
    pub(crate) judge: verify::Config,
    /// Look at a wheel's idle turns.
    pub(crate) idle: bool,
}

impl<'a> Trial<'a> {
    /// Run it; an alarm is a refusal.
    pub(crate) fn run(self) -> Result<Outcome, Refused> {
        let outcome = self.run_to_its_end()?;
        match outcome.faults.first() {
            Some(fault) => Err(Refused::because(fault.to_string())),
            None => Ok(outcome),
        }
    }

    /// Run it to its end, or to the alarm that ends it.
    pub(crate) fn run_to_its_end(self) -> Result<Outcome, Refused> {
        let Trial { session, text, setup, options, planned, iron, judge, idle } = self;
        let simulation: Simulation<'a> = Simulation {
            ops: Ops::new(text, setup, session.auto()),
            planner: crate::preflight::planner(session, options),
            kernel: Kernel::new(crate::wiring::control(&session.machine, None, false)),
            machine: Plant::Inside(Box::new(sim::Faulty::new(iron, &[], 0))),
            keeper: None,
            watch: Watch::new(judge.clone()),
            cams: CamHost::new(session.cams.clone()),
            polygons: PolygonHost::new(&session.machine),
            waiting: None,
            idle: idle.then(|| verify::IdleTurns::new(judge.clone())),
            judge: Judge::new(judge),
            recorder: Recorder::new(&session.tools),
            trace: None,
            log: None,
            stops: Stops::none(),
            sent: VecDeque::new(),
            timings: Timings::new(false),
            planned,
            taps: BTreeSet::new(),
        };
        Ok(simulation.run(&ProgressBar::hidden())?)
    }
}

/// A thread that is cut again after its tap was taken out was recovered, though the judge has not seen it.
fn told_of_recovery(mut features: Vec<Feature>, op: Option<u32>) -> Vec<Feature> {
    for feature in features.iter_mut().filter(|feature| Some(feature.op) == op) {
        if let verify::FeatureKind::Thread(thread) = &mut feature.kind {
            thread.recovered = true;
        }
    }
    features
}

impl Simulation<'_> {
    /// Run to the end of the program, or to the alarm that ends it.
    pub(crate) fn run(mut self, progress: &ProgressBar) -> Result<Outcome, store::Error> {
        let mut queue = VecDeque::new();
        let mut limiting = BTreeMap::new();
        let mut saturated = BTreeMap::new();
        let mut warnings = Vec::new();
        let mut feedback = self.machine.feedback();
        let begun = feedback.time;
        let mut patience = Patience::new(self.planned, begun);
        let mut periods: u64 = 0;
        let mut broke_off = Vec::new();
        if self.keeper.is_some() {
            self.kernel.keep_records();
        }
        self.timings.start();
        let mut faults = Vec::new();
        let mut paced = self.paced(&mut queue);
        while !interrupt::came() {
            if self.is_stopped() {
                match self.deal_with_stop(&mut queue, &mut faults) {
                    Ok(true) => {}
                    Ok(false) => break,
                    Err(why) => {
                        broke_off.push(format!("the tool could not be taken out: {why}"));
                        break;
                    }
                }
                feedback = self.machine.feedback();
            }
            self.feed(&mut queue, &mut limiting);
            let started = self.timings.begins();
            let command = self.kernel.tick(&feedback);
            self.timings.tick_ends(started);
            let report = self.kernel.report();
            let sample = Sample { feedback, command, report, truth: self.machine.truth() };
            self.listen(&sample);
            self.let_come(&sample);
            let Self { kernel, planner, sent, .. } = &mut self;
            paced.keep(kernel, planner, &mut queue, sent);
            if feedback.spindles[0].saturated {
                *saturated.entry(report.op).or_insert(0) += 1;
            }
            if let Some(keeper) = &mut self.keeper {
                self.machine.engage(keeper.serve(&mut self.kernel, &feedback));
            }
            self.cams.consult(&mut self.kernel, &mut self.planner);
            self.polygons.consult(&mut self.kernel);
            while let Some(event) = self.kernel.next_event() {
                self.note(&event, &mut warnings);
            }
            let heard = self.machine.exchange(&command);
            for between in crate::late::missed(&feedback, &heard, self.machine.period()) {
                self.kernel.tick(&between);
            }
            feedback = heard;
            periods += 1;
            let times = (begun, feedback.time);
            if let Some(why) = patience.ends(&command, times, self.kernel.operator()) {
                broke_off.push(why);
                break;
            }
            if periods.is_multiple_of(PROGRESS_EVERY) {
                progress.set_position((feedback.time.value() * 1e3) as u64);
            }
        }
        let features = self.timings.judging(|| self.judge.finish());
        self.timings.stop(periods, feedback.time - begun);
        let lost = self.machine.lost().map(|why| format!("the iron is gone: {why}"));
        let recovered = self.keeper.as_ref().and_then(Keeper::recovered);
        let unwritten = self.keeper.and_then(Keeper::finish);
        let unwritten = unwritten.map(|why| format!("the sync record cannot be written: {why}"));
        if let Some(trace) = self.trace {
            trace.finish()?;
        }
        broke_off.extend(lost.into_iter().chain(unwritten));
        if faults.is_empty() {
            faults.extend_from_slice(self.kernel.faults());
        }
        let ended = self.kernel.report().state == bus::State::Ended;
        self.cams.end(self.planner.worn());
        self.cams.keep(self.polygons.said, self.polygons.kept);
        Ok(Outcome {
            features: told_of_recovery(features, recovered),
            recorder: self.recorder,
            watch: self.watch,
            cycle_time: feedback.time - begun,
            ended,
            faults,
            warnings,
            limiting,
            saturated,
            assumed_holes: self.machine.assumed_holes(),
            lessons: self.kernel.lessons().to_vec(),
            cams: self.cams,
            idle: self.idle.map(verify::IdleTurns::finish).unwrap_or_default(),
            timings: self.timings,
            not_triggered: self.stops.not_triggered(feedback.time - begun),
            happened: self.stops.happened,
            stops: self.stops.threads,
            withdrawn: self.stops.withdrawn,
            broke_off,
        })
    }

    /// What comes in this period; the judge knows how far the operator has turned the spindle override.
    fn let_come(&mut self, sample: &Sample) {
        self.stops.act(sample, &mut self.kernel, &mut self.machine);
        self.watch.spindle_override(self.kernel.operator().spindle_share());
    }

    /// What is ordered from the beginning is known before the first move is planned.
    fn paced(&mut self, queue: &mut VecDeque<Step>) -> Paced {
        let (feedback, report) = (self.machine.feedback(), self.kernel.report());
        let (command, truth) = (bus::Command::default(), self.machine.truth());
        let first = Sample { feedback, command, report, truth };
        self.stops.act(&first, &mut self.kernel, &mut self.machine);
        let mut paced = Paced::default();
        paced.keep(&mut self.kernel, &mut self.planner, queue, &mut self.sent);
        paced
    }

    /// Nothing more will happen by itself: the program is over, the control is gone, or it is held and nobody resumes.
    fn is_stopped(&self) -> bool {
        let rests = self.kernel.operator().wants_rest() && self.kernel.is_standing();
        let held = rests && self.kernel.report().state == bus::State::Held;
        self.kernel.is_over() || self.machine.is_abandoned() || held && self.stops.no_orders_left()
    }

    /// Let the machine run down, take a tap out if that is asked for; whether the program goes on.
    fn deal_with_stop(
        &mut self,
        queue: &mut VecDeque<Step>,
        faults: &mut Vec<kernel::Fault>,
    ) -> Result<bool, String> {
        let known = self.kernel.faults().len();
        faults.extend_from_slice(self.kernel.faults());
        if matches!(self.kernel.report().state, bus::State::Ended) {
            return Ok(false);
        }
        let stopped = self.kernel.report().op;
        let Self { stops, kernel, machine, judge, recorder, trace, log, .. } = self;
        let goes_on = stops.deal_with(kernel, machine, judge, &mut |sample| {
            recorder.sample(sample);
            if let Some(trace) = trace {
                trace.push(sample);
            }
            if let Some(log) = log {
                log.sample(sample);
            }
        })?;
        if !goes_on || !kernel.is_over() {
            faults.extend_from_slice(kernel.faults().get(known..).unwrap_or(&[]));
            return Ok(false);
        }
        kernel.go_on();
        // what waited, without the rest of the tap that was stopped
        self.sent.retain(|step| step.op > stopped);
        for step in self.sent.drain(..).rev() {
            queue.push_front(step);
        }
        Ok(true)
    }

    /// Keep the kernel's queue full, as far as the program goes.
    fn feed(&mut self, queue: &mut VecDeque<Step>, limiting: &mut BTreeMap<u32, String>) {
        while !self.kernel.is_full() {
            if let Some(step) = queue.pop_front() {
                self.limits_of(&step, limiting);
                let done = self.kernel.report().op;
                self.sent.retain(|step| step.op >= done);
                self.sent.push_back(step);
                // there is room: it has just been asked
                let _ = self.kernel.push(step);
                continue;
            }
            let next = match self.waiting.take() {
                Some(waiting) => Some(waiting),
                None => self.ops.next().inspect(|(index, op)| {
                    self.cams.op(*index, op);
                    self.polygons.op(*index, op);
                }),
            };
            let Some((index, op)) = next else {
                self.planner.finish(&mut |step| queue.push_back(step));
                if queue.is_empty() {
                    return;
                }
                continue;
            };
            if self.cams.is_early(&op) {
                self.waiting = Some((index, op));
                return;
            }
            if let canon::OpKind::Tap(_) = &op.kind {
                self.taps.insert(index);
            }
            if let Some(keeper) = &mut self.keeper {
                keeper.op(index, &op);
            }
            self.judge.op(index, &op);
            if let Some(idle) = &mut self.idle {
                idle.op(index, &op);
            }
            self.watch.op(index, &op);
            self.recorder.op(index, &op);
            self.recorder.frame(index, self.ops.frame());
            self.planner.written_in(self.ops.frame());
            self.planner.push(index, &op, &mut |step| queue.push_back(step));
            for table in self.planner.take_tables() {
                // the planner's tables are finite, and a step without its table is an alarm
                if let Ok(function) = kernel::Periodic::new(&table.nodes) {
                    let _ = self.kernel.put_table(table.id, function);
                }
            }
        }
    }

    /// What keeps a tap from being faster. One that is not tied to the spindle is a feed in and out at the programmed
    /// speed; in a clutch holder it also waits until the splines have let go and the spindle has turned round.
    fn limits_of(&self, step: &Step, limiting: &mut BTreeMap<u32, String>) {
        match &step.kind {
            StepKind::Tap(tap) => {
                let speed = tap.limiting.speed.name();
                limiting.insert(step.op, format!("{speed}; run-up: {}", tap.limiting.ramp.name()));
            }
            StepKind::Dwell(time) if self.taps.contains(&step.op) => {
                let text = format!("programmed speed; dwell {:.3} s each way", time.value());
                limiting.insert(step.op, text);
            }
            StepKind::Move(_) if self.taps.contains(&step.op) => {
                limiting
                    .entry(step.op)
                    .or_insert_with(|| "programmed speed; reversal: the spindle's own".to_owned());
            }
            _ => {}
        }
    }

    fn listen(&mut self, sample: &Sample) {
        self.cams.sample(sample);
        self.polygons.sample(sample, &self.kernel);
        self.timings.judging(|| self.judge.sample(sample));
        if let Some(idle) = &mut self.idle {
            idle.sample(sample);
        }
        self.watch.sample(sample);
        self.recorder.sample(sample);
        if let Some(trace) = &mut self.trace {
            trace.push(sample);
        }
        if let Some(log) = &mut self.log {
            log.sample(sample);
        }
    }

    fn note(&self, event: &Event, warnings: &mut Vec<Event>) {
        /// More warnings than a person reads.
        const MOST_WARNINGS: usize = 100;
        if self.log.is_some() {
            Log::event(event);
        }
        let warns = matches!(
            event.kind,
            EventKind::FollowingWarning { .. } | EventKind::SyncWarning { .. }
        );
        if warns && warnings.len() < MOST_WARNINGS {
            warnings.push(*event);
        }
    }
}
