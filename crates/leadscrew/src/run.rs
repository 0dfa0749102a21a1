//! One run of a program: on the machine that is simulated, or on one in another process; what stops
//! it, what is learnt and written down meanwhile, and what is known at its end.
//!
//! ```text
//!   Job + RunOptions ─► Run::prepare ─► link, memory ─► prove ─► execute ─► Finished ─► certificate, report
//!                            └► NotReady: a tool is, or may be, in the work
//! ```
use crate::link::{Link, NotReady};
use crate::program::{Job, Program};
use crate::replay::{Replay, With};
use crate::run_outputs;
use crate::time::{Added, WithoutJerk};
use canon::Material;
use control::job::preflight::{self, Proved, wrong_from};
use control::job::restart::{self, Restart};
use control::observers::{Observer, TraceThread};
use control::operation::EndedProgram;
use control::script::{self, Told};
use control::services::learning::Memory;
use control::stops::{AfterStop, Stops};
use control::{Loaded, Outcome, ProgramRun, RealTimeOptions, Refused, TickTimes, Timings, config};
use kernel::{Kernel, Order, Pause};
use std::path::{Path, PathBuf};
use store::certificate::Certificate;
use store::machine::{Follows, StockMaterial};
use store::output::Folder;
use store::state::broken_tools;
use store::trace::{Columns, Writer};
use sync::{Prediction, SyncMode};
use units::Time;

/// How a run is done; the default is that of `leadscrew run` without options.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Seed of what the control does not know of its machine, and of what scatters; `None` is the
    /// machine file's.
    pub seed: Option<u64>,
    /// Number of the workpiece on that machine; `None` is the first.
    pub part: Option<u32>,
    /// Material of the workpiece by its name; `None` is the machine's set-up.
    pub material: Option<String>,
    /// Unit of lengths in report and tables; `None` is as the program writes them.
    pub units: Option<canon::LengthUnit>,
    /// How the feed is tied to the spindle; `None` is as the machine's file says.
    pub synchronisation: Option<Synchronisation>,
    /// Force the tapping ramp from rest to full speed into this time, 1 ms to 60 s.
    pub force_ramp: Option<Time>,
    /// File of what is learnt from tap to tap; `off` is none; `None` is as the machine's file says.
    pub learning: Option<PathBuf>,
    /// Tools in whose place new ones are since they broke.
    pub renewed: Vec<u32>,
    /// Begin in the middle.
    pub from: Option<restart::From>,
    /// Begin there also where the program was changed since the sync record was written.
    pub program_changed: bool,
    /// Faults of the machine, as `WHAT at MOMENT`.
    pub faults: Vec<String>,
    /// Orders of the operator, as `WHAT at MOMENT`.
    pub operator: Vec<String>,
    /// After a stop in a thread, take the tool out.
    pub recover: Option<AfterStop>,
    /// Socket of a machine in another process.
    pub socket: Option<PathBuf>,
    /// Folder of the sync record.
    pub state: Option<PathBuf>,
    /// The words behind `leadscrew run` that do the same job again.
    pub command: Vec<String>,
    /// Measure how long the kernel's ticks take.
    pub timings: bool,
    /// By the clock, with kernel and machine in a servo thread; `None` is as fast as it goes.
    pub real_time: Option<RealTimeOptions>,
}

/// How the feed is tied to the spindle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Synchronisation {
    /// Spindle and feed obey one planned trajectory.
    Command,
    /// The feed follows the observed spindle, predicted to when the command acts.
    Encoder,
    /// The feed follows the measured angle with speed feed-forward, not predicted: lags by v·Ts.
    EncoderNoPrediction,
    /// The feed follows the measured angle by its position gain alone: lags by v/Kp + v·Ts.
    EncoderNoFeedForward,
}

/// A run that is made ready.
pub struct Run {
    /// The program and what it meets.
    pub job: Job,
    /// Where it is begun, if that is not its beginning; known when it is proved.
    pub restart: Option<Restart>,
    /// What else looks on.
    pub observers: Vec<Box<dyn Observer>>,
    /// File in which every period is recorded.
    pub trace: Option<PathBuf>,
    /// Asked every period: whether the run is to end at once.
    pub is_interrupted: fn() -> bool,
    options: RunOptions,
    seed: u64,
    mode: Option<SyncMode>,
    memory: Option<Memory>,
    told: Told,
    link: Link,
    motion: Time,
}

