//! What commands answer, as values and without printing: for other programs that are built on this
//! one.
//!
//! What is asked is asked in the words of the command line, and read by the same reader:
//! `["check", "part.ngc", "--machine=lathe"]`. A program's text and a machine may be handed over
//! beside the words, so that neither has to lie in a file.
//!
//! ```text
//!   words ─► args ─┬─► check, canon, time, polygon, cam ─► the value that --format json prints
//!                  └─► run ─► leadscrew::Run, ready to be proved and executed
//! ```
use crate::args::{Cli, Command, ProgramArgs};
use crate::log::WorkFrame;
use crate::render::{self, Source};
use crate::{cam, canonical, machine, polygon, refusal, run, time, typed};
use bus::Sample;
use clap::Parser;
use control::Refused;
pub use control::config::machine_file::MachineSource;
use control::job::Interruption;
pub use control::job::choice::{self, Choice};
use control::job::{ProgramOptions, Session, preflight, read_program};
use control::observers::Observer;
use kernel::{Event, EventKind};
use leadscrew::{Finished, Program, Run};
use serde_json::Value;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Version and commit, as `leadscrew --version` says them.
pub const BUILD: &str = env!("LEADSCREW_VERSION");

/// What is asked.
#[derive(Debug, Clone, Default)]
pub struct CommandWords {
    /// The words behind `leadscrew`.
    pub words: Vec<String>,
    /// Text of the program, in place of the file that the words name.
    pub program: Option<Vec<u8>>,
    /// The machine, in place of what the words name.
    pub machine: Option<MachineSource>,
    /// The machine that is simulated, in place of what the words name.
    pub plant: Option<MachineSource>,
    /// Whether the answer is still wanted, asked now and then in the thread that answers.
    pub interruption: Interruption,
}

impl CommandWords {
    fn command(&self) -> Result<Command, Refused> {
        let words = std::iter::once("leadscrew").chain(self.words.iter().map(String::as_str));
        let read = Cli::try_parse_from(words).map_err(|wrong| {
            let text = wrong.render().to_string();
            let said = text.lines().next().unwrap_or_default().trim_start_matches("error: ");
            Refused::because(said)
        });
        read.map(|cli| cli.command)
    }

    fn options(&self, source: ProgramOptions) -> ProgramOptions {
        ProgramOptions {
            chooses: source.chooses && self.machine.is_none() && self.plant.is_none(),
            machine: self.machine.clone().unwrap_or(source.machine),
            plant: self.plant.clone().or(source.plant),
            ..source
        }
    }

    fn program(&self, path: &Path) -> Result<Program, Refused> {
        match &self.program {
            Some(text) => Ok(Program {
                name: path.display().to_string(),
                path: path.to_owned(),
                text: text.clone(),
            }),
            None => Program::open(path),
        }
    }

    fn session(&self, args: &ProgramArgs, path: &Path) -> Result<(Session, Vec<u8>), Refused> {
        let text = self.program.clone().map_or_else(|| read_program(path), Ok)?;
        let mut session = Session::load(&self.options(args.options()), path, &text)?;
        session.interruption = self.interruption.clone();
        Ok((session, text))
    }

    fn other(&self) -> Refused {
        Refused::because(format!("\"{}\" is no command that is answered so", self.words.join(" ")))
    }
}

/// A finding that stands for a refusal, each as an object.
pub fn findings(refused: &Refused) -> Vec<Value> {
    refusal::findings_as_json(refused)
}

/// What is known of a program that was run from before anything moved, each as an object.
pub fn findings_of(finished: &Finished) -> Value {
    let (program, drawn) = (&finished.job.program, &finished.job.session.drawn);
    let source = Source { name: &program.name, text: &program.text, drawn };
    finished.findings().iter().map(|finding| render::json(finding, &source)).collect()
}

/// Everything that is wrong with one program, as `check --format json` has it.
///
/// # Errors
/// Words that mean nothing, and files that cannot be read.
pub fn check(asked: &CommandWords) -> Result<Value, Refused> {
    let Command::Check(args) = asked.command()? else { return Err(asked.other()) };
    let [path] = args.programs.as_slice() else {
        return Err(Refused::because("expected one program"));
    };
    let text = asked.program.clone().map_or_else(|| read_program(path), Ok)?;
    let options = asked.options(args.source.options());
    let (session, found) = if options.chooses {
        let Choice { session, notes, mut found, .. } = choice::choose(&options, path, &text)?;
        found.splice(0..0, notes);
        (session, found)
    } else {
        let (mut session, _) = asked.session(&args.source, path)?;
        let options = session.plan_options(session.machine.setup.stock.material);
        let found = preflight::judge(&mut session, &text, options);
        (session, found)
    };
    let name = path.display().to_string();
    let source = Source { name: &name, text: &text, drawn: &session.drawn };
    Ok(found.iter().map(|finding| render::json(finding, &source)).collect())
}

