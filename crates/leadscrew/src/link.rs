//! The machine that a run controls, in this process or in another one, and the sync record that is
//! kept of it.
use crate::RunOptions;
use crate::program::Job;
use crate::replay::Replay;
use bus::Machine as _;
use control::Drives;
use control::drives::remote;
use control::job::Session;
use control::job::restart::Restart;
use control::recovery::in_work::{self, InWork};
use control::services::{RecordWriter, sync_record};
use control::{Refused, config};
use sim::{Faulty, SimulatedMachine};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use store::state::broken_tools;
use store::sync_record::slots::{Slots, StateFolder};
use store::sync_record::{Identity, Stage, SyncRecord, Untrusted};
use wire::{Hello, Remote};

/// Why a run may not begin.
#[derive(Debug)]
pub enum NotReady {
    /// Something is wrong with options or files.
    Refused(Refused),
    /// This tool is in the work: nothing but recovery may move.
    InWork(Box<SyncRecord>),
    /// It cannot be told whether a tool is in the work, and why.
    Unknown(String),
    /// The sync record is not to be trusted.
    Untrusted(Untrusted),
    /// The machine keeps a tool in its work that the encoders show outside of it.
    Unsettled,
}

impl From<Refused> for NotReady {
    fn from(refused: Refused) -> Self {
        Self::Refused(refused)
    }
}

impl From<store::Error> for NotReady {
    fn from(error: store::Error) -> Self {
        Self::Refused(error.into())
    }
}

impl From<NotReady> for Refused {
    fn from(why: NotReady) -> Self {
        match why {
            NotReady::Refused(refused) => refused,
            NotReady::InWork(record) => Self::because(format!(
                "tool {} is in the work (line {} of {}): nothing but recovery may move",
                record.stroke.tool, record.place.line, record.place.program
            )),
            NotReady::Unknown(why) => Self::because(why),
            NotReady::Untrusted(why) => Self::because(why.to_string()),
            NotReady::Unsettled => Self::because(
                "the machine keeps a tool in its work that the encoders show outside of it: recovery settles that",
            ),
        }
    }
}

/// The machine that is controlled, and the state that is kept of it, before the program is known to
/// be in order.
pub(crate) struct Link {
    remote: Option<Remote<UnixStream>>,
    state: Option<(Slots<StateFolder>, Identity)>,
    /// The hole of this program whose tap a recovery took out, where the program goes on after
    /// that.
    recovered: Option<u32>,
    /// Folder of that state.
    folder: Option<PathBuf>,
}

impl Link {
    /// Connect to the machine simulator, if one is named; refuse where a tap may be in the work.
    pub(crate) fn open(options: &RunOptions, job: &mut Job) -> Result<Self, NotReady> {
        let Some(path) = &options.socket else {
            let Some(folder) = &options.state else {
                return Ok(Self { remote: None, state: None, recovered: None, folder: None });
            };
            // a machine within this process begins anew each time: nothing can be in its work
            let machine = job.session.machine.name.clone();
            let identity = Identity { machine, serial: 0, epoch: 0 };
            let (slots, kept) = sync_record::open(folder, &identity)?
                .map_err(|why| Refused::because(why.to_string()))?;
            refuse_changed(options, job, kept.record.as_ref())?;
            broken_since(folder, options, job);
            let state = Some((slots, identity));
            return Ok(Self { remote: None, state, recovered: None, folder: Some(folder.clone()) });
        };
        let machine = job.session.machine.name.clone();
        let hello = Hello { name: "leadscrew run".into(), machine };
        let mut remote =
            Remote::connect(remote::connect(path)?, hello).map_err(|e| remote::gone(path, &e))?;
        options.renewed.iter().for_each(|number| remote.renew_tool(*number));
        if let Some(why) = remote.lost() {
            return Err(remote::gone(path, why).into());
        }
        let feedback = remote.feedback();
        job.session.stands(feedback);
        let identity = remote::identity(remote.welcome());
        let named = options.state.as_deref();
        let folder = sync_record::folder(named, &identity)?;
        let (welcome, shown) = (remote.welcome(), folder.display().to_string());
        if !folder.exists() {
            in_work(None, welcome, &shown)?; // no folder is made where nothing may begin
        }
        let (slots, kept) = sync_record::open(&folder, &identity)?.map_err(NotReady::Untrusted)?;
        in_work(kept.record.clone(), welcome, &shown)?;
        if welcome.evidence.in_work.is_some() {
            // the encoders show the tool outside: that is for a recovery to settle
            return Err(NotReady::Unsettled);
        }
        refuse_changed(options, job, kept.record.as_ref())?;
        let checksum = checksum(job);
        let of_this = |r: &SyncRecord| r.stage == Stage::Recovered && r.place.checksum == checksum;
        let recovered = kept.record.filter(|r| options.from.is_some() && of_this(r));
        let recovered = recovered.map(|record| record.place.hole);
        broken_since(&folder, options, job);
        let (remote, state) = (Some(remote), Some((slots, identity)));
        Ok(Self { remote, state, recovered, folder: Some(folder) })
    }

