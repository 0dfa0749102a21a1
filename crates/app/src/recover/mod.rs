//! `leadscrew recover`: what is known of a tap in the work after the control has died, and the way out along its thread.
//!
//! ```text
//!   sync record ─┐
//!   encoders ────┴─► where on the (θ, z) plane, how certainly ─► projection ─► kernel ─► out ─► record says out
//!                         │ not certainly enough                     │ --dry-run
//!                         └► refused, with the reason                └► plan and picture
//! ```
//!
//! A tool that is not screwed to the work (a pass over a thread, a cam, a polygon, a gear) needs no angle: [`withdraw`].
//!
//! Nothing is written before the tap is out: whoever is killed here can be begun again, as often as it takes.
mod find;
mod say;
mod withdraw;
pub(crate) use withdraw::along_pass;

use crate::args::{Format, RecoverArgs};
use crate::plant::{Plant, identity};
use crate::refused::Refused;
use crate::{iron, keeper};
use bus::{Feedback, Machine};
use find::{Findings, drive_out, find};
use kernel::{EventKind, Kernel, RecoveryFigures};
use std::os::unix::net::UnixStream;
use store::machine::MachineFile;
use store::sync_record::slots::{Slots, StateFolder};
use store::sync_record::{Cut, Stage, Stroke, SyncRecord};
use units::{Angle, Length, Spin, SpinAccel, Stiffness, Time};
use wire::{Hello, Remote};
use withdraw::Withdrawal;

/// The machine, if none is named.
pub(crate) const USUAL: &str = "tapping-center";
/// The spindle turns no faster on the way out.
pub(crate) const OUT: (Spin, SpinAccel) = (Spin::rpm(300.0), SpinAccel::rev_per_s2(40.0));
/// A recovery that takes longer has gone wrong.
pub(crate) const LONGEST: Time = Time::s(300.0);

/// What is said of a rehearsal.
const REHEARSED: &str = "rehearsed: nothing has moved";

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The tap is out, or would be.
    Recovered,
    /// It is where it was.
    Refused,
    /// There is none.
    Nothing,
}

/// What is said in the end.
struct Answer {
    outcome: Outcome,
    reason: String,
    record: Option<SyncRecord>,
    findings: Option<Findings>,
    figures: Option<RecoveryFigures>,
    /// Of a tool that is not screwed to the work: the way, and how long it took.
    withdrawal: Option<(Withdrawal, Option<Time>)>,
    /// What else should be known.
    note: Option<String>,
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

/// Do it; whether nothing is left in the work.
pub(crate) fn command(args: &RecoverArgs) -> Result<bool, Refused> {
    let answer = answer(args)?;
    let text = match args.format {
        Format::Json => say::json(args, &answer),
        Format::Text => say::text(args, &answer),
    };
    crate::say::out(&text)?;
    Ok(answer.outcome != Outcome::Refused)
}

fn answer(args: &RecoverArgs) -> Result<Answer, Refused> {
    let stream = iron::connect(&args.iron)?;
    let name = args.machine.clone().unwrap_or_else(|| USUAL.into());
    let file = crate::machine::load(&name)?;
    let hello = Hello {
        name: "leadscrew recover".into(),
        machine: file.name.clone(),
        process: std::process::id(),
    };
    let remote = Remote::connect(stream, hello).map_err(|e| iron::gone(&args.iron, &e))?;
    let welcome = remote.welcome().clone();
    let identity = identity(&welcome);
    let path = keeper::folder(args.state.as_deref(), &identity)?;
    if args.discard_record {
        Slots::discard(StateFolder::open(&path)?, &nobody(&identity))
            .map_err(|e| Refused::because(format!("cannot discard the sync record: {e}")))?;
        return Ok(Answer::plain(Outcome::Nothing, "the sync record is discarded"));
    }
    let (mut slots, kept) = match keeper::open(&path, &identity)? {
        Ok(opened) => opened,
        Err(why) => return Ok(Answer::plain(Outcome::Refused, why.to_string())),
    };
    let note = kept.beside.map(|why| format!("the other generation does not count: {why}"));
    let feedback = welcome.observed.feedback;
    let Some(record) = kept.record.filter(|record| record.stage.is_in_work()) else {
        return Ok(Answer::plain(
            Outcome::Nothing,
            "the sync record says that no tool is in the work",
        ));
    };
    if !keeper::in_work(&record, &feedback) {
        if !args.dry_run {
            forget(&mut slots, &record)?;
        }
        let reason =
            "the sync record tells of a tool in the work, and the encoders that it is out of it";
        return Ok(Answer {
            record: Some(record),
            note,
            ..Answer::plain(Outcome::Nothing, reason)
        });
    }
    if feedback.tool != Some(record.stroke.tool) {
        let reason = wrong_tool(&record, &feedback);
        return Ok(Answer {
            record: Some(record),
            note,
            ..Answer::plain(Outcome::Refused, reason)
        });
    }
    if let Some(retreat) = record.stroke.retreat {
        let way = withdraw::find(&record.stroke, retreat, &welcome);
        let mut answer = Answer {
            note,
            ..Answer::plain(Outcome::Recovered, "off the work along its infeed axis")
        };
        if let Some(path) = &args.picture {
            match say::picture_of_pass(&record, &feedback, &file) {
                Some(picture) => store::output::write_file(path, picture.as_bytes())?,
                None => answer.add_note(
                    "there is no picture: only taps and threads of one lead go back along a line",
                ),
            }
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
    if let Some(path) = &args.picture {
        store::output::write_file(path, say::picture(&record, &findings).as_bytes())?;
    }
    let mut answer =
        Answer { note, ..Answer::plain(Outcome::Recovered, "out of the work along its thread") };
    if args.dry_run {
        REHEARSED.clone_into(&mut answer.reason);
    } else {
        let mut plant = Plant::Outside(Box::new(remote));
        match drive_out(&mut plant, &file, &record.stroke, &findings) {
            Ok(figures) => {
                forget(&mut slots, &record)?;
                answer.figures = Some(figures);
            }
            Err(reason) => (answer.outcome, answer.reason) = (Outcome::Refused, reason),
        }
    }
    (answer.record, answer.findings) = (Some(record), Some(findings));
    Ok(answer)
}

/// Take a tool off work that it is not screwed to.
fn withdrawn(
    args: &RecoverArgs,
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
        let mut plant = Plant::Outside(Box::new(remote));
        match withdraw::drive(&mut plant, file, &record.stroke, &way) {
            Ok(drawn) => {
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
    plant: &mut Plant,
    hear: &mut dyn FnMut(&EventKind),
) -> Result<(), String> {
    let mut feedback = plant.feedback();
    let until = feedback.time + LONGEST;
    while feedback.time < until {
        let command = kernel.tick(&feedback);
        while let Some(event) = kernel.next_event() {
            hear(&event.kind);
        }
        if let Some(why) = plant.lost() {
            return Err(format!("the iron is gone: {why}"));
        }
        if let Some(fault) = kernel.faults().first() {
            return Err(fault.to_string());
        }
        if kernel.is_over() {
            break;
        }
        let heard = plant.exchange(&command);
        for between in crate::late::missed(&feedback, &heard, plant.period()) {
            kernel.tick(&between);
        }
        feedback = heard;
    }
    Ok(())
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
fn nobody(identity: &store::sync_record::Identity) -> SyncRecord {
    SyncRecord {
        identity: identity.clone(),
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
            geared: None,
        },
    }
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
