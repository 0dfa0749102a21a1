//! What is known of a tool in the work after the control has died, and the way out.
//!
//! ```text
//!   sync record ─┐
//!   encoders ────┴─► where on the (θ, z) plane, how certainly ─► projection ─► kernel ─► out ─► record says out
//!                         │ not certainly enough                     │ --dry-run
//!                         └► refused, with the reason                └► plan and picture
//! ```
//!
//! A tool that is not screwed to the work (a pass over a thread, a cam, a polygon, a gear) needs no
//! angle: `withdraw`.
//!
//! Nothing is written before the tap is out: a recovery that is killed can be begun again, as often
//! as it takes.
mod bound;
mod find;
pub mod in_work;
mod left;
mod withdraw;

pub use find::Findings;
pub(crate) use left::{LeftTool, WayOut, left};
pub use withdraw::{Leg, Off, Withdrawal, along_pass, pass};

use crate::drives::remote::{connect, gone, identity};
use crate::executor::period;
use crate::services::sync_record;
use crate::{Drives, Refused, config};
use bus::Feedback;
use find::{drive_out, find};
use in_work::InWork;
use kernel::{EventKind, Kernel, RecoveryFigures};
use std::ops::ControlFlow;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use store::machine::MachineFile;
use store::sync_record::slots::{Kept, Slots, StateFolder};
use store::sync_record::{Cut, Identity, Stage, Stroke, SyncRecord, Untrusted};
use units::{Angle, Length, Spin, SpinAccel, Stiffness, Time};
use wire::{Hello, Remote};

/// The spindle turns no faster on the way out.
pub const OUT: (Spin, SpinAccel) = (Spin::rpm(300.0), SpinAccel::rev_per_s2(40.0));
/// A recovery that takes longer has gone wrong.
pub const LONGEST: Time = Time::s(300.0);

/// What is said of a tap that was not tied to the spindle.
const FLOATING: &str = "the tap is in a floating or clutch holder, which ties no axis to the spindle: there is no line to take it back \
     along. Turn the spindle backwards by hand while the axis gives way, until the tap is out";

/// What is said of a rehearsal.
const REHEARSED: &str = "rehearsed: nothing has moved";

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The tap is out, or would be.
    Recovered,
    /// It is where it was.
    Refused,
    /// There is none.
    Nothing,
    /// It is out along its thread, and went so deep before that it may have broken.
    NotKnownWhole,
}

impl Outcome {
    /// The tap is out, or would be.
    pub const fn is_out(self) -> bool {
        matches!(self, Self::Recovered | Self::NotKnownWhole)
    }
}

/// What is said in the end.
pub struct Answer {
    /// How it ended.
    pub outcome: Outcome,
    /// Why, in a sentence.
    pub reason: String,
    /// What was written down of the tool.
    pub record: Option<SyncRecord>,
    /// Where a tool stands on its thread.
    pub findings: Option<Findings>,
    /// What the way out was like.
    pub figures: Option<RecoveryFigures>,
    /// Of a tool that is not screwed to the work: the way, and how long it took.
    pub withdrawal: Option<(Withdrawal, Option<Time>)>,
    /// What else should be known.
    pub note: Option<String>,
}

impl Answer {
    fn plain(outcome: Outcome, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        let (record, findings, figures) = (None, None, None);
        Self { outcome, reason, record, findings, figures, withdrawal: None, note: None }
    }

    fn add_note(&mut self, note: &str) {
        self.note =
            Some(self.note.take().map_or_else(|| note.to_owned(), |said| said + "; " + note));
    }
}

/// Who moves back onto the thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecoveryWay {
    /// In a stiff holder the feed, to where nothing presses; then the axis that overran.
    UnloadFirst,
    /// The axis that overran.
    Direct,
}

