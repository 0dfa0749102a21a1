//! `leadscrew run`: prove a program, run it on the simulated machine, judge the workpiece, leave the papers.
use crate::args::{Format, RunArgs, Synchronisation};
use crate::log::Log;
use crate::progress::Progress;
use crate::recover::advice;
use crate::render::{self, Source};
use crate::time::{Added, without_jerk};
use crate::typed;
use crate::{interrupt, papers, say, summary};
use bus::Machine;
use control::Refused;
use control::config;
use control::job::preflight::{Preflight, preflight_with, wrong_from};
use control::job::restart::Restart;
use control::job::{Session, read_program};
use control::observers::TraceThread;
use control::plant::{self, Plant};
use control::recovery::in_work::{self, InWork};
use control::script::{self, Told};
use control::services::Keeper;
use control::services::learning::Memory;
use control::services::sync_record as keeper;
use control::stops::Stops;
use control::{Loaded, Outcome, ProgramRun, TickTimes, Timings};
use indicatif::ProgressBar;
use sim::Faulty;
use std::os::unix::net::UnixStream;
use std::path::Path;
use store::machine::Material;
use store::output::Folder;
use store::sync_record::slots::{Slots, StateFolder};
use store::sync_record::{Identity, Stage, SyncRecord};
use store::trace::{Columns, Writer};
use sync::{Prediction, SyncMode};
use units::Time;
use wire::{Hello, Remote};

/// How a run ended, as the exit code says it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// The program ended and every feature is within tolerance.
    Good,
    /// A feature is not good, or a fault that was told to happen has not.
    OutOfTolerance,
    /// An alarm on the machine.
    Alarm,
}

/// What one run is told.
pub(crate) struct Job {
    /// Name of the program, as the user typed it.
    pub(crate) program: String,
    /// Its text.
    pub(crate) text: Vec<u8>,
    /// What it meets.
    pub(crate) session: Session,
    /// What the workpiece is made of.
    pub(crate) material: Material,
    /// Seed of the machine's scatter.
    pub(crate) seed: u64,
    options: plan::Options,
    mode: Option<SyncMode>,
    memory: Option<Memory>,
    restart: Option<Restart>,
    told: Told,
}

/// Do it.
pub(crate) fn command(args: &RunArgs, quiet: bool) -> Result<Ending, Refused> {
    let mut job = Job::load(args)?;
    let link = Link::open(args, &mut job)?;
    job.begin_at(args, quiet)?;
    let limits = config::planner(&job.session.machine);
    let mut added = Added::new(&limits);
    let progress = Progress::of_lines(&job.text, "planning");
    let mut known = preflight_with(&mut job.session, &job.text, job.options, &mut |step| {
        progress.reached(step.line);
        added.step(&step);
    });
    drop(progress);
    if let Some(restart) = job.restart.as_ref().filter(|_| !known.is_refused()) {
        known.findings.extend(wrong_from(&job.session, &job.text, job.options, restart));
    }
    if known.is_refused() {
        return Err(Refused::program(job.program, job.text, job.session.drawn, known.findings));
    }
    if !quiet {
        let source = Source { name: &job.program, text: &job.text, drawn: &job.session.drawn };
        say::err(&render::text(&known.findings, &source));
    }
    let folder = args.out.as_deref().map(begin_folder).transpose()?;
    if folder.is_some() {
        interrupt::watch()?;
    }
    let planned_ms = (known.planned.value() * 1e3) as u64;
    let progress = Progress::new(planned_ms, "machining (simulated)");
    let outcome = job.simulate(args, link, &known, folder.as_ref(), &progress)?;
    drop(progress);
    interrupt::refuse()?;
    for why in &outcome.broke_off {
        say::err(&format!("error: {why}\n"));
    }
    if let Some(memory) = job.memory.as_ref().filter(|_| outcome.ended) {
        memory.save(&outcome.lessons)?;
    }
    if outcome.ended {
        outcome.cams.save()?;
        crate::left::write(&args.left, &job.text, &job.session.interp_setup())?;
    }
    let certificate = papers::certificate(&job, &outcome);
    let page = (folder.is_some() || args.report.is_some()).then(|| {
        let free = without_jerk(&mut job.session, &job.text, job.options).map(Time::s);
        let motion = report::Motion { planned: added.motion(), without_jerk: free };
        papers::report(&job, &outcome, &known, motion)
    });
    if let (Some(path), Some(page)) = (&args.report, &page) {
        store::output::write_file(path, page.as_bytes())?;
    }
    if let (Some(folder), Some(page)) = (folder, &page) {
        folder.write("report.html", page.as_bytes())?;
        papers::write_certificate(&folder, &certificate)?;
        papers::write_solids(&folder, &job, &outcome)?;
        interrupt::refuse()?;
        folder.finish()?;
    }
    match args.format {
        Format::Json => say::out(&format!("{}\n", certificate.to_json()))?,
        Format::Text if quiet => say::out(&summary::wrong(&outcome))?,
        Format::Text => say::out(&summary::text(&job, &outcome, args.out.as_deref()))?,
    }
    for missing in &outcome.not_triggered {
        say::err(&format!("error: {missing}\n"));
    }
    if args.timings {
        say::err(&format!("{}\n", outcome.timings.text(&outcome.ticks)));
    }
    Ok(ending(&outcome))
}

