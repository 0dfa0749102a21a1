//! `leadscrew recover`: what is known of a tap in the work after the control has died, and the way out along its thread.
//!
//! ```text
//!   sync record ─┐
//!   encoders ────┴─► where on the (θ, z) plane, how certainly ─► projection ─► kernel ─► out ─► record says out
//!                         │ not certainly enough                     │ --dry-run
//!                         └► refused, with the reason                └► plan and picture
//! ```
//!
//! Nothing is written before the tap is out: whoever is killed here can be begun again, as often as it takes.
use crate::args::{Format, RecoverArgs, RecoveryWay};
use crate::plant::{Plant, identity};
use crate::refused::Refused;
use crate::{iron, keeper, say, wiring};
use bus::{Feedback, Machine};
use kernel::{EventKind, Kernel, RecoveryFigures, RecoveryPlan};
use std::f64::consts::TAU;
use store::machine::{MachineFile, Spindle};
use store::sync_record::slots::{Slots, StateFolder};
use store::sync_record::{Stage, Stroke, SyncRecord};
use sync::Coupling;
use sync::recovery::{Direction, Mover, Point, Projection, Seat, Stored, Way};
use units::{Angle, Length, Spin, SpinAccel, Stiffness, Time};
use wire::{Hello, Remote, Stop, Welcome};

/// The spindle turns no faster on the way out.
const OUT: (Spin, SpinAccel) = (Spin::rpm(300.0), SpinAccel::rev_per_s2(40.0));
/// From here on a holder is stiff: an error of a tenth of a millimetre presses with half a kilonewton.
const STIFF: Stiffness = Stiffness::n_per_mm(5000.0);
/// A recovery that takes longer has gone wrong.
const LONGEST: Time = Time::s(300.0);

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

/// What is found out.
struct Findings {
    stored: Stored,
    at: Point,
    turn: Angle,
    bound: Length,
    why_bound: String,
    projection: Projection,
    direct: Projection,
    way: Way,
}

/// What is said in the end.
struct Answer {
    outcome: Outcome,
    reason: String,
    record: Option<SyncRecord>,
    findings: Option<Findings>,
    figures: Option<RecoveryFigures>,
    /// What else should be known.
    note: Option<String>,
}

impl Answer {
    fn plain(outcome: Outcome, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self { outcome, reason, record: None, findings: None, figures: None, note: None }
    }
}

/// Do it; whether nothing is left in the work.
pub(crate) fn command(args: &RecoverArgs) -> Result<bool, Refused> {
    let answer = answer(args)?;
    let text = match args.format {
        Format::Json => json(args, &answer),
        Format::Text => text(args, &answer),
    };
    say::out(&text)?;
    Ok(answer.outcome != Outcome::Refused)
}