impl Run {
    /// Check the options, and connect to the machine.
    ///
    /// # Errors
    /// An option is wrong, a file that it names cannot be read, or a tool is, or may be, in the
    /// work.
    pub fn prepare(mut job: Job, options: &RunOptions) -> Result<Self, NotReady> {
        let session = &mut job.session;
        job.material = material(options.material.as_deref(), job.material)?;
        let told = script::told(&options.faults, &options.operator, &session.machine);
        let told = told.map_err(Refused::because)?;
        if options.socket.is_some() && !told.faults.is_empty() {
            return Err(Refused::because(
                "--operator: emergency-stop is for a machine simulated within the run; a machine simulator has its own chain (abort works)",
            )
            .into());
        }
        if options.real_time.is_some() && !(told.faults.is_empty() && options.recover.is_none()) {
            return Err(Refused::because(
                "faults and what follows them are simulated in lock-step only: leave --real-time out, or --fault and --recover",
            )
            .into());
        }
        if let Some(ramp) = options.force_ramp.map(Time::value)
            && !(ramp.is_finite() && (0.001..=60.0).contains(&ramp))
        {
            return Err(Refused::because(format!(
                "--force-ramp {ramp}: expected a time from 0.001 to 60 seconds"
            ))
            .into());
        }
        let memory = Memory::load(options.learning.as_deref(), &session.machine)?;
        let control = &session.machine.control;
        let mode = options.synchronisation.map(|asked| match asked {
            Synchronisation::Command => SyncMode::CommandSynchronised,
            Synchronisation::Encoder => config::encoder(control, Prediction::Observer),
            Synchronisation::EncoderNoPrediction => config::encoder(control, Prediction::Speed),
            Synchronisation::EncoderNoFeedForward => config::encoder(control, Prediction::None),
        });
        if mode == Some(SyncMode::CommandSynchronised)
            && config::plain_drive(&session.machine).is_some()
        {
            return Err(Refused::because(format!(
                "the spindle drive of {} is only told a speed and obeys no trajectory: --synchronisation encoder works",
                session.machine.name
            ))
            .into());
        }
        if matches!(mode, Some(SyncMode::EncoderFollowing { .. })) {
            session.machine.tapping.peck = store::machine::Peck::Full; // see config::planner
        }
        let own = session.plan_options(job.material);
        job.plan = plan::Options { force_ramp: options.force_ramp.or(own.force_ramp), ..own };
        let seed = options.seed.unwrap_or(u64::from(session.plant().simulation.seed));
        job.part = options.part.unwrap_or(1);
        let link = Link::open(options, &mut job)?;
        job.forget();
        Ok(Self {
            restart: None,
            observers: Vec::new(),
            trace: None,
            is_interrupted: || false,
            options: options.clone(),
            seed,
            mode,
            memory,
            told,
            link,
            motion: Time::ZERO,
            job,
        })
    }

    /// Interpret and plan the program before anything moves, and find out where it is begun; a look
    /// at every step.
    ///
    /// # Errors
    /// The program is refused, or cannot be begun there.
    pub fn prove(&mut self, look: &mut impl FnMut(&plan::Step)) -> Result<(), Refused> {
        let mut added = Added::new(config::planner(&self.job.session.machine));
        self.job.prove(&mut |step| {
            look(&step);
            added.step(&step);
        })?;
        self.motion = added.motion();
        let (Some(from), Some(Proved { operations, .. })) = (self.options.from, &self.job.proved)
        else {
            return Ok(());
        };
        let session = &self.job.session;
        let (start, top) = (session.interp_setup().start, session.machine.tool_change.z);
        let restart = restart::find(operations.all(), from, &start, top)
            .map_err(|why| Refused::because(format!("--from: {why}")))?;
        let wrong = wrong_from(session, operations, self.job.plan, &restart);
        if !wrong.is_empty() {
            return Err(self.job.refused(wrong));
        }
        self.restart = Some(restart);
        Ok(())
    }

    /// Time does not wait for what looks on: by the clock, here or in the machine simulator.
    pub fn is_real_time(&self) -> bool {
        self.options.real_time.is_some() || self.link.is_real_time()
    }

    /// What is known of the program: empty before it is proved.
    pub fn findings(&self) -> &[diag::Diagnostic] {
        self.job.proved.as_ref().map_or(&[], |proved| &proved.known.findings)
    }

    /// How long it is planned to take.
    pub fn planned(&self) -> Time {
        let planned = self.job.proved.as_ref().and_then(|proved| proved.known.planned);
        planned.unwrap_or(Time::ZERO)
    }

    /// What the workpiece is judged by.
    fn tolerances(&self) -> verify::Tolerances {
        let own = self.job.session.machine.control.synchronisation.follows == Follows::Encoder;
        config::tolerances(self.mode.map_or(own, |mode| mode != SyncMode::CommandSynchronised))
    }