/// What a recovery is told.
#[derive(Debug, Clone)]
pub struct RecoveryOptions {
    /// Socket of the machine.
    pub socket: PathBuf,
    /// Its model: an embedded name, or a file.
    pub machine: String,
    /// Folder of the sync record; `None` is the machine's usual one.
    pub state: Option<PathBuf>,
    /// Say what would be done, and move nothing.
    pub dry_run: bool,
    /// Who moves back onto the thread.
    pub way: RecoveryWay,
    /// A person has seen that no tool is in the work: record and machine forget it.
    pub tool_is_free: bool,
}

/// What is known before anything moves.
pub enum Known<'a> {
    /// Of a tool on its thread.
    OnThread(&'a SyncRecord, &'a Findings),
    /// Of a tool that is not screwed to the work.
    OffWork(&'a SyncRecord, &'a Feedback, &'a MachineFile),
}

/// Sees what is known before anything moves; answers with what else should be known, and may
/// refuse.
pub type Look<'a> = &'a mut dyn FnMut(Known<'_>) -> Result<Option<String>, Refused>;

/// Find out what is in the work, and take it out.
///
/// # Errors
/// The machine or the sync record cannot be reached; what could be reached and may not be moved is
/// an [`Answer`].
pub fn recover(options: &RecoveryOptions, look: Look<'_>) -> Result<Answer, Refused> {
    answer(options, look)
}

fn answer(args: &RecoveryOptions, see: Look<'_>) -> Result<Answer, Refused> {
    let stream = connect(&args.socket)?;
    let file = config::machine_file::load(&args.machine)?;
    let hello = Hello { name: "leadscrew recover".into(), machine: file.name.clone() };
    let mut remote = Remote::connect(stream, hello).map_err(|e| gone(&args.socket, &e))?;
    let welcome = remote.welcome().clone();
    let identity = identity(&welcome);
    let path = sync_record::folder(args.state.as_deref(), &identity)?;
    if args.tool_is_free {
        drop(remote);
        return set_free(args, &path, &identity);
    }
    let feedback = welcome.observed.feedback;
    let folder = path.display().to_string();
    let (mut slots, kept) = match look(&path, &identity)? {
        Some(Ok(looked)) => looked,
        Some(Err(why)) => return Ok(Answer::plain(Outcome::Refused, why.to_string())),
        None => return Ok(Answer::plain(Outcome::Refused, no_record(&welcome, &folder))),
    };
    let note = kept.beside.map(|why| format!("the other generation does not count: {why}"));
    let in_work = kept.record.clone().filter(|record| record.stage.is_in_work());
    let record = match in_work::judge(kept.record, &welcome, &folder) {
        InWork::Tool(record) => *record,
        InWork::Unknown(why) => {
            return Ok(Answer { record: in_work, note, ..Answer::plain(Outcome::Refused, why) });
        }
        InWork::Nothing(why) => {
            if !args.dry_run {
                in_work.as_ref().map_or(Ok(()), |record| forget(&mut slots, record))?;
                drop(remote);
                if welcome.evidence.in_work.is_some() {
                    tell_machine(args)?;
                }
            }
            return Ok(Answer { record: in_work, note, ..Answer::plain(Outcome::Nothing, why) });
        }
    };
    remote.engage(welcome.evidence.in_work);
    if let Some(reason) = not_by_recovery(&record, &feedback) {
        return Ok(Answer {
            record: Some(record),
            note,
            ..Answer::plain(Outcome::Refused, reason)
        });
    }
    if let Some(retreat) = record.stroke.retreat {
        let way = withdraw::find(&record.stroke, retreat, &welcome, &file);
        let mut answer = Answer {
            note,
            ..Answer::plain(Outcome::Recovered, "off the work along its infeed axis")
        };
        if let Some(note) = see(Known::OffWork(&record, &feedback, &file))? {
            answer.add_note(&note);
        }
        return withdrawn(args, remote, &file, (&mut slots, record), way, answer);
    }
    let findings = match find(&record.stroke, record.stage, &welcome, &file, args.way) {
        Ok(findings) => findings,
        Err(reason) => {
            return Ok(Answer {
                record: Some(record),
                note,
                ..Answer::plain(Outcome::Refused, reason)
            });
        }
    };
    let seen = see(Known::OnThread(&record, &findings))?;
    let mut answer =
        Answer { note, ..Answer::plain(Outcome::Recovered, "out of the work along its thread") };
    if let Some(note) = seen {
        answer.add_note(&note);
    }
    if args.dry_run {
        REHEARSED.clone_into(&mut answer.reason);
    } else {
        remote.engage(findings.mark(welcome.evidence.in_work));
        let mut plant = remote;
        match drive_out(&mut plant, &file, &record.stroke, &findings) {
            Ok(figures) => {
                is_out(&mut plant, &file)?;
                forget(&mut slots, &record)?;
                answer.figures = Some(figures);
                if findings.not_known_whole.is_some() {
                    (answer.outcome, answer.reason) =
                        (Outcome::NotKnownWhole, "the axis is back along its thread".into());
                }
            }
            Err(reason) => (answer.outcome, answer.reason) = (Outcome::Refused, reason),
        }
    }
    (answer.record, answer.findings) = (Some(record), Some(findings));
    Ok(answer)
}

/// Take a tool off work that it is not screwed to.
fn withdrawn(
    args: &RecoveryOptions,
    remote: Remote<UnixStream>,
    file: &MachineFile,
    (slots, record): (&mut Slots<StateFolder>, SyncRecord),
    way: Withdrawal,
    mut answer: Answer,
) -> Result<Answer, Refused> {
    let mut taken = None;
    if args.dry_run {
        REHEARSED.clone_into(&mut answer.reason);
    } else {
        let mut plant = remote;
        match withdraw::drive(&mut plant, file, &record.stroke, &way) {
            Ok(drawn) => {
                is_out(&mut plant, file)?;
                forget(slots, &record)?;
                (answer.figures, taken) = (drawn.figures, Some(drawn.duration));
                drawn.note.iter().for_each(|note| answer.add_note(note));
            }
            Err(reason) => (answer.outcome, answer.reason) = (Outcome::Refused, reason),
        }
    }
    (answer.record, answer.withdrawal) = (Some(record), Some((way, taken)));
    Ok(answer)
}

/// Let a kernel take a tool out, and hear what it says.
fn obey(
    kernel: &mut Kernel,
    plant: &mut dyn Drives,
    hear: &mut dyn FnMut(&EventKind),
) -> Result<(), String> {
    let until = plant.feedback().time + LONGEST;
    while plant.feedback().time < until {
        let ended = period(kernel, plant, |kernel, plant, _| {
            while let Some(event) = kernel.next_event() {
                hear(&event.kind);
            }
            if let Some(why) = plant.lost() {
                return ControlFlow::Break(Err(why));
            }
            if let Some(fault) = kernel.faults().first() {
                return ControlFlow::Break(Err(fault.to_string()));
            }
            if kernel.is_over() { ControlFlow::Break(Ok(())) } else { ControlFlow::Continue(()) }
        });
        if let ControlFlow::Break(ended) = ended {
            return ended;
        }
    }
    Ok(())
}

/// A person has looked, and states that no tool is in the work.
fn set_free(args: &RecoveryOptions, path: &Path, identity: &Identity) -> Result<Answer, Refused> {
    Slots::discard(StateFolder::open(path)?, &no_tool(identity))
        .map_err(|e| Refused::because(format!("cannot discard the sync record: {e}")))?;
    tell_machine(args)?;
    let said = "as you state, no tool is in the work: record and machine have forgotten it";
    Ok(Answer::plain(Outcome::Nothing, said))
}

/// The tool is out: the machine is told with a command that holds everything where it stands.
fn is_out(plant: &mut dyn Drives, file: &MachineFile) -> Result<(), Refused> {
    plant.engage(None);
    let mut kernel = Kernel::new(config::unreferenced(file));
    // nothing breaks it off
    let _ = period(&mut kernel, plant, |_, _, _| ControlFlow::<()>::Continue(()));
    match plant.lost() {
        Some(why) => Err(Refused::because(format!(
            "the tool is out, but the machine cannot be told so: {why}; recover again"
        ))),
        None => Ok(()),
    }
}

/// No tool is in the work: the machine forgets the one that it keeps.
fn tell_machine(args: &RecoveryOptions) -> Result<(), Refused> {
    let told = wire::order(connect(&args.socket)?, wire::Order::ToolIsFree);
    told.map(|_| ()).map_err(|e| gone(&args.socket, &e))
}

/// Where the tool side of an axis stands, at rest: an encoder at the motor does not see that a
/// weight stretches its screw.
fn stands(file: &MachineFile, feedback: &Feedback, axis: u8) -> Length {
    let reading = feedback.axes[usize::from(axis)].position;
    let control = config::control(file, None, false);
    let control = control.axes.get(usize::from(axis)).and_then(Option::as_ref);
    let place = control.map_or(reading, |control| control.tool_side_at_rest(reading));
    place.of_linear()
}

/// What lies in a state folder.
type Looked = Result<(Slots<StateFolder>, Kept), Untrusted>;

/// Look into the state folder; `None`: there has never been a record in it. Who only looks makes no
/// folder.
fn look(path: &Path, identity: &Identity) -> Result<Option<Looked>, Refused> {
    if !path.exists() {
        return Ok(None);
    }
    let looked = Slots::open(StateFolder::open_existing(path)?, identity);
    Ok(Some(looked).filter(|looked| !matches!(looked, Ok((_, Kept { record: None, .. })))))
}

/// What is said where there is no record.
fn no_record(welcome: &wire::Welcome, folder: &str) -> String {
    match in_work::judge(None, welcome, folder) {
        InWork::Unknown(why) => why,
        InWork::Tool(_) | InWork::Nothing(_) => format!(
            "there is no sync record in {folder}, so nothing is known from it. The machine itself keeps that no tool is in its work: a run \
             may begin"
        ),
    }
}

/// The tool is out: say so on the disk.
fn forget(slots: &mut Slots<StateFolder>, record: &SyncRecord) -> Result<(), Refused> {
    let out = SyncRecord { stage: Stage::Recovered, ..record.clone() };
    slots.write(&out).map_err(|e| {
        Refused::because(format!(
            "the tool is out, but the sync record cannot be written: {e}; free the disk and recover again"
        ))
    })
}

/// A record that tells of no tap.
pub fn no_tool(identity: &Identity) -> SyncRecord {
    SyncRecord {
        identity: identity.clone(),
        engagement: 0,
        place: store::sync_record::Place {
            program: String::new(),
            checksum: 0,
            op: 0,
            line: 0,
            hole: 0,
            command: Vec::new(),
        },
        stage: Stage::Out,
        stroke: Stroke {
            cut: Cut::Tap,
            retreat: None,
            axis: 2,
            spindle: 0,
            tool: 0,
            diameter: Length::ZERO,
            theta0: Angle::ZERO,
            z0: Length::ZERO,
            lead: units::Lead::mm_per_rev(1.0),
            growth: units::LeadGrowth::ZERO,
            start: Length::ZERO,
            bottom: Length::mm(-1.0),
            surface: Length::ZERO,
            spin: Spin::ZERO,
            stiffness: Stiffness::ZERO,
            travel: Length::ZERO,
            thread_length: Length::ZERO,
            geared: None,
        },
    }
}

/// Why no recovery can take this tool out.
fn not_by_recovery(record: &SyncRecord, feedback: &Feedback) -> Option<String> {
    if feedback.tool != Some(record.stroke.tool) {
        return Some(wrong_tool(record, feedback));
    }
    (record.stroke.cut == Cut::FloatingTap).then(|| FLOATING.into())
}

fn wrong_tool(record: &SyncRecord, feedback: &Feedback) -> String {
    let wanted = record.stroke.tool;
    match feedback.tool {
        Some(0) => format!(
            "the spindle holds no tool, and tool {wanted} is in the work by the sync record"
        ),
        Some(other) => {
            format!("the spindle holds tool {other}, and the sync record is tool {wanted}'s")
        }
        None => format!(
            "the tool changer is at work, and tool {wanted} is in the work by the sync record"
        ),
    }
}