    /// Folder in which the state is kept.
    pub(crate) const fn folder(&self) -> Option<&PathBuf> {
        self.folder.as_ref()
    }

    /// The machine's time passes by the clock.
    pub(crate) fn is_real_time(&self) -> bool {
        self.remote.as_ref().is_some_and(|remote| remote.welcome().real_time)
    }

    /// The machine, and who keeps its record.
    pub(crate) fn join(
        self,
        job: &Job,
        (restart, replay): (Option<&Restart>, Option<&Replay>),
        command: &[String],
        seed: u64,
    ) -> Result<(Box<dyn Drives>, Option<RecordWriter>), Refused> {
        let Session { machine, tools, .. } = &job.session;
        let welcome = self.remote.as_ref().map(Remote::welcome);
        let real_time = welcome.is_some_and(|welcome| welcome.real_time);
        let engaged = welcome.map_or(0, |welcome| welcome.evidence.last);
        let before = restart.map_or(0, |restart| restart.holes);
        let program = sync_record::Program {
            name: &job.program.name,
            checksum: checksum(job),
            command: command.to_vec(),
        };
        let record_writer = self.state.map(|(slots, identity)| {
            let known = (before, self.recovered, engaged);
            let top = job.session.work_zero().linear[2] + machine.setup.stock.to[2];
            RecordWriter::start(slots, identity, program, tools, real_time, known, top)
        });
        let drives: Box<dyn Drives> = if let Some(remote) = self.remote {
            Box::new(remote)
        } else {
            let alone = config::left_alone(job.session.plant(), &job.simulator(seed));
            let machine = simulated(job, seed)?;
            let machine = match replay {
                Some(replay) => machine.with_work_of(&replay.machine),
                None => machine,
            };
            Box::new(Faulty::new(machine, &[], seed).left_alone(alone))
        };
        Ok((drives, record_writer.transpose()?))
    }
}

/// The machine of a job, simulated within this process, with its wheel and blanks where it grinds.
pub(crate) fn simulated(job: &Job, seed: u64) -> Result<SimulatedMachine, Refused> {
    let machine = job.machine(seed)?;
    match job.session.cams.grinding(&job.session.work_zero()) {
        None => Ok(machine),
        Some(grinding) => machine.with_grinding(grinding).map_err(|problems| {
            let problems = problems.join("; ");
            Refused::because(format!("cams cannot be ground here: {problems}"))
        }),
    }
}

/// By what a record knows again that none of the program's texts was changed.
fn checksum(job: &Job) -> u32 {
    job.session.texts(&job.program.text).crc32()
}

/// A program that was changed since its record was written is not begun in its middle without a
/// word: its lines and holes may be others.
fn refuse_changed(
    options: &RunOptions,
    job: &Job,
    record: Option<&SyncRecord>,
) -> Result<(), Refused> {
    let Some(place) = record.map(|record| &record.place) else { return Ok(()) };
    let file = |name: &str| std::path::Path::new(name).file_name().map(ToOwned::to_owned);
    let is_this = file(&place.program).is_some() && file(&place.program) == file(&job.program.name);
    let is_changed = place.checksum != checksum(job);
    if options.from.is_none() || options.program_changed || !is_this || !is_changed {
        return Ok(());
    }
    Err(Refused::because(format!(
        "{} was changed since it was left at line {}, hole {}: its lines and holes may not be those that were cut; compare them, then say \
         --program-changed",
        job.session.texts(&job.program.text).described(&job.program.name),
        place.line,
        place.hole
    )))
}

/// Refuse where a tool is in the work, or may be.
fn in_work(
    record: Option<SyncRecord>,
    welcome: &wire::Welcome,
    folder: &str,
) -> Result<(), NotReady> {
    match in_work::judge(record, welcome, folder) {
        InWork::Nothing(_) => Ok(()),
        InWork::Tool(record) => Err(NotReady::InWork(record)),
        InWork::Unknown(why) => Err(NotReady::Unknown(why)),
    }
}

/// Tools that broke before and in whose place no new one is are broken now.
fn broken_since(folder: &Path, options: &RunOptions, job: &mut Job) {
    let tools = &mut job.session.tools;
    for number in broken_tools::of_all(folder) {
        if let Some(tool) = tools.get(number).filter(|_| !options.renewed.contains(&number)) {
            let mut tool = tool.clone();
            tool.life.is_broken = true;
            tools.insert(tool);
        }
    }
}