fn ending(outcome: &Outcome) -> Ending {
    if !outcome.ended {
        Ending::Alarm
    } else if !outcome.not_triggered.is_empty()
        || outcome.features.iter().any(|f| !f.verdict.is_pass())
        || !outcome.watch.breaches().is_empty()
    {
        Ending::OutOfTolerance
    } else {
        Ending::Good
    }
}

impl Job {
    fn load(args: &RunArgs) -> Result<Self, Refused> {
        let text = read_program(&args.program)?;
        let mut session = Session::load(&args.source.options(), &args.program, &text)?;
        let material = material(args.material.as_deref(), session.machine.setup.stock.material)?;
        let told = script::told(&args.fault, &args.operator, &session.machine);
        let told = told.map_err(Refused::because)?;
        if args.iron.is_some() && !told.faults.is_empty() {
            return Err(Refused::because(
                "--operator: emergency-stop is for a machine simulated within the run; an iron has its own chain (abort works)",
            ));
        }
        if let Some(ramp) = args.force_ramp
            && !(ramp.is_finite() && (0.001..=60.0).contains(&ramp))
        {
            return Err(Refused::because(format!(
                "--force-ramp {ramp}: expected a time from 0.001 to 60 seconds"
            )));
        }
        let memory = Memory::load(args.learning.as_deref(), &session.machine)?;
        let control = &session.machine.control;
        let mode = args.synchronisation.map(|asked| match asked {
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
            )));
        }
        if matches!(mode, Some(SyncMode::EncoderFollowing { .. })) {
            session.machine.tapping.peck = store::machine::Peck::Full; // see config::planner
        }
        let own = session.plan_options(material);
        Ok(Self {
            program: args.program.display().to_string(),
            text,
            material,
            seed: args.seed.unwrap_or(u64::from(session.machine.simulation.seed)),
            options: plan::Options {
                force_ramp: args.force_ramp.map(Time::s).or(own.force_ramp),
                ..own
            },
            mode,
            memory,
            restart: None,
            told,
            session,
        })
    }

    /// What the workpiece is judged by.
    pub(crate) fn tolerances(&self) -> verify::Tolerances {
        let follows = store::machine::Follows::Encoder;
        let own = self.session.machine.control.synchronisation.follows == follows;
        let encoder = self.mode.map_or(own, |mode| mode != SyncMode::CommandSynchronised);
        config::tolerances(encoder)
    }

    /// Find out where the program is begun, and say so.
    fn begin_at(&mut self, args: &RunArgs, quiet: bool) -> Result<(), Refused> {
        let Some(from) = args.from else { return Ok(()) };
        let setup = self.session.interp_setup();
        let top = self.session.machine.tool_change.z;
        let ops = interp::Ops::new(&self.text, &setup);
        let restart = control::job::restart::find(ops, from, &setup.start, top)
            .map_err(|why| Refused::because(format!("--from: {why}")))?;
        if !quiet {
            say::err(&format!(
                "begins at line {} with tool {} and the spindle at {:.0} rpm; {} of the program's holes are left out\n",
                restart.line,
                restart.tool,
                restart.spin.in_rpm(),
                restart.holes
            ));
        }
        self.restart = Some(restart);
        Ok(())
    }

    fn simulate(
        &self,
        args: &RunArgs,
        link: Link,
        known: &Preflight,
        folder: Option<&Folder>,
        progress: &ProgressBar,
    ) -> Result<Outcome, Refused> {
        let Session { machine, tools, .. } = &self.session;
        let setup = self.session.interp_setup();
        let zero = self.session.work_zero();
        let (plant, keeper) = link.join(self)?;
        // a spindle that makes its own ramps shows in the first hole how it stops: what it shows is used, and kept
        // if there is a file for it
        let learns = self.memory.is_some() || config::plain_drive(machine).is_some();
        let mut kernel = kernel::Kernel::new(config::control(machine, self.mode, learns));
        kernel.recall(self.memory.as_ref().map_or_else(Vec::new, |m| m.lessons.clone()));
        let judge = verify::Config {
            synchronised: self.session.taps.method == plan::TapMethod::Synchronised,
            tolerances: self.tolerances(),
            cams: self.session.cams.library.clone(),
            ..config::judge(machine, tools, self.material, &zero)
        };
        let (session, options, planned) = (&self.session, self.options, known.planned);
        let loaded = Loaded { session, text: &self.text, setup: &setup, options, planned };
        let mut run = ProgramRun::new(&loaded, plant, judge);
        run.executor.kernel = kernel;
        run.executor.ticks = TickTimes::new(args.timings);
        run.feeder.ops = run.feeder.ops.begun_at(self.restart.as_ref());
        run.services.keeper = keeper;
        run.services.stops = Stops::new(
            args.recover.map(Into::into),
            self.told.clone(),
            session,
            self.seed,
            planned,
        );
        let observers = &mut run.observers;
        observers.recorder = report::Recorder::new(tools)
            .limited(config::path_limits(machine))
            .shown_in(args.units.map(Into::into));
        observers.trace = folder.map(|folder| self.trace(folder)).transpose()?;
        if args.log {
            observers.others.push(Box::new(Log::new(tools.clone(), zero)));
        }
        observers.timings = Timings::new(args.timings);
        run.is_interrupted = interrupt::came;
        Ok(run.run(&mut |at| progress.set_position((at.value() * 1e3) as u64))?)
    }

    fn trace(&self, folder: &Folder) -> Result<TraceThread, Refused> {
        let seed = self.seed.to_string();
        let about = [
            ("leadscrew", env!("CARGO_PKG_VERSION")),
            ("program", self.program.as_str()),
            ("machine", self.session.machine.name.as_str()),
            ("seed", seed.as_str()),
        ];
        let columns = Columns::of(&self.session.machine);
        let writer = Writer::create(&folder.path("trace.parquet"), columns, &about)?;
        TraceThread::start(writer)
            .map_err(|e| Refused::because(format!("cannot start the trace's thread: {e}")))
    }
}