/// The operations that a program means, as `canon --format json` has them.
///
/// # Errors
/// Words that mean nothing, files that cannot be read, and a program that is refused.
pub fn canon(asked: &CommandWords) -> Result<Value, Refused> {
    let Command::Canon(args) = asked.command()? else { return Err(asked.other()) };
    let (session, text) = asked.session(&args.source, &args.program)?;
    let (objects, findings) = canonical::answer(&session, &text);
    if findings.iter().any(diag::Diagnostic::is_error) {
        let name = args.program.display().to_string();
        return Err(Refused::program(name, text, session.drawn.clone(), findings));
    }
    Ok(objects.into())
}

/// How long a program takes, as `time --format json` has it.
///
/// # Errors
/// Words that mean nothing, files that cannot be read, and a program that is refused.
pub fn time(asked: &CommandWords) -> Result<Value, Refused> {
    let Command::Time(args) = asked.command()? else { return Err(asked.other()) };
    let mut job = asked.program(&args.program)?.on(asked.options(args.source.options()))?;
    job.session.interruption = asked.interruption.clone();
    let (found, _) = time::found(&mut job, &args, &mut |_| ())?;
    Ok(found.answer(&job, args.operations))
}

/// The flattest polygon, as `polygon --format json` has it.
///
/// # Errors
/// Words that mean nothing, and a polygon that cannot be turned so.
pub fn polygon(asked: &CommandWords) -> Result<Value, Refused> {
    let Command::Polygon(args) = asked.command()? else { return Err(asked.other()) };
    polygon::answer(&args, asked.machine.clone().unwrap_or_else(|| (&args.machine).into()))
}

/// The way of the grinding wheel, as `cam --format json` has it, and its G-code.
///
/// # Errors
/// Words that mean nothing, and a cam that cannot be ground so.
pub fn cam(asked: &CommandWords) -> Result<Value, Refused> {
    let Command::Cam(args) = asked.command()? else { return Err(asked.other()) };
    cam::answer(&args, asked.machine.clone().unwrap_or_else(|| (&args.machine).into()))
}

/// A run, ready to be proved and executed.
///
/// # Errors
/// Words that mean nothing, files that cannot be read, and options that do not fit.
pub fn run(asked: &CommandWords) -> Result<Run, Refused> {
    let Command::Run(args) = asked.command()? else { return Err(asked.other()) };
    let program = asked.program(&args.program)?;
    let command = typed::of_job(asked.words.iter().cloned());
    let mut run = run::prepared(&args, program, asked.options(args.options()), command)?;
    run.job.session.interruption = asked.interruption.clone();
    Ok(run)
}

/// A machine's file, with what the simulated one may be and for a seed is, as `machine show` prints
/// it.
///
/// # Errors
/// There is none of this name, or it cannot be read.
pub fn machine(source: &MachineSource, seed: Option<u64>, part: u32) -> Result<String, Refused> {
    machine::shown(source, seed, part)
}

/// Something that has happened in a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Happened {
    /// Since the machine was started, s.
    pub time_s: f64,
    /// Program line at work, 0 for none.
    pub line: u32,
    /// Which kind of event, such as `tool-changed`.
    pub kind: String,
    /// In words; empty where the kind says all.
    pub text: String,
}

/// Where events are kept, for the caller and the run.
pub type KeptEvents = Arc<Mutex<Vec<Happened>>>;

/// An observer that keeps every event of a run; what it has kept, too.
pub fn events(run: &Run) -> (Box<dyn Observer>, KeptEvents) {
    let kept = KeptEvents::default();
    let (tools, zero) = (run.job.session.tools.clone(), run.job.session.work_zero());
    let events = Events { work: WorkFrame::new(tools, zero), now: 0.0, kept: Arc::clone(&kept) };
    (Box::new(events), kept)
}

struct Events {
    work: WorkFrame,
    now: f64,
    kept: KeptEvents,
}

impl Events {
    fn keep(&self, happened: Happened) {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).push(happened);
    }
}

impl Observer for Events {
    fn sample(&mut self, sample: &Sample) {
        self.work.sample(sample);
        self.now = sample.feedback.time.value();
    }

    fn event(&mut self, event: &Event) {
        let text = self.work.text(event).unwrap_or_default();
        let kind = kind(&event.kind);
        self.keep(Happened { time_s: event.time.value(), line: event.line, kind, text });
    }

    fn message(&mut self, line: u32, text: &str) {
        let text = text.trim().to_owned();
        self.keep(Happened { time_s: self.now, line, kind: "message".into(), text });
    }
}

/// The name of an event's variant in small letters: `ToolChanged { … }` is `tool-changed`.
fn kind(event: &EventKind) -> String {
    let shown = format!("{event:?}");
    let mut name = String::new();
    for c in shown.chars().take_while(char::is_ascii_alphanumeric) {
        if c.is_ascii_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.push(c.to_ascii_lowercase());
    }
    name
}