    /// Run it to its end, or to the alarm that ends it. `progress` hears now and then how long the
    /// machine has been at it.
    ///
    /// # Errors
    /// It was not proved; the machine cannot be simulated; the trace or what was learnt cannot be
    /// written.
    pub fn execute(self, progress: &mut dyn FnMut(Time)) -> Result<Finished, Refused> {
        let tolerances = self.tolerances();
        let Self {
            job, restart, observers, trace, options, seed, mode, memory, told, link, ..
        } = self;
        let Some(Proved { operations, known }) = &job.proved else {
            return Err(Refused::because("the program was not proved"));
        };
        let (session, planned) = (&job.session, known.planned);
        // a spindle that makes its own ramps shows in the first hole how it stops: what it shows is
        // used, and kept if there is a file for it
        let learns = memory.is_some() || config::plain_drive(&session.machine).is_some();
        let mut control = config::control(&session.machine, mode, learns);
        let replaying = control.clone();
        if told.orders.iter().any(|item| item.what == Order::Confirm) {
            control.pause = Pause::Wait;
        }
        let mut kernel = Kernel::new(control);
        kernel.recall(memory.as_ref().map_or_else(Vec::new, |m| m.records.clone()));
        let mut bands = memory.as_ref().map_or_else(Vec::new, |m| m.bands.clone());
        bands.retain(|band| !options.renewed.contains(&band.key.tool));
        kernel.recall_bands(bands);
        let judge = verify::Config { tolerances, tools: job.judged_tools(seed), ..job.judge() };
        let restart = restart.as_ref();
        let replay = restart.filter(|restart| restart.skip > 0).map(|restart| {
            let with = With {
                judge: &judge,
                kernel: Kernel::new(replaying),
                seed,
                is_interrupted: self.is_interrupted,
            };
            Replay::of(&job, restart.skip, with, progress)
        });
        let replay = replay.transpose()?;
        let folder = link.folder().cloned();
        let (plant, record_writer) =
            link.join(&job, (restart, replay.as_ref()), &options.command, seed)?;
        let loaded = Loaded { session, operations, restart, options: job.plan, planned };
        let mut run = ProgramRun::new(&loaded, plant, judge.clone());
        run.executor.kernel = kernel.into();
        run.executor.ticks = TickTimes::new(options.timings);
        if let Some(real_time) = options.real_time {
            run.executor.keep_time(real_time);
        }
        run.is_interrupted = self.is_interrupted;
        run.observes_beside = std::thread::available_parallelism().is_ok_and(|n| n.get() > 1);
        run.services.record_writer = record_writer;
        let whole = planned.unwrap_or(Time::ZERO);
        run.services.stops = Stops::new(options.recover, told, session, seed, whole);
        if let Some(Replay { work, alarm, .. }) = replay {
            run.observers.judge = verify::Judge::new(judge).on(work);
            run.services.stops.happened.extend(alarm.map(|alarm| {
                format!("what comes before the beginning, simulated: {alarm}; the work is as it was then")
            }));
        }
        run.observers.recorder = report::Recorder::new(&session.tools)
            .limited(config::path_limits(&session.machine))
            .shown_in(options.units);
        run.observers.trace =
            trace.as_deref().map(|path| start_trace(path, &job, seed)).transpose()?;
        run.observers.others = observers;
        run.observers.timings = Timings::new(options.timings);
        let outcome = run.run(progress)?;
        if let Some(folder) = folder {
            keep_broken(&folder, &outcome, &options.renewed).map_err(Refused::because)?;
        }
        Ok(Finished { motion: Some(self.motion), job, outcome, seed, tolerances, memory })
    }
}

/// Which tools are broken by now is kept for the next program.
fn keep_broken(folder: &Path, outcome: &Outcome, renewed: &[u32]) -> Result<(), String> {
    let mut broken = broken_tools::of_runs(folder);
    broken.retain(|number| !renewed.contains(number));
    broken.extend(outcome.watch.broken_tools());
    broken_tools::keep(folder, &broken)
}

fn start_trace(path: &Path, job: &Job, seed: u64) -> Result<TraceThread, Refused> {
    let seed = seed.to_string();
    let about = [
        ("leadscrew", env!("CARGO_PKG_VERSION")),
        ("program", job.program.name.as_str()),
        ("machine", job.session.machine.name.as_str()),
        ("seed", seed.as_str()),
    ];
    let columns = Columns::of(&job.session.machine);
    let writer = Writer::create(path, columns, &about)?;
    TraceThread::start(writer)
        .map_err(|e| Refused::because(format!("cannot start the trace's thread: {e}")))
}