/// The machine that is controlled, and the state that is kept of it, before the program is known to be in order.
struct Link {
    remote: Option<Remote<UnixStream>>,
    state: Option<(Slots<StateFolder>, Identity)>,
    /// The hole of this program whose tap a recovery took out, where the program goes on after that.
    recovered: Option<u32>,
}

impl Link {
    /// Connect to the iron, if one is named; refuse where a tap may be in the work.
    fn open(args: &RunArgs, job: &mut Job) -> Result<Self, Refused> {
        let Some(path) = &args.iron else {
            let Some(folder) = &args.state else {
                return Ok(Self { remote: None, state: None, recovered: None });
            };
            // a machine within this process begins anew each time: nothing can be in its work
            let machine = job.session.machine.name.clone();
            let identity = Identity { machine, serial: 0, epoch: 0 };
            let (slots, _) = keeper::open(folder, &identity)?
                .map_err(|why| Refused::because(why.to_string()))?;
            return Ok(Self { remote: None, state: Some((slots, identity)), recovered: None });
        };
        let machine = job.session.machine.name.clone();
        let hello = Hello { name: "leadscrew run".into(), machine, process: std::process::id() };
        let remote =
            Remote::connect(plant::connect(path)?, hello).map_err(|e| plant::gone(path, &e))?;
        let feedback = remote.feedback();
        job.session.stands(&feedback);
        let identity = plant::identity(remote.welcome());
        let named = args.state.as_deref();
        let folder = keeper::folder(named, &identity)?;
        let (welcome, shown) = (remote.welcome(), folder.display().to_string());
        if !folder.exists() {
            in_work(None, welcome, &shown, path, named)?; // no folder is made where nothing may begin
        }
        let (slots, kept) =
            keeper::open(&folder, &identity)?.map_err(|why| advice::unsure(&why, path, named))?;
        in_work(kept.record.clone(), welcome, &shown, path, named)?;
        if welcome.evidence.in_work.is_some() {
            // the encoders show the tool outside: that is for a recovery to settle
            return Err(advice::settle(path, named));
        }
        let checksum = crc32fast::hash(&job.text);
        let of_this = |r: &SyncRecord| r.stage == Stage::Recovered && r.place.checksum == checksum;
        let recovered = kept.record.filter(|r| args.from.is_some() && of_this(r));
        let recovered = recovered.map(|record| record.place.hole);
        Ok(Self { remote: Some(remote), state: Some((slots, identity)), recovered })
    }