fn answer(args: &RecoverArgs) -> Result<Answer, Refused> {
    let stream = iron::connect(&args.iron)?;
    let name = args.machine.clone().unwrap_or_else(|| "tapping-center".into());
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
    let Some(record) = kept.record.filter(|record| record.stage != Stage::Out) else {
        return Ok(Answer::plain(
            Outcome::Nothing,
            "the sync record says that no tap is in the work",
        ));
    };
    if !keeper::in_work(&record, &feedback) {
        if !args.dry_run {
            forget(&mut slots, &record)?;
        }
        let reason = "the sync record tells of a tap, and the encoders that it is out of the work";
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
        store::output::write_file(path, picture(&record, &findings).as_bytes())?;
    }
    let mut answer =
        Answer { note, ..Answer::plain(Outcome::Recovered, "out of the work along its thread") };
    if args.dry_run {
        "rehearsed: nothing has moved".clone_into(&mut answer.reason);
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

/// The tap is out: say so on the disk.
fn forget(slots: &mut Slots<StateFolder>, record: &SyncRecord) -> Result<(), Refused> {
    let out = SyncRecord { stage: Stage::Out, ..record.clone() };
    slots.write(&out).map_err(|e| {
        Refused::because(format!(
            "the tap is out, but the sync record cannot be written: {e}; free the disk and recover again"
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
        },
        stage: Stage::Out,
        stroke: Stroke {
            axis: 2,
            spindle: 0,
            tool: 0,
            diameter: Length::ZERO,
            theta0: Angle::ZERO,
            z0: Length::ZERO,
            lead: units::Lead::mm_per_rev(1.0),
            start: Length::ZERO,
            bottom: Length::mm(-1.0),
            surface: Length::ZERO,
            spin: Spin::ZERO,
            stiffness: Stiffness::ZERO,
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

/// Where the tap stands, and the way back onto its coupling; or why that cannot be known.
fn find(
    stroke: &Stroke,
    stage: Stage,
    welcome: &Welcome,
    file: &MachineFile,
    way: RecoveryWay,
) -> Result<Findings, String> {
    let coupling = Coupling::line(stroke.lead, stroke.theta0, stroke.z0);
    let angle = |z: Length| stroke.theta0 + (z - stroke.z0) / stroke.lead;
    let direction = match stage {
        Stage::Inward | Stage::Out => Direction::Inward,
        Stage::Outward => Direction::Outward,
    };
    let stored = Stored::on(coupling, angle(stroke.start), angle(stroke.bottom), direction);
    let feedback = &welcome.observed.feedback;
    let place = feedback.axes[usize::from(stroke.axis)].position;
    let reading = feedback.spindles[usize::from(stroke.spindle)].angle;
    let Some(spindle) = file.spindles.get(usize::from(stroke.spindle)) else {
        return Err(format!("the machine's file has no spindle {}", stroke.spindle));
    };
    let (turned, bound, why_bound) = if welcome.turns_lost[usize::from(stroke.spindle)] {
        let (bound, why) = shown(stroke, spindle, file.tapping.sync_stop, welcome.stop);
        let turned = stored.turn(reading, place, bound).map_err(|e| {
            format!("the spindle's encoder has lost count of its turns, and the turn cannot be shown from the axis: {e} ({why})")
        })?;
        (turned, bound, format!("single-turn encoder, turn from the axis; {why}"))
    } else {
        let count = 1.0 / f64::from(spindle.encoder_counts_per_rev);
        let bound = Length::mm(stroke.lead.value().abs() * count) + Length::um(1.0);
        (reading, bound, "multi-turn encoder".to_owned())
    };
    let at = Point { angle: turned, place };
    let is_stiff = stroke.stiffness >= STIFF;
    let seat = Seat { play: Length::ZERO, is_stiff };
    let way = match way {
        RecoveryWay::Direct => Way::Direct,
        RecoveryWay::UnloadFirst => Way::UnloadFirst(seat),
    };
    Ok(Findings {
        projection: stored.project(at, way),
        direct: stored.project(at, Way::Direct),
        stored,
        at,
        turn: turned - reading,
        bound,
        why_bound,
        way,
    })
}

/// What the distance from the coupling is shown not to exceed: the monitor's window while everything was driven, and the
/// turns that the spindle ran down alone.
fn shown(stroke: &Stroke, spindle: &Spindle, window: Length, stop: Stop) -> (Length, String) {
    let omega = stroke.spin.in_rad_per_s().abs();
    let inertia = spindle.inertia.value();
    let (turns, how) = match stop {
        Stop::Coupled => (0.0, "the drives stopped together"),
        Stop::QuickStop => {
            let torque =
                0.9 * spindle.peak_torque.value().min(spindle.peak_power.value() / omega.max(1e-9));
            (inertia * omega * omega / 2.0 / torque / TAU, "the spindle braked by itself")
        }
        Stop::Coasted | Stop::None => {
            // J·ω·dω/dθ = −(c₀ + c₁ω), from ω to 0
            let c0 = spindle.friction.coulomb.value().max(1e-9);
            let c1 = spindle.friction.viscous_n_m_s_per_rad.max(1e-12);
            let turns = inertia / c1 * (omega - c0 / c1 * (1.0 + c1 * omega / c0).ln()) / TAU;
            (turns, "the spindle may have coasted")
        }
    };
    let bound = window + Length::mm(stroke.lead.value().abs() * turns);
    (bound, format!("{how}: {:.3} mm from the thread at most", bound.value()))
}

/// Take it out.
fn drive_out(
    plant: &mut Plant,
    file: &MachineFile,
    stroke: &Stroke,
    findings: &Findings,
) -> Result<RecoveryFigures, String> {
    let letter = canon::Axis::ALL[usize::from(stroke.axis)];
    let Some(axis) = file.axis(letter) else {
        return Err(format!("the machine's file has no axis {}", letter.letter()));
    };
    let mut kernel = Kernel::new(wiring::control(file, None, false));
    kernel.recover(RecoveryPlan {
        axis: letter,
        spindle: stroke.spindle,
        stored: findings.stored,
        turn: findings.turn,
        way: findings.way,
        spin: OUT,
        feed: (axis.gentle.speed / 10.0, axis.gentle.acceleration),
        retreat: None,
    });
    let mut feedback = plant.feedback();
    let until = feedback.time + LONGEST;
    let mut figures = None;
    while feedback.time < until {
        let command = kernel.tick(&feedback);
        while let Some(event) = kernel.next_event() {
            if let EventKind::RecoveryEnded(ended) = event.kind {
                figures = Some(ended);
            }
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
        feedback = plant.exchange(&command);
    }
    figures.ok_or_else(|| format!("it is not out after {LONGEST}"))
}

fn picture(record: &SyncRecord, findings: &Findings) -> String {
    let stroke = &record.stroke;
    let zero = findings.stored.start().angle;
    let point = |p: Point| [(p.angle - zero).value(), (p.place - stroke.surface).value()];
    report::recovery_svg(&report::Recovery {
        title: format!(
            "Tool {} in hole {} of {}",
            stroke.tool, record.place.hole, record.place.program
        ),
        start: point(findings.stored.start()),
        end: point(findings.stored.end()),
        stop: point(findings.at),
        chosen: [findings.projection.unloaded, findings.projection.to].map(point),
        direct: point(findings.direct.to),
    })
}

/// Who moves first.
fn first(findings: &Findings) -> &'static str {
    let projection = &findings.projection;
    match projection.mover {
        _ if projection.unloaded != projection.from => "feed, to zero force",
        Some(Mover::Feed) => "feed",
        Some(Mover::Spindle) => "spindle",
        None => "nobody: it is on its thread",
    }
}

/// The command that goes on with the rest.
fn go_on(args: &RecoverArgs, record: &SyncRecord) -> String {
    let state =
        args.state.as_ref().map_or_else(String::new, |s| format!(" --state {}", s.display()));
    format!(
        "leadscrew run {} --iron {}{state} --from \"hole {}\"",
        record.place.program,
        args.iron.display(),
        record.place.hole
    )
}

fn json(args: &RecoverArgs, answer: &Answer) -> String {
    let record = answer.record.as_ref();
    let findings = answer.findings.as_ref();
    let error = findings.map(|f| f.stored.error(f.at).in_um());
    let value = serde_json::json!({
        "outcome": match answer.outcome {
            Outcome::Recovered => "recovered",
            Outcome::Refused => "refused",
            Outcome::Nothing => "nothing-to-do",
        },
        "reason": answer.reason,
        "phase_error_before_um": error,
        "phase_error_bound_um": findings.map(|f| f.bound.in_um()),
        "helix_error_max_um": answer.figures.as_ref().map(|f| f.helix_error_max.in_um()),
        "moved_first": findings.map(first),
        "hand": record.map(|r| if r.stroke.is_right_hand() { "right" } else { "left" }),
        "program": record.map(|r| r.place.program.as_str()),
        "line": record.map(|r| r.place.line),
        "hole": record.map(|r| r.place.hole),
        "tool": record.map(|r| r.stroke.tool),
        "dry_run": args.dry_run,
        "note": answer.note,
        "continue_with": record.filter(|_| answer.outcome == Outcome::Recovered).map(|r| go_on(args, r)),
    });
    format!("{value:#}\n")
}

fn text(args: &RecoverArgs, answer: &Answer) -> String {
    let mut text = match answer.outcome {
        Outcome::Recovered => "recovered: ".to_owned(),
        Outcome::Refused => "refused: ".to_owned(),
        Outcome::Nothing => "nothing to do: ".to_owned(),
    };
    text += &answer.reason;
    text.push('\n');
    if let Some(record) = &answer.record {
        let (stroke, place) = (&record.stroke, &record.place);
        let hand = if stroke.is_right_hand() { "right" } else { "left" };
        text += &format!(
            "  tap            tool {}, {hand} hand, lead {} mm; hole {} of {}, line {}\n",
            stroke.tool,
            stroke.lead.value().abs(),
            place.hole,
            place.program,
            place.line
        );
    }
    if let Some(findings) = &answer.findings {
        let error = findings.stored.error(findings.at);
        let phase = findings.stored.phase_difference(findings.at).in_deg();
        text += &format!(
            "  before         {:.1} µm off its thread ({phase:.2}° of the spindle), known within {:.1} µm: {}\n",
            error.in_um(),
            findings.bound.in_um(),
            findings.why_bound
        );
        text += &format!("  moves first    {}\n", first(findings));
    }
    if let Some(figures) = &answer.figures {
        text += &format!(
            "  on the way out {:.1} µm off its thread at most, {:.2} s\n",
            figures.helix_error_max.in_um(),
            figures.duration.value()
        );
    }
    if let Some(note) = &answer.note {
        text += &format!("  note           {note}\n");
    }
    if let Some(path) = args.picture.as_ref().filter(|_| answer.findings.is_some()) {
        text += &format!("  picture        {}\n", path.display());
    }
    match (&answer.record, answer.outcome) {
        (Some(record), Outcome::Recovered) if !args.dry_run => {
            text += &format!("  go on with     {}\n", go_on(args, record));
        }
        (_, Outcome::Refused) => {
            text += "  help           take the tap out by hand; then: leadscrew recover … --discard-record\n";
        }
        _ => {}
    }
    text
}