/// By name, or as the machine's set-up has it.
///
/// # Errors
/// There is none of this name.
pub fn material(named: Option<&str>, usual: StockMaterial) -> Result<StockMaterial, Refused> {
    let Some(name) = named else { return Ok(usual) };
    StockMaterial::named(name).ok_or_else(|| {
        let known = Material::ALL.map(Material::name).join(", ");
        Refused::because(format!("there is no material \"{name}\": expected one of {known}"))
    })
}

/// A program that a control has executed is planned again for its report, with and without its
/// limits of jerk, if it has no more operations than this: that takes a minute or two at most.
const MOST_PLANNED: usize = 20_000;

/// A run that has come to its end, or to an alarm.
pub struct Finished {
    /// The program and what it met.
    pub job: Job,
    /// What came of it.
    pub outcome: Outcome,
    /// Seed of the machine that was simulated.
    pub seed: u64,
    /// What the workpiece was judged by.
    pub tolerances: verify::Tolerances,
    memory: Option<Memory>,
    /// Planned time in motion; `None`: a long program is not planned for its report.
    motion: Option<Time>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The program ended and every feature is within tolerance.
    Good,
    /// A feature is not good or not judged, or a fault that was told to happen has not.
    OutOfTolerance,
    /// An alarm on the machine.
    Alarm,
}

impl Finished {
    /// A program that a control has executed, with the folder in which it is recorded.
    pub fn of_control(ended: EndedProgram) -> (Self, Folder) {
        let EndedProgram { folder, name, path, text, session, proved, outcome, seed, .. } = ended;
        let follows = session.machine.control.synchronisation.follows == Follows::Encoder;
        let material = session.machine.setup.stock.material;
        let plan = session.plan_options(material);
        let program = Program { name, path, text };
        let chosen = Vec::new();
        let job = Job { program, session, chosen, material, plan, part: 1, proved: Some(proved) };
        let motion = (job.operations().all().len() <= MOST_PLANNED).then(|| {
            let mut added = Added::new(config::planner(&job.session.machine));
            let mut planner = preflight::ahead(&job.session, plan);
            preflight::plan(&mut job.cursor(), &mut planner, &mut |step| {
                added.step(&step);
            });
            added.motion()
        });
        let tolerances = config::tolerances(follows);
        (Self { job, outcome, seed, tolerances, memory: None, motion }, folder)
    }

    /// How it ended.
    pub fn ending(&self) -> Ending {
        let Outcome { ended, not_triggered, features, watch, real_time, .. } = &self.outcome;
        let is_good = |feature: &verify::Feature| feature.verdict.is_pass();
        if !ended {
            Ending::Alarm
        } else if !not_triggered.is_empty()
            || real_time.is_some_and(|figures| figures.unobserved > 0)
            || !features.iter().all(is_good)
            || watch.violations() > 0
        {
            Ending::OutOfTolerance
        } else {
            Ending::Good
        }
    }

    /// What was cut, with its verdict.
    pub fn features(&self) -> &[verify::Feature] {
        &self.outcome.features
    }

    /// What other programs rely on.
    pub fn certificate(&self) -> Certificate {
        run_outputs::certificate(self)
    }

    /// The page that a process engineer pins to the job: HTML in one file.
    pub fn report(&mut self) -> String {
        let motion = self.motion.map(|planned| {
            let mut free = WithoutJerk::of(&mut self.job.session, self.job.plan);
            if let Some(free) = &mut free {
                free.all(&mut self.job.cursor());
            }
            report::Motion { planned, without_jerk: free.map(WithoutJerk::motion) }
        });
        run_outputs::report(self, motion)
    }

    /// What is known of the program from before anything moved.
    pub fn findings(&self) -> &[diag::Diagnostic] {
        self.job.proved.as_ref().map_or(&[], |proved| &proved.known.findings)
    }

    /// Keep what was learnt and measured, where the options and the machine's file say.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn keep(&self) -> Result<(), Refused> {
        if !self.outcome.ended {
            return Ok(());
        }
        if let Some(memory) = &self.memory {
            memory.save(&self.outcome.learning_records, &self.outcome.bands)?;
        }
        self.outcome.cams.save()
    }

    /// What the program leaves behind: parameters and tools.
    pub fn left(&self) -> Option<&control::job::Left> {
        let proved = self.job.proved.as_ref().filter(|_| self.outcome.ended)?;
        Some(self.outcome.left.as_ref().unwrap_or_else(|| proved.operations.left()))
    }

    /// Into the folder of the run: each polygon as a solid and as a cross-section.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn write_solids(&self, folder: &store::output::Folder) -> Result<(), Refused> {
        Ok(run_outputs::write_solids(folder, self)?)
    }
}