    /// The plant, and who keeps its record.
    fn join(self, job: &Job) -> Result<(Plant, Option<Keeper>), Refused> {
        let Session { machine, tools, .. } = &job.session;
        let welcome = self.remote.as_ref().map(Remote::welcome);
        let real_time = welcome.is_some_and(|welcome| welcome.real_time);
        let engaged = welcome.map_or(0, |welcome| welcome.evidence.last);
        let before = job.restart.as_ref().map_or(0, |restart| restart.holes);
        let program = (job.program.as_str(), &job.text[..]);
        let keeper = self.state.map(|(slots, identity)| {
            let known = (before, self.recovered, engaged);
            let top = job.session.work_zero().linear[2] + machine.setup.stock.to[2];
            Keeper::start(
                slots,
                identity,
                program,
                typed::of_this_run(),
                tools,
                real_time,
                known,
                top,
            )
        });
        let plant = if let Some(remote) = self.remote {
            Plant::Outside(Box::new(remote))
        } else {
            let zero = job.session.work_zero();
            let config = config::simulator(machine, tools, job.material, job.seed, &zero);
            let alone = config::left_alone(machine, &config);
            let machine = plant::simulated(machine, config)?;
            let machine = match job.session.cams.grinding(&zero) {
                None => machine,
                Some(grinding) => machine.with_grinding(grinding).map_err(|problems| {
                    let problems = problems.join("; ");
                    Refused::because(format!("cams cannot be ground here: {problems}"))
                })?,
            };
            Plant::Inside(Box::new(Faulty::new(machine, &[], job.seed).left_alone(alone)))
        };
        Ok((plant, keeper.transpose()?))
    }
}

/// Refuse where a tool is in the work, or may be.
fn in_work(
    record: Option<SyncRecord>,
    welcome: &wire::Welcome,
    folder: &str,
    iron: &Path,
    state: Option<&Path>,
) -> Result<(), Refused> {
    match in_work::judge(record, welcome, folder) {
        InWork::Nothing(_) => Ok(()),
        InWork::Tool(record) => Err(advice::interlock(&record, iron, state)),
        InWork::Unknown(why) => Err(advice::unknown(&why, iron, state)),
    }
}

/// By name, or as the machine's set-up has it.
pub(crate) fn material(named: Option<&str>, usual: Material) -> Result<Material, Refused> {
    let Some(name) = named else { return Ok(usual) };
    Material::KNOWN.iter().find(|m| m.name.eq_ignore_ascii_case(name)).copied().ok_or_else(|| {
        let known = Material::KNOWN.map(|m| m.name).join(", ");
        Refused::because(format!("there is no material \"{name}\": expected one of {known}"))
    })
}

/// The folder for the papers; the folders above it are made if they are missing.
fn begin_folder(path: &Path) -> Result<Folder, Refused> {
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(|e| {
            Refused::because(format!("cannot create the folder {}: {e}", parent.display()))
        })?;
    }
    Ok(Folder::begin(path)?)
}
